//! The positions of a player at which a goal can hold, derived from its predicate: boxes per space. The distance field
//! (`distance.rs`) starts from those that lead to the goal: it also follows the guards of the edges into a mode that the
//! goal asks for, and what is not a player but moves, such as a crate that has to stand on a plate.

use std::cell::Cell;

use crate::analysis::ConfigurationSpace;
use crate::ir::{
    Arithmetic, Bounds, Collider, CompareOp, Expr, ExprId, Extremes, LeafId, ModeId, Origin, SlotId, Space, SpaceId,
    Subject, TagSet, TouchId, VarId,
};

use super::around::images;
use super::outcome::Visited;
use super::problem::Problem;
use super::subgoals::{Fact, Subgoal};

/// Maximum number of boxes per goal.
const MAX_BOXES: usize = 4096;
/// Maximum number of edges in a row that are followed back from a goal, and of guards that are read for it.
const MAX_EDGES: u8 = 4;
const MAX_GUARDS: u32 = 10_000;

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
        let places = Finder { problem, player, back: None, owner: None }.places(problem.predicate())?;
        Some((player, places))
    })
}

/// Where somebody has to be for the goal to come about.
pub(super) struct Lead {
    /// Who: the first player of whom that is known, else the first other instance that moves.
    pub slot: SlotId,
    /// The positions; none if they are not known, but what has to come about before is.
    pub boxes: Vec<PositionBox>,
    /// Whether the goal holds only with the player there; else the positions are those from which an edge leads on.
    pub is_goal: bool,
    /// What has to come about before, in this order.
    pub before: Vec<Subgoal>,
}

/// What leads to the goal; `None` if that depends on nobody's position.
pub(super) fn lead(problem: &Problem<'_>, space: &ConfigurationSpace) -> Option<Lead> {
    let guards = Cell::new(MAX_GUARDS);
    let finder = |player: SlotId| {
        let back = Some(Back { space, edges: MAX_EDGES, guards: &guards });
        Finder { problem, player, back, owner: None }
    };
    let goal = problem.predicate();
    if let Some((slot, boxes)) = goal_positions(problem) {
        return Some(Lead { slot, boxes, is_goal: true, before: finder(slot).subgoals(goal) });
    }
    let players = || problem.players().iter().copied();
    let is_other = |slot: &SlotId| !problem.players().contains(slot) && is_moving(problem, space, *slot);
    let others = problem.sim.world().slots.ids().filter(is_other);
    let to_edges = players().chain(others).find_map(|slot| {
        let boxes = finder(slot).places(goal).filter(|boxes| !boxes.is_empty())?;
        let mut before = if problem.players().contains(&slot) { finder(slot).subgoals(goal) } else { Vec::new() };
        before.retain(|subgoal| !subgoal.is_last_mode());
        Some(Lead { slot, boxes, is_goal: false, before })
    });
    to_edges.or_else(|| {
        players().find_map(|slot| {
            let mut before = finder(slot).subgoals(goal);
            let boxes = before.pop()?.boxes;
            (!boxes.is_empty() || !before.is_empty()).then_some(Lead { slot, boxes, is_goal: false, before })
        })
    })
}

/// What has to come about for a fact, itself the last, with where a player makes it so.
pub(super) fn subgoals_of(
    problem: &Problem<'_>,
    space: &ConfigurationSpace,
    player: SlotId,
    fact: Fact,
) -> Vec<Subgoal> {
    let guards = Cell::new(MAX_GUARDS);
    let back = Some(Back { space, edges: MAX_EDGES, guards: &guards });
    Finder { problem, player, back, owner: None }.subgoals_of(fact)
}

