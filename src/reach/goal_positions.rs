//! The positions of a player at which a goal can hold, derived from its predicate: boxes per space. The distance field
//! (`distance.rs`) starts from them.

use crate::ir::{
    Arithmetic, Bounds, Collider, CompareOp, Expr, ExprId, Extremes, Origin, SlotId, Space, SpaceId, Subject, TagSet,
    TouchId, VarId,
};

use super::around::images;
use super::outcome::Visited;
use super::problem::Problem;

/// Maximum number of boxes per goal.
const MAX_BOXES: usize = 4096;

/// A box of positions of a player, px.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct PositionBox {
    /// The space; `None`: any.
    pub space: Option<SpaceId>,
    /// The range of x.
    pub x: (f64, f64),
    /// The range of y.
    pub y: (f64, f64),
}

impl PositionBox {
    const ANYWHERE: PositionBox =
        PositionBox { space: None, x: (f64::NEG_INFINITY, f64::INFINITY), y: (f64::NEG_INFINITY, f64::INFINITY) };

    /// How far a place is from it, along x and y, px; `None` in another space.
    pub fn away(&self, space: SpaceId, (x, y): (f64, f64)) -> Option<(f64, f64)> {
        let apart = |at: f64, (low, high): (f64, f64)| (low - at).greatest(at - high).greatest(0.0);
        self.space.is_none_or(|of| of == space).then(|| (apart(x, self.x), apart(y, self.y)))
    }

    fn and(self, other: PositionBox) -> Option<PositionBox> {
        let space = match (self.space, other.space) {
            (Some(a), Some(b)) if a != b => return None,
            (a, b) => a.or(b),
        };
        let both = |a: (f64, f64), b: (f64, f64)| (a.0.greatest(b.0), a.1.least(b.1));
        let place = PositionBox { space, x: both(self.x, other.x), y: both(self.y, other.y) };
        (place.x.0 <= place.x.1 && place.y.0 <= place.y.1).then_some(place)
    }
}

/// The first player whose position the goal restricts, with the boxes.
pub(super) fn goal_positions(problem: &Problem<'_>) -> Option<(SlotId, Vec<PositionBox>)> {
    problem.players().iter().find_map(|&player| {
        let places = Finder { problem, player }.places(problem.predicate())?;
        Some((player, places))
    })
}

/// The least distance of some places of a player to where the target can hold, px; `None` if it does not restrict the
/// player's position.
pub fn distance_to_goal(problem: &Problem<'_>, places: &[Visited]) -> Option<f64> {
    let (_, boxes) = goal_positions(problem)?;
    let far = |place: &Visited, goal: &PositionBox| {
        let [x, y] = place.at.map(f64::from);
        goal.away(place.space, (x, y)).map_or(f64::INFINITY, |(across, along)| across.hypot(along))
    };
    let all = places.iter().flat_map(|place| boxes.iter().map(move |goal| far(place, goal)));
    all.reduce(f64::least)
}

/// The box of a collider of a slot relative to its position; `None` if it is not constant.
pub(super) fn extent(problem: &Problem<'_>, slot: SlotId, collider: &Collider) -> Option<Bounds> {
    let world = problem.sim.world();
    let params = &world.slots[slot].params;
    let number = |id| problem.sim.program().constant(id, params, world.step);
    collider.shape.sides(number).map(Bounds::new)
}

/// The boxes of static obstacles with some tags in a space, rectangles first; at most `most` tiles.
pub(super) fn static_boxes(space: &Space, tags: TagSet, most: usize) -> impl Iterator<Item = Bounds> {
    let solids = space.solids.iter().filter(move |solid| solid.tags.meets(tags)).map(|solid| solid.bounds);
    let tiles = space.map.iter().flat_map(move |map| {
        let has: Vec<bool> = map.kinds.iter().map(|k| k.tags.iter().copied().collect::<TagSet>().meets(tags)).collect();
        let hits = map.cells.iter().enumerate().filter(move |(_, kind)| has[usize::from(**kind)]);
        hits.take(most).map(|(cell, _)| Bounds::new(map.rectangle(cell)))
    });
    solids.chain(tiles)
}

/// The ranges of x and y at which a box relative to a position overlaps another.
pub(super) fn overlapping(mine: &Bounds, other: &Bounds) -> [(f64, f64); 2] {
    [(other.left - mine.right, other.right - mine.left), (other.bottom - mine.top, other.top - mine.bottom)]
}

struct Finder<'a> {
    problem: &'a Problem<'a>,
    player: SlotId,
}

