//! Coverage-guided: grows what little is covered, without asking for neighbours.
//!
//! After KPIECE, Şucan and Kavraki, *Kinodynamic Motion Planning by Interior-Exterior Cell Exploration*, 2009, and EST, Hsu,
//! Latombe and Motwani, *Path Planning in Expansive Configuration Spaces*, 1997. From KPIECE it has the levels of cells over
//! a projection and the importance of a cell; from EST that a cell counts the less, the more it holds. Where KPIECE sorts
//! its cells, a few are drawn here and the most important of them is taken; that needs no order to be kept.
//!
//! The projections follow from the analysis and from what is seen. The first is what seldom changes: modes, spawned
//! instances and counts that few extensions change are what has been achieved (a door is open, a key is held). The second
//! is where the players are, the third everything else that varies.

use hashbrown::HashTable;
use rand::RngExt;

use crate::reach::coverage::mixed;
use crate::reach::ground::Ground;
use crate::reach::metric::{Metric, Point, Projected};
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

/// What seldom changes is changed by fewer than one extension in so many.
const SELDOM: u64 = 40;
/// The number of extensions after which it is first looked at what seldom changes; then at each doubling.
const FIRST_LOOK: u64 = 256;

/// A coordinate or a mode, and the cells that it makes.
#[derive(Debug, Clone, Copy)]
struct Axis {
    level: usize,
    /// Cells along a distance of 1, and where the first one begins; of a mode each value is a cell.
    cells: Option<(f32, f32)>,
    /// Whether it can be something that is achieved: the level it has if it seldom changes, and the other.
    counts: bool,
    otherwise: usize,
    /// How many extensions changed it.
    changes: u64,
}

impl Axis {
    fn cell(&self, value: f32) -> u64 {
        match self.cells {
            Some((scale, offset)) => ((value - offset) * scale).floor() as i64 as u64,
            None => u64::from(value.to_bits()),
        }
    }
}

/// Grows where little is covered.
#[derive(Debug)]
pub struct CoverageGuided {
    /// The coordinates, then the modes.
    axes: Vec<Axis>,
    extensions: u64,
    next_look: u64,
    cells: Vec<Cell>,
    /// Cells by their keys.
    known: HashTable<u32>,
    /// The cells of the first level that hold open nodes.
    first: Vec<u32>,
    /// Of each node, its cell and its place in it.
    homes: Vec<(u32, u32)>,
    before: Point,
}

impl CoverageGuided {
    /// A strategy for a space.
    pub fn new(metric: &Metric) -> Self {
        let axis = |(level, cells, counts): Projected| Axis {
            level: if counts { 0 } else { level },
            cells,
            counts,
            otherwise: level,
            changes: 0,
        };
        CoverageGuided {
            axes: metric.projection().into_iter().map(axis).collect(),
            extensions: 0,
            next_look: FIRST_LOOK,
            cells: Vec::new(),
            known: HashTable::new(),
            first: Vec::new(),
            homes: Vec::new(),
            before: Point::default(),
        }
    }

    /// Notes what an extension changed.
    fn compare(&mut self, ground: &Ground<'_>, from: NodeId, point: &Point) {
        ground.point(from, &mut self.before);
        let before = self.before.reals.iter().chain(&self.before.modes);
        for ((axis, before), after) in self.axes.iter_mut().zip(before).zip(point.reals.iter().chain(&point.modes)) {
            axis.changes += u64::from(axis.counts && before != after);
        }
        self.extensions += 1;
    }

    /// Tells anew what seldom changes, and sorts all nodes accordingly.
    fn look(&mut self, ground: &Ground<'_>) {
        self.next_look = self.extensions * 2;
        let mut is_other = false;
        for axis in &mut self.axes {
            let seldom = axis.changes * SELDOM < self.extensions;
            let level = if axis.counts && seldom { 0 } else { axis.otherwise };
            is_other |= level != axis.level;
            axis.level = level;
        }
        if !is_other {
            return;
        }
        self.clear();
        let mut point = Point::default();
        for node in (0..ground.tree.len()).map(|n| NodeId(n as u32)) {
            if ground.tree.untried(node) > 0 {
                ground.point(node, &mut point);
                self.add(node, &point);
            }
        }
    }

    fn clear(&mut self) {
        self.cells.clear();
        self.known.clear();
        self.first.clear();
        self.homes.clear();
    }

    fn keys(&self, point: &Point) -> [u64; LEVELS] {
        let mut keys = [0; LEVELS];
        let mut key = 0;
        for (level, out) in keys.iter_mut().enumerate() {
            key = mixed(key, level as u64);
            for (axis, value) in self.axes.iter().zip(point.reals.iter().chain(&point.modes)) {
                if axis.level == level {
                    key = mixed(key, axis.cell(*value));
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

    fn learn(&mut self, ground: &mut Ground<'_>, choice: Option<Choice>, growth: Growth<'_>) {
        match (growth, choice) {
            (Growth::Rooted(root, point), _) => {
                self.clear();
                self.add(root, point);
            }
            (Growth::Added(node, point), Some(choice)) => {
                self.compare(ground, choice.node, point);
                self.add(node, point);
                if self.extensions >= self.next_look {
                    self.look(ground);
                }
            }
            _ => {}
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
