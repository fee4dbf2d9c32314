//! The tiles of a space as the analysis models them: tags, rows, columns and boxes of each kind of tile.

use crate::ir::{Bounds, Side, Slope, Solid, SpaceId, TagId, TagSet, TileKind, TileMap, World};
use crate::watch::Meter;

use crate::analysis::domain::values::Interval;
use crate::analysis::geometry::body::TOLERANCE;
use crate::analysis::geometry::seam::origin;

/// The map of a space; empty if it has none.
pub(in crate::analysis) struct Tiles<'a> {
    map: Option<&'a TileMap<TagId>>,
    /// The numbers of the first column and of the first row.
    origin: [i64; 2],
    wraps: bool,
    /// The rectangles of the space.
    solids: &'a [Solid],
    /// The tags of each kind of tile.
    pub tags: Vec<TagSet>,
    /// Whether each kind of tile is always there, in all of its cell.
    pub lasts: Vec<bool>,
    /// The line up to which each kind of tile is solid, if it is a slope: anything up to it may be there or not.
    pub slopes: Vec<Option<Slope>>,
}

/// Intervals along an axis, px.
type Lines = Vec<(f64, f64)>;

impl<'a> Tiles<'a> {
    pub fn new(world: &'a World, space: SpaceId) -> Self {
        let map = world.spaces[space].map.as_ref();
        let kinds = map.iter().flat_map(|m| &m.kinds);
        let origin = map.map_or([0; 2], |map| origin(&world.spaces[space], map));
        let lasts = kinds.clone().map(TileKind::lasts).collect();
        let slopes = kinds.clone().map(|k| k.slope).collect();
        let (wraps, solids) = (world.spaces[space].wraps(), &*world.spaces[space].solids);
        Tiles {
            map,
            origin,
            wraps,
            solids,
            tags: kinds.map(|k| k.tags.iter().copied().collect()).collect(),
            lasts,
            slopes,
        }
    }

    /// Width and height of a tile, px.
    pub fn size(&self) -> [f64; 2] {
        self.map.map_or([f64::INFINITY; 2], |m| [m.tile.0, m.tile.1])
    }

    /// Columns and rows.
    pub fn count(&self) -> (usize, usize) {
        self.map.map_or((0, 0), |m| (m.columns, m.rows))
    }

    /// Charges the meter for a pass over all cells; returns whether it has stopped.
    pub fn spend(&self, meter: &Meter<'_>) -> bool {
        let (columns, rows) = self.count();
        meter.spend(columns as u64 * rows as u64)
    }

    /// The kind of the tile in a cell, by its number.
    pub fn kind(&self, at: usize) -> Option<usize> {
        self.map?.cells.get(at).map(|k| usize::from(*k))
    }

    /// The box of a cell, by its number.
    pub fn bounds(&self, at: usize) -> Bounds {
        let [width, height] = self.size();
        let columns = self.count().0.max(1);
        let (column, row) = (self.number(0, at % columns), self.number(1, at / columns));
        let (left, bottom) = (column * width, row * height);
        Bounds { left, right: left + width, bottom, top: bottom + height }
    }

    /// The number of the column or the row with an index, from the origin of the space on.
    fn number(&self, axis: usize, index: usize) -> f64 {
        (index as i64 + self.origin[axis]) as f64
    }

    /// The tags of the tile in a cell.
    pub fn tag(&self, at: usize) -> TagSet {
        self.kind(at).and_then(|k| self.tags.get(k).copied()).unwrap_or_default()
    }

    /// Whether the map contains a tile of a kind.
    pub fn has(&self, kind: usize) -> bool {
        self.map.is_some_and(|m| m.cells.iter().any(|k| usize::from(*k) == kind))
    }

