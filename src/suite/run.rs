//! The run of a test's inputs, and the claims about it. A predicate counts in a state as `hypedc sim --expect` counts it: out
//! of bounds no goal holds, and a `never` does.

use std::sync::Arc;

use crate::compile::{Asked, Compilation, ExtraQuestion, TestCase, TestClaim, TestClaimKind, When, question_name};
use crate::ir::{ExprId, NeverId, SlotId, World};
use crate::sim::{Fault, Run, Script, Simulator, State};
use crate::source::SourceMap;
use crate::watch::Watch;
use crate::why::{place, predicate_atoms, predicate_distance};

use super::record::ClaimResult;
use super::{ORIGIN, Subject};

/// Number of steps between two looks at the watch.
const STEPS_PER_POLL: u64 = 256;

/// What came of a run.
pub(super) struct Ran {
    /// Why it is no good run.
    pub problems: Vec<String>,
    /// Number of its steps.
    pub steps: u64,
    /// The claims about it.
    pub claims: Vec<ClaimResult>,
}

/// Runs the inputs of a test, and answers its claims about the run.
pub(super) fn run(subject: &Subject<'_>, case: &TestCase, sources: &SourceMap, watch: &dyn Watch) -> Ran {
    let expects: Vec<(&TestClaim, When)> = case
        .claims
        .iter()
        .filter_map(|claim| if let TestClaimKind::Expect(when) = claim.kind { Some((claim, when)) } else { None })
        .collect();
    let question = |(claim, _): &(&TestClaim, When)| claim.predicate.clone();
    let texts: Vec<String> = expects.iter().map(question).collect();
    let world = Some(case.world_name.as_str());
    let asked = |text| ExtraQuestion { asked: Asked::Either, world, text, origin: ORIGIN };
    let questions: Vec<ExtraQuestion<'_>> = texts.iter().map(String::as_str).map(asked).collect();
    let mut ran = Ran { problems: Vec::new(), steps: 0, claims: Vec::new() };
    let Compilation { sources: texts, program: Some(program), .. } = subject.compile(&questions, None) else {
        ran.problems.push("the program cannot be compiled with the predicates of the test".to_string());
        return ran;
    };
    let sim = Arc::new(Simulator::new(&program, case.world));
    let mut watched: Vec<Watched<'_>> = Vec::new();
    for (claim, when) in expects {
        match Watched::new(claim, when, sim.world()) {
            Some(one) => watched.push(one),
            None => ran.problems.push(format!("`{}` is no question of this world", claim.predicate)),
        }
    }
    let script = case.script.clone().unwrap_or_default();
    let needed = watched.iter().map(|claim| u64::from(claim.when.least_steps())).max().unwrap_or(0);
    let steps = script.len().max(needed);
    let ended = drive(&sim, (&script, case.seed), steps, &mut watched, watch);
    ran.steps = ended.steps;
    ran.problems.extend(ended.problem.as_ref().map(|problem| problem.words(&sim, ended.steps, steps)));
    let named = |never: NeverId| watched.iter().any(|claim| claim.never == Some(never));
    for (never, step) in ended.violated.iter().filter(|(never, _)| !named(*never)) {
        let name = &sim.world().nevers[*never].name;
        ran.problems.push(format!("`never {name}` is violated {}", after(&sim, *step)));
    }
    if let Some((slot, step)) = ended.broken {
        let name = &sim.world().slots[slot].name;
        ran.problems.push(format!("an invariant of `{name}` does not hold {}", after(&sim, step)));
    }
    let is_whole = ended.problem.is_none();
    ran.claims = watched.iter().map(|claim| claim.result(&sim, (&texts, sources), (ended.steps, is_whole))).collect();
    ran
}

/// `after step 90 (1.50 s)`, `at the start`
fn after(sim: &Simulator, step: u64) -> String {
    match step {
        0 => "at the start".to_string(),
        _ => format!("after step {step} ({:.2} s)", step as f64 * sim.world().step.seconds()),
    }
}

