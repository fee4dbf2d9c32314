//! Probes, by the letter of the reference: every tile, every rectangle, every collider of another instance is looked at.

use hypedc::ir::TagId;
use hypedc::sema::checked::{Collider, Probe, Shape};

use super::collide::Area;
use super::evaluate::Code;
use super::model::Fault;
use super::slope::Ends;

/// How deep an overlap has to be to count, px.
const TOLERANCE: f64 = 0.001;

/// A box, and whether it is the square around a disc.
#[derive(Debug, Clone, Copy)]
struct Form {
    left: f64,
    bottom: f64,
    right: f64,
    top: f64,
    is_disc: bool,
    /// The line up to which a tile is solid.
    slope: Option<Ends>,
}

/// What is in a place.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Taken {
    Free,
    ByStatic,
    /// By a tile that can be broken, given by its cell, where a name is given.
    ByTile(usize),
    ByInstance(usize),
}

impl Code<'_> {
    /// What one's own colliders, moved, overlap; of instances the first.
    pub fn probe(&self, asked: &Probe) -> Result<Taken, Fault> {
        let [x, y] = &asked.offset;
        let (dx, dy) = (self.value(x)?, self.value(y)?);
        let me = self.me.unwrap();
        let mut first: Option<usize> = None;
        let mut most: Option<(f64, usize)> = None;
        for own in self.forms(me, asked.mine)? {
            let there =
                Form { left: own.left + dx, right: own.right + dx, bottom: own.bottom + dy, top: own.top + dy, ..own };
            let images = self.images(me, there);
            let overlaps = |other: Form| images.iter().any(|there| overlap(*there, self.image(me, other, [0, 0])));
            if asked.bound.is_none() && self.statics(me, asked.other).into_iter().any(|(form, _)| overlaps(form)) {
                return Ok(Taken::ByStatic);
            }
            for (form, cell) in self.statics(me, asked.other) {
                let Some(cell) = cell.filter(|_| asked.bound.is_some()) else { continue };
                for there in &images {
                    let other = self.image(me, form, [0, 0]);
                    let part = part(*there, other);
                    let area = (there.right.min(part.right) - there.left.max(part.left))
                        * (there.top.min(part.top) - there.bottom.max(part.bottom));
                    let wins = most.is_none_or(|(known, at)| area > known || (area == known && cell < at));
                    if overlap(*there, other) && wins {
                        most = Some((area, cell));
                    }
                }
            }
            for slot in 0..self.state.things.len() {
                let is_same_space = |slot: usize| {
                    let space = |slot: usize| self.state.things[slot].as_ref().map(|thing| thing.space);
                    space(slot) == space(me)
                };
                if slot == me || first.is_some_and(|first| first <= slot) {
                    continue;
                }
                for other in self.forms(slot, asked.other)? {
                    if is_same_space(slot) && overlaps(other) {
                        if asked.bound.is_none() {
                            return Ok(Taken::ByInstance(slot));
                        }
                        first = Some(first.map_or(slot, |first| first.min(slot)));
                    }
                }
            }
        }
        let tile = most.map_or(Taken::Free, |(_, cell)| Taken::ByTile(cell));
        Ok(first.map_or(tile, Taken::ByInstance))
    }

    /// A form with its lower-left corner between the borders of an instance's space, moved by whole periods.
    fn image(&self, slot: usize, form: Form, turns: [i32; 2]) -> Form {
        let space = self.state.things[slot].as_ref().unwrap().space;
        let borders = self.oracle.borders(space);
        let way = |axis: usize, from: f64| {
            let Some((low, high)) = borders[axis] else { return 0.0 };
            (high - low) * (f64::from(turns[axis]) - ((from - low) / (high - low)).floor())
        };
        let (x, y) = (way(0, form.left), way(1, form.bottom));
        Form { left: form.left + x, right: form.right + x, bottom: form.bottom + y, top: form.top + y, ..form }
    }

    /// A form as it is seen from all sides of the seams.
    fn images(&self, slot: usize, form: Form) -> Vec<Form> {
        let space = self.state.things[slot].as_ref().unwrap().space;
        let [x, y] = self.oracle.borders(space).map(|borders| if borders.is_some() { -4..=4 } else { 0..=0 });
        let turns = x.flat_map(|across| y.clone().map(move |up| [across, up]));
        turns.map(|turns| self.image(slot, form, turns)).collect()
    }

    /// The active colliders of an instance with a tag.
    fn forms(&self, slot: usize, tag: TagId) -> Result<Vec<Form>, Fault> {
        let Some(thing) = &self.state.things[slot] else { return Ok(Vec::new()) };
        if self.passing.is_some_and(|passing| !passing.acts(slot)) {
            return Ok(Vec::new());
        }
        let code = self.oracle.code(self.state, slot);
        let mut out = Vec::new();
        for Collider { shape, guard, tags, .. } in self.oracle.entity(slot).colliders.iter() {
            if !tags.contains(&tag) || !guard.as_ref().map_or(Ok(true), |guard| code.holds(guard))? {
                continue;
            }
            let numbers: Vec<f64> = shape.numbers().iter().map(|n| code.value(n)).collect::<Result<_, Fault>>()?;
            let (px, py) = thing.position();
            let (is_disc, [x, y, width, height]) = match (shape, numbers.as_slice()) {
                (Shape::Rect(_), &[x, y, width, height]) => (false, [x, y, width, height]),
                (Shape::Circle(_), &[x, y, r]) => (true, [x - r, y - r, 2.0 * r, 2.0 * r]),
                _ => unreachable!(),
            };
            if width > 0.0 && height > 0.0 {
                let (left, bottom) = (px + x, py + y);
                out.push(Form { left, bottom, right: left + width, top: bottom + height, is_disc, slope: None });
            }
        }
        Ok(out)
    }

    /// The tiles and rectangles with a tag in an instance's space; of tiles that can be broken the cell.
    fn statics(&self, slot: usize, tag: TagId) -> Vec<(Form, Option<usize>)> {
        let number = self.state.things[slot].as_ref().unwrap().space;
        let space = self.oracle.world.spaces.iter().nth(number).unwrap();
        let form = |left: f64, bottom: f64, width: f64, height: f64| Form {
            left,
            bottom,
            right: left + width,
            top: bottom + height,
            is_disc: false,
            slope: None,
        };
        let rects = space.solids.iter().filter(|solid| solid.tags.contains(&tag));
        let mut out: Vec<_> = rects.map(|solid| solid.rect).map(|[x, y, w, h]| (form(x, y, w, h), None)).collect();
        if let Some(map) = &space.map {
            for (at, kind) in map.cells.iter().enumerate() {
                let is_there = !self.state.broken.contains_key(&(number, at));
                if is_there && map.kinds[usize::from(*kind)].tags.contains(&tag) {
                    let (column, row) = ((at % map.columns) as f64, (at / map.columns) as f64);
                    let (width, height) = map.tile;
                    let cell = self.oracle.breakable(number, at).map(|_| at);
                    let slope = map.kinds[usize::from(*kind)].slope;
                    let slope = slope.map(|slope| Ends { left: slope.left, right: slope.right });
                    out.push((Form { slope, ..form(column * width, row * height, width, height) }, cell));
                }
            }
        }
        out
    }
}

