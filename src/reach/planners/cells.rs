//! Nested cells over projections of the state, with the nodes in the innermost ones, for planners without
//! nearest-neighbour queries (`coverage_guided.rs`, `distance_guided.rs`).

use hashbrown::HashTable;
use rand::RngExt;

use crate::reach::search_context::SearchContext;
use crate::reach::tree::NodeId;

use super::few::Few;

/// Number of cells drawn, of which the most important is taken.
const CANDIDATES: usize = 3;
/// No cell, or no index.
const NONE: u32 = u32::MAX;

/// A cell of a level; cells of the last level hold nodes, others hold cells of the next level.
#[derive(Debug, Clone, Default)]
struct Cell {
    inside: Few,
    parent: u32,
    /// Its index in its parent.
    place: u32,
    key: u64,
    /// Number of times it was chosen.
    chosen: u32,
    /// Number of nodes ever added to it.
    held: u32,
}

/// Cells, and the location of each node.
#[derive(Debug, Default)]
pub(super) struct Cells {
    cells: Vec<Cell>,
    /// Cells by their keys.
    known: HashTable<u32>,
    /// The cells of the first level that hold open nodes.
    first: Few,
    /// For each node, its cell and its index in it.
    locations: Vec<(u32, u32)>,
}

impl Cells {
    /// Removes everything.
    pub fn clear(&mut self) {
        self.cells.clear();
        self.known.clear();
        self.first.clear();
        self.locations.clear();
    }

    /// The open cells of the first level.
    pub fn first(&self) -> &[u32] {
        &self.first
    }

    /// The open cells in a cell; for the last level, its nodes.
    pub fn inside(&self, cell: u32) -> &[u32] {
        &self.cells[cell as usize].inside
    }

    /// Number of times a cell was chosen.
    pub fn chosen(&self, cell: u32) -> u32 {
        self.cells[cell as usize].chosen
    }

    /// Number of nodes that were ever added to a cell.
    pub fn held(&self, cell: u32) -> u32 {
        self.cells[cell as usize].held
    }

    /// Counts that a cell was chosen.
    pub fn choose(&mut self, cell: u32) {
        self.cells[cell as usize].chosen += 1;
    }

    fn inside_mut(&mut self, cell: u32) -> &mut Few {
        match cell {
            NONE => &mut self.first,
            cell => &mut self.cells[cell as usize].inside,
        }
    }

    /// Adds a node by the keys of its cells, from the first level to the last; each key includes those before it.
    /// Returns its cell of the first level, and whether that was closed before.
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
                // It is new, or open again.
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
        self.locations.resize(node.index() + 1, (NONE, NONE));
        self.locations[node.index()] = (parent, place);
        outermost.unwrap_or((NONE, false))
    }

    /// Removes a finished node, and cells that become empty; nothing if the node is not there.
    pub fn remove(&mut self, node: NodeId) {
        let Some(location) = self.locations.get_mut(node.index()).filter(|(cell, _)| *cell != NONE) else { return };
        let (mut cell, place) = std::mem::replace(location, (NONE, NONE));
        let inside = &mut self.cells[cell as usize].inside;
        inside.swap_remove(place as usize);
        if let Some(moved) = inside.get(place as usize) {
            self.locations[*moved as usize].1 = place;
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

    /// The most important of a few random cells: importance decreases with the number of choices and of nodes.
    pub fn draw(&self, context: &mut SearchContext<'_>, of: &[u32]) -> Option<u32> {
        let importance = |id: u32| {
            let cell = &self.cells[id as usize];
            1.0 / (f64::from(1 + cell.chosen) * f64::from(cell.held.max(1)))
        };
        if of.is_empty() {
            return None;
        }
        let mut best = of[context.rng.random_range(0..of.len())];
        for _ in 1..CANDIDATES.min(of.len()) {
            let other = of[context.rng.random_range(0..of.len())];
            if importance(other) > importance(best) {
                best = other;
            }
        }
        Some(best)
    }

    /// A node of a cell of the last level. Recent nodes are likelier, as in KPIECE: the minimum of two random distances
    /// from the end.
    pub fn draw_node(&self, context: &mut SearchContext<'_>, cell: u32) -> NodeId {
        let nodes = self.inside(cell);
        let back = |context: &mut SearchContext<'_>| context.rng.random_range(0..nodes.len());
        let from_end = back(context).min(back(context));
        NodeId(nodes[nodes.len() - 1 - from_end])
    }

    /// Memory use, bytes.
    pub fn bytes(&self) -> usize {
        let cells = self.cells.capacity() * (size_of::<Cell>() + size_of::<u32>());
        cells + self.known.capacity() * 5 + self.locations.capacity() * size_of::<(u32, u32)>()
    }
}
