//! Coverage-guided: grows what little is covered, without asking for neighbours.
//!
//! After KPIECE, Şucan and Kavraki, *Kinodynamic Motion Planning by Interior-Exterior Cell Exploration*, 2009, and EST, Hsu,
//! Latombe and Motwani, *Path Planning in Expansive Configuration Spaces*, 1997. From KPIECE it has the levels of cells over
//! a projection and the importance of a cell; from EST that a cell counts the less, the more it holds. The projections come
//! from the analysis: the first is where the players are, the second adds their modes and what is counted, the third
//! everything else that varies. Where KPIECE sorts its cells, a few are drawn here and the most important of them is taken;
//! that needs no order to be kept.

use hashbrown::HashTable;
use rand::RngExt;

use crate::reach::coverage::mixed;
use crate::reach::ground::Ground;
use crate::reach::metric::{Metric, Point};
use crate::reach::strategy::{Choice, Growth, Strategy};
use crate::reach::tree::NodeId;

/// The levels of cells.
const LEVELS: usize = 3;
/// How many cells are drawn, of which the most important is taken.
const DRAWN: usize = 3;
/// No cell, or no place.
const NONE: u32 = u32::MAX;

/// A cell of a level; those of the last hold nodes, the others cells of the next.
#[derive(Debug, Clone, Default)]
struct Cell {
    inside: Vec<u32>,
    parent: u32,
    /// Its place among its parent's.
    place: u32,
    key: u64,
    /// How often it was chosen.
    chosen: u32,
    /// How many nodes were ever in it.
    held: u32,
}

/// Grows where little is covered.
#[derive(Debug)]
pub struct CoverageGuided {
    /// Of each coordinate: the first level that tells it, and cells along its range.
    reals: Vec<(usize, f32, f32)>,
    /// Of each mode: the first level that tells it.
    modes: Vec<usize>,
    cells: Vec<Cell>,
    /// Cells by their keys.
    known: HashTable<u32>,
    /// The cells of the first level that hold open nodes.
    first: Vec<u32>,
    /// Of each node, its cell and its place in it.
    homes: Vec<(u32, u32)>,
}

impl CoverageGuided {
    /// A strategy for a space.
    pub fn new(metric: &Metric) -> Self {
        let (reals, modes) = metric.projection();
        CoverageGuided {
            reals,
            modes,
            cells: Vec::new(),
            known: HashTable::new(),
            first: Vec::new(),
            homes: Vec::new(),
        }
    }

    fn keys(&self, point: &Point) -> [u64; LEVELS] {
        let mut keys = [0; LEVELS];
        let mut key = 0;
        for (level, out) in keys.iter_mut().enumerate() {
            key = mixed(key, level as u64);
            for (value, (first, scale, offset)) in point.reals.iter().zip(&self.reals) {
                if *first == level {
                    key = mixed(key, ((value - offset) * scale).floor() as i64 as u64);
                }
            }
            for (value, first) in point.modes.iter().zip(&self.modes) {
                if *first == level {
                    key = mixed(key, u64::from(value.to_bits()));
                }
            }
            *out = key;
        }
        keys
    }

    /// The open cells of the next level in a cell, of the first in none.
    fn inside(&mut self, cell: u32) -> &mut Vec<u32> {
        match cell {
            NONE => &mut self.first,
            cell => &mut self.cells[cell as usize].inside,
        }
    }

    fn add(&mut self, node: NodeId, point: &Point) {
        let mut parent = NONE;
        for key in self.keys(point) {
            let found = self.known.find(key, |id| self.cells[*id as usize].key == key).copied();
            let id = found.unwrap_or_else(|| {
                let id = self.cells.len() as u32;
                self.cells.push(Cell { parent, key, place: NONE, ..Cell::default() });
                let cells = &self.cells;
                self.known.insert_unique(key, id, |id| cells[*id as usize].key);
                id
            });
            if self.cells[id as usize].place == NONE {
                // It is new, or comes back to life.
                let siblings = self.inside(parent);
                siblings.push(id);
                let place = siblings.len() as u32 - 1;
                self.cells[id as usize].place = place;
            }
            self.cells[id as usize].held += 1;
            parent = id;
        }
        let home = &mut self.cells[parent as usize].inside;
        home.push(node.0);
        let place = home.len() as u32 - 1;
        self.homes.resize(node.index() + 1, (NONE, NONE));
        self.homes[node.index()] = (parent, place);
    }

    /// Takes out a node that is done with, and cells that hold nothing any more.
    fn remove(&mut self, node: NodeId) {
        let (mut cell, place) = self.homes[node.index()];
        let inside = &mut self.cells[cell as usize].inside;
        inside.swap_remove(place as usize);
        if let Some(moved) = inside.get(place as usize) {
            self.homes[*moved as usize].1 = place;
        }
        while cell != NONE && self.cells[cell as usize].inside.is_empty() {
            let (parent, place) = (self.cells[cell as usize].parent, self.cells[cell as usize].place as usize);
            self.cells[cell as usize].place = NONE;
            let siblings = self.inside(parent);
            siblings.swap_remove(place);
            if let Some(moved) = siblings.get(place).copied() {
                self.cells[moved as usize].place = place as u32;
            }
            cell = parent;
        }
    }

    /// The most important of a few cells.
    fn draw(&self, ground: &mut Ground<'_>, of: &[u32]) -> Option<u32> {
        let importance = |id: u32| {
            let cell = &self.cells[id as usize];
            1.0 / (f64::from(1 + cell.chosen) * f64::from(cell.held.max(1)))
        };
        if of.is_empty() {
            return None;
        }
        let mut best = of[ground.rng.random_range(0..of.len())];
        for _ in 1..DRAWN.min(of.len()) {
            let other = of[ground.rng.random_range(0..of.len())];
            if importance(other) > importance(best) {
                best = other;
            }
        }
        Some(best)
    }
}

impl Strategy for CoverageGuided {
    fn choose(&mut self, ground: &mut Ground<'_>, _toward: &Point) -> Option<Choice> {
        let mut cell = self.draw(ground, &self.first)?;
        self.cells[cell as usize].chosen += 1;
        for _ in 1..LEVELS {
            cell = self.draw(ground, &self.cells[cell as usize].inside)?;
            self.cells[cell as usize].chosen += 1;
        }
        let nodes = &self.cells[cell as usize].inside;
        // What came last is likelier, as in KPIECE: the least of two drawn distances from the end.
        let back = |ground: &mut Ground<'_>| ground.rng.random_range(0..nodes.len());
        let from_end = back(ground).min(back(ground));
        let node = NodeId(nodes[nodes.len() - 1 - from_end]);
        let choice = ground.draw_untried(node);
        if ground.tree.untried(node) == 0 {
            self.remove(node);
        }
        choice
    }

    fn learn(&mut self, _ground: &mut Ground<'_>, _choice: Option<Choice>, growth: Growth<'_>) {
        match growth {
            Growth::Rooted(root, point) => {
                self.cells.clear();
                self.known.clear();
                self.first.clear();
                self.homes.clear();
                self.add(root, point);
            }
            Growth::Added(node, point) => self.add(node, point),
            Growth::Failed => {}
        }
    }

    fn samples(&self) -> bool {
        false
    }

    fn bytes(&self) -> usize {
        let cells = self.cells.capacity() * (size_of::<Cell>() + size_of::<u32>());
        cells + self.known.capacity() * 5 + self.homes.capacity() * 12
    }
}
