//! The smallest change of a number that turns an answer.

use std::sync::Arc;

use hypedc::ask::{Loaded, find_world, unknown};
use hypedc::compile::{Compilation, NumberSetting, added_nevers, question_name, written_number};
use hypedc::diagnostic::{Severity, render};
use hypedc::ir::WorldId;
use hypedc::reach::query::{Kind, Query};
use hypedc::reach::{Limits, Settings, Target};
use hypedc::tune::{Axis, Built, Change, Host, MAX_AXES, Part, Question, Trial, Wanted, tune as tuned};
use hypedc::watch::Watch;
use pyo3::prelude::*;
use serde::{Deserialize, Serialize};

use crate::error::{argument, question, refusal};
use crate::files::Texts;
use crate::program::{NEVERS, Program, Questions, Recipe};
use crate::questions::only_goal;
use crate::watched::{Flag, watched};

/// What is asked.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Asked {
    /// Each number with its range, and perhaps the step between two values.
    vary: Vec<(String, (f64, f64), Option<f64>)>,
    goal: Option<String>,
    world: Option<String>,
    prevent: bool,
    nevers: Vec<String>,
    within: Option<u32>,
    min_hold: Option<u16>,
    samples: usize,
    nodes: u64,
    seconds: Option<f64>,
    memory: u64,
    seed: u64,
    chance: Option<u64>,
}

/// Maximum number of values that are tried first.
const MAX_SAMPLES: usize = 1000;

/// The answer.
#[derive(Serialize)]
struct Answer<'a> {
    axes: &'a [Axis],
    trials: &'a [Trial],
    parts: &'a [Part],
    change: &'a Option<Change>,
    is_wanted_already: bool,
    is_stopped: bool,
    is_refuted: bool,
}

/// Compiles the texts of a program with other numbers.
struct Recompiling<'r> {
    recipe: &'r Recipe,
    seconds: Option<f64>,
    flag: &'r Flag,
}

impl Host for Recompiling<'_> {
    fn build(&self, numbers: &[NumberSetting<'_>]) -> Result<Built, String> {
        let more = numbers.iter().map(|of| (of.path.to_string(), of.value.to_string()));
        let recipe =
            Recipe { numbers: self.recipe.numbers.iter().cloned().chain(more).collect(), ..self.recipe.clone() };
        let Compilation { sources, program, diagnostics, .. } = recipe.compiled(false);
        let Some(program) = program else {
            let errors = diagnostics.iter().filter(|found| found.severity == Severity::Error);
            return Err(render::short(&sources, errors).trim_end().to_string());
        };
        let world = find_world(&program, &recipe.root, recipe.questions.world.as_deref()).map_err(|why| why.why)?;
        Ok(Built { sources, program, world })
    }

    fn watched(&self, _: &str, work: &mut dyn FnMut(&dyn Watch)) {
        self.flag.limit(self.seconds);
        work(self.flag);
        self.flag.limit(None);
    }

    fn is_stopped(&self) -> bool {
        self.flag.is_interrupted()
    }
}

/// Asks; returns the record as JSON.
#[pyfunction]
#[pyo3(name = "_tune", signature = (program, asked, progress = None))]
pub fn tune(
    py: Python<'_>,
    program: &Bound<'_, Program>,
    asked: &str,
    progress: Option<Py<PyAny>>,
) -> PyResult<String> {
    let asked: Asked = serde_json::from_str(asked).map_err(|error| argument(format!("not a question: {error}")))?;
    if !(1..=MAX_AXES).contains(&asked.vary.len()) {
        return Err(argument(format!("1 to {MAX_AXES} numbers are varied, not {}", asked.vary.len())));
    }
    if !(1..=MAX_SAMPLES).contains(&asked.samples) {
        return Err(argument(format!("`samples` is from 1 to {MAX_SAMPLES}, not {}", asked.samples)));
    }
    if asked.seconds.is_some_and(|seconds| !(seconds >= 0.0 && seconds.is_finite())) {
        return Err(argument("`seconds` is a number of at least 0"));
    }
    let goals: Vec<String> = asked.goal.iter().cloned().collect();
    let questions =
        Questions { world: asked.world.clone(), goals: goals.clone(), nevers: asked.nevers.clone(), without: None };
    let program = program.get().asking(py, questions)?;
    let id = program.world_id(asked.world.as_deref())?;
    let axes = asked.vary.iter().map(|vary| axis(&program.recipe, vary)).collect::<PyResult<Vec<Axis>>>()?;
    let question = wanted(&asked, &program.loaded, id, axes, &goals)?;
    let recipe = Arc::clone(&program.recipe);
    watched(py, progress.as_ref(), move |flag| {
        let found = tuned(&Recompiling { recipe: &recipe, seconds: asked.seconds, flag }, &question);
        let answer = Answer {
            axes: &question.axes,
            trials: &found.trials,
            parts: &found.parts,
            change: &found.change,
            is_wanted_already: found.is_wanted_already(),
            is_stopped: found.is_stopped,
            is_refuted: found.refuted.is_some(),
        };
        serde_json::to_string(&answer).unwrap_or_default()
    })
}

fn wanted(asked: &Asked, loaded: &Loaded, id: WorldId, axes: Vec<Axis>, goals: &[String]) -> PyResult<Question> {
    let table = &loaded.program.worlds[id];
    let known: Vec<(Target, &str)> =
        table.nevers.pairs().map(|(id, never)| (Target::Never(id), never.name.as_str())).collect();
    let never = |text: &String| {
        let name = question_name(text);
        let found = known.iter().find(|(_, known)| *known == name).map(|(target, _)| *target);
        found.ok_or_else(|| refusal(&loaded.sources, unknown(table, Kind::Never, &name, &known)))
    };
    Ok(Question {
        axes,
        query: Query {
            settings: Settings { seed: asked.seed, ..Settings::default() },
            limits: Limits { nodes: asked.nodes, memory: asked.memory },
            min_hold: asked.min_hold.unwrap_or(1),
            within: asked.within,
            asked: added_nevers(&loaded.program, &loaded.sources, id, NEVERS),
            chance: asked.chance,
            ..Query::new(vec![Target::Goal(only_goal(table, goals)?)])
        },
        wanted: if asked.prevent { Wanted::Prevented } else { Wanted::Reached },
        nevers: asked.nevers.iter().map(never).collect::<PyResult<_>>()?,
        samples: asked.samples,
    })
}

/// A number with what the program has.
fn axis(recipe: &Recipe, (path, range, step): &(String, (f64, f64), Option<f64>)) -> PyResult<Axis> {
    let written = written_number(&recipe.root, &Texts(recipe.texts.clone()), path).map_err(question)?;
    let set = recipe.numbers.iter().rev().find(|(set, _)| set == path);
    let base = set.map_or(written.literal, |(_, value)| value.parse().ok());
    let base = base.ok_or_else(|| {
        argument(format!("`{path}` is no plain number in the program: say by `params` what to begin with"))
    })?;
    Axis::new(path, &written.unit, base, *range, *step).map_err(argument)
}
