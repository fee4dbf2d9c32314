//! Nested cells over projections of the state, and the nodes in the innermost ones: what planners choose from that ask for
//! no neighbours (`coverage_guided.rs`, `lead.rs`).

use hashbrown::HashTable;
use rand::RngExt;

use crate::reach::search_context::SearchContext;
use crate::reach::tree::NodeId;

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

/// Cells, and of each node where it is.
#[derive(Debug, Default)]
pub(super) struct Cells {
    cells: Vec<Cell>,
    /// Cells by their keys.
    known: HashTable<u32>,
    /// The cells of the first level that hold open nodes.
    first: Vec<u32>,
    /// Of each node, its cell and its place in it.
    homes: Vec<(u32, u32)>,
}

impl Cells {
    /// Forgets all.
    pub fn clear(&mut self) {
        self.cells.clear();
        self.known.clear();
        self.first.clear();
        self.homes.clear();
    }

    /// The open cells of the first level.
    pub fn first(&self) -> &[u32] {
        &self.first
    }

    /// The cells that are open in a cell; in one of the last level, the nodes.
    pub fn inside(&self, cell: u32) -> &[u32] {
        &self.cells[cell as usize].inside
    }

    /// How often a cell was chosen.
    pub fn chosen(&self, cell: u32) -> u32 {
        self.cells[cell as usize].chosen
    }

    /// Counts that a cell was chosen.
    pub fn choose(&mut self, cell: u32) {
        self.cells[cell as usize].chosen += 1;
    }

    fn inside_mut(&mut self, cell: u32) -> &mut Vec<u32> {
        match cell {
            NONE => &mut self.first,
            cell => &mut self.cells[cell as usize].inside,
        }
    }

    /// Adds a node by the keys of its cells, from the first level to the last, each of which names those before it. Gives
    /// its cell of the first level, and whether that was not open before.
    pub fn add(&mut self, node: NodeId, keys: &[u64]) -> (u32, bool) {
        let mut parent = NONE;
        let mut outermost = None;
        for &key in keys {
            let found = self.known.find(key, |id| self.cells[*id as usize].key == key).copied();
            let id = found.unwrap_or_else(|| {
                let id = self.cells.len() as u32;
                self.cells.push(Cell { parent, key, place: NONE, ..Cell::default() });
                let cells = &self.cells;
                self.known.insert_unique(key, id, |id| cells[*id as usize].key);
                id
            });
            let was_shut = self.cells[id as usize].place == NONE;
            if was_shut {
                // It is new, or comes back to life.
                let siblings = self.inside_mut(parent);
                siblings.push(id);
                let place = siblings.len() as u32 - 1;
                self.cells[id as usize].place = place;
            }
            outermost = outermost.or(Some((id, was_shut)));
            self.cells[id as usize].held += 1;
            parent = id;
        }
        let home = self.inside_mut(parent);
        home.push(node.0);
        let place = home.len() as u32 - 1;
        self.homes.resize(node.index() + 1, (NONE, NONE));
        self.homes[node.index()] = (parent, place);
        outermost.unwrap_or((NONE, false))
    }

    /// Takes out a node that is done with, and cells that hold nothing any more.
    pub fn remove(&mut self, node: NodeId) {
        let (mut cell, place) = self.homes[node.index()];
        let inside = &mut self.cells[cell as usize].inside;
        inside.swap_remove(place as usize);
        if let Some(moved) = inside.get(place as usize) {
            self.homes[*moved as usize].1 = place;
        }
        while cell != NONE && self.cells[cell as usize].inside.is_empty() {
            let (parent, place) = (self.cells[cell as usize].parent, self.cells[cell as usize].place as usize);
            self.cells[cell as usize].place = NONE;
            let siblings = self.inside_mut(parent);
            siblings.swap_remove(place);
            if let Some(moved) = siblings.get(place).copied() {
                self.cells[moved as usize].place = place as u32;
            }
            cell = parent;
        }
    }

    /// The most important of a few cells: a cell counts the less, the more often it was chosen and the more it holds.
    pub fn draw(&self, context: &mut SearchContext<'_>, of: &[u32]) -> Option<u32> {
        let importance = |id: u32| {
            let cell = &self.cells[id as usize];
            1.0 / (f64::from(1 + cell.chosen) * f64::from(cell.held.max(1)))
        };
        if of.is_empty() {
            return None;
        }
        let mut best = of[context.rng.random_range(0..of.len())];
        for _ in 1..DRAWN.min(of.len()) {
            let other = of[context.rng.random_range(0..of.len())];
            if importance(other) > importance(best) {
                best = other;
            }
        }
        Some(best)
    }

    /// A node of a cell of the last level. What came last is likelier, as in KPIECE: the least of two drawn distances from
    /// the end.
    pub fn draw_node(&self, context: &mut SearchContext<'_>, cell: u32) -> NodeId {
        let nodes = self.inside(cell);
        let back = |context: &mut SearchContext<'_>| context.rng.random_range(0..nodes.len());
        let from_end = back(context).min(back(context));
        NodeId(nodes[nodes.len() - 1 - from_end])
    }

    /// The memory that it takes, bytes.
    pub fn bytes(&self) -> usize {
        let cells = self.cells.capacity() * (size_of::<Cell>() + size_of::<u32>());
        cells + self.known.capacity() * 5 + self.homes.capacity() * 12
    }
}
