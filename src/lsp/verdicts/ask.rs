//! Asks the questions of a world again: known inputs are replayed first, then the analysis may prove, then a search
//! looks within a budget of nodes. A question whose work is stopped has no verdict.

use std::sync::Arc;

use crate::ir::{Program, World, WorldId};
use crate::reach::query::{Found, Kind, Query, QueryError, Session, replay};
use crate::reach::why_not::astray;
use crate::reach::{Conclusion, End, Limits, Settings, Target, Termination, Verdict as Searched};
use crate::sim::{Script, Simulator, parse_script};
use crate::source::SourceMap;
use crate::watch::{Meter, Watch};

use super::memory::Memory;
use super::verdict::{Broken, Question, Verdict, Way};

/// The budget of a search.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::lsp) struct Budget {
    /// Maximum number of nodes for a question.
    pub nodes: u64,
    /// Maximum memory, bytes.
    pub memory: u64,
}

impl Default for Budget {
    fn default() -> Self {
        Budget { nodes: 20_000, memory: 256 << 20 }
    }
}

/// A world of a compiled program.
#[derive(Clone, Copy)]
pub(in crate::lsp) struct Subject<'a> {
    pub program: &'a Arc<Program>,
    pub sources: &'a SourceMap,
    pub world: WorldId,
    /// The name of the level of its open map; empty if it has none.
    pub level: &'a str,
}

/// A question with its verdict, and whether an edit has broken what was before.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::lsp) struct Asked {
    pub question: Question,
    pub verdict: Verdict,
    pub broken: Option<Broken>,
}

impl<'a> Subject<'a> {
    fn world(&self) -> &'a World {
        &self.program.worlds[self.world]
    }

    fn question(&self, target: Target) -> Question {
        let world = self.world();
        Question {
            world: world.name.clone(),
            level: self.level.to_string(),
            kind: target.kind(),
            name: target.name(world).to_string(),
        }
    }

    /// The inputs of a script in its program; `None` if it names others.
    fn script(&self, text: &str) -> Option<Script> {
        let mut sources = SourceMap::new();
        let file = sources.add("way", text);
        let (script, found) = parse_script(self.program, self.world, file, text);
        Some(script).filter(|_| !found.has_errors())
    }

    fn way(&self, script: &Script, luck: Option<String>) -> Way {
        let steps = script.len();
        let seconds = steps as f64 * self.world().step.seconds();
        Way { inputs: script.text(self.program, self.world), steps, seconds, luck }
    }
}

