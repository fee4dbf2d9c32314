//! Questions about what can be reached. The records are those of `hypedc reach --format json`.

use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Instant;

use hypedc::ask::{Exploration, Loaded, Refusal, Refuted, RunResult, Without, read_scripts, search_svg, targets};
use hypedc::compile::added_nevers;
use hypedc::corpus;
use hypedc::diagnostic::catalogue::run::NoQuestion;
use hypedc::diagnostic::similar;
use hypedc::ir::WorldId;
use hypedc::reach::query::{Phase, Query, QueryError, Session, Supervisor, TimingErrors};
use hypedc::reach::robust::Jitter;
use hypedc::reach::{Explorer, Limits, Planner, Settings, Style, Target, Termination};
use hypedc::view::Images;
use hypedc::watch::Watch;
use pyo3::prelude::*;
use serde::Deserialize;

use crate::error::{argument, question, refusal, step};
use crate::program::{NEVERS, Program, Questions};
use crate::watched::{Flag, watched};

/// What is asked, beside the program.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Asked {
    pub world: Option<String>,
    pub goals: Vec<String>,
    pub nevers: Vec<String>,
    pub without: Option<String>,
    pub within: Option<u32>,
    pub min_hold: Option<u16>,
    pub after: Vec<String>,
    pub planner: String,
    pub nodes: Option<u64>,
    pub seconds: Option<f64>,
    pub memory: Option<u64>,
    pub seed: u64,
    pub trees: usize,
    pub threads: usize,
    pub style: Option<String>,
    pub chance: Option<u64>,
    pub exhaust: bool,
    pub sigma: Option<f64>,
    pub trials: u64,
    pub svg: bool,
}

/// Maximum number of trees and of threads.
const MAX_THREADS: usize = 1 << 10;
/// Maximum number of plays with timing errors.
const MAX_TRIALS: u64 = 1_000_000;

