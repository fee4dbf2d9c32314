//! Probes: whether a collider, moved by an offset, overlaps something with a tag. Answered where a guard asks, on the
//! state that it reads: nothing is stored, and a program without probes has no tables for them.

use std::cell::Cell;

use crate::ir::{Bounds, Expr, Extremes, Period, Program, SlotId, SpaceId, TagId, TagSet, TileId, World};

use super::actor::Actor;
use super::breakable::Best;
use super::collision::{Body, Collision};
use super::contact::{Rect, TOLERANCE, sinks_in};
use super::evaluate::Reader;
use super::simulator::Simulator;
use super::slope::Line;
use super::state::leaf_at;

/// For each tag that a probe names, what has it.
#[derive(Debug)]
pub(super) struct Probes {
    of: Vec<Option<Tagged>>,
}

/// What has a tag.
#[derive(Debug, Default)]
struct Tagged {
    /// The colliders, in the order of their slots.
    bodies: Vec<usize>,
    /// For each space, the kinds of tiles; empty if no tile of its map has the tag.
    tiles: Vec<Vec<bool>>,
    /// For each space, its free-standing rectangles.
    rects: Vec<Vec<Bounds>>,
}

/// What a probe finds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Found {
    Nothing,
    /// A tile or a rectangle.
    Static,
    /// A breakable tile, where a name can stand for one.
    Tile(TileId),
    Instance(SlotId),
}

impl Probes {
    /// The tables of a world; `None` if no instance asks.
    pub fn new(program: &Program, world: &World, collision: &Collision, actors: &[Actor]) -> Option<Box<Probes>> {
        let mut of: Vec<Option<Tagged>> = Vec::new();
        for expr in actors.iter().flat_map(|actor| &actor.code.exprs) {
            let Expr::Probe { mine, other, .. } = *expr else { continue };
            of.resize_with(program.tags.len().max(of.len()), || None);
            for tag in [mine, other] {
                let entry = of.get_mut(tag.0 as usize)?;
                entry.get_or_insert_with(|| Tagged::new(world, collision, TagSet::of(tag)));
            }
        }
        (!of.is_empty()).then(|| Box::new(Probes { of }))
    }

    fn tagged(&self, tag: TagId) -> Option<&Tagged> {
        self.of.get(tag.0 as usize)?.as_ref()
    }

    /// The number of colliders that a probe looks at.
    pub fn cost(&self, expr: &Expr) -> u64 {
        let Expr::Probe { other, .. } = *expr else { return 0 };
        self.tagged(other).map_or(0, |tagged| tagged.bodies.len() as u64)
    }
}

impl Tagged {
    fn new(world: &World, collision: &Collision, tag: TagSet) -> Tagged {
        let has = |(_, body): &(usize, &Body)| collision.kinds[body.kind].tags.meets(tag);
        let mut bodies: Vec<usize> = collision.bodies.iter().enumerate().filter(has).map(|(at, _)| at).collect();
        bodies.sort_by_key(|at| collision.bodies[*at].slot);
        let mut out = Tagged { bodies, ..Tagged::default() };
        for (space, solids) in world.spaces.iter().zip(&collision.solids) {
            let kinds = space.map.iter().flat_map(|map| &map.kinds);
            let tiles: Vec<bool> = kinds.map(|kind| kind.tags.iter().any(|t| TagSet::of(*t).meets(tag))).collect();
            out.tiles.push(if tiles.contains(&true) { tiles } else { Vec::new() });
            out.rects.push(solids.iter().filter(|s| s.tags.meets(tag)).map(|s| s.bounds).collect());
        }
        out
    }
}

