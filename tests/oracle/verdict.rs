//! Checks the verdicts on the goals of a tiny world against its reachable states.

use hypedc::analysis::{at_most, configuration_space};
use hypedc::compile::IdeCompilation;
use hypedc::ir::{Program, WorldId};
use hypedc::reach::{Limits, Planner, Problem, Settings, Target, Verdict, search};
use hypedc::sim::{Script, Simulator};
use hypedc::watch::Unwatched;
use std::sync::Arc;

use super::brute::{Explored, explore};
use super::compare::input;
use super::model::{Moves, Oracle};

/// A source of verdicts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Judge {
    /// The configuration space, which rules goals out.
    Analysis,
    /// Breadth-first exhaustion with inputs that are held for one step each.
    Exhaustion,
}

/// Statistics of many worlds.
#[derive(Debug, Default, Clone)]
pub struct Tally {
    /// Programs that compile.
    pub worlds: usize,
    /// Worlds whose states were enumerated completely.
    pub closed: usize,
    /// Worlds with a possible run-time fault.
    pub faulty: usize,
    pub states: usize,
    pub goals: usize,
    pub reachable: usize,
    /// Reachable goals that do not hold at the start.
    pub later: usize,
    /// Reachable goals with a known shortest path.
    pub shortest: usize,
    /// Unreachable goals of completely enumerated worlds.
    pub unreachable: usize,
    /// Unreachable goals that the source of verdicts rules out.
    pub proven: usize,
}

/// A path as `hypedc sim --inputs` reads it.
pub fn written(program: &Program, world: WorldId, way: &[Moves]) -> String {
    let mut script = Script::default();
    way.iter().for_each(|moves| script.push(&input(moves), 1));
    script.text(program, world)
}

/// Checks a world; the first false verdict is an error.
pub fn check(study: &IdeCompilation, judge: Judge, most: usize, tally: &mut Tally) -> Result<(), String> {
    let program = study.compilation.program.as_ref().unwrap();
    let world = WorldId(0);
    let oracle = Oracle::new(&study.checked, world);
    let explored = explore(&oracle, most);
    tally.worlds += 1;
    tally.closed += usize::from(explored.is_closed);
    tally.faulty += usize::from(explored.faulted);
    tally.states += explored.states;
    tally.goals += explored.ways.len();
    tally.reachable += explored.ways.iter().flatten().count();
    tally.later += explored.ways.iter().flatten().filter(|way| !way.is_empty()).count();
    let missing = explored.ways.iter().filter(|g| g.is_none()).count();
    tally.unreachable += if explored.is_closed { missing } else { 0 };
    match judge {
        Judge::Analysis => analysed(program, world, &explored, tally),
        Judge::Exhaustion => exhausted(program, world, &explored, most, tally),
    }
}

/// All targets of a world: the name, and the planner's target.
fn questions(program: &Program, world: WorldId) -> Vec<(String, Target)> {
    let world = &program.worlds[world];
    let goals = world.goals.pairs().map(|(id, goal)| (goal.name.clone(), Target::Goal(id)));
    let nevers = world.nevers.pairs().map(|(id, never)| (never.name.clone(), Target::Never(id)));
    goals.chain(nevers).collect()
}

fn analysed(program: &Program, world: WorldId, explored: &Explored, tally: &mut Tally) -> Result<(), String> {
    let space = configuration_space(program, world);
    let space = space.by_place(program, world, &[], &Unwatched).by_flight(
        program,
        world,
        &[],
        &mut at_most(10_000),
        &Unwatched,
    );
    for ((name, target), way) in questions(program, world).into_iter().zip(&explored.ways) {
        // A `never` also counts outside of the bounds, about which the analysis claims nothing.
        let Target::Goal(goal) = target else { continue };
        let can_hold = space.can_hold(program, world, goal);
        match way {
            Some(way) if !can_hold => {
                let way = written(program, world, way);
                return Err(format!("the analysis rules {name} out, but `{way}` leads to it"));
            }
            None if explored.is_closed => tally.proven += usize::from(!can_hold),
            _ => {}
        }
    }
    Ok(())
}

fn exhausted(
    program: &Arc<Program>,
    world: WorldId,
    explored: &Explored,
    most: usize,
    tally: &mut Tally,
) -> Result<(), String> {
    let sim = Simulator::new(program, world);
    // The planner only uses its coordinates.
    let space = configuration_space(program, world);
    let settings = Settings { planner: Planner::Exhaustive, hold: Some((1, 1)), ..Settings::default() };
    let limits = Limits { nodes: 4 * most as u64, ..Limits::default() };
    for ((name, target), way) in questions(program, world).into_iter().zip(&explored.ways) {
        let problem = Problem::asking(&sim, target);
        let Ok(outcome) = search(&problem, &space, &settings, &limits, &Unwatched) else {
            if explored.states > 0 || !explored.faulted {
                return Err(format!("{name}: the first state breaks a rule for the simulator only"));
            }
            continue;
        };
        match (&outcome.verdict, way) {
            (Verdict::Reached(plan), Some(way)) => {
                // A way around outside of a search window may be shorter than what is found inside, and is never ruled out.
                let is_open = outcome.cuts.iter().any(|cut| u64::from(cut.soonest) + 1 < plan.steps);
                let is_right = match is_open {
                    true => plan.steps >= way.len() as u64 && !plan.is_shortest,
                    false => plan.steps == way.len() as u64 && (plan.is_shortest || plan.steps == 0),
                };
                tally.shortest += usize::from(!is_open);
                if !is_right {
                    let (theirs, way) = (plan.script.text(program, world), written(program, world, way));
                    return Err(format!("{name}: `{theirs}` as the shortest way, but `{way}` is"));
                }
            }
            (Verdict::Reached(plan), None) => {
                if explored.is_closed || plan.steps <= explored.depth as u64 {
                    let way = plan.script.text(program, world);
                    return Err(format!("{name}: `{way}` as a way, but there is none"));
                }
            }
            (Verdict::Unreachable(_) | Verdict::Exhausted(_), Some(way)) => {
                let way = written(program, world, way);
                return Err(format!("{name}: ruled out by exhaustion, but `{way}` leads to it"));
            }
            (Verdict::Unreachable(_) | Verdict::Exhausted(_), None) => tally.proven += usize::from(explored.is_closed),
            (Verdict::NotFound, _) => {}
        }
    }
    Ok(())
}
