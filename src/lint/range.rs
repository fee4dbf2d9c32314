//! Intervals of the values of a term, from the text alone: literals, the ranges of discrete variables, clocks that
//! never run backwards, axes, and the guard's comparisons.

use crate::ir::{Arithmetic, CompareOp, Extremes, Function, Subject};

use crate::sema::checked::{Entity, Term, TermKind, Type};

use super::terms::same;

/// An interval from `low` to `high`; either end may be open.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Range {
    pub low: f64,
    pub high: f64,
    /// Whether `low` is excluded.
    pub above: bool,
    /// Whether `high` is excluded.
    pub below: bool,
}

impl Range {
    pub const ALL: Range = Range::closed(f64::NEG_INFINITY, f64::INFINITY);

    pub const fn closed(low: f64, high: f64) -> Self {
        Range { low, high, above: false, below: false }
    }

    /// The values that satisfy `op value` for some value of a range.
    fn compared(op: CompareOp, with: Range) -> Self {
        let up_to = |open| Range { high: with.high, below: open || with.below, ..Range::ALL };
        let from = |open| Range { low: with.low, above: open || with.above, ..Range::ALL };
        match op {
            CompareOp::Equal => with,
            CompareOp::Unequal => Range::ALL,
            CompareOp::Less => up_to(true),
            CompareOp::AtMost => up_to(false),
            CompareOp::Greater => from(true),
            CompareOp::AtLeast => from(false),
        }
    }

    /// The range of the whole numbers within it.
    fn whole(self) -> Self {
        let low = if self.above { self.low.floor() + 1.0 } else { self.low.ceil() };
        let high = if self.below { self.high.ceil() - 1.0 } else { self.high.floor() };
        Range::closed(low, high)
    }

    pub fn and(self, other: Range) -> Self {
        let (low, above) = match self.low.total_cmp(&other.low) {
            std::cmp::Ordering::Less => (other.low, other.above),
            std::cmp::Ordering::Greater => (self.low, self.above),
            std::cmp::Ordering::Equal => (self.low, self.above || other.above),
        };
        let (high, below) = match self.high.total_cmp(&other.high) {
            std::cmp::Ordering::Less => (self.high, self.below),
            std::cmp::Ordering::Greater => (other.high, other.below),
            std::cmp::Ordering::Equal => (self.high, self.below || other.below),
        };
        Range { low, high, above, below }
    }

    fn or(self, other: Range) -> Self {
        Range::closed(self.low.least(other.low), self.high.greatest(other.high))
    }

    pub fn is_empty(self) -> bool {
        self.low > self.high || (self.low == self.high && (self.above || self.below))
    }

    /// Whether it is a subset of another one.
    pub fn is_within(self, other: Range) -> bool {
        self.and(other) == self
    }

    fn is_point(self) -> bool {
        self.low == self.high && !self.is_empty()
    }

    /// The closed range around the images of both ends.
    fn map(self, f: impl Fn(f64) -> f64) -> Self {
        let (a, b) = (f(self.low), f(self.high));
        Range::hull([a, b])
    }

    /// The hull of the images of all pairs of ends; unknown if one is undefined.
    fn pairs(self, other: Range, f: impl Fn(f64, f64) -> f64) -> Self {
        let (a, b) = (self, other);
        Range::hull([f(a.low, b.low), f(a.low, b.high), f(a.high, b.low), f(a.high, b.high)])
    }

    fn hull<const N: usize>(values: [f64; N]) -> Self {
        if values.iter().any(|v| v.is_nan()) {
            return Range::ALL;
        }
        let (low, high) =
            values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), &v| (l.least(v), h.greatest(v)));
        Range::closed(low, high)
    }
}

/// A constraint of a guard on a number.
#[derive(Clone, Copy)]
pub(super) struct Fact<'t> {
    pub of: &'t Term,
    pub range: Range,
}