impl Simulator {
    /// What one's own colliders tagged `mine`, moved by `offset`, overlap of what is tagged `other`. Of several instances
    /// it is the one with the lowest slot; `bound` leaves out tiles and rectangles, but for breakable tiles if `tiles`:
    /// where there is no instance, the one that it overlaps most.
    // Not inlined: it is rare, and would enlarge every guard.
    #[inline(never)]
    pub(super) fn probe(
        &self,
        reader: &Reader<'_>,
        (mine, other): (TagId, TagId),
        offset: [f64; 2],
        (bound, tiles): (bool, bool),
    ) -> Found {
        let tables = self.probes.as_ref().and_then(|probes| probes.tagged(mine).zip(probes.tagged(other)));
        let Some((own, asked)) = tables else { return Found::Nothing };
        let bodies = &self.collision.bodies;
        let mut found = Found::Nothing;
        let most: Cell<Option<Best>> = Cell::new(None);
        let from = own.bodies.partition_point(|&at| bodies[at].slot < reader.me);
        for &at in own.bodies[from..].iter().take_while(|&&at| bodies[at].slot == reader.me) {
            let Some(rect) = self.rect_of(at, reader) else { continue };
            let rect = rect.moved(offset);
            if !bound && self.any_image(&rect, |rect| self.overlaps_static(reader.state, rect, asked)) {
                return Found::Static;
            }
            let others = asked.bodies.iter().map(|&at| (at, &bodies[at]));
            for (at, body) in others.filter(|(_, body)| body.slot != reader.me) {
                if matches!(found, Found::Instance(lowest) if body.slot >= lowest) {
                    break;
                }
                let there = self.rect_of(at, reader).map(|there| self.brought_in(&there));
                if there.is_some_and(|there| self.any_image(&rect, |rect| overlap(rect, &there))) {
                    found = Found::Instance(body.slot);
                    if !bound {
                        return found;
                    }
                }
            }
            if tiles && found == Found::Nothing {
                self.any_image(&rect, |rect| {
                    self.most_overlapped(reader.state, rect, asked, &most);
                    false
                });
            }
        }
        match (found, most.get()) {
            (Found::Nothing, Some(most)) => Found::Tile(most.tile),
            _ => found,
        }
    }

    /// Keeps the breakable tile that a box overlaps most, if that is more than what is known.
    #[inline(never)]
    fn most_overlapped(&self, state: &[u8], rect: &Rect, asked: &Tagged, most: &Cell<Option<Best>>) {
        let Some(breakables) = &self.breakables else { return };
        self.tiles_under(rect, asked, |cell, bounds| {
            let Some(tile) = breakables.tile(rect.space as usize, cell) else { return false };
            let other = rect.at(bounds);
            if !breakables.is_broken(state, tile) && overlap(rect, &other) {
                let width = rect.right.least(other.right) - rect.left.greatest(other.left);
                let height = rect.top.least(other.top) - rect.bottom.greatest(other.bottom);
                let found = Best { tile, cell, measure: width * height };
                if most.get().is_none_or(|known| found.is_better_than(&known)) {
                    most.set(Some(found));
                }
            }
            false
        });
    }

    /// Whether something holds of a box or, in a space that wraps, of the box as it is seen beyond a seam.
    fn any_image(&self, rect: &Rect, holds: impl Fn(&Rect) -> bool) -> bool {
        let Some(seams) = self.collision.seams.as_ref() else { return holds(rect) };
        let ([x, y], rect) = (seams.periods(rect.space as usize), self.brought_in(rect));
        // A collider may be longer than a period.
        let turns = |period: Option<Period>| if period.is_some() { -2..=2 } else { 0..=0 };
        let way = |turn: i32, period: Option<Period>| period.map_or(0.0, |period| f64::from(turn) * period.size());
        turns(x).any(|across| turns(y).any(|up| holds(&rect.moved([way(across, x), way(up, y)]))))
    }

    /// A box with its lower-left corner between the borders of its space.
    fn brought_in(&self, rect: &Rect) -> Rect {
        let periods = self.collision.seams.as_ref().map_or([None; 2], |seams| seams.periods(rect.space as usize));
        let way = |axis: usize, low: f64| periods[axis].map_or(0.0, |period| period.wrapped(low) - low);
        rect.moved([way(0, rect.left), way(1, rect.bottom)])
    }