    /// The kind of the neighbour that covers the face of a tile which a body touches with one of its sides.
    pub fn neighbour(&self, at: usize, side: Side) -> Option<usize> {
        let columns = self.map?.columns;
        let column = at % columns;
        match side {
            Side::Left if column + 1 < columns => self.kind(at + 1),
            Side::Right if column > 0 => self.kind(at - 1),
            Side::Below => self.kind(at + columns),
            Side::Above => self.kind(at.checked_sub(columns)?),
            Side::Left | Side::Right => None,
        }
    }

    /// Whether a rectangle with some tags is so near to a cell that it may cover a part of a face of the tile. Across the
    /// seam of a space that wraps, any is.
    pub fn beside_rect(&self, is_met: impl Fn(TagSet) -> bool) -> impl Fn(usize) -> bool {
        let rects: Vec<Bounds> = self.solids.iter().filter(|s| is_met(s.tags)).map(|s| s.bounds).collect();
        let is_near = match self.map {
            Some(map) if !self.wraps => map.cells_near(rects.iter().copied(), TOLERANCE),
            _ => Vec::new(),
        };
        let is_anywhere = self.wraps && !rects.is_empty();
        move |at| is_anywhere || is_near.get(at).is_some_and(|is| *is)
    }

    /// The columns and rows that contain a selected cell; incomplete if the meter runs out.
    pub fn lines(&self, is_selected: impl Fn(usize) -> bool, meter: &Meter<'_>) -> (Lines, Lines) {
        let Some(map) = self.map else { return (Vec::new(), Vec::new()) };
        let (mut columns, mut rows) = (vec![false; map.columns], vec![false; map.rows]);
        for (row, is_in_row) in rows.iter_mut().enumerate() {
            if meter.spend(4 * map.columns as u64) {
                break;
            }
            for (column, is_in_column) in columns.iter_mut().enumerate() {
                let is_in = is_selected(row * map.columns + column);
                *is_in_row |= is_in;
                *is_in_column |= is_in;
            }
        }
        let lines = |on: &[bool], axis: usize, size: f64| {
            let on = on.iter().enumerate().filter(|(_, on)| **on).map(|(i, _)| self.number(axis, i));
            on.map(|i| (i * size, i * size + size)).collect()
        };
        (lines(&columns, 0, map.tile.0), lines(&rows, 1, map.tile.1))
    }

    /// The boxes of the selected kinds of tiles; runs in a row are merged.
    pub fn boxes(&self, is_selected: impl Fn(usize) -> bool) -> impl Iterator<Item = Bounds> + '_ {
        let [width, height] = self.size();
        let columns = self.count().0.max(1);
        let cells: Vec<bool> = self.map.iter().flat_map(|m| &m.cells).map(|k| is_selected(usize::from(*k))).collect();
        let rows = cells.chunks(columns).enumerate();
        let mut out = Vec::new();
        for (row, cells) in rows {
            let mut from = 0;
            for run in cells.chunk_by(|a, b| a == b) {
                if run[0] {
                    let bottom = self.number(1, row) * height;
                    out.push(Bounds {
                        left: self.number(0, from) * width,
                        right: self.number(0, from + run.len()) * width,
                        bottom,
                        top: bottom + height,
                    });
                }
                from += run.len();
            }
        }
        out.into_iter()
    }

    /// The kinds of the tiles whose interior a box overlaps.
    pub fn within(&self, x: Interval, y: Interval) -> impl Iterator<Item = usize> + '_ {
        let (columns, rows) = self.count();
        let [width, height] = self.size();
        let range = |i: Interval, axis: usize, size: f64, count: usize| {
            let first = self.origin[axis] as f64;
            let cell = |x: f64| ((x / size).floor() - first).clamp(0.0, count as f64) as usize;
            if i.high < first * size { 0..0 } else { cell(i.low)..(cell(i.high) + 1).min(count) }
        };
        let across = range(x, 0, width, columns);
        let cells = range(y, 1, height, rows).flat_map(move |row| across.clone().map(move |c| row * columns + c));
        cells.filter_map(|at| self.kind(at))
    }
}
