//! The claims of a test about all runs: the questions of `hypedc reach`, with the same answers.

use std::sync::Arc;

use crate::compile::{
    Asked, Compilation, ExtraConstraint, ExtraQuestion, SearchKind, TestCase, TestClaim, TestSearch, added_nevers,
    question_name,
};
use crate::ir::{NeverId, Program, WorldId};
use crate::reach::query::{Answer, ProofMethod, Query, QueryError, Session, replay};
use crate::reach::{Conclusion, End, Limits, Luck, Settings, Target, Termination, Verdict};
use crate::sim::{Script, Simulator, parse_script};
use crate::source::SourceMap;
use crate::watch::Watch;
use crate::why::place;

use super::record::ClaimResult;
use super::ways::WayName;
use super::{ORIGIN, Subject, TestOptions};

/// The name of the `never` of a `without`: not a valid name in a program.
const WITHOUT: &str = "without";

/// A question that can be asked.
struct Question {
    program: Arc<Program>,
    sources: SourceMap,
    target: Target,
    query: Query,
}

/// What is known of a question.
struct Known {
    conclusion: Conclusion,
    /// What it says, in words.
    words: String,
    reasons: Vec<String>,
    /// The way, with its text.
    way: Option<(Script, String)>,
    /// Whether the whole budget was used, if nothing is known.
    is_spent: bool,
}

/// Answers a claim about all runs; returns the ways that were found, too.
pub(super) fn search(
    subject: &Subject<'_>,
    case: &TestCase,
    (claim, asked): (&TestClaim, &TestSearch),
    options: &TestOptions<'_>,
    sources: &SourceMap,
    watch: &dyn Watch,
) -> (ClaimResult, Vec<Script>) {
    let mut result = ClaimResult::new(claim, place(sources, claim.at));
    let is_needed = asked.is_needed;
    let first = TestSearch { without: asked.without.clone().filter(|_| !is_needed), ..asked.clone() };
    let mut known = match ask(subject, case, (claim, &first), options, watch) {
        Ok(known) => known,
        Err(why) => {
            result.answer = why;
            return (result, Vec::new());
        }
    };
    let mut ways: Vec<Script> = known.way.iter().map(|(script, _)| script.clone()).collect();
    let mut passed = known.is_as_claimed(asked.kind);
    if is_needed && passed {
        // There is a way: is there one without, too?
        let (kind, search) = (SearchKind::Unreachable, TestSearch { kind: SearchKind::Unreachable, ..asked.clone() });
        match ask(subject, case, (claim, &search), options, watch) {
            Ok(other) => {
                passed = other.is_as_claimed(kind);
                ways.extend(other.way.iter().map(|(script, _)| script.clone()));
                let words = format!("{}; without: {}", known.words, other.words);
                known = Known { words, ..other };
            }
            Err(why) => (passed, known.words) = (false, why),
        }
    }
    result.passed = passed;
    result.answer = known.words;
    result.verdict = Some(known.conclusion);
    result.reasons = known.reasons;
    result.step = known.way.as_ref().map(|(script, _)| script.len());
    result.inputs = known.way.map(|(_, text)| text);
    (result, ways)
}

impl Known {
    /// Whether it is what is claimed. Only `unfound` is content with less than a way or a proof.
    fn is_as_claimed(&self, kind: SearchKind) -> bool {
        match kind {
            SearchKind::Reachable => self.conclusion == Conclusion::Reached,
            SearchKind::Unreachable | SearchKind::Never => self.conclusion == Conclusion::ProvenUnreachable,
            SearchKind::Unfound => match self.conclusion {
                Conclusion::ProvenUnreachable | Conclusion::Exhausted => true,
                Conclusion::NotFound | Conclusion::NotAnswered => self.is_spent,
                Conclusion::Reached | Conclusion::Violated | Conclusion::Error => false,
            },
        }
    }
}

