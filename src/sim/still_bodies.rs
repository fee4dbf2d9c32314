//! The colliders of instances that never move: their boxes are known, and those near a box are looked up in a grid.

use std::cell::Cell;

use crate::ir::{Extremes, Id, SpaceId, World};
use crate::watch::Meter;

use super::actor::Actor;
use super::chance::Frames;
use super::collision::{Body, Collision};
use super::contact::Rect;
use super::encounter::Encounter;
use super::fault::Fault;
use super::simulator::{Scratch, Simulator, first_position};
use super::state::leaf_at;
use super::still::Still;

/// The colliders of instances that never move. They follow those that may in the list of all.
#[derive(Debug)]
pub(super) struct StillBodies {
    /// The box of each.
    rects: Vec<Rect>,
    /// Those of each space.
    grids: Vec<Grid>,
    /// Those that touch each other with an effect, the lower slot first.
    pairs: Vec<(u32, u32)>,
    /// Those that touch tiles or rectangles with an effect.
    fixed: Vec<u32>,
    /// For each set of tags, with which of these a contact has an effect.
    meets: Vec<Option<Box<[bool]>>>,
}

/// Colliders by the cells of a grid that they overlap.
#[derive(Debug, Default)]
struct Grid {
    axes: [Axis; 2],
    /// For each cell, row by row, the end of its entries; they begin where those of the cell before end.
    ends: Vec<u32>,
    entries: Vec<u32>,
    /// Colliders that overlap many cells.
    large: Vec<u32>,
}

/// The columns or rows of a grid.
#[derive(Debug, Clone, Copy, Default)]
struct Axis {
    low: f64,
    high: f64,
    per_px: f64,
    count: usize,
}

/// The cells of a box: the first column and the last, and the rows.
type Cells = [(usize, usize); 2];

/// A collider that overlaps more cells than this is apart from the others.
const MANY_CELLS: usize = 16;

impl Axis {
    /// With cells of about twice the size of the boxes.
    fn new(ends: impl Iterator<Item = (f64, f64)> + Clone) -> Axis {
        let count = ends.clone().count();
        let (low, high) = ends
            .clone()
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), (from, to)| (low.least(from), high.greatest(to)));
        let size = 2.0 * ends.map(|(from, to)| to - from).sum::<f64>() / count as f64;
        // The cast saturates, and makes 0 of no number.
        let cells = (((high - low) / size) as usize).clamp(1, count.max(1));
        Axis { low, high, per_px: 0.0, count: 0 }.with_count(cells)
    }

    fn with_count(self, count: usize) -> Axis {
        let per_px = count as f64 / (self.high - self.low);
        Axis { per_px: if per_px.is_finite() { per_px } else { 0.0 }, count, ..self }
    }

    /// The cell of a coordinate, or the nearest one: it grows with the coordinate.
    #[inline]
    fn cell(&self, at: f64) -> usize {
        // The cast saturates.
        (((at - self.low) * self.per_px) as usize).min(self.count.max(1) - 1)
    }
}

impl Grid {
    /// Of some colliders with their boxes.
    fn new(bodies: &[u32], rect: impl Fn(u32) -> Rect) -> Grid {
        if bodies.is_empty() {
            return Grid::default();
        }
        let sides = [|r: &Rect| (r.left, r.right), |r: &Rect| (r.bottom, r.top)];
        let mut axes = sides.map(|ends| Axis::new(bodies.iter().map(|at| ends(&rect(*at)))));
        while axes[0].count * axes[1].count > 4 * bodies.len() {
            let longer = usize::from(axes[1].count > axes[0].count);
            axes[longer] = axes[longer].with_count(axes[longer].count / 2);
        }
        let mut out = Grid { axes, ends: vec![0; axes[0].count * axes[1].count], ..Grid::default() };
        let (large, small): (Vec<u32>, Vec<u32>) = bodies.iter().partition(|at| {
            let [columns, rows] = out.cells(&rect(**at));
            (columns.1 - columns.0 + 1) * (rows.1 - rows.0 + 1) > MANY_CELLS
        });
        let places = |out: &Grid, at: u32| {
            let [columns, rows] = out.cells(&rect(at));
            let width = out.axes[0].count;
            (rows.0..=rows.1).flat_map(move |row| (columns.0..=columns.1).map(move |column| row * width + column))
        };
        for &at in &small {
            for cell in places(&out, at) {
                out.ends[cell] += 1;
            }
        }
        let mut sum = 0;
        for end in &mut out.ends {
            // For now, where the entries begin.
            (sum, *end) = (sum + *end, sum);
        }
        out.entries = vec![0; sum as usize];
        for &at in &small {
            for cell in places(&out, at) {
                out.entries[out.ends[cell] as usize] = at;
                out.ends[cell] += 1;
            }
        }
        Grid { large, ..out }
    }

