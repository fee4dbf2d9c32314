//! Questions asked of both programs. A way that answers the old one is replayed on the new program first; a search comes
//! after that, and a second one that begins along the old way. What a search does not find is lost, not worse: only a
//! proof, or a way to break a `never`, makes it so.

use std::sync::Arc;

use serde::Serialize;

use crate::analysis::ConfigurationSpace;
use crate::diagnostic::Severity;
use crate::ir::{ExprId, NeverId, Program, World, WorldId};
use crate::reach::query::{Answer, Found, Kind, Query, Session};
use crate::reach::{self, Conclusion, Problem, Settings, Shift, StateStatus, Target, plan_from_script};
use crate::sim::{Script, Simulator, parse_script};
use crate::source::SourceMap;
use crate::watch::{Meter, Watch};

use super::divergence::{Divergence, Side, diverge};

/// Number of states along an old way from which the second search begins.
const STARTS: u64 = 8;
/// How much longer the second search is than the first.
const LONGER: u64 = 2;

/// What a change of the program did to an answer.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
#[serde(rename_all = "lowercase")]
pub enum Class {
    /// A goal that was reached is proven unreachable, or a `never` is violated in a way in which it was not before.
    Worse,
    /// The expected answer is not found any more; it may still be so.
    Lost,
    /// Another answer, neither better nor worse as far as is known.
    Other,
    /// The same answer, by another way: the old one does not hold any more.
    Way,
    /// The expected answer is found now; it may have been so before.
    Found,
    /// A goal that was proven unreachable is reached, or a `never` that was violated is proven.
    Better,
    /// The answer is the same, by whatever way.
    Same,
}

impl From<Shift> for Class {
    fn from(shift: Shift) -> Class {
        match shift {
            Shift::Worse => Class::Worse,
            Shift::Lost => Class::Lost,
            Shift::Other => Class::Other,
            Shift::Found => Class::Found,
            Shift::Better => Class::Better,
            Shift::Same => Class::Same,
        }
    }
}

/// How the way that answers the old program fares on the new one.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct OldWay {
    /// Its number of steps on the old program.
    pub steps: u64,
    /// The number of steps after which it arrives on the new program; null if it does not.
    pub holds: Option<u64>,
    /// Why its inputs cannot be given to the new program; null if they can.
    pub refused: Option<String>,
    /// How the runs differ, if the way does not hold.
    pub divergence: Option<Divergence>,
}

/// Where an answer comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Origin {
    /// A search, or a proof.
    Search,
    /// A replay of the way that answers the other program.
    Replay,
    /// A search that began along the old way.
    AlongOldWay,
}

/// The answer of one program.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct Answered {
    /// The verdict.
    pub verdict: Conclusion,
    /// Where it comes from.
    pub by: Origin,
    /// The number of steps of the way; null if there is none.
    pub steps: Option<u64>,
    /// The duration of the way in the world, s; null if there is none.
    pub seconds_of_play: Option<f64>,
    /// The way, as an input script; null if there is none.
    pub inputs: Option<String>,
    /// Why there is no way, a sentence each; empty if that is not known.
    pub reasons: Vec<String>,
    /// The nodes of all searches.
    pub nodes: u64,
}

/// The answers of two programs to a question.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct Comparison {
    /// What kind of thing is asked for.
    pub kind: Kind,
    /// Its name.
    pub goal: String,
    /// What the change did.
    pub class: Class,
    /// The old program's answer.
    pub old: Answered,
    /// The new program's answer.
    pub new: Answered,
    /// How the old way fares on the new program; null if there is none.
    pub old_way: Option<OldWay>,
}

impl Comparison {
    /// The new way, where it is another one than before.
    pub fn other_way(&self) -> Option<&str> {
        let is_other = matches!(self.class, Class::Way | Class::Worse | Class::Found | Class::Better);
        self.new.inputs.as_deref().filter(|_| is_other)
    }
}

/// A program with a world.
#[derive(Clone, Copy)]
pub struct Version<'v> {
    /// The program.
    pub program: &'v Arc<Program>,
    /// Its texts.
    pub sources: &'v SourceMap,
    /// The world.
    pub world: WorldId,
    /// `never`s that are questions only, and end no run.
    pub asked: &'v [NeverId],
}

