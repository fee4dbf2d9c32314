//! `hypedc stuck`: places that can be reached from which a goal cannot be. Proven where all states can be visited, else
//! candidates; [`crate::reach::stuck`] finds them, this part asks, shows and draws.

pub(in crate::cli) mod args;
mod result;
mod text;

#[cfg(feature = "testing")]
pub(in crate::cli) use result::json_schema;

use std::io::{self, Write};

use crate::compile::{Asked, Changes, ExtraQuestion, question_name};
use crate::diagnostic::catalogue::run::NoQuestion;
use crate::diagnostic::similar;
use crate::ir::{GoalId, World, WorldId};
use crate::json::{self, Layout};
use crate::reach::stuck::{ExactAnswer, Gap, find_stuck};
use crate::reach::{Limits, Problem};
use crate::sim::Simulator;

use crate::cli::Exit;
use crate::cli::args::ResultFormat;
use crate::cli::report::{Loaded, choose_world, load_changed, plain_error, program_sha256, show_fact};
use crate::cli::watches::CommandWatch;
use args::StuckArgs;
use result::{RESULT_VERSION, StuckResult, StuckVerdict, WayResult};
use text::result_text;

/// Maximum number of ways in a result.
const MAX_WAYS: usize = 100;

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
    let goal = match goal(&loaded.program.worlds[world], args.goal.as_deref()) {
        Ok(goal) => goal,
        Err(fact) => {
            show_fact(&loaded.sources, fact)?;
            return Ok(Exit::Refused);
        }
    };
    answer(args, &loaded, world, goal)
}

/// The goal of the arguments, or the only one.
fn goal(world: &World, text: Option<&str>) -> Result<GoalId, NoQuestion> {
    let names: Vec<&str> = world.goals.iter().map(|goal| goal.name.as_str()).collect();
    let list = || format!("there is {}", names.iter().map(|n| format!("`{n}`")).collect::<Vec<_>>().join(", "));
    match text.map(question_name) {
        Some(name) => world.goal_named(&name).ok_or_else(|| NoQuestion {
            why: format!("no goal `{name}` in `{}`", world.name),
            near: similar(&name, names.iter().copied()),
            help: (!names.is_empty()).then(list),
        }),
        None => world.goals.ids().next().filter(|_| names.len() == 1).ok_or_else(|| match names.is_empty() {
            true => NoQuestion {
                why: format!("`{}` has no goal", world.name),
                near: None,
                help: Some(
                    "add one, such as `goal arrive: near(hero, (416, 48), 16)`, or ask a predicate with `--goal`"
                        .into(),
                ),
            },
            false => NoQuestion {
                why: format!("`{}` has several goals", world.name),
                near: None,
                help: Some(format!("choose one with `--goal NAME`; {}", list())),
            },
        }),
    }
}

fn answer(args: &StuckArgs, loaded: &Loaded, world: WorldId, goal: GoalId) -> io::Result<Exit> {
    let sim = Simulator::new(&loaded.program, world);
    let problem = Problem::new(&sim, goal);
    let limits = Limits { nodes: args.nodes, memory: args.memory << 20 };
    let watch = CommandWatch::new("states", args.seconds);
    let exact = find_stuck(&problem, &limits, MAX_WAYS, &watch);
    watch.finish();
    let mut result = StuckResult {
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
        places: 0,
        ways: Vec::new(),
        seconds: 0.0,
    };
    match exact {
        Err(fault) => {
            show_fact(&loaded.sources, fault.fact(&loaded.program, world, 0))?;
            return Ok(Exit::Refused);
        }
        Ok(Ok(exact)) => add_exact(&mut result, &exact, &sim),
        Ok(Err(gap)) => {
            if let Gap::Fault(fault, step) = gap {
                show_fact(&loaded.sources, fault.fact(&loaded.program, world, step))?;
            }
            result.not_all_states = Some(gap_words(gap, &limits, sim.world()));
        }
    }
    result.seconds = watch.seconds();
    match args.format {
        ResultFormat::Human => write!(io::stdout(), "{}", result_text(&result, None))?,
        ResultFormat::Json => {
            let mut out = io::stdout().lock();
            json::write(&result, Layout::Indented, &mut out)?;
            writeln!(out)?;
        }
    }
    Ok(if result.verdict == StuckVerdict::None { Exit::Yes } else { Exit::No })
}

fn add_exact(result: &mut StuckResult, exact: &ExactAnswer, sim: &Simulator) {
    result.verdict = match exact.counts.stuck {
        _ if !exact.starts_well => StuckVerdict::Unreachable,
        0 => StuckVerdict::None,
        _ => StuckVerdict::Stuck,
    };
    result.reads_between = exact.reads_between;
    result.states = Some(exact.counts.into());
    result.places = exact.places as u64;
    result.ways = exact.ways.iter().map(|way| WayResult::proven(way, sim.program(), sim.world_id())).collect();
}

/// Why not all states were visited, and what helps.
fn gap_words(gap: Gap, limits: &Limits, world: &World) -> String {
    match gap {
        Gap::Inputs => "there are too many combinations of buttons".to_string(),
        Gap::Draws => "nature draws from too many values".to_string(),
        Gap::Window(space) => {
            let space = &world.spaces[space].name;
            format!("a player can leave all that there is in `{space}`; `bounds` end a run there")
        }
        Gap::Fault(..) => "the program has a run-time error".to_string(),
        Gap::Nodes => format!("there are more than {}; `--nodes N` gives more", limits.nodes),
        Gap::Memory => "the memory is full; `--memory MIB` gives more".to_string(),
        Gap::Stopped => "the search was stopped".to_string(),
    }
}