    #[inline]
    fn cells(&self, rect: &Rect) -> Cells {
        let [x, y] = &self.axes;
        [(x.cell(rect.left), x.cell(rect.right)), (y.cell(rect.bottom), y.cell(rect.top))]
    }

    /// Calls `visit` with each collider whose box overlaps or touches another one; returns the number of comparisons.
    #[inline]
    fn near(&self, rect: &Rect, rects: impl Fn(u32) -> Rect, mut visit: impl FnMut(u32, &Rect)) -> usize {
        let mut compared = self.large.len();
        for &at in &self.large {
            let other = rects(at);
            if rect.is_near(&other) {
                visit(at, &other);
            }
        }
        if self.ends.is_empty() {
            return compared;
        }
        let [columns, rows] = self.cells(rect);
        for row in rows.0..=rows.1 {
            for column in columns.0..=columns.1 {
                let cell = row * self.axes[0].count + column;
                let from = if cell == 0 { 0 } else { self.ends[cell - 1] };
                let entries = &self.entries[from as usize..self.ends[cell] as usize];
                compared += 1 + entries.len();
                for &at in entries {
                    let other = rects(at);
                    // It may be in several cells; the first that both share reports it.
                    let [first_column, first_row] = self.cells(&other).map(|(first, _)| first);
                    let is_first = column == columns.0.max(first_column) && row == rows.0.max(first_row);
                    if is_first && rect.is_near(&other) {
                        visit(at, &other);
                    }
                }
            }
        }
        compared
    }
}

impl StillBodies {
    /// Those of a world.
    pub fn new(world: &World, collision: &Collision) -> StillBodies {
        let Collision { bodies, effects, moving, .. } = collision;
        let rects: Vec<Rect> = bodies[*moving..].iter().map(|body| rect(world, body)).collect();
        let rect_of = |at: u32| rects[at as usize - moving];
        // An empty collider touches nothing.
        let is_solid = |at: &u32| rect_of(*at).active;
        let still: Vec<u32> = (*moving as u32..bodies.len() as u32).filter(is_solid).collect();
        let of_space =
            |space: u32| -> Vec<u32> { still.iter().copied().filter(|at| rect_of(*at).space == space).collect() };
        let grids: Vec<Grid> =
            (0..world.spaces.len() as u32).map(|space| Grid::new(&of_space(space), rect_of)).collect();
        let mut pairs = Vec::new();
        for &at in &still {
            let rect = rect_of(at);
            let mine = &bodies[at as usize];
            grids[rect.space as usize].near(&rect, rect_of, |other, _| {
                let theirs = &bodies[other as usize];
                if at < other && mine.slot != theirs.slot && effects[mine.set][theirs.set] {
                    pairs.push((at, other));
                }
            });
        }
        let fixed = still.iter().copied().filter(|at| {
            let body = &bodies[*at as usize];
            body.meets && touches_fixed(collision, world, body, &rect_of(*at))
        });
        let fixed = fixed.collect();
        let is_still = |set: usize| bodies[*moving..].iter().any(|body| body.set == set);
        let there: Vec<bool> = (0..effects.len()).map(is_still).collect();
        let with_still = |of: &Vec<bool>| -> Option<Box<[bool]>> {
            let of: Box<[bool]> = of.iter().zip(&there).map(|(meets, there)| *meets && *there).collect();
            of.contains(&true).then_some(of)
        };
        StillBodies { grids, pairs, fixed, meets: effects.iter().map(with_still).collect(), rects }
    }

    /// The box of a collider by its number among them; `None` if it is empty.
    pub fn rect(&self, at: usize) -> Option<Rect> {
        Some(self.rects[at]).filter(|rect| rect.active)
    }
}

/// The box of a body, active if it is not empty.
fn rect(world: &World, body: &Body) -> Rect {
    let slot = &world.slots[body.slot];
    let [x, y, width, height] = body.fixed.unwrap_or_default();
    let (px, py) = first_position(slot);
    let (left, bottom) = (px + x, py + y);
    Rect {
        left,
        right: left + width,
        bottom,
        top: bottom + height,
        active: width > 0.0 && height > 0.0,
        space: slot.space.0,
        back: (0.0, 0.0),
        round: body.shape.is_round(),
    }
}

