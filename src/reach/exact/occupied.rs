//! Where something with a tag can be: the cells of a grid that its colliders were seen to overlap. More than one
//! instance can be in a cell, and at different times.

use crate::ir::{Bounds, Id, SpaceId, TagId, World};
use crate::sim::{Placed, Scratch, Simulator};

/// The side of a cell, px.
const CELL: f64 = 4.0;
/// Maximum number of columns or rows of a space.
const MAX_CELLS: f64 = 4_096.0;

/// The cells of a space.
#[derive(Debug, Clone, Copy)]
struct Grid {
    left: f64,
    bottom: f64,
    columns: usize,
    rows: usize,
}

/// The cells in which something with each of some tags can be.
#[derive(Debug, Clone)]
pub(super) struct Occupied {
    grids: Vec<Grid>,
    tags: Vec<TagId>,
    /// For each space and each tag, a bit for each cell.
    layers: Vec<Vec<u64>>,
    /// The colliders that are recorded, and the indices of their tags.
    colliders: Vec<(Placed, Vec<usize>)>,
}

impl Grid {
    fn new(extent: Option<Bounds>) -> Grid {
        let Some(Bounds { left, right, bottom, top }) = extent else {
            return Grid { left: 0.0, bottom: 0.0, columns: 1, rows: 1 };
        };
        let count = |length: f64| (length / CELL).ceil().clamp(1.0, MAX_CELLS) as usize;
        Grid { left, bottom, columns: count(right - left), rows: count(top - bottom) }
    }

    /// The first column and the last of a box, and the rows. What is outside counts as at the border: boxes that
    /// overlap always share a cell.
    fn cells(&self, of: &Bounds) -> [(usize, usize); 2] {
        // The casts saturate.
        let cell = |at: f64, from: f64, count: usize| (((at - from) / CELL) as usize).min(count - 1);
        [
            (cell(of.left, self.left, self.columns), cell(of.right, self.left, self.columns)),
            (cell(of.bottom, self.bottom, self.rows), cell(of.top, self.bottom, self.rows)),
        ]
    }
}

impl Occupied {
    /// Nothing is anywhere yet.
    pub fn new(world: &World) -> Self {
        let extent = |space: &crate::ir::Space| {
            let solids = space.solids.iter().map(|solid| solid.bounds);
            space.extent().into_iter().chain(solids).reduce(Bounds::join)
        };
        let grids = world.spaces.iter().map(|space| Grid::new(extent(space))).collect();
        Occupied { grids, tags: Vec::new(), layers: Vec::new(), colliders: Vec::new() }
    }

    /// Records the colliders of a world from now on.
    pub fn recording(mut self, sim: &Simulator) -> Self {
        let mut colliders = Vec::new();
        for placed in sim.moving_colliders() {
            let entity = &sim.program().entities[sim.world().slots[placed.slot].entity];
            let tags = entity.colliders[placed.collider].tags.iter().map(|tag| self.layer(tag)).collect();
            colliders.push((placed, tags));
        }
        self.colliders = colliders;
        self
    }

    /// The index of a tag.
    fn layer(&mut self, tag: TagId) -> usize {
        if let Some(known) = self.layer_of(tag) {
            return known;
        }
        self.tags.push(tag);
        let cells = |grid: &Grid| vec![0; (grid.columns * grid.rows).div_ceil(64)];
        self.layers.extend(self.grids.iter().map(cells));
        self.tags.len() - 1
    }

    /// The index of a tag that something has.
    pub fn layer_of(&self, tag: TagId) -> Option<usize> {
        self.tags.iter().position(|known| *known == tag)
    }

    /// Records where the colliders were in the last step.
    pub fn mark(&mut self, scratch: &Scratch) {
        for (placed, tags) in &self.colliders {
            let Some((space, bounds)) = scratch.placed(*placed) else { continue };
            let grid = self.grids[space.index()];
            let [columns, rows] = grid.cells(&bounds);
            for tag in tags {
                let layer = &mut self.layers[tag * self.grids.len() + space.index()];
                for row in rows.0..=rows.1 {
                    for cell in row * grid.columns + columns.0..=row * grid.columns + columns.1 {
                        layer[cell / 64] |= 1 << (cell % 64);
                    }
                }
            }
        }
    }

    /// Whether something with a tag can overlap a box.
    #[inline]
    pub fn meets(&self, tag: usize, space: SpaceId, bounds: &Bounds) -> bool {
        let grid = &self.grids[space.index()];
        let [columns, rows] = grid.cells(bounds);
        let layer = &self.layers[tag * self.grids.len() + space.index()];
        (rows.0..=rows.1).any(|row| {
            let mut cells = row * grid.columns + columns.0..=row * grid.columns + columns.1;
            cells.any(|cell| layer[cell / 64] >> (cell % 64) & 1 == 1)
        })
    }

    /// Both together.
    pub fn join(mut self, other: Occupied) -> Occupied {
        for (theirs, tag) in other.tags.iter().enumerate() {
            let mine = self.layer(*tag);
            for space in 0..self.grids.len() {
                let from = &other.layers[theirs * self.grids.len() + space];
                let into = &mut self.layers[mine * self.grids.len() + space];
                into.iter_mut().zip(from).for_each(|(into, from)| *into |= from);
            }
        }
        self
    }
}
