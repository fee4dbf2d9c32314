//! The picture of a simulated run.

use std::io;
use std::path::Path;

use crate::ir::{GoalId, Program, WorldId};
use crate::sim::Simulator;
use crate::view::{Mark, Picture, Run, picture_svg};

use super::reach::counted;

/// What is known of a run beside its states.
pub(super) struct Outcome<'o> {
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

/// What became true in a run of a world: for each goal and each `never` the first step after which it held.
pub(super) fn marks(sim: &Simulator, goals: &[Option<u64>], nevers: &[Option<u64>]) -> Vec<Mark> {
    let world = sim.world();
    let mark = |is_never: bool, name: &str, step: Option<u64>| {
        let seconds = |step: u64| step as f64 * world.step.seconds();
        step.map(|step| Mark { name: name.to_string(), is_never, step, seconds: seconds(step) })
    };
    let goals = world.goals.iter().zip(goals).filter_map(|(goal, step)| mark(false, &goal.name, *step));
    let nevers = world.nevers.iter().zip(nevers).filter_map(|(never, step)| mark(true, &never.name, *step));
    goals.chain(nevers).collect()
}

/// Writes the picture of a run.
pub(super) fn save_svg(
    path: &Path,
    (program, world): (&Program, WorldId),
    run: &Run,
    outcome: &Outcome<'_>,
) -> io::Result<()> {
    let goals: Vec<GoalId> = program.worlds[world].goals.ids().collect();
    let mut notes: Vec<String> = outcome.end.iter().cloned().collect();
    if !outcome.script.is_empty() {
        notes.push(format!("inputs  {}", outcome.script));
    }
    let seconds = outcome.steps as f64 * program.worlds[world].step.seconds();
    let picture = Picture {
        title: "a run",
        result: &format!("{}, {seconds:.2} s", counted(outcome.steps, "step")),
        is_good: outcome.is_good,
        goals: &goals,
        nodes: &[],
        run,
        notes: &notes,
    };
    std::fs::write(path, picture_svg(program, world, &picture))
}