/// Whether a contact of a box with a tile, whole or broken, or with a rectangle could set a contact bit of its body.
fn touches_fixed(collision: &Collision, world: &World, body: &Body, rect: &Rect) -> bool {
    let (kind, space) = (&collision.kinds[body.kind], rect.space as usize);
    let is_read = |with: &Option<Encounter>| with.as_ref().is_some_and(|with| !with.is_unread());
    let mut solids = collision.solids[space].iter().zip(&kind.solids[space]);
    if solids.any(|(solid, with)| is_read(with) && rect.is_near(&rect.at(&solid.bounds))) {
        return true;
    }
    let Some(map) = &world.spaces[SpaceId(rect.space)].map else { return false };
    let [columns, rows] = &collision.grids[space];
    let ((first, after), (low, high)) = (columns.range(rect.left, rect.right), rows.range(rect.bottom, rect.top));
    (low..high).any(|row| {
        let cells = map.cells.get(row * map.columns + first..row * map.columns + after).unwrap_or_default();
        cells.iter().any(|tile| is_read(&kind.tiles[space][usize::from(*tile)]))
    })
}

impl Simulator {
    /// Detects the contacts of instances that never move.
    #[inline(never)]
    pub(super) fn collide_still(&self, still: &Still, state: &mut [u8], scratch: &mut Scratch, meter: &Meter<'_>) {
        for &slot in &scratch.still.awake {
            let Actor { layout, touches, bound, .. } = &self.actors[slot as usize];
            layout.clear_touches(state, *touches, *bound);
        }
        let Scratch { frames, collision, .. } = scratch;
        let super::collision::Scratch { boxes, displacements, lengths, work, .. } = collision;
        let (bodies, moving) = (&self.collision.bodies, self.collision.moving);
        let StillBodies { rects, grids, pairs, fixed, meets } = &still.bodies;
        let rect_of = |at: u32| rects[at as usize - moving];
        for &(i, j) in pairs {
            let (i, j) = (i as usize, j as usize);
            if self.is_there(&bodies[i], state, frames) && self.is_there(&bodies[j], state, frames) {
                self.pair(state, (i, j), [&rects[i - moving], &rects[j - moving]], displacements);
            }
        }
        let mut compared = pairs.len();
        for (i, rect) in boxes.iter().enumerate().filter(|(_, rect)| rect.active) {
            let mine = &bodies[i];
            let Some(meets) = &meets[mine.set] else { continue };
            let seen = grids[rect.space as usize].near(rect, rect_of, |j, other| {
                let (j, theirs) = (j as usize, &bodies[j as usize]);
                if !meets[theirs.set] || !self.is_there(theirs, state, frames) {
                    return;
                }
                match mine.slot < theirs.slot {
                    true => self.pair(state, (i, j), [rect, other], displacements),
                    false => self.pair(state, (j, i), [other, rect], displacements),
                }
            });
            compared += seen;
            if meter.spend(seen as u64) {
                return;
            }
        }
        *work = work.wrapping_add(compared as u64);
        let lengths = Cell::from_mut(lengths.as_mut_slice()).as_slice_of_cells();
        for &at in fixed {
            let (body, rect) = (&bodies[at as usize], rect_of(at));
            if !self.is_there(body, state, frames) {
                continue;
            }
            let kind = &self.collision.kinds[body.kind];
            let displacement = &mut displacements[body.slot.index()];
            let mut looked_at = 0;
            if kind.meets_solids[rect.space as usize] {
                looked_at += self.collide_solids(state, body, &rect, displacement, meter);
            }
            if kind.meets_tiles[rect.space as usize] {
                looked_at += self.collide_tiles(state, body, &rect, (displacement, lengths), meter);
            }
            if meter.spend(looked_at as u64) {
                return;
            }
        }
    }

    /// Whether a collider of an instance that never moves is there.
    #[inline]
    pub(super) fn is_there(&self, body: &Body, state: &[u8], frames: &Frames) -> bool {
        if !body.layout.acts(state) {
            return false;
        }
        match &body.by_leaf {
            Some((at, leaves)) => leaves[leaf_at(state, *at).index()],
            None => {
                body.is_plain || self.evaluate_box(body, state, frames, &Cell::<Option<Fault>>::new(None)).is_some()
            }
        }
    }
}