/// How a run ended.
struct Ended {
    steps: u64,
    /// Why it did not go on to its last step, or should not have ended so.
    problem: Option<Problem>,
    /// The first step after which each `never` holds that does.
    violated: Vec<(NeverId, u64)>,
    /// The first broken invariant.
    broken: Option<(SlotId, u64)>,
}

enum Problem {
    LeftBounds(SlotId),
    Fault(Fault, u64),
    Stopped,
}

impl Problem {
    fn words(&self, sim: &Simulator, step: u64, steps: u64) -> String {
        match self {
            Problem::LeftBounds(slot) => {
                let name = &sim.world().slots[*slot].name;
                format!("the run ends {}: `{name}` has left the bounds of its space", after(sim, step))
            }
            Problem::Fault(fault, step) => {
                let fact = fault.fact(sim.program(), sim.world_id(), *step);
                format!("the run ends by an error in step {step}: {} in `{}`", fact.what, fact.instance)
            }
            Problem::Stopped => format!("stopped after step {step} of {steps}"),
        }
    }
}

/// A claim about the run, as far as the run has gone.
struct Watched<'c> {
    claim: &'c TestClaim,
    when: When,
    predicate: ExprId,
    /// The `never` that it names.
    never: Option<NeverId>,
    /// Whether it is decided, and how.
    decided: Option<bool>,
    /// The step that decides, or the nearest one so far, and the state after it.
    step: Option<(u64, State)>,
    /// How near that state is.
    distance: (usize, f64),
}

impl<'c> Watched<'c> {
    fn new(claim: &'c TestClaim, when: When, world: &World) -> Option<Self> {
        let name = question_name(&claim.predicate);
        let goal = world.goal_named(&name);
        let never = world.never_named(&name).filter(|_| goal.is_none());
        let goal = goal.map(|goal| world.goals[goal].holds);
        let predicate = goal.or_else(|| never.map(|never| world.nevers[never].holds))?;
        let distance = (usize::MAX, f64::INFINITY);
        Some(Watched { claim, when, predicate, never, decided: None, step: None, distance })
    }

    /// Looks at the state after a step.
    fn look(&mut self, sim: &Simulator, step: u64, state: &State, is_out: bool) -> Result<(), Fault> {
        let is_asked = match self.when {
            When::At(at) => step == u64::from(at),
            When::By(by) => step <= u64::from(by),
            When::AtEnd | When::ByEnd | When::Always | When::Never => true,
        };
        // Out of bounds, where the run is over, only a `never` counts.
        if self.decided.is_some() || !is_asked || is_out && self.never.is_none() {
            return Ok(());
        }
        let holds = sim.holds(state, self.predicate)?;
        let decided = match self.when {
            When::At(_) => Some(holds),
            When::By(_) | When::ByEnd if holds => Some(true),
            When::Always if !holds => Some(false),
            When::Never if holds => Some(false),
            // The last state is the one that counts; others are overwritten.
            When::AtEnd => None,
            When::By(_) | When::ByEnd => {
                let distance = predicate_distance(sim, state, self.predicate);
                if self.step.is_none() || distance < self.distance {
                    (self.distance, self.step) = (distance, Some((step, state.clone())));
                }
                None
            }
            When::Always | When::Never => None,
        };
        if decided.is_some() || self.when == When::AtEnd {
            (self.decided, self.step) = (decided, Some((step, state.clone())));
        }
        Ok(())
    }