/// The values of a term under some facts.
pub(super) fn range(entity: &Entity, term: &Term, facts: &[Fact<'_>]) -> Range {
    let of = |term: &Term| range(entity, term, facts);
    let plain = match &term.kind {
        TermKind::Number(n) => Range::closed(*n, *n),
        TermKind::Quantity(quantity) => Range::closed(quantity.0, quantity.0),
        TermKind::Frames(n) if *n > 0.0 => Range { low: 0.0, above: true, ..Range::ALL },
        TermKind::Discrete(Subject::Me, id) => {
            let (low, high) = entity.discretes[*id].range;
            Range::closed(f64::from(low), f64::from(high))
        }
        TermKind::Axis(_) => Range::closed(-1.0, 1.0),
        TermKind::Chance(id) => {
            let (low, high) = entity.chances[*id].range;
            Range::closed(f64::from(low), f64::from(high))
        }
        TermKind::Timer(_) | TermKind::Members(_) | TermKind::Distance(_) => Range::closed(0.0, f64::INFINITY),
        TermKind::Negate(a) => of(a).map(|x| -x),
        TermKind::Arithmetic(op, sides) => {
            let [a, b] = sides.as_ref();
            let (a, b) = (of(a), of(b));
            match op {
                Arithmetic::Add => a.pairs(b, |a, b| a + b),
                Arithmetic::Subtract => a.pairs(b, |a, b| a - b),
                // Zero times infinity is zero: infinite ends stand for large numbers.
                Arithmetic::Multiply => a.pairs(b, |a, b| if a == 0.0 || b == 0.0 { 0.0 } else { a * b }),
                Arithmetic::Divide if b.low > 0.0 || b.high < 0.0 => a.pairs(b, |a, b| a / b),
                Arithmetic::Divide => Range::ALL,
            }
        }
        TermKind::Call(call) => called(entity, call.0, &call.1, facts),
        TermKind::Bool(_)
        | TermKind::Compare(..)
        | TermKind::And(..)
        | TermKind::Or(..)
        | TermKind::Not(_)
        | TermKind::Button(..) => Range::closed(0.0, 1.0),
        _ => Range::ALL,
    };
    let known = facts.iter().filter(|f| same(f.of, term));
    let found = known.fold(plain, |range, fact| range.and(fact.range));
    if is_whole(&term.ty) { found.whole() } else { found }
}

fn is_whole(ty: &Type) -> bool {
    matches!(ty, Type::Int | Type::Set(_))
}

fn called(entity: &Entity, function: Function, arguments: &[Term], facts: &[Fact<'_>]) -> Range {
    let of = |index: usize| arguments.get(index).map_or(Range::ALL, |a| range(entity, a, facts));
    let (a, b, c) = (of(0), of(1), of(2));
    let least = |a: Range, b: Range| Range::closed(a.low.least(b.low), a.high.least(b.high));
    let greatest = |a: Range, b: Range| Range::closed(a.low.greatest(b.low), a.high.greatest(b.high));
    match function {
        Function::Min => least(a, b),
        Function::Max => greatest(a, b),
        Function::Clamp => least(greatest(a, b), c),
        Function::Abs if a.low <= 0.0 && a.high >= 0.0 => Range::closed(0.0, a.high.greatest(-a.low)),
        Function::Abs => a.map(f64::abs),
        Function::Sign => a.map(|x| if x == 0.0 { 0.0 } else { x.signum() }),
        Function::Floor => a.map(f64::floor),
        Function::Ceil => a.map(f64::ceil),
        Function::Round => a.map(f64::round),
        Function::Sqrt => Range::closed(0.0, f64::INFINITY),
        Function::Sin | Function::Cos => Range::closed(-1.0, 1.0),
        Function::Atan2 => Range::closed(-4.0, 4.0),
        Function::Mod if b.low > 0.0 => Range { low: 0.0, high: b.high, above: false, below: true },
        Function::Mod if b.high < 0.0 => Range { low: b.low, high: 0.0, above: true, below: false },
        Function::Mod => Range::ALL,
        Function::If => b.or(c),
    }
}

/// The constraint of a comparison on one of its sides, if the other is a known number.
pub(super) fn fact<'t>(entity: &Entity, term: &'t Term) -> Option<Fact<'t>> {
    let (op, a, b) = match &term.kind {
        TermKind::Compare(op, sides) => {
            let [a, b] = sides.as_ref();
            (*op, a, b)
        }
        TermKind::Not(inner) => match &inner.kind {
            TermKind::Compare(op, sides) => {
                let [a, b] = sides.as_ref();
                (op.negated(), a, b)
            }
            _ => return None,
        },
        _ => return None,
    };
    let (left, right) = (range(entity, a, &[]), range(entity, b, &[]));
    let (of, op, with): (&Term, _, _) = if right.is_point() {
        (a, op, right)
    } else if left.is_point() {
        (b, op.mirrored(), left)
    } else {
        return None;
    };
    let range = Range::compared(op, with);
    let range = if is_whole(&of.ty) { range.whole() } else { range };
    (range != Range::ALL).then_some(Fact { of, range })
}

/// All constraints of a guard on numbers.
pub(super) fn facts<'t>(entity: &Entity, guard: &'t Term) -> Vec<Fact<'t>> {
    let mut out = Vec::new();
    let mut open = vec![guard];
    while let Some(term) = open.pop() {
        match &term.kind {
            TermKind::And(sides) => open.extend(sides.iter()),
            _ => out.extend(fact(entity, term)),
        }
    }
    out
}
