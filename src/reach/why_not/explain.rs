//! Explains a missing answer: replays the inputs that lead to the nearest states, and describes what is missing there.
//! What a replay does not confirm is left out.

use crate::ir::{ExprId, Space};
use crate::sim::{Script, State};
use crate::source::SourceMap;
use crate::watch::Meter;

use super::super::luck::only_read;
use super::super::problem::{Problem, StateStatus};
use super::bar::bar;
use super::closed::{closed_modes, closed_rooms};
use super::lack::{Parts, Term};
use super::record::{Barrier, NearState, PartNearest, Point, WhyNot};
use super::tracker::{Near, Nearest};
use super::way::way_end;
use super::words::Describer;

/// A state with the inputs that lead to it.
pub(super) struct Replayed {
    pub script: Script,
    pub state: State,
}

/// Why a goal was not reached, by what a search of some nodes found out; `kept` steps of all inputs were given. `None`
/// if the meter stops it.
pub(in super::super) fn explain(
    problem: &Problem<'_>,
    sources: &SourceMap,
    (nearest, nodes): (&Nearest, u64),
    kept: u64,
    meter: &Meter<'_>,
) -> Option<WhyNot> {
    let parts = Parts::new(problem);
    let describer = Describer { sim: problem.sim, sources };
    let cost = |state: &[u8]| parts.terms.iter().map(|term| term.cost(problem.sim, state, f64::INFINITY)).sum();
    let whole = nearest.whole.as_ref().and_then(|near| replay(problem, near, kept, &cost, meter));
    let describe = |replayed: &Replayed| {
        let described = parts.ids.iter().zip(&parts.terms);
        let described = described.map(|(id, term)| describer.part(*id, term, &replayed.state));
        NearState { at: point(problem, replayed), parts: described.collect() }
    };
    let by_itself = |((id, term), near): ((&ExprId, &Term), &Option<Near>)| {
        let cost = |state: &[u8]| term.cost(problem.sim, state, f64::INFINITY);
        let replayed = replay(problem, near.as_ref()?, kept, &cost, meter)?;
        Some(PartNearest { part: describer.part(*id, term, &replayed.state), at: Some(point(problem, &replayed)) })
    };
    let several = if parts.terms.len() > 1 { parts.ids.len() } else { 0 };
    let all = parts.ids.iter().zip(&parts.terms).zip(&nearest.parts).take(several);
    let each: Vec<PartNearest> = all.filter_map(by_itself).collect();
    if meter.is_stopped() {
        return None;
    }
    let seen = &nearest.seen;
    let bar = whole.as_ref().and_then(|whole| bar(problem, &whole.state));
    let way = way_end(problem, seen).filter(|way| way.barrier != Barrier::Unknown || bar.is_none());
    let way = way.or_else(|| Some(bar.as_ref()?.way_end(problem, &point(problem, whole.as_ref()?))));
    Some(WhyNot {
        nodes: nearest.sample().unwrap_or(nodes),
        is_sample: nearest.sample().is_some(),
        nearest: whole.as_ref().map(describe),
        parts: each,
        way,
        highest_jump: seen.highest.size,
        longest_jump: seen.longest.size,
        rooms: closed_rooms(problem, &describer, seen, whole.as_ref().map(|whole| &*whole.state)),
        modes: whole.as_ref().map_or(Vec::new(), |whole| {
            let slot = bar.as_ref().map(|bar| bar.slot);
            closed_modes(problem, sources, (&parts, seen, slot), (&whole.script, &whole.state))
        }),
    })
}

/// Replays the inputs to a state; `None` if it is not as the search said, or if the run is over there.
fn replay(
    problem: &Problem<'_>,
    near: &Near,
    kept: u64,
    cost: &dyn Fn(&[u8]) -> f64,
    meter: &Meter<'_>,
) -> Option<Replayed> {
    let script = match problem.sim.draws().is_empty() {
        true => near.script.clone(),
        false => only_read(problem, &near.script, kept.min(near.script.len()), meter)?,
    };
    let mut scratch = problem.sim.scratch();
    let mut state = problem.sim.metered_initial(&mut scratch, meter).ok().filter(|_| !meter.is_stopped())?;
    for (step, input) in (1..).zip(script.inputs()) {
        problem.sim.metered_step(&mut state, &problem.draw(step, input), &mut scratch, meter).ok()?;
        if meter.is_stopped() {
            return None;
        }
    }
    let is_open = matches!(problem.judge(&state), Ok(StateStatus::Open));
    debug_assert!(is_open && cost(&state) == near.cost(), "a nearest state must replay");
    (is_open && cost(&state) == near.cost()).then_some(Replayed { script, state })
}

/// The column of the map of a space at a position, from 1; `None` outside of it and without a map.
pub(super) fn column(space: &Space, x: f64) -> Option<usize> {
    let map = space.map.as_ref()?;
    let column = (x / map.tile.0).floor();
    (column >= 0.0 && column < map.columns as f64).then_some(column as usize + 1)
}

/// Where the first player is in a state.
pub(super) fn point(problem: &Problem<'_>, Replayed { script, state }: &Replayed) -> Point {
    let (sim, step) = (problem.sim, script.len());
    let player = problem.players().first().copied();
    let (x, y) = player.map_or((0.0, 0.0), |player| sim.position(state, player));
    let space = player.map(|player| &sim.world().spaces[sim.space(state, player)]);
    let column = space.and_then(|space| column(space, x));
    Point {
        step,
        seconds: step as f64 * sim.world().step.seconds(),
        space: space.map(|space| space.name.clone()),
        x,
        y,
        column,
        inputs: script.text(sim.program(), sim.world_id()),
    }
}