/// Whether an instance that is there at first may be elsewhere later.
pub(super) fn is_moving(problem: &Problem<'_>, space: &ConfigurationSpace, slot: SlotId) -> bool {
    let (world, known) = (problem.sim.world(), &space.slots[slot]);
    let is_away = |var: VarId| {
        let at = world.slots[slot].vars[var][0];
        known.configurations.iter().flat_map(|c| c.vars[var][0].intervals()).any(|v| v.low < at || v.high > at)
    };
    world.slots[slot].origin != Origin::Free && (known.is_given_up || VarId::XY.into_iter().any(is_away))
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

/// How far edges are followed back.
#[derive(Clone, Copy)]
pub(super) struct Back<'a> {
    space: &'a ConfigurationSpace,
    /// How many edges, and how many guards may still be read.
    edges: u8,
    pub guards: &'a Cell<u32>,
}

/// Finds positions, and what else has to come about (`subgoals.rs`).
pub(super) struct Finder<'a> {
    pub problem: &'a Problem<'a>,
    /// Whose positions are looked for.
    pub player: SlotId,
    /// Whether what the guards of edges ask for counts, too.
    pub back: Option<Back<'a>>,
    /// The instance of which the expression is part; none of a predicate of the world.
    pub owner: Option<SlotId>,
}

