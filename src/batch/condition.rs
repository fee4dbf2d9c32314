//! What ends the runs of a batch, as it is decided for each row after each step: predicates, and the borders of the
//! space. The frequent forms read numbers of the state by their offsets; all others are evaluated as everywhere. Both
//! have the same answer, bit for bit.

use crate::ir::{Bounds, CompareOp, Expr, ExprId, Program, SlotId, Subject, VarId, World, compare};
use crate::sim::{Fault, Simulator};

/// A number at an offset of a state.
#[inline(always)]
fn real(state: &[u8], at: usize) -> f64 {
    // Real numbers are at multiples of 8.
    state.as_chunks().0.get(at / 8).map_or(0.0, |bytes| f64::from_le_bytes(*bytes))
}

/// A predicate of a world.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Condition {
    /// `hero.y < 0`: a variable of a named instance beside a number.
    Variable { at: usize, op: CompareOp, bound: f64 },
    /// `near(hero, (416, 48), 16)`, of a named instance in a world that wraps nowhere.
    Near { of: [usize; 2], point: [f64; 2], radius: f64 },
    /// Any other.
    Other(ExprId),
}

impl Condition {
    /// The condition of an expression of a world.
    pub fn new(program: &Program, world: &World, holds: ExprId) -> Condition {
        let number = |id: ExprId| match program.exprs[id] {
            Expr::Number(number) => Some(number),
            _ => None,
        };
        let offset = |slot: SlotId, var, degree| world.layout.slots[slot].moving_offset(var, degree);
        let wraps = world.spaces.iter().any(|space| space.wraps());
        let simple = || match program.exprs[holds] {
            Expr::Compare(op, a, b) => match program.exprs[a] {
                Expr::Var(Subject::Slot(slot), var, degree) => {
                    Some(Condition::Variable { at: offset(slot, var, degree)?, op, bound: number(b)? })
                }
                _ => None,
            },
            Expr::Near { of: Subject::Slot(slot), x, y, radius } if !wraps => Some(Condition::Near {
                of: [offset(slot, VarId::X, 0)?, offset(slot, VarId::Y, 0)?],
                point: [number(x)?, number(y)?],
                radius: number(radius)?,
            }),
            _ => None,
        };
        simple().unwrap_or(Condition::Other(holds))
    }

    /// Whether it holds in a state.
    ///
    /// # Errors
    /// A [`Fault`] if its evaluation breaks a rule.
    #[inline(always)]
    pub fn holds(&self, sim: &Simulator, state: &[u8]) -> Result<bool, Fault> {
        match *self {
            Condition::Variable { at, op, bound } => Ok(compare(op, real(state, at), bound)),
            Condition::Near { of: [x, y], point, radius } => {
                // As `Simulator::distance` has it.
                let (dx, dy) = (real(state, x) - point[0], real(state, y) - point[1]);
                Ok((dx * dx + dy * dy).sqrt() <= radius)
            }
            Condition::Other(holds) => sim.holds(state, holds),
        }
    }
}

/// How players leave the bounds of their spaces.
#[derive(Debug, Clone, PartialEq)]
pub enum Borders {
    /// A world of one space: for each player, where the state says whether it is there, and its position.
    OneSpace(Option<Bounds>, Vec<(usize, [usize; 2])>),
    /// Players who go from space to space, or who never move.
    Other,
}

impl Borders {
    /// The borders of a world.
    pub fn new(world: &World) -> Borders {
        let player = |slot: SlotId| {
            let layout = &world.layout.slots[slot];
            let at = [layout.moving_offset(VarId::X, 0)?, layout.moving_offset(VarId::Y, 0)?];
            Some((layout.alive_offset(), at))
        };
        let players = || world.players.iter().map(|of| player(of.slot)).collect::<Option<Vec<_>>>();
        let mut spaces = world.spaces.iter();
        match (spaces.next(), spaces.next()) {
            (Some(space), None) => players().map_or(Borders::Other, |all| Borders::OneSpace(space.bounds, all)),
            _ => Borders::Other,
        }
    }

    /// Whether a player has left the bounds of its space, as `Simulator::left_bounds` finds it.
    #[inline(always)]
    pub fn are_left(&self, sim: &Simulator, state: &[u8]) -> bool {
        match self {
            Borders::OneSpace(None, _) => false,
            Borders::OneSpace(Some(bounds), players) => players.iter().any(|&(alive, [x, y])| {
                state.get(alive).is_some_and(|is| *is != 0) && bounds.is_left_at((real(state, x), real(state, y)))
            }),
            Borders::Other => sim.left_bounds(state).is_some(),
        }
    }
}
