//! `reach`: searches for goals and counterexamples.

use std::ops::ControlFlow;

use super::{Drawn, Monitor, ReachArguments, named};
use crate::ask::{Drawing, Refusal, Refuted, RunResult, WITHOUT, Without, no_goal, read_scripts, search_svg, targets};
use crate::compile::{Asked, Changes, ExtraConstraint, ExtraQuestion, added_nevers};
use crate::corpus;
use crate::ir::{World, WorldId};
use crate::lsp::buffers::Buffers;
use crate::reach::query::{Phase, Query, QueryError, Session, Supervisor};
use crate::reach::{Limits, Settings, Style, Target};
use crate::view::Images;
use crate::watch::Watch;

/// The sources of what is asked beside the program.
const GOALS: &str = "goals";
const NEVERS: &str = "nevers";

pub(super) fn run(
    arguments: &ReachArguments,
    buffers: &Buffers,
    monitor: &dyn Monitor,
) -> Result<Drawn<RunResult>, String> {
    let ReachArguments { program, goals, nevers, without, after, .. } = arguments;
    let numbers = program.numbers()?;
    let world = program.world.as_deref();
    let question = |asked, origin| move |text: &'_ String| (asked, origin, text.clone());
    let texts: Vec<(Asked, &str, String)> = goals
        .iter()
        .map(question(Asked::Goal, GOALS))
        .chain(nevers.iter().map(question(Asked::Never, NEVERS)))
        .collect();
    let questions: Vec<ExtraQuestion<'_>> =
        texts.iter().map(|(asked, origin, text)| ExtraQuestion { asked: *asked, world, text, origin }).collect();
    let avoided = without.as_deref().map(Without::read);
    let excluded = avoided.and_then(Without::predicate);
    let constraint = excluded.map(|predicate| ExtraConstraint { world, name: WITHOUT, predicate, origin: WITHOUT });
    let changes = Changes { questions: &questions, constraint, numbers: &numbers };
    let (mut loaded, _) = program.load(&changes, buffers)?;
    let world = program.world(&loaded)?;
    let table = &loaded.program.worlds[world];
    // The compiler appends it.
    let excluded = excluded.and_then(|_| table.nevers.ids().next_back());
    let unpressed = avoided.map_or(Ok(Vec::new()), |avoided| avoided.buttons(&loaded.program, table));
    let unpressed = unpressed.map_err(|why| Refusal::of(why).sentence(&loaded.sources))?;
    let is_offered = |target: Target| excluded.map(Target::Never) != Some(target);
    let chosen = targets(table, (goals, nevers), &is_offered).and_then(|chosen| match chosen.is_empty() {
        true => Err(no_goal(table)),
        false => Ok(chosen),
    });
    let chosen = chosen.map_err(|why| why.sentence(&loaded.sources))?;
    let asked = added_nevers(&loaded.program, &loaded.sources, world, NEVERS);
    let scripts = read_scripts(&mut loaded, world, (after, "after"));
    let scripts = scripts.map_err(|why| why.sentence(&loaded.sources))?;
    let settings = Settings {
        seed: arguments.seed.unwrap_or(1),
        explains: true,
        records: arguments.picture,
        ..Settings::default()
    };
    let limits = Limits { nodes: arguments.nodes.unwrap_or(Limits::default().nodes), ..Limits::default() };
    let query = Query {
        settings,
        limits,
        without: excluded.into_iter().collect(),
        unpressed,
        asked,
        after: scripts,
        style: arguments.minimize.then_some(Style::Fast),
        chance: arguments.chance,
        ..Query::new(chosen)
    };
    let count = query.targets.len();
    monitor.part(0, count + 1, "analysis");
    let started = monitor.seconds();
    let session = Session::new(&loaded.program, world, query, monitor);
    let mut phases = Phases { monitor, world: &loaded.program.worlds[world], done: 0, count, seconds: Vec::new() };
    let recorded = corpus::Settings {
        set: program.set.clone(),
        without: without.clone(),
        after: after.clone(),
        chance: arguments.chance,
        minimize: arguments.minimize,
        ..corpus::Settings::of(&settings, &limits)
    };
    let mut result = RunResult::new(&named(&program.path), &session, recorded, monitor.seconds() - started);
    let all =
        session.find_all(&mut phases).map_err(|error| refusal(&loaded.program, world, &error, &loaded.sources))?;
    result.refuted = session.refutation().map(|found| Refuted::new(&loaded.program, world, &found));
    let mut pictures = Vec::new();
    for (mut found, seconds) in all.into_iter().zip(phases.seconds) {
        let answer = session.answer(&mut found, &loaded.sources);
        if arguments.picture {
            let svg = search_svg(&session, &found, &answer, &Images::default(), monitor);
            pictures.push(Drawing { name: answer.goal.clone(), svg });
        }
        result.add(answer, &found.outcome, seconds, false);
    }
    Ok(Drawn { result, pictures })
}

/// Why a session cannot answer.
fn refusal(
    program: &crate::ir::Program,
    world: WorldId,
    error: &QueryError,
    sources: &crate::source::SourceMap,
) -> String {
    match *error {
        QueryError::Fault(fault, step) => Refusal::of(fault.fact(program, world, step)).sentence(sources),
        QueryError::Over { script, step, .. } => {
            format!("script {} of `after` leads nowhere: the run is over after step {step}", script + 1)
        }
    }
}

/// Tells which search runs.
struct Phases<'a> {
    monitor: &'a dyn Monitor,
    world: &'a World,
    done: usize,
    count: usize,
    /// How long each search took.
    seconds: Vec<f64>,
}

impl Supervisor for Phases<'_> {
    fn supervise(&mut self, phase: Phase, work: &mut dyn FnMut(&dyn Watch)) -> ControlFlow<()> {
        let name = |target: Target| target.name(self.world).to_string();
        let started = self.monitor.seconds();
        match phase {
            Phase::Search(target) => {
                self.done += 1;
                self.monitor.part(self.done, self.count + 1, &name(target));
            }
            Phase::Minimize(target) | Phase::MakeRobust(target) | Phase::MeasureRobust(target) => {
                self.monitor.part(self.count, self.count + 1, &format!("{}, a faster path", name(target)));
            }
            Phase::Exchange => {}
        }
        work(self.monitor);
        if matches!(phase, Phase::Search(_)) {
            self.seconds.push(self.monitor.seconds() - started);
        }
        if self.monitor.stop() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }
}
