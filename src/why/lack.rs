//! What an expression lacks to be true: the fewest parts that would have to change, and how far these are from it.

use crate::ir::{Expr, ExprId, Program};

/// What an expression lacks.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Lack {
    /// The parts that are missing.
    pub parts: Vec<ExprId>,
    /// The sum of their distances.
    pub distance: f64,
}

impl Lack {
    /// What an expression lacks to be true. `truth` gives the truth of a part, which `and`, `or` and `not` join; `apart`
    /// how far the sides of a comparison are apart.
    pub fn of(
        program: &Program,
        id: ExprId,
        truth: &dyn Fn(ExprId) -> Option<bool>,
        apart: &dyn Fn(ExprId) -> Option<f64>,
    ) -> Lack {
        Lack::to_be((program, id), true, truth, apart)
    }

    fn to_be(
        (program, id): (&Program, ExprId),
        wanted: bool,
        truth: &dyn Fn(ExprId) -> Option<bool>,
        apart: &dyn Fn(ExprId) -> Option<f64>,
    ) -> Lack {
        let of = |id| Lack::to_be((program, id), wanted, truth, apart);
        match program.exprs[id] {
            Expr::And(a, b) if wanted => of(a).join(of(b)),
            Expr::And(a, b) => of(a).least(of(b)),
            Expr::Or(a, b) if wanted => of(a).least(of(b)),
            Expr::Or(a, b) => of(a).join(of(b)),
            Expr::Not(a) if matches!(program.exprs[a], Expr::And(..) | Expr::Or(..)) => {
                Lack::to_be((program, a), !wanted, truth, apart)
            }
            _ if truth(id) == Some(wanted) => Lack::default(),
            _ => Lack { parts: vec![id], distance: apart(id).unwrap_or(0.0) },
        }
    }

    fn join(mut self, other: Lack) -> Lack {
        self.parts.extend(other.parts);
        self.distance += other.distance;
        self
    }

    /// Whether it is less than another one: the number of parts is compared first.
    pub fn is_less(&self, other: &Lack) -> bool {
        (self.parts.len(), self.distance) < (other.parts.len(), other.distance)
    }

    fn least(self, other: Lack) -> Lack {
        if other.is_less(&self) { other } else { self }
    }
}
