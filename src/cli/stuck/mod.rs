//! `hypedc stuck`: places that can be reached from which a goal cannot be. Proven where all states can be visited, else
//! candidates; [`crate::ask`] finds them, this part asks, shows and draws.

pub(in crate::cli) mod args;
mod picture;
mod text;

use std::io::{self, Write};

use crate::ask::{StuckLimits, StuckVerdict, StuckWatches, answer_stuck};
use crate::compile::{Asked, Changes, ExtraQuestion};
use crate::ir::{GoalId, WorldId};
use crate::json::{self, Layout};
use crate::sim::Simulator;

use crate::cli::Exit;
use crate::cli::args::ResultFormat;
use crate::cli::goal::chosen_goal;
use crate::cli::pictures::images;
use crate::cli::reach::ScriptDetail;
use crate::cli::report::{Loaded, choose_world, load_changed, plain_error, show_fact};
use crate::cli::watches::{CommandWatch, Interrupt};
use args::StuckArgs;
use text::result_text;

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
    let limits = StuckLimits {
        states: args.states,
        nodes: args.nodes,
        memory: args.memory << 20,
        seed: args.seed,
        seconds: args.seconds,
    };
    let watches =
        StuckWatches { exact: &watch.part(EXACT_PART), whole: &watch, is_interrupted: &|| watch.is_interrupted() };
    let answer = answer_stuck(&args.file, (&sim, goal), &limits, &watches);
    watch.finish();
    let (mut result, drawn) = match answer {
        Ok(answer) => {
            if let Some((fault, step)) = answer.fault {
                show_fact(&loaded.sources, fault.fact(&loaded.program, world, step))?;
            }
            (answer.result, answer.drawn)
        }
        Err(fault) => {
            show_fact(&loaded.sources, fault.fact(&loaded.program, world, 0))?;
            return Ok(Exit::Refused);
        }
    };
    (result.set, result.seconds) = (args.numbers.texts(), watch.seconds());
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
