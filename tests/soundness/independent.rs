//! Visiting all states without the instances that cannot help, against searches of whole worlds: what is proven is
//! never reached, and a shortest way is as short.

use hypedc::analysis::configuration_space;
use hypedc::ir::{Program, WorldId};
use hypedc::reach::{Argument, Limits, Outcome, Planner, Problem, Settings, Target, Verdict, exhaust, search};
use hypedc::sim::Simulator;
use hypedc::watch::Unwatched;

use std::sync::Arc;

use super::choices::choices;
use super::files::compiled;
use super::frame::Frame;
use super::generate::program;

const WORLD: WorldId = WorldId(0);
/// Number of states of an exhaustion.
const STATES: u64 = 3_000;
/// One in so many worlds is asked of which nothing is left out.
const ENTANGLED: u64 = 16;
/// Number of nodes of a search.
const NODES: u64 = 600;

/// What was seen.
#[derive(Debug, Default)]
pub struct Seen {
    pub worlds: u64,
    /// Questions that were exhausted, and those of them without some instances.
    pub proven: u64,
    pub proven_without: u64,
    /// Ways that were found, and found without some instances.
    pub reached: u64,
    pub reports: Vec<String>,
}

/// Asks all questions about a random world.
pub fn look(seed: u64, seen: &mut Seen) {
    let text = program(&choices(seed), Frame::default());
    let Some(program) = compiled(&text).program else { return };
    seen.worlds += 1;
    let world = &program.worlds[WORLD];
    let goals = world.goals.ids().map(Target::Goal).chain(world.nevers.ids().map(Target::Never));
    for target in goals {
        // Most worlds are too entangled; of these some are enough.
        if !leaves_out(&program, target) && !seed.is_multiple_of(ENTANGLED) {
            continue;
        }
        if let Some(what) = asked(&program, target, seen) {
            seen.reports.push(format!("{seed}, {target:?}: {what}\n{text}"));
        }
    }
}

/// Whether instances are left out of a question.
fn leaves_out(program: &Arc<Program>, target: Target) -> bool {
    let sim = Simulator::new(program, WORLD);
    let limits = Limits { nodes: 1, ..Limits::default() };
    let begun = exhaust(&Problem::asking(&sim, target), &limits, 1, &Unwatched).ok().flatten();
    begun.is_some_and(|begun| match begun.verdict {
        Verdict::Unreachable(Argument::Exhaustion(all)) | Verdict::Exhausted(all) => all.left_out > 0,
        _ => begun.unfinished.is_some_and(|begun| begun.left_out > 0),
    })
}

fn asked(program: &Arc<Program>, target: Target, seen: &mut Seen) -> Option<String> {
    let sim = Simulator::new(program, WORLD);
    let problem = Problem::asking(&sim, target);
    let limits = Limits { nodes: STATES, ..Limits::default() };
    let visited = exhaust(&problem, &limits, 1, &Unwatched).ok()??;
    let all = match &visited.verdict {
        Verdict::Unreachable(Argument::Exhaustion(all)) | Verdict::Exhausted(all) => Some(*all),
        Verdict::Reached(_) => None,
        _ => return None,
    };
    let space = configuration_space(program, WORLD);
    let by = |planner: Planner| -> Option<Outcome> {
        let settings = Settings { planner, checks: false, ..Settings::default() };
        let limits = Limits { nodes: NODES, ..Limits::default() };
        search(&problem, &space, &settings, &limits, &Unwatched).ok()
    };
    for planner in [Planner::Exhaustive, Planner::Coverage] {
        let found = by(planner)?;
        match (&visited.verdict, &found.verdict) {
            (Verdict::Reached(short), Verdict::Reached(known)) => {
                if known.steps < short.steps || known.is_shortest && known.steps != short.steps {
                    return Some(format!("{} steps instead of {}", short.steps, known.steps));
                }
                seen.reached += 1;
            }
            (_, Verdict::Reached(plan)) => return Some(format!("proven, but {planner:?} needs {} steps", plan.steps)),
            (Verdict::Reached(short), Verdict::Unreachable(_)) => {
                return Some(format!("{} steps lead there, but {planner:?} proves it", short.steps));
            }
            _ => {}
        }
    }
    if let Some(all) = all {
        seen.proven += 1;
        seen.proven_without += u64::from(all.left_out > 0);
    }
    None
}