impl Finder<'_> {
    /// Boxes of which the player must be in one for an expression to hold; `None` if it is unrestricted.
    pub fn places(&self, id: ExprId) -> Option<Vec<PositionBox>> {
        let is_mine = |of: Subject| self.slot(of) == Some(self.player);
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
            Expr::Touching(of, touch) => self.touched_by(self.slot(of)?, touch),
            Expr::InMode(of, mode) => self.entering(self.slot(of)?, mode),
            _ => None,
        }
    }

    /// Whose instance it is at first.
    pub fn slot(&self, subject: Subject) -> Option<SlotId> {
        match subject {
            Subject::Slot(slot) => Some(slot),
            Subject::Me => self.owner,
            Subject::Ref(id) => self.problem.sim.world().slots[self.owner?].refs.get(id).copied().flatten(),
            _ => None,
        }
    }

    /// The positions from which edges lead into a mode.
    fn entering(&self, slot: SlotId, mode: ModeId) -> Option<Vec<PositionBox>> {
        let entity = &self.problem.sim.program().entities[self.problem.sim.world().slots[slot].entity];
        let leaves: Vec<LeafId> = entity.modes.get(mode)?.leaves.ids().collect();
        self.leading_into(slot, &leaves)
    }

    /// The positions from which edges lead to some leaves; `None` if there is an edge of which that is not known.
    pub fn leading_into(&self, slot: SlotId, wanted: &[LeafId]) -> Option<Vec<PositionBox>> {
        let back = self.back.filter(|back| back.edges > 0)?;
        let (program, world) = (self.problem.sim.program(), self.problem.sim.world());
        let entity = &program.entities[world.slots[slot].entity];
        let enters = |mode: ModeId| entity.enterable(mode).ids().any(|leaf| wanted.contains(&leaf));
        let mut first = entity.groups.iter().flat_map(|g| g.choices.iter().map(|c| c.mode).chain([g.first]));
        if first.any(enters) {
            return None;
        }
        let before = Finder { back: Some(Back { edges: back.edges - 1, ..back }), owner: Some(slot), ..*self };
        let mut all = Vec::new();
        for (leaf, from) in entity.leaves.pairs().filter(|(leaf, _)| !wanted.contains(leaf)) {
            for edge in from.edges.iter().map(|edge| &entity.edges[*edge]) {
                if !edge.target.is_some_and(enters) {
                    continue;
                }
                back.guards.set(back.guards.get().checked_sub(1)?);
                all.extend(match before.places(edge.guard) {
                    Some(places) => places,
                    None => before.leading_into(slot, &[leaf])?,
                });
            }
        }
        all.truncate(MAX_BOXES);
        (!all.is_empty()).then_some(all)
    }

    /// The positions at which a still instance touches a collider of the player.
    fn touched_by(&self, other: SlotId, touch: TouchId) -> Option<Vec<PositionBox>> {
        let back = self.back?;
        let (program, world) = (self.problem.sim.program(), self.problem.sim.world());
        let entity = &program.entities[world.slots[other].entity];
        let touch = entity.touches.get(touch)?;
        if world.slots[other].origin == Origin::Free || is_moving(self.problem, back.space, other) {
            return None;
        }
        let at = (world.slots[other].vars[VarId::X][0], world.slots[other].vars[VarId::Y][0]);
        let theirs = entity.colliders.iter().filter(|c| c.tags.meets(touch.mine));
        let theirs: Vec<Bounds> = theirs.map(|c| extent(self.problem, other, c)).collect::<Option<_>>()?;
        let wanted = TagSet::of(touch.other);
        let mine = program.entities[world.slots[self.player].entity].colliders.iter();
        let mine = mine.filter(|c| c.tags.meets(wanted) && self.is_paired(c.tags, touch.mine));
        let mut places = Vec::new();
        for collider in mine {
            let mine = extent(self.problem, self.player, collider)?;
            places.extend(theirs.iter().flat_map(|b| {
                let [x, y] = overlapping(&mine, &b.placed(at));
                images(world, PositionBox { space: Some(world.slots[other].space), x, y })
            }));
        }
        (!places.is_empty()).then_some(places)
    }

    /// Whether a body is ever in contact with something that has one of some tags: the world pairs it with that, or with
    /// what that is besides.
    fn is_paired(&self, body: TagSet, wanted: TagSet) -> bool {
        let (program, world) = (self.problem.sim.program(), self.problem.sim.world());
        let kinds = world.spaces.iter().flat_map(|space| &space.map).flat_map(|map| &map.kinds);
        let tiles = kinds.map(|kind| kind.tags.iter().copied().collect::<TagSet>());
        let solids = world.spaces.iter().flat_map(|space| &space.solids).map(|solid| solid.tags);
        let colliders =
            program.entities.iter().flat_map(|entity| entity.colliders.iter()).map(|collider| collider.tags);
        let mut all = tiles.chain(solids).chain(colliders).filter(|tags| tags.meets(wanted));
        all.any(|tags| world.meeting(body, tags).is_some())
    }

    /// An expression as `a·x + b·y + c` of the player's position; other instances are at their initial positions.
    fn linear(&self, id: ExprId) -> Option<[f64; 3]> {
        let (program, world) = (self.problem.sim.program(), self.problem.sim.world());
        let constant = |c: f64| Some([0.0, 0.0, c]);
        match program.exprs[id] {
            Expr::Number(n) => constant(n),
            Expr::Negate(a) => self.linear(a).map(|a| a.map(|a| -a)),
            Expr::Var(of, var, 0) => match (self.slot(of)?, var) {
                (slot, VarId::X) if slot == self.player => Some([1.0, 0.0, 0.0]),
                (slot, VarId::Y) if slot == self.player => Some([0.0, 1.0, 0.0]),
                (slot, _) if slot == self.player => None,
                (slot, var) => constant(world.slots[slot].vars.get(var)?[0]),
            },
            Expr::Param(of, param) => constant(*world.slots[self.slot(of)?].params.get(param)?),
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
        let touch = entity.touches.get(touch)?;
        let wanted = TagSet::of(touch.other);
        let mut targets: Vec<(SpaceId, Bounds)> = Vec::new();
        for (id, space) in world.spaces.pairs() {
            targets.extend(static_boxes(space, wanted, MAX_BOXES).map(|bounds| (id, bounds)));
        }
        for (id, slot) in world.slots.pairs().filter(|(_, s)| s.origin != Origin::Free) {
            let at = (slot.vars[VarId::X][0], slot.vars[VarId::Y][0]);
            let colliders = program.entities[slot.entity].colliders.iter().filter(|c| c.tags.meets(wanted));
            let boxes = colliders.filter_map(|c| extent(self.problem, id, c));
            targets.extend(boxes.map(|b| (slot.space, b.placed(at))));
        }
        let mut places = Vec::new();
        for collider in entity.colliders.iter().filter(|c| touch.mine.meets(c.tags) && self.is_paired(c.tags, wanted)) {
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