    /// The box of a collider in the state that is read; `None` if it is not there.
    fn rect_of(&self, at: usize, reader: &Reader<'_>) -> Option<Rect> {
        let (body, state) = (&self.collision.bodies[at], reader.state);
        if let Some(still) = self.still.as_ref().filter(|_| at >= self.collision.moving) {
            let rect = still.bodies.rect(at - self.collision.moving);
            return rect.filter(|_| self.is_there(body, state, reader.frames));
        }
        if !body.layout.acts(state) {
            return None;
        }
        if let Some((at, leaves)) = &body.by_leaf
            && !leaves[leaf_at(state, *at).0 as usize]
        {
            return None;
        }
        let [x, y, width, height] = match body.fixed {
            Some(sides) if body.is_plain => sides,
            _ => self.evaluate_box(body, state, reader.frames, reader.fault)?,
        };
        if !(width > 0.0 && height > 0.0) {
            return None;
        }
        let (px, py) = body.layout.position(state);
        let (left, bottom) = (px + x, py + y);
        let round = body.shape.is_round();
        let space = body.layout.space(state).0;
        Some(Rect {
            left,
            right: left + width,
            bottom,
            top: bottom + height,
            active: true,
            space,
            round,
            ..Rect::default()
        })
    }

    /// The part of a tile that a shape can overlap: of a slope, up to the highest point of its line over the shape.
    #[inline(never)]
    fn under_line(&self, rect: &Rect, kind: u16, tile: Bounds) -> Option<Bounds> {
        let slopes = self.collision.slopes.as_ref().map_or(&[][..], |slopes| slopes.of_space(rect.space as usize));
        let Some(slope) = slopes.get(usize::from(kind)).copied().flatten() else { return Some(tile) };
        let line = Line { tile, slope };
        (!rect.round || line.takes_disc(rect)).then(|| Bounds { top: line.top(rect), ..tile })
    }

    /// Whether a box overlaps a tile or a rectangle of its space that has a tag.
    fn overlaps_static(&self, state: &[u8], rect: &Rect, asked: &Tagged) -> bool {
        if asked.rects[rect.space as usize].iter().any(|b| overlap(rect, &rect.at(b))) {
            return true;
        }
        self.tiles_under(rect, asked, |cell, bounds| {
            overlap(rect, &rect.at(bounds)) && !self.is_gone(state, rect.space as usize, cell)
        })
    }

    /// Whether something holds of a tile near a box that has a tag, given its cell and its bounds.
    fn tiles_under(&self, rect: &Rect, asked: &Tagged, mut holds: impl FnMut(usize, &Bounds) -> bool) -> bool {
        let kinds = &asked.tiles[rect.space as usize];
        let Some(map) = self.world().spaces[SpaceId(rect.space)].map.as_ref().filter(|_| !kinds.is_empty()) else {
            return false;
        };
        let [columns, rows] = &self.collision.grids[rect.space as usize];
        let (first, after) = columns.range(rect.left, rect.right);
        let (low, high) = rows.range(rect.bottom, rect.top);
        let (width, height) = map.tile;
        (low..high).any(|row| {
            let start = row * map.columns + first;
            let cells = map.cells.get(start..row * map.columns + after).unwrap_or_default();
            cells.iter().enumerate().filter(|(_, kind)| kinds[usize::from(**kind)]).any(|(index, _)| {
                let (left, bottom) = ((first + index) as i64 as f64 * width, row as i64 as f64 * height);
                let bounds = Bounds { left, right: left + width, bottom, top: bottom + height };
                self.under_line(rect, cells[index], bounds).is_some_and(|bounds| holds(start + index, &bounds))
            })
        })
    }
}

/// Whether two shapes overlap by more than what faces that merely touch may.
fn overlap(a: &Rect, b: &Rect) -> bool {
    let x = (a.right - b.left).least(b.right - a.left);
    let y = (a.top - b.bottom).least(b.top - a.bottom);
    a.space == b.space && x > TOLERANCE && y > TOLERANCE && (!(a.round || b.round) || sinks_in(a, b))
}