/// Asks a question: a way that is known is replayed first.
///
/// # Errors
/// Why it cannot be asked, in words.
fn ask(
    subject: &Subject<'_>,
    case: &TestCase,
    (claim, asked): (&TestClaim, &TestSearch),
    options: &TestOptions<'_>,
    watch: &dyn Watch,
) -> Result<Known, String> {
    let Question { program, sources, target, query } = question(subject, case, (claim, asked), options)?;
    let name = name(case, &claim.predicate, asked, options);
    if let Some(known) = kept(&program, (&query, target, asked.kind), &name, options, watch) {
        return Ok(known);
    }
    let session = Session::new(&program, case.world, query, watch);
    let mut found = session.find(target, watch).map_err(|error| query_error(&error, &program, case.world))?;
    let answer = session.answer(&mut found, &sources);
    let way = match &found.outcome.verdict {
        Verdict::Reached(plan) => Some((plan.script.clone(), answer.inputs.clone().unwrap_or_default())),
        _ => None,
    };
    if let Some((_, text)) = &way {
        options.ways.keep(&program, &name, text);
    }
    let is_refuted = session.refutation().is_some();
    Ok(Known {
        conclusion: if is_refuted { Conclusion::NotAnswered } else { answer.verdict },
        words: words(&answer, (asked, is_refuted), program.worlds[case.world].step.seconds()),
        is_spent: !is_refuted && answer.end != End::Stopped,
        reasons: answer.reasons,
        way,
    })
}

/// A way that was found before, if it still leads there.
fn kept(
    program: &Arc<Program>,
    (query, target, kind): (&Query, Target, SearchKind),
    name: &WayName<'_>,
    options: &TestOptions<'_>,
    watch: &dyn Watch,
) -> Option<Known> {
    let text = options.ways.find(program, name)?;
    let sim = Simulator::new(program, program.world_named(name.world)?);
    let mut blank = SourceMap::new();
    let file = blank.add("way", text.as_str());
    let (script, found) = parse_script(program, sim.world_id(), file, &text);
    let script = Some(script).filter(|_| !found.has_errors())?;
    let (plan, luck) = replay(&sim, query, target, &script, watch)?;
    let conclusion = Conclusion::of_path(target);
    Some(Known {
        conclusion,
        words: found_words(kind, plan.steps, luck.as_ref(), sim.world().step.seconds()),
        reasons: Vec::new(),
        way: Some((plan.script.clone(), plan.script.text(program, sim.world_id()))),
        is_spent: true,
    })
}

/// Compiles the program with the question.
fn question(
    subject: &Subject<'_>,
    case: &TestCase,
    (claim, asked): (&TestClaim, &TestSearch),
    options: &TestOptions<'_>,
) -> Result<Question, String> {
    let world_name = Some(case.world_name.as_str());
    let is_goal = matches!(asked.kind, SearchKind::Reachable | SearchKind::Unreachable);
    let kind = if is_goal { Asked::Goal } else { Asked::Never };
    let extra = [ExtraQuestion { asked: kind, world: world_name, text: &claim.predicate, origin: ORIGIN }];
    let constraint = asked.without.as_deref().map(|predicate| ExtraConstraint {
        world: world_name,
        name: WITHOUT,
        predicate,
        origin: WITHOUT,
    });
    let Compilation { sources, program: Some(program), .. } = subject.compile(&extra, constraint) else {
        return Err("the program cannot be compiled with this predicate".to_string());
    };
    let world = &program.worlds[case.world];
    let name = question_name(&claim.predicate);
    let target = match is_goal {
        true => world.goal_named(&name).map(Target::Goal),
        false => world.never_named(&name).map(Target::Never),
    };
    let target = target.ok_or_else(|| format!("`{name}` is no question of this world"))?;
    // The compiler appends it.
    let without: Vec<NeverId> = constraint.and_then(|_| world.nevers.ids().next_back()).into_iter().collect();
    let query = Query {
        settings: Settings { seed: options.seed, ..Settings::default() },
        limits: Limits { nodes: options.nodes, ..Limits::default() },
        within: asked.within,
        asked: added_nevers(&program, &sources, case.world, ORIGIN),
        without,
        chance: case.seed,
        ..Query::new(vec![target])
    };
    Ok(Question { program, sources, target, query })
}

