//! What an instance looks like as it starts: its colliders, as far as their shapes never change.

use crate::ir::{Bounds, Expr, ExprId, Id, ModeId, Program, Shape, Slot, SlotId, Subject, TagSet, World};

use super::frame::moved;

/// A collider relative to the position, px.
#[derive(Debug, Clone, Copy)]
pub(super) struct Part {
    pub bounds: Bounds,
    /// Whether it is the circle inside.
    pub round: bool,
    pub tags: TagSet,
}

/// The colliders of an instance that are there at first.
#[derive(Debug, Clone, Default)]
pub(super) struct Body {
    pub parts: Vec<Part>,
    /// The largest of them, or of all where none is known to be there.
    main: Option<Part>,
}

impl Body {
    /// Of the instance of a slot.
    pub fn new(program: &Program, world: &World, id: SlotId) -> Body {
        let slot = &world.slots[id];
        let start = Start { program, world, slot };
        let (mut parts, mut others) = (Vec::new(), Vec::new());
        for collider in program.entities[slot.entity].colliders.iter() {
            let numbers = collider.shape.numbers().iter();
            let numbers: Option<Vec<f64>> = numbers.map(|&n| program.constant(n, &slot.params, world.step)).collect();
            let Some(numbers) = numbers else { continue };
            let (bounds, round) = match (collider.shape, numbers.as_slice()) {
                (Shape::Rect(_), &[x, y, width, height]) => (Bounds::new([x, y, width, height]), false),
                (Shape::Circle(_), &[x, y, radius]) => {
                    (Bounds::new([x - radius, y - radius, 2.0 * radius, 2.0 * radius]), true)
                }
                _ => continue,
            };
            let part = Part { bounds, round, tags: collider.tags };
            match collider.guard.map_or(Some(true), |guard| start.truth(guard)) {
                Some(true) => parts.push(part),
                _ => others.push(part),
            }
        }
        let main = largest(&parts).or(largest(&others));
        Body { parts, main }
    }

    /// The box that stands for it, relative to the position; none if it has no collider of a known shape.
    pub fn bounds(&self) -> Option<Bounds> {
        self.main.map(|part| part.bounds)
    }

    /// Where its middle is, relative to the position.
    pub fn middle(&self) -> [f64; 2] {
        self.bounds().map_or([0.0, 0.0], |b| [(b.left + b.right) / 2.0, (b.bottom + b.top) / 2.0])
    }
}

fn largest(parts: &[Part]) -> Option<Part> {
    let area = |p: &Part| (p.bounds.right - p.bounds.left) * (p.bounds.top - p.bounds.bottom);
    parts.iter().copied().reduce(|best, next| if area(&next) > area(&best) { next } else { best })
}

/// Where the position of a slot is at first, px.
pub(super) fn position(slot: &Slot) -> [f64; 2] {
    let mut places = slot.vars.iter().map(|values| values[0]);
    [places.next().unwrap_or(0.0), places.next().unwrap_or(0.0)]
}

/// A part of an instance that stands somewhere.
pub(super) fn placed(part: &Part, slot: &Slot) -> Bounds {
    moved(part.bounds, position(slot))
}

/// An instance before the first step.
struct Start<'a> {
    program: &'a Program,
    world: &'a World,
    slot: &'a Slot,
}

impl Start<'_> {
    /// Whether a guard holds; none where that takes more than modes and constants to tell.
    fn truth(&self, id: ExprId) -> Option<bool> {
        match self.program.exprs[id] {
            Expr::InMode(Subject::Me, mode) => Some(self.is_in(mode)),
            Expr::Not(a) => self.truth(a).map(|a| !a),
            Expr::And(a, b) => match (self.truth(a), self.truth(b)) {
                (Some(false), _) | (_, Some(false)) => Some(false),
                (a, b) => Some(a? && b?),
            },
            Expr::Or(a, b) => match (self.truth(a), self.truth(b)) {
                (Some(true), _) | (_, Some(true)) => Some(true),
                (a, b) => Some(a? || b?),
            },
            _ => self.constant(id).map(|value| value != 0.0),
        }
    }

    fn constant(&self, id: ExprId) -> Option<f64> {
        self.program.constant(id, &self.slot.params, self.world.step)
    }

    /// Whether a mode is active at first.
    fn is_in(&self, mode: ModeId) -> bool {
        let entity = &self.program.entities[self.slot.entity];
        let group = &entity.groups[entity.modes[mode].group];
        let chosen = |choices: &[crate::ir::Choice], otherwise: Option<ModeId>| {
            let choice = choices.iter().find(|c| self.constant(c.guard).is_some_and(|value| value != 0.0));
            choice.map(|c| c.mode).or(otherwise)
        };
        let mut active = chosen(&group.choices, Some(group.first));
        while let Some(outer) = active {
            if (mode.index()..entity.modes[mode].end.index()).contains(&outer.index()) {
                return true;
            }
            active = chosen(&entity.modes[outer].choices, entity.modes[outer].inner);
        }
        false
    }
}
