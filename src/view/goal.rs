//! The region of a goal: the constraints of its predicate on the player's position; and the tags and instances that it
//! names.

use crate::ir::{
    Bounds, CompareOp, Expr, ExprId, Extremes, IdVec, Predicate, Program, SlotId, SpaceId, Subject, TagSet, VarId,
    World,
};

use super::frame::{moved, shared};

/// Every point.
const EVERYWHERE: Bounds =
    Bounds { left: f64::NEG_INFINITY, right: f64::INFINITY, bottom: f64::NEG_INFINITY, top: f64::INFINITY };

/// An area of a goal's region.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Area {
    /// The space; any if none.
    pub space: Option<SpaceId>,
    pub form: Form,
}

/// The shape of an area, px.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Form {
    /// A rectangle, possibly unbounded on some sides.
    Box(Bounds),
    Circle([f64; 2], f64),
}

/// The drawable parts of a goal.
#[derive(Debug, Clone, Default)]
pub(super) struct Goal {
    pub name: String,
    /// The player must be in one of these areas; none if unknown.
    pub areas: Vec<Area>,
    /// The tags that the player must touch.
    pub tags: TagSet,
    /// Other instances that it names.
    pub slots: Vec<SlotId>,
}

impl Goal {
    /// A goal of a world, as far as it is about the first player.
    pub fn new(program: &Program, world: &World, goal: &Predicate, middle: [f64; 2]) -> Goal {
        let name = goal.name.clone();
        let Some(player) = world.players.iter().next().map(|player| player.slot) else {
            return Goal { name, ..Goal::default() };
        };
        let reader = Reader { program, world, player, middle };
        let mut slots: Vec<SlotId> = program
            .with_operands(vec![goal.holds])
            .into_iter()
            .filter_map(|id| match program.exprs[id] {
                Expr::InMode(Subject::Slot(slot), _)
                | Expr::Discrete(Subject::Slot(slot), _)
                | Expr::Var(Subject::Slot(slot), ..)
                | Expr::Near { of: Subject::Slot(slot), .. }
                | Expr::Alive(slot) => Some(slot),
                _ => None,
            })
            .filter(|slot| *slot != player)
            .collect();
        slots.sort_unstable();
        slots.dedup();
        let areas = reader.areas(goal.holds).unwrap_or_default();
        Goal { name, areas, tags: touched(program, world, goal.holds, player), slots }
    }
}

/// The tags that a slot must touch according to a predicate.
pub(super) fn touched(program: &Program, world: &World, predicate: ExprId, slot: SlotId) -> TagSet {
    let touches = &program.entities[world.slots[slot].entity].touches;
    let tags = program.with_operands(vec![predicate]).into_iter().filter_map(|id| match program.exprs[id] {
        Expr::Touching(Subject::Slot(of), touch) if of == slot => touches.get(touch).map(|t| t.other),
        _ => None,
    });
    tags.collect()
}

struct Reader<'a> {
    program: &'a Program,
    world: &'a World,
    player: SlotId,
    /// The offset from the position to the drawn point.
    middle: [f64; 2],
}

impl Reader<'_> {
    /// Areas such that the player is in one of them if the predicate holds; none if the position is unconstrained.
    fn areas(&self, id: ExprId) -> Option<Vec<Area>> {
        let me = Subject::Slot(self.player);
        match self.program.exprs[id] {
            Expr::And(a, b) => match (self.areas(a), self.areas(b)) {
                (Some(a), Some(b)) => Some(a.iter().flat_map(|a| b.iter().filter_map(|b| both(*a, *b))).collect()),
                (a, b) => a.or(b),
            },
            Expr::Or(a, b) => {
                let (mut a, b) = (self.areas(a)?, self.areas(b)?);
                a.extend(b);
                Some(a)
            }
            Expr::InSpace(of, space) if of == me => {
                Some(vec![Area { space: Some(space), form: Form::Box(EVERYWHERE) }])
            }
            Expr::Near { of, x, y, radius } if of == me => {
                let (x, y, radius) = (self.constant(x)?, self.constant(y)?, self.constant(radius)?);
                let at = [x + self.middle[0], y + self.middle[1]];
                Some(vec![Area { space: None, form: Form::Circle(at, radius.greatest(0.0)) }])
            }
            Expr::Compare(op, a, b) => {
                let bounds = self.half_plane(op, a, b)?;
                Some(vec![Area { space: None, form: Form::Box(moved(bounds, self.middle)) }])
            }
            _ => None,
        }
    }

    fn constant(&self, id: ExprId) -> Option<f64> {
        self.program.constant(id, &IdVec::new(), self.world.step)
    }

    fn half_plane(&self, op: CompareOp, a: ExprId, b: ExprId) -> Option<Bounds> {
        let me = Subject::Slot(self.player);
        let axis = |id| match self.program.exprs[id] {
            Expr::Var(of, var, 0) if of == me && var.is_position() => Some(var),
            _ => None,
        };
        let (var, value, turned) = match (axis(a), axis(b)) {
            (Some(var), None) => (var, self.constant(b)?, false),
            (None, Some(var)) => (var, self.constant(a)?, true),
            _ => return None,
        };
        let (low, high) = match (op, turned) {
            (CompareOp::Equal, _) => (value - 0.5, value + 0.5),
            (CompareOp::Unequal, _) => return None,
            (CompareOp::Less | CompareOp::AtMost, false) | (CompareOp::Greater | CompareOp::AtLeast, true) => {
                (f64::NEG_INFINITY, value)
            }
            _ => (value, f64::INFINITY),
        };
        Some(if var == VarId::X {
            Bounds { left: low, right: high, ..EVERYWHERE }
        } else {
            Bounds { bottom: low, top: high, ..EVERYWHERE }
        })
    }
}

/// The intersection of two areas; of a circle and another area, the circle.
fn both(a: Area, b: Area) -> Option<Area> {
    let space = match (a.space, b.space) {
        (Some(a), Some(b)) if a != b => return None,
        (a, b) => a.or(b),
    };
    let form = match (a.form, b.form) {
        (Form::Box(a), Form::Box(b)) => Form::Box(shared(a, b)),
        (circle @ Form::Circle(..), _) | (_, circle) => circle,
    };
    Some(Area { space, form })
}
