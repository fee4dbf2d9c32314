//! What a number can be: a few closed intervals, of which a point is the smallest. Operations on floating-point numbers
//! never decrease when an operand grows, so that the rounded ends of an interval enclose all rounded results.

use std::fmt;

/// A closed interval; `low <= high`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Interval {
    /// Its least number.
    pub low: f64,
    /// Its greatest number.
    pub high: f64,
}

impl Interval {
    /// All numbers.
    pub const ALL: Interval = Interval { low: f64::NEG_INFINITY, high: f64::INFINITY };

    /// One number.
    pub const fn point(x: f64) -> Self {
        Interval { low: x, high: x }
    }

    /// From one number to another, whichever is less.
    pub fn between(a: f64, b: f64) -> Self {
        if a.is_nan() || b.is_nan() { Interval::ALL } else { Interval { low: a.min(b), high: a.max(b) } }
    }

    /// Whether it is one number.
    pub fn is_point(self) -> bool {
        self.low == self.high
    }

    /// Whether a number is in it.
    pub fn contains(self, x: f64) -> bool {
        self.low <= x && x <= self.high
    }

    /// The common part; none if there is none.
    pub fn and(self, other: Interval) -> Option<Interval> {
        let (low, high) = (self.low.max(other.low), self.high.min(other.high));
        (low <= high).then_some(Interval { low, high })
    }

    /// The least interval around both.
    #[must_use]
    pub fn or(self, other: Interval) -> Interval {
        Interval { low: self.low.min(other.low), high: self.high.max(other.high) }
    }

    /// Around the values at the ends of a function that never turns.
    pub(super) fn map(self, f: impl Fn(f64) -> f64) -> Interval {
        Interval::between(f(self.low), f(self.high))
    }

    /// Around the values at the corners of a function of two numbers that never turns in either.
    pub(super) fn corners(self, other: Interval, f: impl Fn(f64, f64) -> f64) -> Interval {
        let with = |b: f64| self.map(|a| f(a, b));
        with(other.low).or(with(other.high))
    }

    pub(super) fn plus(self, other: Interval) -> Interval {
        Interval { low: self.low + other.low, high: self.high + other.high }.sound()
    }

    pub(super) fn minus(self, other: Interval) -> Interval {
        Interval { low: self.low - other.high, high: self.high - other.low }.sound()
    }

    pub(super) fn times(self, other: Interval) -> Interval {
        // Nothing times as much as one likes is nothing.
        self.corners(other, |a, b| if a == 0.0 || b == 0.0 { 0.0 } else { a * b })
    }

    /// Of a number with itself.
    pub(super) fn square(self) -> Interval {
        let (a, b) = (self.low * self.low, self.high * self.high);
        if self.contains(0.0) { Interval { low: 0.0, high: a.max(b) } } else { Interval::between(a, b) }
    }

    fn sound(self) -> Interval {
        let low = if self.low.is_nan() { f64::NEG_INFINITY } else { self.low };
        let high = if self.high.is_nan() { f64::INFINITY } else { self.high };
        Interval { low, high }
    }
}

impl fmt::Display for Interval {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.is_point() {
            return write!(f, "{}", Short(self.low));
        }
        match (self.low == f64::NEG_INFINITY, self.high == f64::INFINITY) {
            (true, true) => f.write_str("any"),
            (true, false) => write!(f, "..{}", Short(self.high)),
            (false, true) => write!(f, "{}..", Short(self.low)),
            (false, false) => write!(f, "{}..{}", Short(self.low), Short(self.high)),
        }
    }
}

/// A number with at most three digits after the point.
struct Short(f64);

impl fmt::Display for Short {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let text = format!("{:.3}", self.0);
        let text = text.trim_end_matches('0').trim_end_matches('.');
        f.write_str(if text == "-0" { "0" } else { text })
    }
}

/// The most intervals that are kept apart.
const MOST: usize = 8;

/// What a number can be: disjoint intervals in order; none if there is no such number.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Values(Vec<Interval>);

impl Values {
    /// All numbers.
    pub fn all() -> Self {
        Values(vec![Interval::ALL])
    }

    /// One number.
    pub fn point(x: f64) -> Self {
        Values(vec![Interval::point(x)])
    }