impl Finder<'_> {
    /// Boxes of which the player must be in one for an expression to hold; `None` if it is unrestricted.
    fn places(&self, id: ExprId) -> Option<Vec<PositionBox>> {
        let is_mine = |of: Subject| of == Subject::Slot(self.player);
        match self.problem.sim.program().exprs[id] {
            Expr::Bool(false) => Some(Vec::new()),
            Expr::And(a, b) => match (self.places(a), self.places(b)) {
                (Some(a), Some(b)) => {
                    let both = a.iter().flat_map(|a| b.iter().filter_map(|b| a.and(*b)));
                    Some(both.take(MAX_BOXES).collect())
                }
                (a, b) => a.or(b),
            },
            Expr::Or(a, b) => {
                let (mut either, b) = (self.places(a)?, self.places(b)?);
                either.extend(b);
                either.truncate(MAX_BOXES);
                Some(either)
            }
            Expr::Near { of, x, y, radius } if is_mine(of) => {
                let (x, y, r) = (self.value(x)?, self.value(y)?, self.value(radius)?.greatest(0.0));
                let around = PositionBox { space: None, x: (x - r, x + r), y: (y - r, y + r) };
                Some(images(self.problem.sim.world(), around))
            }
            Expr::Compare(op, a, b) => self.comparison(op, a, b).map(|place| vec![place]),
            Expr::InSpace(of, space) if is_mine(of) => {
                Some(vec![PositionBox { space: Some(space), ..PositionBox::ANYWHERE }])
            }
            Expr::Touching(of, touch) if is_mine(of) => self.touching(touch),
            _ => None,
        }
    }

    /// An expression as `a·x + b·y + c` of the player's position; other instances are at their initial positions.
    fn linear(&self, id: ExprId) -> Option<[f64; 3]> {
        let (program, world) = (self.problem.sim.program(), self.problem.sim.world());
        let constant = |c: f64| Some([0.0, 0.0, c]);
        match program.exprs[id] {
            Expr::Number(n) => constant(n),
            Expr::Negate(a) => self.linear(a).map(|a| a.map(|a| -a)),
            Expr::Var(Subject::Slot(slot), var, 0) if slot == self.player => match var {
                VarId::X => Some([1.0, 0.0, 0.0]),
                VarId::Y => Some([0.0, 1.0, 0.0]),
                _ => None,
            },
            Expr::Var(Subject::Slot(slot), var, 0) => constant(world.slots[slot].vars[var][0]),
            Expr::Param(Subject::Slot(slot), param) => constant(world.slots[slot].params[param]),
            Expr::Arithmetic(op, a, b) => {
                let (a, b) = (self.linear(a)?, self.linear(b)?);
                let is_constant = |v: [f64; 3]| v[0] == 0.0 && v[1] == 0.0;
                match op {
                    Arithmetic::Add => Some([a[0] + b[0], a[1] + b[1], a[2] + b[2]]),
                    Arithmetic::Subtract => Some([a[0] - b[0], a[1] - b[1], a[2] - b[2]]),
                    Arithmetic::Multiply if is_constant(b) => Some(a.map(|a| a * b[2])),
                    Arithmetic::Multiply if is_constant(a) => Some(b.map(|b| b * a[2])),
                    Arithmetic::Divide if is_constant(b) && b[2] != 0.0 => Some(a.map(|a| a / b[2])),
                    _ => None,
                }
            }
            _ => None,
        }
    }

    fn value(&self, id: ExprId) -> Option<f64> {
        let [a, b, c] = self.linear(id)?;
        (a == 0.0 && b == 0.0 && c.is_finite()).then_some(c)
    }

    /// A comparison of `a·x + c` or `b·y + c` with 0.
    fn comparison(&self, op: CompareOp, left: ExprId, right: ExprId) -> Option<PositionBox> {
        let (l, r) = (self.linear(left)?, self.linear(right)?);
        let [a, b, c] = [l[0] - r[0], l[1] - r[1], l[2] - r[2]];
        let range = |factor: f64| {
            let at = -c / factor;
            let is_above = matches!(op, CompareOp::Greater | CompareOp::AtLeast) == (factor > 0.0);
            match op {
                CompareOp::Equal => Some((at, at)),
                CompareOp::Unequal => None,
                _ if is_above => Some((at, f64::INFINITY)),
                _ => Some((f64::NEG_INFINITY, at)),
            }
        };
        match (a != 0.0, b != 0.0) {
            (true, false) => range(a).map(|x| PositionBox { x, ..PositionBox::ANYWHERE }),
            (false, true) => range(b).map(|y| PositionBox { y, ..PositionBox::ANYWHERE }),
            _ => None,
        }
    }

    /// The positions at which a collider of the player overlaps something with the tag: a tile, a rectangle, or an
    /// instance at its initial position.
    fn touching(&self, touch: TouchId) -> Option<Vec<PositionBox>> {
        let (program, world) = (self.problem.sim.program(), self.problem.sim.world());
        let entity = &program.entities[world.slots[self.player].entity];
        let touch = entity.touches[touch];
        let wanted = TagSet::of(touch.other);
        let mut targets: Vec<(SpaceId, Bounds)> = Vec::new();
        for (id, space) in world.spaces.pairs() {
            targets.extend(static_boxes(space, wanted, MAX_BOXES).map(|bounds| (id, bounds)));
        }
        for (id, slot) in world.slots.pairs().filter(|(_, s)| s.origin != Origin::Free) {
            let (x, y) = (slot.vars[VarId::X][0], slot.vars[VarId::Y][0]);
            let colliders = program.entities[slot.entity].colliders.iter().filter(|c| c.tags.meets(wanted));
            let boxes = colliders.filter_map(|c| extent(self.problem, id, c));
            targets.extend(boxes.map(|b| {
                (slot.space, Bounds { left: b.left + x, right: b.right + x, bottom: b.bottom + y, top: b.top + y })
            }));
        }
        let mut places = Vec::new();
        for collider in entity.colliders.iter().filter(|c| touch.mine.meets(c.tags)) {
            let mine = extent(self.problem, self.player, collider)?;
            places.extend(targets.iter().flat_map(|(space, target)| {
                let [x, y] = overlapping(&mine, target);
                images(world, PositionBox { space: Some(*space), x, y })
            }));
        }
        places.truncate(MAX_BOXES);
        (!places.is_empty()).then_some(places)
    }
}
