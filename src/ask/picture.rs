//! Pictures of answers: the level with what a search visited and the path that was found, or the run of some inputs.

use std::ops::ControlFlow;

use serde::Serialize;

use crate::ir::{GoalId, Program, WorldId};
use crate::reach::query::{Answer, ChangeRecord, Found, Session};
use crate::reach::why_not::WhyNot;
use crate::reach::{Plan, Verdict, Visited};
use crate::sim::{Script, Simulator};
use crate::view::{Images, Mark, Moment, Node, Picture, Recorder, Run, picture_svg};
use crate::watch::Watch;

use super::run::{Observed, RunEnd, drive};

/// A picture, of an answer or of a run.
#[derive(Debug, Serialize)]
pub struct Drawing {
    /// The goal, the `never`, or the world.
    pub name: String,
    /// The picture.
    pub svg: String,
}

/// The path that was found.
pub fn plan<'f>(found: &'f Found<'_>) -> Option<&'f Plan> {
    match &found.outcome.verdict {
        Verdict::Reached(plan) => Some(plan),
        Verdict::NotFound | Verdict::Unreachable(_) | Verdict::Exhausted(_) => None,
    }
}

/// The way to the state that came nearest, of a goal that was not reached; none if that is the start.
pub fn nearest<'f>(found: &'f Found<'_>, answer: &Answer) -> Option<&'f Script> {
    // Only what was replayed is part of an answer.
    answer.why_not.as_ref()?.nearest.as_ref().filter(|nearest| nearest.at.step > 0)?;
    Some(&found.outcome.nearest.as_ref()?.whole.as_ref()?.script)
}

/// The nodes of a search, as pictures show them.
pub fn nodes(found: &Found<'_>) -> Vec<Node> {
    let node = |v: &Visited| Node { parent: v.parent, space: v.space, at: v.at };
    found.outcome.record.iter().map(node).collect()
}

/// The picture of a search.
pub fn search_svg(session: &Session, found: &Found<'_>, answer: &Answer, images: &Images, watch: &dyn Watch) -> String {
    let (nodes, sim) = (nodes(found), session.simulator());
    let chance = session.query().chance;
    let shown = plan(found).map(|plan| &plan.script).or(nearest(found, answer));
    let mut run = shown.map_or(Run::default(), |script| recorded(sim, (script, chance), watch));
    run.moments = moments(answer);
    let goals: Vec<GoalId> = sim.world().goal_named(&answer.goal).into_iter().collect();
    let notes = notes(answer);
    let picture = Picture {
        title: &answer.goal,
        result: answer.verdict.words(),
        is_good: answer.is_expected,
        goals: &goals,
        nodes: &nodes,
        traps: &[],
        layers: &[],
        run: &run,
        notes: &notes,
        images,
    };
    picture_svg(sim.program(), sim.world_id(), &picture)
}

/// The moments of a path that need timing, where that was asked for.
fn moments(answer: &Answer) -> Vec<Moment> {
    let Some(robust) = &answer.robust else { return Vec::new() };
    let timed = robust.changes.iter().enumerate().filter(|(_, change)| change.needs_timing());
    let moment = |(index, change): (usize, &ChangeRecord)| Moment {
        step: change.step,
        words: format!("{}: {}", change.what, change.window()),
        is_hardest: robust.hardest == Some(index),
    };
    timed.map(moment).collect()
}

/// What an answer says below its picture.
fn notes(answer: &Answer) -> Vec<String> {
    let mut notes = Vec::new();
    if let (Some(steps), Some(seconds)) = (answer.steps, answer.seconds_of_play) {
        notes.push(format!("path of {steps} steps, {seconds:.2} s of play"));
    }
    if !answer.reasons.is_empty() {
        notes.push(answer.reasons.join("; "));
    }
    let is_drawn = |why: &&WhyNot| why.nearest.as_ref().is_some_and(|nearest| nearest.at.step > 0);
    if let Some(phrase) = answer.why_not.as_ref().filter(is_drawn).and_then(WhyNot::phrase) {
        notes.push(format!("the line leads to the nearest state: {phrase}"));
    }
    if let (Some(planner), 1..) = (&answer.answered_by, answer.nodes) {
        let c = &answer.coverage;
        notes.push(format!(
            "{} nodes, {} places of {} px, {} combinations of modes ({planner})",
            answer.nodes, c.places, c.place, c.mode_combinations
        ));
    }
    notes
}