/// Asks all questions of a world, and passes on verdicts as soon as they are known. `None` if the watch stops it: then
/// some have none.
pub(in crate::lsp) fn ask_world(
    subject: Subject<'_>,
    memory: &Memory,
    budget: Budget,
    watch: &dyn Watch,
    emit: &mut dyn FnMut(Vec<Asked>),
) -> Option<()> {
    let world = subject.world();
    let goals = world.goals.ids().map(Target::Goal);
    let targets: Vec<Target> = goals.chain(world.nevers.ids().map(Target::Never)).collect();
    if targets.is_empty() || world.open.is_some() {
        return Some(());
    }
    let query = Query {
        settings: Settings { explains: true, ..Settings::default() },
        limits: Limits { nodes: budget.nodes, memory: budget.memory },
        ..Query::new(targets.clone())
    };
    let asked = |target: Target, verdict: Verdict| {
        let question = subject.question(target);
        let broken = broken(subject, &query, target, (&question, &verdict), memory, watch);
        Asked { question, verdict, broken }
    };
    let sim = Simulator::new(subject.program, subject.world);
    let (mut open, mut known) = (Vec::new(), Vec::new());
    for target in targets {
        let ways = memory.ways(&subject.question(target));
        let scripts = ways.into_iter().filter_map(|text| subject.script(text));
        match leads_there(subject, (&sim, &query), target, scripts, watch) {
            Some(way) => known.push(asked(target, Verdict::of_way(target.kind(), way))),
            None => open.push(target),
        }
        if watch.stop() {
            return None;
        }
    }
    emit(known);
    if open.is_empty() {
        return Some(());
    }
    let session = Session::new(subject.program, subject.world, query.clone(), watch);
    let mut all: Vec<Found<'_>> = Vec::new();
    // Ways that this search has found: one may pass several goals.
    let mut scripts: Vec<Script> = Vec::new();
    for target in open {
        if watch.stop() {
            return None;
        }
        if let Some(way) = leads_there(subject, (&sim, &query), target, scripts.iter().cloned(), watch) {
            emit(vec![asked(target, Verdict::of_way(target.kind(), way))]);
            continue;
        }
        let found = match session.find(target, watch) {
            Ok(found) => found,
            Err(error) => {
                emit(vec![asked(target, Verdict::failed(why_not_asked(&error, subject)))]);
                continue;
            }
        };
        if found.outcome.end == End::Stopped || watch.stop() {
            return None;
        }
        scripts.extend(found.outcome.violations.iter().map(|(_, script)| script.clone()));
        match &found.outcome.verdict {
            Searched::Reached(plan) => {
                scripts.push(plan.script.clone());
                let mut found = found;
                let answer = session.answer(&mut found, subject.sources);
                emit(vec![asked(target, Verdict::of_answer(&answer))]);
            }
            _ => all.push(found),
        }
    }
    // Only now: one search can withdraw the proof of another.
    let mut last = Vec::new();
    for mut found in all {
        let answer = session.answer(&mut found, subject.sources);
        last.push(asked(found.target, Verdict::of_answer(&answer)));
        if watch.stop() {
            return None;
        }
    }
    emit(last);
    Some(())
}

/// The first of some scripts that leads to a target, cut where it holds.
fn leads_there(
    subject: Subject<'_>,
    (sim, query): (&Simulator, &Query),
    target: Target,
    mut scripts: impl Iterator<Item = Script>,
    watch: &dyn Watch,
) -> Option<Way> {
    scripts.find_map(|script| {
        let (plan, luck) = replay(sim, query, target, &script, watch).filter(|_| !watch.stop())?;
        Some(subject.way(&plan.script, luck.filter(|luck| !luck.is_none()).map(|luck| luck.words())))
    })
}

/// What an edit has broken, if a verdict is worse than the one that is remembered.
fn broken(
    subject: Subject<'_>,
    query: &Query,
    target: Target,
    (question, verdict): (&Question, &Verdict),
    memory: &Memory,
    watch: &dyn Watch,
) -> Option<Broken> {
    let known = memory.known(question)?;
    if question.kind == Kind::Never {
        let is_broken = known.was_proven && verdict.conclusion == Conclusion::Violated;
        return is_broken.then_some(Broken { inputs: None, seconds: 0.0, fails: None });
    }
    let before = known.reached.as_ref().filter(|_| verdict.conclusion != Conclusion::Reached)?;
    let fails = match subject.script(&before.inputs) {
        None => Some((0, "the program no longer has all of these inputs".to_string())),
        Some(script) => {
            let sim = Simulator::new(subject.program, subject.world);
            let problem = query.problem(&sim, target, watch).ok().flatten()?;
            let lost = astray(&problem, subject.sources, &script, &Meter::new(watch))?;
            let step =
                lost.nearest.as_ref().filter(|_| lost.step == script.len()).map_or(lost.step, |near| near.at.step);
            Some((step, lost.words(&problem)))
        }
    };
    Some(Broken { inputs: Some(before.inputs.clone()), seconds: before.seconds, fails })
}

fn why_not_asked(error: &QueryError, subject: Subject<'_>) -> String {
    match error {
        QueryError::Fault(fault, step) => {
            let fact = fault.fact(subject.program, subject.world, *step);
            format!("a run-time error in step {step}: {} in `{}`", fact.what, fact.instance)
        }
        QueryError::Over { reason, .. } => match reason {
            Termination::Never(id) => format!("`never {}` holds at the start", subject.world().nevers[*id].name),
            Termination::Avoided | Termination::Outside => "the run is over at the start".to_string(),
        },
    }
}
