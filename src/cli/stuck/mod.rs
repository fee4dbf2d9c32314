//! `hypedc stuck`: places that can be reached from which a goal cannot be. Proven where all states can be visited, else
//! candidates; [`crate::reach::stuck`] finds them, this part asks, shows and draws.

pub(in crate::cli) mod args;
mod picture;
mod result;
mod text;

#[cfg(feature = "testing")]
pub(in crate::cli) use result::json_schema;

use std::io::{self, Write};

use crate::analysis::watched_space;
use crate::compile::{Asked, Changes, ExtraQuestion};
use crate::ir::{ExprId, GoalId, World, WorldId};
use crate::json::{self, Layout};
use crate::reach::stuck::{CandidateAnswer, CandidateLimits, ExactAnswer, Gap, Unknown, find_candidates, find_stuck};
use crate::reach::{Limits, Problem};
use crate::sim::{Fault, Simulator};
use crate::watch::Watch;

use crate::cli::Exit;
use crate::cli::args::ResultFormat;
use crate::cli::goal::chosen_goal;
use crate::cli::pictures::images;
use crate::cli::reach::ScriptDetail;
use crate::cli::report::{Loaded, choose_world, load_changed, plain_error, program_sha256, show_fact};
use crate::cli::watches::{CommandWatch, Interrupt};
use args::StuckArgs;
use picture::Drawn;
use result::{RESULT_VERSION, StuckResult, StuckVerdict, WayResult};
use text::result_text;

/// Maximum number of ways in a result.
const MAX_WAYS: usize = 100;
/// The part of a limit of time in which all states are visited.
const EXACT_PART: f64 = 0.4;

pub(in crate::cli) fn run(args: &StuckArgs) -> io::Result<Exit> {
    if let Some(why) = args.numbers.refusal() {
        plain_error(&why)?;
        return Ok(Exit::Refused);
    }
    let numbers = args.numbers.fixed();
    let world_name = args.world.as_deref();
    let questions: Vec<ExtraQuestion<'_>> = match &args.goal {
        Some(text) => vec![ExtraQuestion { asked: Asked::Goal, world: world_name, text, origin: "--goal" }],
        None => Vec::new(),
    };
    let changes = Changes { questions: &questions, numbers: &numbers, ..Changes::default() };
    let Some(loaded) = load_changed(&args.file, args.level.file(), &changes)? else { return Ok(Exit::Refused) };
    let Some(world) = choose_world(&loaded, &args.file, args.world.as_deref())? else { return Ok(Exit::Refused) };
    let goal = match chosen_goal(&loaded.program.worlds[world], args.goal.as_deref()) {
        Ok(goal) => goal,
        Err(fact) => {
            show_fact(&loaded.sources, fact)?;
            return Ok(Exit::Refused);
        }
    };
    answer(args, &loaded, world, goal)
}

/// Asks, and shows the answer.
fn answer(args: &StuckArgs, loaded: &Loaded, world: WorldId, goal: GoalId) -> io::Result<Exit> {
    let sim = Simulator::new(&loaded.program, world);
    let images = match args.svg.as_ref().map(|_| images(&loaded.program, &args.file)).transpose() {
        Ok(images) => images.unwrap_or_default(),
        Err(why) => {
            plain_error(&why)?;
            return Ok(Exit::Refused);
        }
    };
    let watch = CommandWatch::new("stuck", args.seconds);
    let mut result = empty(args, loaded, &sim, goal);
    let drawn = find(args, loaded, (&sim, goal), &mut result, &watch);
    watch.finish();
    result.seconds = watch.seconds();
    let drawn = match drawn {
        Ok(drawn) => drawn,
        Err(fault) => {
            show_fact(&loaded.sources, fault.fact(&loaded.program, world, 0))?;
            return Ok(Exit::Refused);
        }
    };
    if let Some(path) = &args.svg
        && let Err(error) = picture::save(path, (&sim, goal), &result, &drawn, &images, &Interrupt::new())
    {
        plain_error(&format!("cannot write `{}`: {error}", path.display()))?;
        return Ok(Exit::Refused);
    }
    match args.format {
        ResultFormat::Human => {
            let detail = ScriptDetail::on_terminal(args.verbose);
            write!(io::stdout(), "{}", result_text(&result, args.svg.as_deref(), detail))?;
        }
        ResultFormat::Json => {
            let mut out = io::stdout().lock();
            json::write(&result, Layout::Indented, &mut out)?;
            writeln!(out)?;
        }
    }
    Ok(if result.verdict == StuckVerdict::None { Exit::Yes } else { Exit::No })
}

/// The record before anything is known.
fn empty(args: &StuckArgs, loaded: &Loaded, sim: &Simulator, goal: GoalId) -> StuckResult {
    StuckResult {
        version: RESULT_VERSION,
        file: args.file.display().to_string(),
        program_sha256: program_sha256(&loaded.program),
        world: sim.world().name.clone(),
        set: args.numbers.texts(),
        goal: sim.world().goals[goal].name.clone(),
        verdict: StuckVerdict::Unknown,
        reads_between: false,
        states: None,
        not_all_states: None,
        unknown: None,
        rest_places: None,
        open_places: 0,
        places: 0,
        ways: Vec::new(),
        seconds: 0.0,
    }
}

