//! By how much a state misses what the goal asks of numbers that are no positions, coarsely: a speed at which a lander
//! touches down, the fuel that it has to have left. Planners keep states apart by it (`planners/player_cells.rs`,
//! `planners/coverage_guided.rs`). What the edges into a mode ask for that is part of the goal counts, too.

use crate::ir::{SlotId, compare};
use crate::reach::coverage::mix;
use crate::reach::problem::Problem;
use crate::sim::Simulator;

use super::lack::{Atom, Gauge, Parts};

/// Maximum number of numbers that count: each divides the states by [`CLASSES`] at most.
const MOST: usize = 4;
/// What misses by less than a tile in this number is in the class nearest to what holds; each further one is twice as
/// wide as that before.
const NEAREST: f64 = 8.0;
const CLASSES: u32 = 7;

/// The conditions on numbers.
#[derive(Debug, Default)]
pub(in super::super) struct Margins {
    atoms: Vec<(Option<SlotId>, Atom)>,
}

impl Margins {
    /// Those of the target of a question.
    pub fn new(problem: &Problem<'_>) -> Margins {
        let mut atoms = Vec::new();
        for term in Parts::new(problem).terms {
            term.into_atoms(None, &mut atoms);
        }
        let mut last = Vec::new();
        for (_, atom) in &mut atoms {
            if let Gauge::Mode(_, approach) | Gauge::Value(approach) = &mut atom.gauge {
                let slot = approach.slot;
                approach.take_last().into_iter().for_each(|term| term.into_atoms(Some(slot), &mut last));
            }
        }
        atoms.extend(last);
        atoms.retain(|(_, atom)| match &atom.gauge {
            Gauge::Var(_, var, degree, ..) => *degree > 0 || !var.is_position(),
            Gauge::Numbers(.., approach) => approach.is_none(),
            _ => false,
        });
        atoms.truncate(MOST);
        Margins { atoms }
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.atoms.is_empty()
    }

    /// A key with the class of each.
    pub fn key(&self, sim: &Simulator, state: &[u8], key: u64) -> u64 {
        self.atoms.iter().fold(key, |key, (slot, atom)| {
            let is_there = slot.is_none_or(|slot| sim.world().layout.slots[slot].alive(state));
            let class = if is_there { class_of(atom, sim, state) } else { i64::from(CLASSES) };
            mix(key, class as u64)
        })
    }
}

/// The class of a state by a number: above 0 by how much it misses, below 0 by how much a supply is above what is needed.
fn class_of(atom: &Atom, sim: &Simulator, state: &[u8]) -> i64 {
    match &atom.gauge {
        Gauge::Var(slot, var, 0, op, bound) => {
            let value = sim.world().layout.slots[*slot].var(state, *var, 0);
            let away = i64::from(class((value - bound).abs() * atom.unit.weight()));
            if compare(*op, value, *bound) { -away } else { away }
        }
        _ => i64::from(class(atom.cost(sim, state, f64::INFINITY))),
    }
}

/// The class of what misses by some tiles.
fn class(tiles: f64) -> u32 {
    let (mut class, mut bound) = (0, 0.0);
    while class + 1 < CLASSES && tiles > bound {
        bound = if class == 0 { 1.0 / NEAREST } else { bound * 2.0 };
        class += 1;
    }
    class
}