/// A choice by name.
fn named<T: Copy>(what: &str, text: &str, all: &[(T, &'static str)]) -> PyResult<T> {
    let found = all.iter().find(|(_, name)| *name == text).map(|(of, _)| *of);
    found.ok_or_else(|| {
        let list: Vec<String> = all.iter().map(|(_, name)| format!("`{name}`")).collect();
        let near = similar(text, all.iter().map(|(_, name)| *name));
        question(NoQuestion {
            why: format!("no {what} `{text}`"),
            near,
            help: Some(format!("there is {}", list.join(", "))),
        })
    })
}

impl Asked {
    fn new(text: &str) -> PyResult<Asked> {
        let asked: Asked = serde_json::from_str(text).map_err(|error| argument(format!("not a question: {error}")))?;
        if asked.seconds.is_some_and(|seconds| !(seconds >= 0.0 && seconds.is_finite())) {
            return Err(argument("`seconds` is a number of at least 0"));
        }
        if !(1..=MAX_THREADS).contains(&asked.trees) || !(1..=MAX_THREADS).contains(&asked.threads) {
            return Err(argument(format!("`trees` and `threads` are from 1 to {MAX_THREADS}")));
        }
        if let Some(sigma) = asked.sigma.filter(|sigma| !(*sigma > 0.0 && *sigma <= Jitter::MAX_SIGMA)) {
            let most = Jitter::MAX_SIGMA;
            return Err(argument(format!("timing errors of {sigma} steps: `sigma` is above 0, at most {most} steps")));
        }
        if !(1..=MAX_TRIALS).contains(&asked.trials) {
            return Err(argument(format!("`trials` is from 1 to {MAX_TRIALS}, not {}", asked.trials)));
        }
        Ok(asked)
    }

    fn limits(&self) -> Limits {
        let nodes = if self.seconds.is_some() { u64::MAX } else { Limits::default().nodes };
        let memory = self.memory.unwrap_or(Limits::default().memory);
        Limits { nodes: self.nodes.unwrap_or(nodes), memory }
    }

    fn style(&self) -> PyResult<Option<Style>> {
        let all: Vec<(Style, &str)> = Style::ALL.into_iter().map(|style| (style, style.name())).collect();
        self.style.as_deref().map(|name| named("style", name, &all)).transpose()
    }

    fn settings(&self) -> PyResult<Settings> {
        let all: Vec<(Planner, &str)> = Planner::ALL.into_iter().map(|planner| (planner, planner.name())).collect();
        Ok(Settings {
            seed: self.seed,
            planner: named("planner", &self.planner, &all)?,
            trees: self.trees,
            threads: self.threads,
            exhausts: self.exhaust,
            explains: true,
            records: self.svg,
            ..Settings::default()
        })
    }

    /// The query about a world of a program that has the questions.
    fn query(&self, loaded: &mut Loaded, world: WorldId) -> PyResult<Query> {
        let (style, settings) = (self.style()?, self.settings()?);
        let no = |why: Refusal| refusal(&hypedc::source::SourceMap::new(), why);
        let after = read_scripts(loaded, world, (&self.after, "after")).map_err(|why| refusal(&loaded.sources, why))?;
        let table = &loaded.program.worlds[world];
        let avoided = self.without.as_deref().map(Without::read);
        let unpressed = avoided.map_or(Ok(Vec::new()), |of| of.buttons(&loaded.program, table)).map_err(question)?;
        // The compiler appends it.
        let without = avoided.and_then(Without::predicate).and_then(|_| table.nevers.ids().next_back());
        let is_offered = |target: Target| without.map(Target::Never) != Some(target);
        let chosen = targets(table, (&self.goals, &self.nevers), &is_offered).map_err(no)?;
        if chosen.is_empty() {
            return Err(no(hypedc::ask::no_goal(table)));
        }
        Ok(Query {
            settings,
            limits: self.limits(),
            min_hold: self.min_hold.unwrap_or(1),
            within: self.within,
            without: without.into_iter().collect(),
            unpressed,
            asked: added_nevers(&loaded.program, &loaded.sources, world, NEVERS),
            after,
            style,
            chance: self.chance,
            errors: self.sigma.map(|sigma| TimingErrors::new(sigma, self.trials)),
            ..Query::new(chosen)
        })
    }

    /// The settings as results record them.
    fn recorded(&self, program: &Program, settings: &Settings) -> corpus::Settings {
        corpus::Settings {
            set: program.recipe.numbers.iter().map(|(path, value)| format!("{path}={value}")).collect(),
            without: self.without.clone(),
            within: self.within.map(|steps| format!("{steps}frames")),
            after: self.after.clone(),
            min_hold: self.min_hold.map(|steps| format!("{steps}frames")),
            minimize: self.style.is_some(),
            style: self.style.clone().filter(|style| style != Style::Fast.name()),
            chance: self.chance,
            robust: self.sigma.map(|sigma| format!("sigma={sigma}frames,trials={}", self.trials)),
            nodes_limit: self.nodes.or(self.seconds.is_none().then(|| self.limits().nodes)),
            seconds_limit: self.seconds,
            ..corpus::Settings::of(settings, &self.limits())
        }
    }
}

/// Limits each phase of a session, and measures searches.
struct Phases<'f> {
    flag: &'f Flag,
    seconds: Option<f64>,
    /// The time for the next search, s.
    next: Option<f64>,
    /// Each target with the duration of its search and the time that is left for its path, s.
    searched: Vec<(Target, f64, Option<f64>)>,
}

impl Supervisor for Phases<'_> {
    fn supervise(&mut self, phase: Phase, work: &mut dyn FnMut(&dyn Watch)) -> ControlFlow<()> {
        let left = |target| self.searched.iter().find(|of| of.0 == target).and_then(|of| of.2);
        self.flag.limit(match phase {
            Phase::Search(_) => self.next,
            Phase::Minimize(target) => left(target),
            Phase::MakeRobust(_) => self.seconds,
            // What was found is replayed whatever it takes.
            Phase::Exchange | Phase::MeasureRobust(_) => None,
        });
        let started = Instant::now();
        work(self.flag);
        self.flag.limit(None);
        if let Phase::Search(target) = phase {
            let seconds = started.elapsed().as_secs_f64();
            self.searched.push((target, seconds, self.next.map(|limit| (limit - seconds).max(0.0))));
            self.next = self.seconds;
        }
        if self.flag.is_interrupted() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }
}

/// What a search gave: the record as JSON, a picture of each answer, and whether it was interrupted.
type Found = (String, Vec<String>, bool);

/// What is asked, with the program that has the questions.
struct Prepared {
    asked: Asked,
    loaded: Arc<Loaded>,
    world: WorldId,
    query: Query,
    recorded: corpus::Settings,
    root: PathBuf,
}

impl Prepared {
    fn new(py: Python<'_>, program: &Bound<'_, Program>, asked: Asked) -> PyResult<Prepared> {
        let questions = Questions {
            world: asked.world.clone(),
            goals: asked.goals.clone(),
            nevers: asked.nevers.clone(),
            without: asked.without.as_deref().and_then(|text| Without::read(text).predicate()).map(str::to_string),
        };
        let program = program.get().asking(py, questions)?;
        let world = program.world_id(asked.world.as_deref())?;
        let (sources, of) = (program.loaded.sources.clone(), Arc::clone(&program.loaded.program));
        let mut loaded = Loaded { sources, program: of };
        let query = asked.query(&mut loaded, world)?;
        let recorded = asked.recorded(&program, &query.settings);
        Ok(Prepared { asked, loaded: Arc::new(loaded), world, query, recorded, root: program.recipe.root.clone() })
    }
}