impl<'v> Version<'v> {
    fn table(&self) -> &'v World {
        &self.program.worlds[self.world]
    }

    fn target(&self, kind: Kind, name: &str) -> Option<Target> {
        let world = self.table();
        match kind {
            Kind::Goal => world.goal_named(name).map(Target::Goal),
            Kind::Never => world.never_named(name).map(Target::Never),
        }
    }
}

/// The budget of each search.
#[derive(Debug, Clone, Copy)]
pub struct Budget {
    /// Nodes and memory; the second search may take twice as many nodes.
    pub limits: reach::Limits,
    /// The seed.
    pub seed: u64,
}

/// The comparisons of a level.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Compared {
    /// One for each question that both programs can be asked.
    pub comparisons: Vec<Comparison>,
    /// Whether a search has shown that the analysis is wrong about one of the programs; its proofs are withdrawn.
    pub is_refuted: bool,
}

/// One program under questions.
struct Asked<'v> {
    version: Version<'v>,
    budget: Budget,
    session: Session,
}

impl<'v> Asked<'v> {
    fn new(version: Version<'v>, budget: Budget, watch: &dyn Watch) -> Self {
        let query = query(&version, budget, Vec::new());
        Asked { version, budget, session: Session::new(version.program, version.world, query, watch) }
    }

    fn predicate(&self, target: Target) -> ExprId {
        let world = self.version.table();
        match target {
            Target::Goal(goal) => world.goals[goal].holds,
            Target::Never(never) => world.nevers[never].holds,
        }
    }

    fn problem<'s>(&'s self, sim: &'s Simulator, target: Target) -> Problem<'s> {
        Problem::asking(sim, target).asking_only(self.version.asked)
    }

    /// Searches; none if a rule is broken in the initial state.
    fn find(&self, target: Target, watch: &dyn Watch) -> Option<Found<'_>> {
        self.session.find(target, watch).ok()
    }

    /// The answer of a search. Call it after all searches.
    fn answer(&self, kind: Kind, name: &str, found: Option<Found<'_>>) -> Answer {
        match found {
            Some(mut found) => self.session.answer(&mut found, self.version.sources),
            None => Answer::failed(kind, name.to_string()),
        }
    }

    /// A way to a target by another program's script.
    fn replay(&self, target: Target, script: &Script, watch: &dyn Watch) -> Option<Script> {
        let problem = self.problem(self.session.simulator(), target);
        plan_from_script(&problem, script, 0, watch).map(|plan| plan.script)
    }

    /// The script of another program with the inputs of this one.
    fn translated(&self, text: &str) -> Result<Script, String> {
        let mut sources = SourceMap::new();
        let file = sources.add("inputs", text);
        let (script, found) = parse_script(self.version.program, self.version.world, file, text);
        match found.iter().find(|finding| finding.severity == Severity::Error) {
            Some(error) => Err(error.message.clone()),
            None => Ok(script),
        }
    }

    /// The answer that a replayed way gives.
    fn by_way(&self, target: Target, script: &Script) -> Answered {
        let steps = script.len();
        Answered {
            verdict: Conclusion::of_path(target),
            by: Origin::Replay,
            steps: Some(steps),
            seconds_of_play: Some(steps as f64 * self.version.table().step.seconds()),
            inputs: Some(script.text(self.version.program, self.version.world)),
            reasons: Vec::new(),
            nodes: 0,
        }
    }

    /// A longer search that begins in states along an old way. Its proofs are about those states only.
    fn find_along(&self, target: Target, way: &Script, watch: &dyn Watch) -> Option<Along> {
        let starts = self.open_prefixes(target, way, watch);
        if starts.is_empty() {
            return None;
        }
        let limits = reach::Limits { nodes: self.budget.limits.nodes.saturating_mul(LONGER), ..self.budget.limits };
        let query = Query { after: starts, ..query(&self.version, Budget { limits, ..self.budget }, vec![target]) };
        let space: ConfigurationSpace = self.session.space().clone();
        let session = Session::with_space(self.version.program, self.version.world, query, space);
        let mut found = session.find(target, watch).ok()?;
        let answer = session.answer(&mut found, self.version.sources);
        Some(Along { answer, is_refuted: session.refutation().is_some() })
    }

    /// Beginnings of a way, evenly apart, after which the run goes on.
    fn open_prefixes(&self, target: Target, way: &Script, watch: &dyn Watch) -> Vec<Script> {
        let (sim, meter) = (self.session.simulator(), Meter::new(watch));
        let problem = self.problem(sim, target);
        let mut scratch = sim.scratch();
        let Ok(mut state) = sim.metered_initial(&mut scratch, &meter) else { return Vec::new() };
        let mut open = 0;
        for (input, step) in way.inputs().zip(1..) {
            let stepped = sim.metered_step(&mut state, &problem.draw(step, input), &mut scratch, &meter);
            if stepped.is_err() || meter.is_stopped() || problem.judge(&state) != Ok(StateStatus::Open) {
                break;
            }
            open = step;
        }
        let mut steps: Vec<u64> = (1..=STARTS).map(|part| open * part / STARTS).filter(|steps| *steps > 0).collect();
        steps.dedup();
        steps.into_iter().map(|steps| way.first(steps)).collect()
    }
}