/// The run of a script, until the watch stops it.
pub fn recorded(sim: &Simulator, (script, chance): (&Script, Option<u64>), watch: &dyn Watch) -> Run {
    let (mut recorder, mut last) = (Recorder::new(sim), Vec::new());
    // A path ends in its last step, also out of bounds; nothing is written here that could fail.
    let _ = drive(sim, (script, chance), script.len(), watch, &mut |step, input, state, _| {
        recorder.observe(step, input, state);
        last.clear();
        last.extend_from_slice(state);
        Ok(ControlFlow::Continue(()))
    });
    recorder.finish(&last, Vec::new())
}

/// What is known of a run beside its states.
pub struct RunOutcome<'o> {
    /// Number of steps.
    pub steps: u64,
    /// The goals and `never`s that became true.
    pub marks: Vec<Mark>,
    /// Whether the run is as it should be.
    pub is_good: bool,
    /// How it ended, if not after all of its steps.
    pub end: Option<String>,
    /// The inputs, as a script.
    pub script: &'o str,
}

impl<'o> RunOutcome<'o> {
    /// Of a run that was observed; `is_as_expected` tells whether it is also what was asked for.
    pub fn new(observed: &Observed<'_>, script: &'o str, ended: &RunEnd, is_as_expected: bool) -> Self {
        let end = match ended {
            RunEnd::LeftBounds => Some("a player has left the bounds, which ends the run"),
            RunEnd::Fault(..) => Some("a run-time error ended the run"),
            RunEnd::Stopped(_) => Some("stopped before the last step"),
            RunEnd::Done | RunEnd::Enough => None,
        };
        let is_whole = !matches!(ended, RunEnd::Fault(..) | RunEnd::Stopped(_));
        RunOutcome {
            steps: observed.steps,
            marks: marks(observed.sim, &observed.goals, &observed.nevers),
            is_good: is_as_expected && is_whole && !observed.violated(),
            end: end.map(str::to_string),
            script,
        }
    }
}

/// What became true in a run of a world: for each goal and each `never` the first step after which it held.
fn marks(sim: &Simulator, goals: &[Option<u64>], nevers: &[Option<u64>]) -> Vec<Mark> {
    let world = sim.world();
    let mark = |is_never: bool, name: &str, step: Option<u64>| {
        let seconds = |step: u64| step as f64 * world.step.seconds();
        step.map(|step| Mark { name: name.to_string(), is_never, step, seconds: seconds(step) })
    };
    let goals = world.goals.iter().zip(goals).filter_map(|(goal, step)| mark(false, &goal.name, *step));
    let nevers = world.nevers.iter().zip(nevers).filter_map(|(never, step)| mark(true, &never.name, *step));
    goals.chain(nevers).collect()
}

/// The picture of a run.
pub fn run_svg((program, world): (&Program, WorldId), run: &Run, outcome: &RunOutcome<'_>, images: &Images) -> String {
    let goals: Vec<GoalId> = program.worlds[world].goals.ids().collect();
    let mut notes: Vec<String> = outcome.end.iter().cloned().collect();
    if !outcome.script.is_empty() {
        notes.push(format!("inputs  {}", outcome.script));
    }
    let seconds = outcome.steps as f64 * program.worlds[world].step.seconds();
    let steps = if outcome.steps == 1 { "1 step".to_string() } else { format!("{} steps", outcome.steps) };
    let picture = Picture {
        title: "a run",
        result: &format!("{steps}, {seconds:.2} s"),
        is_good: outcome.is_good,
        goals: &goals,
        nodes: &[],
        traps: &[],
        layers: &[],
        run,
        notes: &notes,
        images,
    };
    picture_svg(program, world, &picture)
}