/// What a way is kept under.
fn name<'c>(case: &'c TestCase, predicate: &str, asked: &TestSearch, options: &TestOptions<'_>) -> WayName<'c> {
    let kind = match asked.kind {
        SearchKind::Reachable | SearchKind::Unreachable => "goal",
        SearchKind::Never | SearchKind::Unfound => "never",
    };
    let without = asked.without.as_ref().map(|without| format!(" without {without}")).unwrap_or_default();
    let within = asked.within.map(|steps| format!(" within {steps}")).unwrap_or_default();
    let chance = case.seed.map(|seed| format!(" chance {seed}")).unwrap_or_default();
    WayName {
        world: &case.world_name,
        question: format!("{kind} {predicate}{without}{within}{chance}"),
        settings: format!("nodes {} seed {} hypedc {}", options.nodes, options.seed, env!("CARGO_PKG_VERSION")),
    }
}

fn query_error(error: &QueryError, program: &Program, world: WorldId) -> String {
    match error {
        QueryError::Fault(fault, step) => {
            let fact = fault.fact(program, world, *step);
            format!("a run-time error in step {step}: {} in `{}`", fact.what, fact.instance)
        }
        QueryError::Over { reason, .. } => match reason {
            Termination::Never(id) => format!("`never {}` holds at the start", program.worlds[world].nevers[*id].name),
            Termination::Avoided => "the predicate of `without` holds at the start".to_string(),
            Termination::Outside => "a player is out of bounds at the start".to_string(),
        },
    }
}

/// `reached in 2.40 s, step 144`
fn found_words(kind: SearchKind, steps: u64, luck: Option<&Luck>, seconds_per_step: f64) -> String {
    let seconds = steps as f64 * seconds_per_step;
    let luck =
        luck.filter(|luck| !luck.is_none()).map_or(String::new(), |luck| format!(", with luck: {}", luck.words()));
    let what = match kind {
        SearchKind::Reachable | SearchKind::Unreachable => "reached",
        SearchKind::Never => "violated",
        SearchKind::Unfound => "found",
    };
    format!("{what} in {seconds:.2} s, step {steps}{luck}")
}

/// What an answer says.
fn words(answer: &Answer, (asked, is_refuted): (&TestSearch, bool), seconds_per_step: f64) -> String {
    let within = match asked.within {
        // What holds in no reachable state is not reached later, either.
        Some(steps) if answer.proven_by != Some(ProofMethod::Analysis) => format!(" within {steps} steps"),
        _ => String::new(),
    };
    let open = |what: &str| {
        let why = match answer.end {
            End::Stopped => "the search was stopped",
            End::Memory => "the memory is full",
            End::Nodes => "the budget of nodes is used up",
            End::Answered => "the search has nothing more to try",
        };
        format!("{what}, which proves nothing: {why}")
    };
    match answer.verdict {
        _ if is_refuted => {
            "not answered: a run has refuted the analysis, which is a mistake of hypedc; `hypedc reach` tells more"
                .into()
        }
        Conclusion::Reached | Conclusion::Violated => {
            found_words(asked.kind, answer.steps.unwrap_or_default(), answer.luck.as_ref(), seconds_per_step)
        }
        Conclusion::ProvenUnreachable => format!("proven: no inputs lead there{within}"),
        Conclusion::Exhausted => format!("no way{within} with axes at -1, 0 and 1, which is no proof"),
        Conclusion::NotFound => open("not found"),
        Conclusion::NotAnswered => open("not found, and not proven"),
        Conclusion::Error => "it cannot be asked".to_string(),
    }
}
