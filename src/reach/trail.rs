//! How a search came to each tile of a world's maps: the fewest steps that it needed, the inputs, how often it was
//! there. It is a record of what was seen: other inputs may lead there sooner, and to other tiles.

use std::sync::{Mutex, PoisonError};

use crate::ir::{Id, SpaceId};
use crate::sim::{Scratch, Script, Simulator};
use crate::watch::Meter;

use super::explore::{Explored, Explorer, Observer, Reached};
use super::problem::{Problem, StateStatus, Termination};

/// How a search came to a tile.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct TileTrail {
    /// The fewest steps after which a player was in it, and their inputs.
    pub first: Option<(u64, Script)>,
    /// Number of states in which a player was in it.
    pub visits: u64,
    /// Whether one of the ways that were followed leads through it.
    pub is_on_way: bool,
    /// The last state that was counted.
    seen: u64,
}

/// Records how a search comes to each tile.
pub struct Trail {
    explorer: Explorer,
    /// The number of states, and the cells of each space.
    tiles: Mutex<(u64, Vec<Vec<TileTrail>>)>,
}

impl Trail {
    /// For a world of which nothing is known yet.
    pub fn new(sim: &Simulator) -> Self {
        let cells = |space: &crate::ir::Space| space.map.as_ref().map_or(0, |map| map.cells.len());
        let tiles = sim.world().spaces.iter().map(|space| vec![TileTrail::default(); cells(space)]);
        Trail { explorer: Explorer::new(sim), tiles: Mutex::new((0, tiles.collect())) }
    }

    /// Follows a way from the initial state until the run is over.
    pub fn follow(&self, problem: &Problem<'_>, script: &Script, meter: &Meter<'_>) {
        let (sim, mut scratch) = (problem.sim, problem.sim.scratch());
        let Ok(mut state) = sim.metered_initial(&mut scratch, meter) else { return };
        let (mut step, mut inputs) = (0, script.inputs());
        loop {
            let judged = problem.judge(&state);
            if matches!(judged, Ok(StateStatus::Open | StateStatus::Goal | StateStatus::Dead(Termination::Never(_)))) {
                let reached = Reached { steps: step, script: &|| script.first(step) };
                self.record(sim, &state, &scratch, &reached, true);
            }
            let is_open = matches!(judged, Ok(StateStatus::Open | StateStatus::Goal));
            let Some(input) = inputs.next().filter(|_| is_open && !meter.is_stopped()) else { return };
            step += 1;
            if sim.metered_step(&mut state, &problem.draw(step, input), &mut scratch, meter).is_err() {
                return;
            }
        }
    }

    fn record(&self, sim: &Simulator, state: &[u8], scratch: &Scratch, reached: &Reached<'_>, is_on_way: bool) {
        let mut tiles = self.tiles.lock().unwrap_or_else(PoisonError::into_inner);
        let (count, spaces) = &mut *tiles;
        *count += 1;
        self.explorer.see_cells(sim, state, scratch, &mut |space: SpaceId, cell| {
            let Some(tile) = spaces.get_mut(space.index()).and_then(|cells| cells.get_mut(cell)) else { return };
            tile.is_on_way |= is_on_way;
            if std::mem::replace(&mut tile.seen, *count) != *count {
                tile.visits += 1;
            }
            if tile.first.as_ref().is_none_or(|(steps, _)| reached.steps < *steps) {
                tile.first = Some((reached.steps, (reached.script)()));
            }
        });
    }

    /// What was covered, and the tiles of each space, row by row from the lowest.
    pub fn into_tiles(self) -> (Explored, Vec<Vec<TileTrail>>) {
        (self.explorer.explored(), self.tiles.into_inner().unwrap_or_else(PoisonError::into_inner).1)
    }
}

impl Observer for Trail {
    fn see(&self, sim: &Simulator, state: &[u8], scratch: &Scratch, reached: &Reached<'_>) {
        self.record(sim, state, scratch, reached, false);
    }
}
