//! Questions about runs and worlds, answered by the records of the command line as JSON.

use std::sync::Arc;
use std::time::{Duration, Instant};

use hypedc::ask::{
    BoundsResult, StuckLimits, StuckWatches, WhyQuestion, WorldBounds, answer_stuck, answer_why, bounds_watched,
    goal_reasons, no_goal, targets,
};
use hypedc::ir::{GoalId, World};
use hypedc::reach::Target;
use hypedc::sim::Simulator;
use hypedc::source::SourceMap;
use hypedc::watch::{Progress, Watch};
use pyo3::prelude::*;
use serde::Deserialize;

use crate::error::{argument, refusal, step};
use crate::inputs::script;
use crate::program::{Program, Questions};
use crate::watched::{Flag, watched};

/// Why an instance did what it did in a step of a run, or why it never did something.
#[pyfunction]
#[pyo3(
    name = "_why",
    signature = (program, inputs, world = None, instance = None, mode = None, edge = None, never = false, at = None, chance = 0)
)]
#[allow(clippy::too_many_arguments, reason = "they are keywords in Python")]
pub fn why(
    py: Python<'_>,
    program: &Bound<'_, Program>,
    inputs: &str,
    world: Option<&str>,
    instance: Option<String>,
    mode: Option<String>,
    edge: Option<String>,
    never: bool,
    at: Option<u64>,
    chance: u64,
) -> PyResult<String> {
    let of = program.get();
    let id = of.world_id(world)?;
    let script = script(&of.loaded, id, inputs)?;
    let question = WhyQuestion { instance, mode, edge, not: never, at };
    let (loaded, root) = (of.loaded.clone(), of.recipe.root.clone());
    let answer = watched(py, None, move |_| {
        let answer = answer_why(&loaded, id, &root, (&script, chance), &question);
        answer.map(|(result, ..)| serde_json::to_string(&result).unwrap_or_default())
    })?;
    answer.map_err(|why| refusal(&of.loaded.sources, why))
}

/// The budget of `stuck`.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct StuckAsked {
    world: Option<String>,
    goal: Option<String>,
    states: u64,
    nodes: u64,
    seconds: Option<f64>,
    memory: u64,
    seed: u64,
}

/// The part of a limit of time in which all states are visited.
const EXACT_PART: f64 = 0.4;

/// Stops when a whole does, or when a part of its time is over.
struct PartOf<'f>(&'f Flag, Option<Instant>);

impl Watch for PartOf<'_> {
    fn stop(&self) -> bool {
        self.0.stop() || self.1.is_some_and(|until| Instant::now() >= until)
    }

    fn progress(&self, progress: Progress) {
        self.0.progress(progress);
    }
}

/// Where a player gets stuck: the record of `hypedc stuck --format json`, and whether it was interrupted.
#[pyfunction]
#[pyo3(name = "_stuck", signature = (program, asked, progress = None))]
pub fn stuck(
    py: Python<'_>,
    program: &Bound<'_, Program>,
    asked: &str,
    progress: Option<Py<PyAny>>,
) -> PyResult<(String, bool)> {
    let asked: StuckAsked =
        serde_json::from_str(asked).map_err(|error| argument(format!("not a question: {error}")))?;
    if asked.seconds.is_some_and(|seconds| !(seconds >= 0.0 && seconds.is_finite())) {
        return Err(argument("`seconds` is a number of at least 0"));
    }
    let goals: Vec<String> = asked.goal.iter().cloned().collect();
    let questions = Questions { world: asked.world.clone(), goals: goals.clone(), ..Questions::default() };
    let program = program.get().asking(py, questions)?;
    let id = program.world_id(asked.world.as_deref())?;
    let goal = only_goal(&program.loaded.program.worlds[id], &goals)?;
    let (loaded, root) = (Arc::clone(&program.loaded), program.recipe.root.clone());
    let answer = watched(py, progress.as_ref(), move |flag| {
        let started = Instant::now();
        flag.limit(asked.seconds);
        let part = asked.seconds.and_then(|s| Duration::try_from_secs_f64(EXACT_PART * s).ok());
        let part = PartOf(flag, part.and_then(|part| started.checked_add(part)));
        let StuckAsked { states, nodes, seconds, memory, seed, .. } = asked;
        let limits = StuckLimits { states, nodes, memory, seed, seconds };
        let is_interrupted = || flag.is_interrupted();
        let watches = StuckWatches { exact: &part, whole: flag, is_interrupted: &is_interrupted };
        let sim = Simulator::new(&loaded.program, id);
        answer_stuck(&root, (&sim, goal), &limits, &watches).map(|mut answer| {
            answer.result.seconds = started.elapsed().as_secs_f64();
            (serde_json::to_string(&answer.result).unwrap_or_default(), flag.is_interrupted())
        })
    })?;
    answer.map_err(|fault| step(&program.loaded.sources, fault.fact(&program.loaded.program, id, 0)))
}

/// What each part of a world can be: the record of `hypedc bounds --format json`.
#[pyfunction]
#[pyo3(name = "_bounds", signature = (program, world = None))]
pub fn bounds(py: Python<'_>, program: &Bound<'_, Program>, world: Option<&str>) -> PyResult<String> {
    let of = program.get();
    let id = of.world_id(world)?;
    let (loaded, root) = (Arc::clone(&of.loaded), of.recipe.root.clone());
    watched(py, None, move |flag| {
        let space = bounds_watched(&loaded.program, id, flag);
        let of = WorldBounds { program: &loaded.program, world: &loaded.program.worlds[id], space: &space };
        let goals = goal_reasons(&loaded, id, &space);
        serde_json::to_string(&BoundsResult::new(&root, &of, &goals)).unwrap_or_default()
    })
}

/// The named goal, or the only one.
pub(crate) fn only_goal(world: &World, names: &[String]) -> PyResult<GoalId> {
    let known: Vec<Target> = targets(world, (names, &[]), &|_| true).map_err(|why| refusal(&SourceMap::new(), why))?;
    match known.as_slice() {
        [Target::Goal(goal)] => Ok(*goal),
        [] => Err(refusal(&SourceMap::new(), no_goal(world))),
        _ => {
            let list: Vec<String> = world.goals.iter().map(|goal| format!("`{}`", goal.name)).collect();
            Err(argument(format!("`{}` has several goals: choose one of {}", world.name, list.join(", "))))
        }
    }
}