/// The answer of a search along an old way.
struct Along {
    answer: Answer,
    is_refuted: bool,
}

fn query(version: &Version<'_>, budget: Budget, targets: Vec<Target>) -> Query {
    Query {
        settings: Settings { seed: budget.seed, ..Settings::default() },
        limits: budget.limits,
        asked: version.asked.to_vec(),
        ..Query::new(targets)
    }
}

fn answered(answer: &Answer, by: Origin) -> Answered {
    Answered {
        verdict: answer.verdict,
        by,
        steps: answer.steps,
        seconds_of_play: answer.seconds_of_play,
        inputs: answer.inputs.clone(),
        reasons: answer.reasons.clone(),
        nodes: answer.nodes,
    }
}

/// What is known of a question while the searches run.
struct Open<'f> {
    kind: Kind,
    name: String,
    /// The target in the old world and in the new one.
    targets: [Target; 2],
    old: Option<Found<'f>>,
    /// The old way and how it fares.
    way: Option<(Script, OldWay)>,
    /// The way by which the old one answers the new program.
    held: Option<Script>,
    new: Option<Found<'f>>,
    along: Option<Along>,
    /// The new way, if it answers the old program.
    held_before: Option<Script>,
}

/// Compares the answers of two programs to questions, by kind and name. Questions that only one of them has are left
/// out. Stopped by the watch, it compares what is known.
pub fn compare(
    old: Version<'_>,
    new: Version<'_>,
    questions: &[(Kind, String)],
    budget: Budget,
    watch: &dyn Watch,
) -> Compared {
    let (old, new) = (Asked::new(old, budget, watch), Asked::new(new, budget, watch));
    let mut open = Vec::new();
    let mut is_refuted = false;
    for (kind, name) in questions {
        let targets = (old.version.target(*kind, name), new.version.target(*kind, name));
        let (Some(before), Some(now)) = targets else { continue };
        if watch.stop() {
            break;
        }
        let question = ask((&old, &new), (*kind, name), [before, now], watch);
        is_refuted |= question.along.as_ref().is_some_and(|along| along.is_refuted);
        // A way where there is proven to be none.
        is_refuted |= question.held_before.is_some() && is_proven(&question.old);
        open.push(question);
    }
    // A search may have refuted the proof of another one.
    let comparisons = open.into_iter().map(|question| conclude((&old, &new), question, is_refuted)).collect();
    is_refuted |= old.session.refutation().is_some() || new.session.refutation().is_some();
    Compared { comparisons, is_refuted }
}