/// Searches without a question; returns the record of what was covered, and whether it was interrupted.
#[pyfunction]
#[pyo3(name = "_explore", signature = (program, asked, progress = None))]
pub fn explore(
    py: Python<'_>,
    program: &Bound<'_, Program>,
    asked: &str,
    progress: Option<Py<PyAny>>,
) -> PyResult<(String, bool)> {
    let Prepared { asked, loaded, world, mut query, mut recorded, root } =
        Prepared::new(py, program, Asked::new(asked)?)?;
    // What is said of a goal that was not found costs time; there is none.
    query.settings.explains = false;
    if query.settings.planner == Planner::Auto {
        query.settings.planner = Planner::Coverage;
        recorded.planner = Planner::Coverage.name().to_string();
    }
    let (kept, seconds) = (Arc::clone(&loaded), asked.seconds);
    let found = watched(py, progress.as_ref(), move |flag| {
        let started = Instant::now();
        flag.limit(seconds);
        let session = Session::new(&loaded.program, world, query, flag);
        let explorer = Explorer::new(session.simulator());
        let left = seconds.map(|limit| (limit - started.elapsed().as_secs_f64()).max(0.0));
        flag.limit(left);
        let started = Instant::now();
        let outcome = session.explore(&explorer, flag)?;
        let (covered, seconds) = ((&outcome, &explorer.explored()), started.elapsed().as_secs_f64());
        let result = Exploration::new((&root, &loaded, world), recorded, covered, seconds);
        Ok((serde_json::to_string(&result).unwrap_or_default(), flag.is_interrupted()))
    })?;
    found.map_err(|error| refused(&kept, world, &asked, &error))
}

/// Asks.
#[pyfunction]
#[pyo3(name = "_reach", signature = (program, asked, progress = None))]
pub fn reach(
    py: Python<'_>,
    program: &Bound<'_, Program>,
    asked: &str,
    progress: Option<Py<PyAny>>,
) -> PyResult<Found> {
    let Prepared { asked, loaded, world, query, recorded, root } = Prepared::new(py, program, Asked::new(asked)?)?;
    let kept = Arc::clone(&loaded);
    let (seconds, draws) = (asked.seconds, asked.svg);
    let found = watched(py, progress.as_ref(), move |flag| {
        answers(&loaded, (world, query), recorded, &root, (seconds, draws), flag)
    })?;
    found.map_err(|error| refused(&kept, world, &asked, &error))
}

fn answers(
    loaded: &Loaded,
    (world, query): (WorldId, Query),
    recorded: corpus::Settings,
    root: &Path,
    (seconds, draws): (Option<f64>, bool),
    flag: &Flag,
) -> Result<Found, QueryError> {
    // The analysis counts towards the time for the first target.
    flag.limit(seconds);
    let started = Instant::now();
    let session = Session::new(&loaded.program, world, query, flag);
    let analysis = started.elapsed().as_secs_f64();
    let mut phases =
        Phases { flag, seconds, next: seconds.map(|limit| (limit - analysis).max(0.0)), searched: Vec::new() };
    let all = session.find_all(&mut phases)?;
    let mut result = RunResult::new(root, &session, recorded, analysis);
    result.refuted = session.refutation().map(|of| Refuted::new(&loaded.program, world, &of));
    let mut pictures = Vec::new();
    for (mut found, (_, seconds, _)) in all.into_iter().zip(&phases.searched) {
        let answer = session.answer(&mut found, &loaded.sources);
        if draws {
            pictures.push(search_svg(&session, &found, &answer, &Images::default(), flag));
        }
        result.add(answer, &found.outcome, *seconds, false);
    }
    Ok((serde_json::to_string(&result).unwrap_or_default(), pictures, flag.is_interrupted()))
}

fn refused(loaded: &Loaded, world: WorldId, asked: &Asked, error: &QueryError) -> PyErr {
    let (index, reason, at) = match *error {
        QueryError::Fault(fault, at) => return step(&loaded.sources, fault.fact(&loaded.program, world, at)),
        QueryError::Over { script, reason, step } => (script, reason, step),
    };
    let reason = match reason {
        Termination::Never(id) => format!("`never {}` holds", loaded.program.worlds[world].nevers[id].name),
        Termination::Avoided => "the predicate of `without` holds".to_string(),
        Termination::Outside => "the player is out of bounds".to_string(),
    };
    let text = asked.after.get(index).map_or("", String::as_str);
    argument(format!(
        "`after` {text:?} leads nowhere: {reason} after step {at}; give a script whose run goes on at its end"
    ))
}
