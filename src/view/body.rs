//! The initial shape of an instance: its colliders, where modes, parameters and its initial values determine them.

use crate::ir::{
    Bounds, Choice, Expr, ExprId, Extremes, Id, ModeId, Program, Push, Slot, SlotId, Subject, TagSet, World,
    arithmetic, call, compare,
};

use super::frame::{is_proper, moved, shared};
use super::track::Part;

/// The colliders of an instance that are active initially.
#[derive(Debug, Clone, Default)]
pub(super) struct Body {
    pub parts: Vec<Part>,
    /// The largest solid collider whose shape never changes and that is certainly active; if none is solid, the largest
    /// of all.
    main: Option<Part>,
}

impl Body {
    /// The body of the instance in a slot.
    pub fn new(program: &Program, world: &World, id: SlotId) -> Body {
        let slot = &world.slots[id];
        let start = Start { program, world, slot };
        let (mut parts, mut steady, mut others) = (Vec::new(), Vec::new(), Vec::new());
        for collider in program.entities[slot.entity].colliders.iter() {
            let numbers = collider.shape.numbers();
            let Some(sides) = collider.shape.sides(|number| start.value(number)) else { continue };
            let (bounds, round) = (Bounds::new(sides), collider.shape.is_round());
            let part = Part { bounds, round, tags: collider.tags };
            let never_changes = numbers.iter().all(|&number| start.constant(number).is_some());
            let there = collider.guard.is_none_or(|guard| start.value(guard).is_some_and(|value| value != 0.0));
            if there {
                parts.push(part);
            }
            match (never_changes, there) {
                (true, true) => steady.push(part),
                (true, false) => others.push(part),
                (false, _) => {}
            }
        }
        let pushes = |part: &Part| pushes(world, part.tags);
        let pushing = |parts: &[Part]| largest(parts.iter().filter(|p| pushes(p)));
        let solid = pushing(&steady).or(pushing(&others));
        without_views(world, &mut parts, solid.as_ref());
        let main = solid.or(largest(steady.iter())).or(largest(others.iter()));
        Body { parts, main }
    }

    /// The box of the main collider relative to the position; none if no collider has a known shape.
    pub fn bounds(&self) -> Option<Bounds> {
        self.main.map(|part| part.bounds)
    }

    /// Its middle relative to the position.
    pub fn middle(&self) -> [f64; 2] {
        self.bounds().map_or([0.0, 0.0], |b| [(b.left + b.right) / 2.0, (b.bottom + b.top) / 2.0])
    }
}

/// The parts of an instance that are drawn on its way: those that push, or all if none does.
pub(super) fn outline(world: &World, parts: &[Part]) -> Vec<Part> {
    let pushing: Vec<Part> = parts.iter().filter(|part| pushes(world, part.tags)).copied().collect();
    if !pushing.is_empty() {
        let mut shown = parts.to_vec();
        without_views(world, &mut shown, largest(pushing.iter()).as_ref());
        // What it carries for a while, such as a sword, is beside its body; feet and eyes are in it.
        let inside = |part: &Part| pushing.iter().any(|body| covers(body.bounds, part.bounds));
        shown.retain(|part| pushes(world, part.tags) || !inside(part));
        return shown;
    }
    parts.to_vec()
}

/// Whether a rectangle covers nearly all of another one.
fn covers(body: Bounds, part: Bounds) -> bool {
    let common = shared(body, part);
    let size = |b: Bounds| (b.right - b.left).greatest(0.0) * (b.top - b.bottom).greatest(0.0);
    is_proper(common) && size(common) >= 0.6 * size(part)
}

/// Leaves out sensors that are larger than the largest solid collider: they are fields of view.
fn without_views(world: &World, parts: &mut Vec<Part>, solid: Option<&Part>) {
    if let Some(solid) = solid {
        parts.retain(|part| pushes(world, part.tags) || area(part) <= area(solid));
    }
}

fn area(part: &Part) -> f64 {
    (part.bounds.right - part.bounds.left) * (part.bounds.top - part.bounds.bottom)
}

fn largest<'p>(parts: impl Iterator<Item = &'p Part>) -> Option<Part> {
    parts.copied().reduce(|best, next| if area(&next) > area(&best) { next } else { best })
}

/// Whether a collider with these tags pushes or is pushed.
pub(super) fn pushes(world: &World, tags: TagSet) -> bool {
    let mut pushing = world.collide.iter().filter(|line| line.response.push != Push::Sense);
    pushing.any(|line| line.left.meets(tags) || line.right.meets(tags))
}

/// The initial position of a slot, px.
pub(super) fn position(slot: &Slot) -> [f64; 2] {
    let mut places = slot.vars.iter().map(|values| values[0]);
    [places.next().unwrap_or(0.0), places.next().unwrap_or(0.0)]
}

/// The bounds of a part at the instance's position.
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
    /// The value of an expression that reads no inputs, no contacts and no other instance; truth is 1.
    fn value(&self, id: ExprId) -> Option<f64> {
        let truth = |holds: bool| f64::from(u8::from(holds));
        let value = match self.program.exprs[id] {
            Expr::InMode(Subject::Me, mode) => truth(self.is_in(mode)),
            Expr::Var(Subject::Me, var, degree) => *self.slot.vars.get(var)?.get(usize::from(degree))?,
            Expr::Discrete(Subject::Me, discrete) => f64::from(*self.slot.discretes.get(discrete)?),
            Expr::Negate(a) => -self.value(a)?,
            Expr::Not(a) => truth(self.value(a)? == 0.0),
            // One operand suffices if it decides the result.
            Expr::And(a, b) => match (self.value(a), self.value(b)) {
                (Some(0.0), _) | (_, Some(0.0)) => 0.0,
                (a, b) => a.and(b).map(|_| 1.0)?,
            },
            Expr::Or(a, b) => match (self.value(a), self.value(b)) {
                (Some(a), Some(b)) => truth(a != 0.0 || b != 0.0),
                (a, b) => a.or(b).filter(|value| *value != 0.0)?,
            },
            Expr::Arithmetic(op, a, b) => arithmetic(op, self.value(a)?, self.value(b)?),
            Expr::Compare(op, a, b) => truth(compare(op, self.value(a)?, self.value(b)?)),
            Expr::Call(function, [a, b, c]) => call(function, [self.value(a)?, self.value(b)?, self.value(c)?]),
            _ => self.constant(id)?,
        };
        value.is_finite().then_some(value)
    }

    fn constant(&self, id: ExprId) -> Option<f64> {
        self.program.constant(id, &self.slot.params, self.world.step)
    }

    /// Whether a mode is active initially.
    fn is_in(&self, mode: ModeId) -> bool {
        let entity = &self.program.entities[self.slot.entity];
        let group = &entity.groups[entity.modes[mode].group];
        let chosen = |choices: &[Choice], otherwise: Option<ModeId>| {
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