/// Whether two forms sink into each other by more than the tolerance.
fn overlap(a: Form, b: Form) -> bool {
    if let (Some(ends), true) = (b.slope, a.is_disc) {
        let centre = ((a.left + a.right) / 2.0, (a.bottom + a.top) / 2.0);
        if (a.right - a.left) / 2.0 - ends.distance(area(b), centre).sqrt() <= TOLERANCE {
            return false;
        }
    }
    let b = part(a, b);
    let ways = [a.right - b.left, b.right - a.left, a.top - b.bottom, b.top - a.bottom];
    if ways.iter().any(|way| *way <= TOLERANCE) {
        return false;
    }
    let middle = |f: Form| ((f.left + f.right) / 2.0, (f.bottom + f.top) / 2.0, (f.right - f.left) / 2.0);
    match (a.is_disc, b.is_disc) {
        (false, false) => true,
        (true, true) => {
            let ((x, y, r), (ox, oy, or)) = (middle(a), middle(b));
            r + or - ((x - ox) * (x - ox) + (y - oy) * (y - oy)).sqrt() > TOLERANCE
        }
        _ => {
            let (disc, flat) = if a.is_disc { (a, b) } else { (b, a) };
            let (x, y, r) = middle(disc);
            let (dx, dy) = (x - x.max(flat.left).min(flat.right), y - y.max(flat.bottom).min(flat.top));
            r - (dx * dx + dy * dy).sqrt() > TOLERANCE
        }
    }
}

fn area(of: Form) -> Area {
    Area { left: of.left, bottom: of.bottom, right: of.right, top: of.top }
}

/// The part of a form that another one can overlap.
fn part(a: Form, b: Form) -> Form {
    let top = b.slope.map_or(b.top, |ends| ends.top(area(b), (a.left, a.right)));
    Form { top, slope: None, ..b }
}