/// Visits all states; if that cannot be done, searches for candidates.
fn find(
    args: &StuckArgs,
    loaded: &Loaded,
    (sim, goal): (&Simulator, GoalId),
    result: &mut StuckResult,
    watch: &CommandWatch,
) -> Result<Drawn, Fault> {
    let problem = Problem::new(sim, goal);
    let [all, limits] = [args.states, args.nodes].map(|nodes| Limits { nodes, memory: args.memory << 20 });
    // The search for candidates needs time, too.
    let gap = match find_stuck(&problem, &all, MAX_WAYS, &watch.part(EXACT_PART))? {
        Ok(exact) => return Ok(add_exact(result, exact, sim)),
        Err(gap) => gap,
    };
    if let Gap::Fault(fault, step) = gap {
        // The fault is shown, and the search goes on around it.
        let _ = show_fact(&loaded.sources, fault.fact(&loaded.program, sim.world_id(), step));
    }
    let stopped = Stopped { is_interrupted: watch.is_interrupted(), seconds: args.seconds };
    result.not_all_states = Some(gap_words(gap, &all, sim.world(), stopped));
    if watch.stop() {
        result.unknown = Some(unknown_words(Unknown::Stopped, stopped));
        return Ok(Drawn::default());
    }
    let nevers: Vec<ExprId> = sim.world().nevers.iter().map(|never| never.holds).collect();
    let space = watched_space(sim.program(), sim.world_id(), &nevers, watch);
    match find_candidates(&problem, &space, &CandidateLimits { limits, seed: args.seed }, watch)? {
        Ok(answer) => Ok(add_candidates(result, answer, sim)),
        Err(unknown) => {
            let stopped = Stopped { is_interrupted: watch.is_interrupted(), ..stopped };
            result.unknown = Some(unknown_words(unknown, stopped));
            Ok(Drawn::default())
        }
    }
}

fn add_exact(result: &mut StuckResult, exact: ExactAnswer, sim: &Simulator) -> Drawn {
    result.verdict = match exact.counts.stuck {
        _ if !exact.starts_well => StuckVerdict::Unreachable,
        0 => StuckVerdict::None,
        _ => StuckVerdict::Stuck,
    };
    result.reads_between = exact.reads_between;
    result.states = Some(exact.counts);
    result.places = exact.places as u64;
    let record = |way| WayResult::exact(way, !exact.reads_between, sim.program(), sim.world_id());
    result.ways = exact.ways.iter().map(record).collect();
    Drawn { spots: exact.spots, scripts: exact.ways.into_iter().map(|way| way.script).collect() }
}

fn add_candidates(result: &mut StuckResult, answer: CandidateAnswer, sim: &Simulator) -> Drawn {
    result.verdict = if answer.candidates.is_empty() { StuckVerdict::NoneFound } else { StuckVerdict::Candidates };
    (result.rest_places, result.open_places) = (Some(answer.rest_places), answer.open_places);
    result.places = answer.candidates.len() as u64;
    let shown = || answer.candidates.iter().take(MAX_WAYS);
    result.ways = shown().map(|way| WayResult::candidate(way, sim.program(), sim.world_id())).collect();
    let scripts = shown().map(|way| way.script.clone()).collect();
    Drawn { spots: answer.spots, scripts }
}

/// What stopped a search.
#[derive(Clone, Copy)]
struct Stopped {
    /// Whether ctrl-C was pressed.
    is_interrupted: bool,
    /// The limit of time.
    seconds: Option<f64>,
}

impl Stopped {
    fn words(self) -> String {
        match self.seconds.filter(|_| !self.is_interrupted) {
            Some(seconds) => format!("`--seconds {seconds}` allows no more"),
            None => "the search was interrupted".to_string(),
        }
    }
}

/// Why nothing can be said, and what helps.
fn unknown_words(unknown: Unknown, stopped: Stopped) -> String {
    match unknown {
        Unknown::NotFound => "no way to the goal was found from the start; `hypedc reach` tells more".to_string(),
        Unknown::Unreachable => "the goal cannot be reached from the start; `hypedc reach` tells why".to_string(),
        Unknown::NoRest => "players never rest in this world, so that there are no places to search from".to_string(),
        Unknown::Stopped => format!("places to get stuck were not looked for to the end: {}", stopped.words()),
    }
}

/// Why not all states were visited, and what helps.
fn gap_words(gap: Gap, limits: &Limits, world: &World, stopped: Stopped) -> String {
    match gap {
        Gap::Inputs => "there are too many combinations of buttons".to_string(),
        Gap::Draws => "nature draws from too many values".to_string(),
        Gap::Window(space) => {
            let space = &world.spaces[space].name;
            format!("a player can leave all that there is in `{space}`; `bounds` end a run there")
        }
        Gap::Fault(..) => "the program has a run-time error".to_string(),
        Gap::Nodes => format!("more than `--states {}` allows", limits.nodes),
        Gap::Memory => "the memory is full; `--memory MIB` gives more".to_string(),
        Gap::Stopped => stopped.words(),
    }
}