    /// The result after the last state of the run.
    fn result(
        &self,
        sim: &Simulator,
        (texts, sources): (&SourceMap, &SourceMap),
        (steps, is_whole): (u64, bool),
    ) -> ClaimResult {
        let mut result = ClaimResult::new(self.claim, place(sources, self.claim.at));
        let last = self.step.as_ref().map(|(step, _)| *step);
        let at = |step: Option<u64>| after(sim, step.unwrap_or(steps));
        let holds_at_end = || self.step.as_ref().and_then(|(_, state)| sim.holds(state, self.predicate).ok());
        // What is not decided is so only if the run was as long as it should be.
        let (passed, answer) = match (self.when, self.decided) {
            (When::At(_) | When::By(_) | When::ByEnd, Some(true)) => (true, format!("holds {}", at(last))),
            (When::Never, Some(_)) => (false, format!("holds {}", at(last))),
            (When::At(_) | When::Always, Some(_)) => (false, format!("does not hold {}", at(last))),
            _ if !is_whole => (false, "not known: the run ended before".to_string()),
            (When::AtEnd, _) => match holds_at_end() {
                Some(true) => (true, format!("holds {}", at(last))),
                _ => (false, format!("does not hold {}", at(last))),
            },
            (When::By(_) | When::ByEnd, _) => {
                let end = match self.when {
                    When::By(by) => u64::from(by),
                    _ => steps,
                };
                let nearest = match last {
                    Some(last) if last < end && self.distance.1 > 0.0 => format!("; it is nearest {}", at(Some(last))),
                    _ => String::new(),
                };
                (false, format!("does not hold up to step {end}{nearest}"))
            }
            (When::Always, None) => (true, format!("holds up to step {steps}")),
            (When::Never, None) => (true, format!("does not hold up to step {steps}")),
            (When::At(_), None) => (false, "not known".to_string()),
        };
        (result.passed, result.answer) = (passed, answer);
        if !is_whole && self.decided.is_none() {
            return result;
        }
        result.step = last;
        if let Some((_, state)) = self.step.as_ref().filter(|_| !passed) {
            result.parts = predicate_atoms(sim, texts, state, self.predicate);
        }
        result
    }
}

/// Runs a number of steps; the claims look at each state, the initial one included.
fn drive(
    sim: &Arc<Simulator>,
    (script, seed): (&Script, Option<u64>),
    steps: u64,
    watched: &mut [Watched<'_>],
    watch: &dyn Watch,
) -> Ended {
    let mut ended = Ended { steps: 0, problem: None, violated: Vec::new(), broken: None };
    let mut run = match Run::of(Arc::clone(sim)) {
        Ok(run) => run,
        Err(fault) => return Ended { problem: Some(Problem::Fault(fault, 0)), ..ended },
    };
    run.set_seed(seed.unwrap_or_default());
    let nothing = run.nothing();
    let mut inputs = script.inputs().chain(std::iter::repeat(&nothing));
    for step in 0..=steps {
        if step > 0
            && let Err(fault) = run.step(inputs.next().unwrap_or(&nothing))
        {
            ended.problem = Some(Problem::Fault(fault, step));
            return ended;
        }
        ended.steps = step;
        let (state, left) = (run.state(), sim.left_bounds(run.state()));
        let looked = watched.iter_mut().try_for_each(|claim| claim.look(sim, step, state, left.is_some()));
        if let Err(fault) = looked.and_then(|()| ended.note(sim, step, state)) {
            ended.problem = Some(Problem::Fault(fault, step));
            return ended;
        }
        if let Some(slot) = left {
            ended.problem = Some(Problem::LeftBounds(slot));
            return ended;
        }
        if step % STEPS_PER_POLL == 0 && watch.stop() {
            ended.problem = Some(Problem::Stopped);
            return ended;
        }
    }
    ended
}

impl Ended {
    /// Notes `never`s and invariants that a state breaks.
    fn note(&mut self, sim: &Simulator, step: u64, state: &State) -> Result<(), Fault> {
        for (id, never) in sim.world().nevers.pairs() {
            let is_known = self.violated.iter().any(|(known, _)| *known == id);
            if !is_known && sim.holds(state, never.holds)? {
                self.violated.push((id, step));
            }
        }
        if self.broken.is_none() {
            self.broken = sim.broken_invariant(state)?.map(|(slot, _)| (slot, step));
        }
        Ok(())
    }
}
