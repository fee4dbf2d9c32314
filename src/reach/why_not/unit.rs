//! Units of distances: px, px/s, s, rooms, or none where the program does not tell.

use crate::ir::{Arithmetic, Expr, ExprId, Function, Program, VarId};

/// A unit: powers of px and s.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Unit {
    px: i8,
    s: i8,
    count: Count,
}

/// What is counted, of what has no dimension.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Count {
    Things,
    Rooms,
    Edges,
}

impl Unit {
    /// Counts, and what is not known.
    pub const NONE: Unit = Unit { px: 0, s: 0, count: Count::Things };
    /// Lengths.
    pub const PX: Unit = Unit { px: 1, s: 0, count: Count::Things };
    /// Durations.
    const S: Unit = Unit { px: 0, s: 1, count: Count::Things };
    /// Rooms on a way.
    pub const ROOMS: Unit = Unit { px: 0, s: 0, count: Count::Rooms };
    /// Edges on a way.
    pub const EDGES: Unit = Unit { px: 0, s: 0, count: Count::Edges };

    /// What 1 of it counts as, in tiles of 16 px.
    pub fn weight(self) -> f64 {
        match (self.px, self.s) {
            (1, 0) => 1.0 / 16.0,
            (1, -1) => 1.0 / 60.0,
            (1, -2) => 1.0 / 600.0,
            (0, 1) => 4.0,
            _ => 1.0,
        }
    }

    /// How it is written after a number; empty if there is none.
    pub fn name(self) -> String {
        let power = |n: i8| if n == 1 { String::new() } else { format!("^{n}") };
        match (self.px, self.s) {
            _ if self.count == Count::Rooms => "rooms".to_string(),
            _ if self.count == Count::Edges => "edges".to_string(),
            (0, 0) => String::new(),
            (0, s @ 1..) => format!("s{}", power(s)),
            (px, 0) => format!("px{}", power(px)),
            (0, s) => format!("1/s{}", power(-s)),
            (px, s @ ..0) => format!("px{}/s{}", power(px), power(-s)),
            (px, s) => format!("px{}*s{}", power(px), power(s)),
        }
    }

    /// Whether it is a duration.
    pub fn is_time(self) -> bool {
        self == Unit::S
    }

    /// It, or if it is none the other one.
    pub fn or(self, other: Unit) -> Unit {
        if self == Unit::NONE { other } else { self }
    }

    fn times(self, other: Unit, sign: i8) -> Unit {
        Unit {
            px: self.px.saturating_add(other.px.saturating_mul(sign)),
            s: self.s.saturating_add(other.s.saturating_mul(sign)),
            count: Count::Things,
        }
    }
}

/// The unit of an expression, as far as positions and timers tell it.
pub(super) fn unit_of(program: &Program, id: ExprId) -> Unit {
    let of = |id| unit_of(program, id);
    match program.exprs[id] {
        Expr::Var(_, VarId::X | VarId::Y, degree) => Unit { px: 1, s: -(degree as i8), count: Count::Things },
        Expr::Distance { .. } => Unit::PX,
        Expr::Timer(_) | Expr::Frames(_) => Unit::S,
        Expr::Negate(a) => of(a),
        Expr::Arithmetic(Arithmetic::Add | Arithmetic::Subtract, a, b) => of(a).or(of(b)),
        Expr::Arithmetic(Arithmetic::Multiply, a, b) => of(a).times(of(b), 1),
        Expr::Arithmetic(Arithmetic::Divide, a, b) => of(a).times(of(b), -1),
        Expr::Call(Function::Min | Function::Max | Function::Mod | Function::Clamp, [a, b, _]) => of(a).or(of(b)),
        Expr::Call(Function::Abs | Function::Floor | Function::Ceil | Function::Round, [a, ..]) => of(a),
        Expr::Call(Function::If, [_, a, b]) => of(a).or(of(b)),
        _ => Unit::NONE,
    }
}