/// Searches and replays.
fn ask<'s>(
    (old, new): (&'s Asked<'_>, &'s Asked<'_>),
    (kind, name): (Kind, &str),
    targets: [Target; 2],
    watch: &dyn Watch,
) -> Open<'s> {
    let mut open = Open {
        kind,
        name: name.to_string(),
        targets,
        old: old.find(targets[0], watch),
        way: None,
        held: None,
        new: None,
        along: None,
        held_before: None,
    };
    let script = open.old.as_ref().and_then(script_of).cloned();
    let text = script.as_ref().map(|script| script.text(old.version.program, old.version.world));
    if let (Some(script), Some(text)) = (script, text) {
        let mut way = OldWay { steps: script.len(), holds: None, refused: None, divergence: None };
        match new.translated(&text) {
            Err(why) => way.refused = Some(why),
            Ok(translated) => {
                open.held = new.replay(targets[1], &translated, watch);
                way.holds = open.held.as_ref().map(Script::len);
                if open.held.is_none() {
                    let side = |of: &'s Asked<'_>, script, target| Side {
                        sim: of.session.simulator(),
                        sources: of.version.sources,
                        script,
                        asked: of.version.asked,
                        target: Some(of.predicate(target)),
                    };
                    let sides = (side(old, &script, targets[0]), side(new, &translated, targets[1]));
                    way.divergence = Some(diverge(sides.0, sides.1));
                }
                open.way = Some((translated, way.clone()));
            }
        }
        if way.refused.is_some() {
            open.way = Some((Script::default(), way));
        }
    }
    if open.held.is_some() {
        return open;
    }
    open.new = new.find(targets[1], watch);
    let new_script = open.new.as_ref().and_then(script_of).cloned();
    match (&new_script, &open.way) {
        (None, Some((way, _))) if is_open(&open.new, targets[1]) => {
            open.along = new.find_along(targets[1], way, watch);
        }
        (Some(script), None) => {
            let text = script.text(new.version.program, new.version.world);
            open.held_before = old.translated(&text).ok().and_then(|script| old.replay(targets[0], &script, watch));
        }
        _ => {}
    }
    open
}

/// Whether it is proven that there is no way.
fn is_proven(found: &Option<Found<'_>>) -> bool {
    found.as_ref().is_some_and(|found| matches!(found.outcome.verdict, reach::Verdict::Unreachable(_)))
}

/// Whether a search has no answer.
fn is_open(found: &Option<Found<'_>>, target: Target) -> bool {
    found.as_ref().is_some_and(|found| found.outcome.conclusion(target).is_open())
}

fn script_of<'f>(found: &'f Found<'_>) -> Option<&'f Script> {
    match &found.outcome.verdict {
        reach::Verdict::Reached(plan) => Some(&plan.script),
        reach::Verdict::NotFound | reach::Verdict::Unreachable(_) | reach::Verdict::Exhausted(_) => None,
    }
}

/// The answers, after all searches.
fn conclude((old, new): (&Asked<'_>, &Asked<'_>), open: Open<'_>, is_refuted: bool) -> Comparison {
    let Open { kind, name, targets, .. } = open;
    let checked = |mut answer: Answer| {
        if is_refuted && answer.answered_by.as_deref() == Some("analysis") && answer.steps.is_none() {
            (answer.verdict, answer.reasons) = (Conclusion::NotAnswered, Vec::new());
        }
        answer
    };
    let mut before = answered(&checked(old.answer(kind, &name, open.old)), Origin::Search);
    if let Some(script) = &open.held_before {
        before = Answered { nodes: before.nodes, ..old.by_way(targets[0], script) };
    }
    let now = match &open.held {
        Some(script) => new.by_way(targets[1], script),
        None => {
            let mut now = answered(&checked(new.answer(kind, &name, open.new)), Origin::Search);
            if let Some(Along { answer, .. }) = &open.along {
                let nodes = now.nodes + answer.nodes;
                if answer.steps.is_some() {
                    now = answered(answer, Origin::AlongOldWay);
                }
                now.nodes = nodes;
            }
            now
        }
    };
    let fails = open.way.as_ref().is_some_and(|(_, way)| way.holds.is_none());
    let class = match Shift::of(kind, before.verdict, now.verdict) {
        Shift::Same if fails => Class::Way,
        // The way was tried on the old program, and does not break it there.
        Shift::Other if now.verdict == Conclusion::Violated => Class::Worse,
        shift => shift.into(),
    };
    Comparison { kind, goal: name, class, old: before, new: now, old_way: open.way.map(|(_, way)| way) }
}