    /// No number.
    pub fn none() -> Self {
        Values::default()
    }

    /// Any of some intervals.
    pub fn any(intervals: impl IntoIterator<Item = Interval>) -> Self {
        let mut all: Vec<Interval> = intervals.into_iter().collect();
        all.sort_by(|a, b| a.low.total_cmp(&b.low).then(a.high.total_cmp(&b.high)));
        let mut out: Vec<Interval> = Vec::with_capacity(all.len());
        for next in all {
            match out.last_mut() {
                Some(last) if next.low <= last.high => last.high = last.high.max(next.high),
                _ => out.push(next),
            }
        }
        if out.len() > MOST {
            // The widest gaps stay.
            let mut gaps: Vec<(f64, usize)> = (1..out.len()).map(|at| (out[at].low - out[at - 1].high, at)).collect();
            gaps.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
            gaps.truncate(MOST - 1);
            let mut cuts: Vec<usize> = gaps.into_iter().map(|(_, at)| at).collect();
            cuts.sort_unstable();
            let ends = cuts.iter().copied().chain([out.len()]);
            let starts = std::iter::once(0).chain(cuts.iter().copied());
            out = starts.zip(ends).map(|(from, to)| Interval { low: out[from].low, high: out[to - 1].high }).collect();
        }
        Values(out)
    }

    /// The intervals in order.
    pub fn intervals(&self) -> &[Interval] {
        &self.0
    }

    /// Whether there is no such number.
    pub fn is_none(&self) -> bool {
        self.0.is_empty()
    }

    /// The number, if there is only one.
    pub fn constant(&self) -> Option<f64> {
        match self.0.as_slice() {
            [only] if only.is_point() => Some(only.low),
            _ => None,
        }
    }

    /// The least interval around them; none if there is no number.
    pub fn hull(&self) -> Option<Interval> {
        Some(Interval { low: self.0.first()?.low, high: self.0.last()?.high })
    }

    /// Whether a number is one of them.
    pub fn contains(&self, x: f64) -> bool {
        self.0.iter().any(|i| i.contains(x))
    }

    /// Whether all of them are among others.
    pub fn is_within(&self, others: &Values) -> bool {
        self.0.iter().all(|a| others.0.iter().any(|b| b.low <= a.low && a.high <= b.high))
    }

    /// Those of both.
    #[must_use]
    pub fn or(&self, other: &Values) -> Values {
        Values::any(self.0.iter().chain(&other.0).copied())
    }

    /// Those in both.
    #[must_use]
    pub fn and(&self, other: &Values) -> Values {
        Values::any(self.0.iter().flat_map(|a| other.0.iter().filter_map(|b| a.and(*b))))
    }

    /// Those in an interval.
    #[must_use]
    pub fn within(&self, interval: Interval) -> Values {
        Values(self.0.iter().filter_map(|a| a.and(interval)).collect())
    }

    /// Without a number, where that leaves an interval closed.
    #[must_use]
    pub fn without(&self, x: f64) -> Values {
        Values(self.0.iter().copied().filter(|i| !(i.is_point() && i.low == x)).collect())
    }

    /// What a function makes of them.
    #[must_use]
    pub(super) fn map(&self, f: impl Fn(Interval) -> Interval) -> Values {
        Values::any(self.0.iter().map(|i| f(*i)))
    }

    /// What a function makes of all pairs.
    #[must_use]
    pub(super) fn pairs(&self, other: &Values, f: impl Fn(Interval, Interval) -> Interval) -> Values {
        Values::any(self.0.iter().flat_map(|a| other.0.iter().map(|b| f(*a, *b)).collect::<Vec<_>>()))
    }
}

impl From<Interval> for Values {
    fn from(interval: Interval) -> Self {
        Values(vec![interval])
    }
}

impl fmt::Display for Values {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.0.as_slice() {
            [] => f.write_str("none"),
            [only] => write!(f, "{only}"),
            several => {
                for (index, interval) in several.iter().enumerate() {
                    let between = if index == 0 { "" } else { ", " };
                    write!(f, "{between}{interval}")?;
                }
                Ok(())
            }
        }
    }
}
