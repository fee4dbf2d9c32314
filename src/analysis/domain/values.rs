//! Sets of numbers as a few closed intervals (a point is an interval). Floating-point operations are monotonic, so the
//! rounded ends of an interval enclose all rounded results.

use crate::ir::Extremes;

use std::fmt;

/// A closed interval; `low <= high`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Interval {
    /// The lower end.
    pub low: f64,
    /// The upper end.
    pub high: f64,
}

impl Interval {
    /// All numbers.
    pub const ALL: Interval = Interval { low: f64::NEG_INFINITY, high: f64::INFINITY };

    /// One number.
    pub const fn point(x: f64) -> Self {
        Interval { low: x, high: x }
    }

    /// The interval between two numbers, in either order.
    pub fn between(a: f64, b: f64) -> Self {
        if a.is_nan() || b.is_nan() { Interval::ALL } else { Interval { low: a.least(b), high: a.greatest(b) } }
    }

    /// Whether the interval is a single number.
    pub fn is_point(self) -> bool {
        self.low == self.high
    }

    /// Whether the interval contains a number.
    pub fn contains(self, x: f64) -> bool {
        self.low <= x && x <= self.high
    }

    /// The intersection, if it is not empty.
    pub fn and(self, other: Interval) -> Option<Interval> {
        let (low, high) = (self.low.greatest(other.low), self.high.least(other.high));
        (low <= high).then_some(Interval { low, high })
    }

    /// The smallest interval that contains both.
    #[must_use]
    pub fn or(self, other: Interval) -> Interval {
        Interval { low: self.low.least(other.low), high: self.high.greatest(other.high) }
    }

    /// The image under a monotonic function.
    pub(in crate::analysis) fn map(self, f: impl Fn(f64) -> f64) -> Interval {
        Interval::between(f(self.low), f(self.high))
    }

    /// The image under a function that is monotonic in both arguments.
    pub(in crate::analysis) fn corners(self, other: Interval, f: impl Fn(f64, f64) -> f64) -> Interval {
        let with = |b: f64| self.map(|a| f(a, b));
        with(other.low).or(with(other.high))
    }

    /// The minimum of two numbers.
    pub(in crate::analysis) fn least(self, other: Interval) -> Interval {
        Interval { low: self.low.least(other.low), high: self.high.least(other.high) }
    }

    /// The maximum of two numbers.
    pub(in crate::analysis) fn greatest(self, other: Interval) -> Interval {
        Interval { low: self.low.greatest(other.low), high: self.high.greatest(other.high) }
    }

    pub(in crate::analysis) fn plus(self, other: Interval) -> Interval {
        Interval { low: self.low + other.low, high: self.high + other.high }.sound()
    }

    pub(in crate::analysis) fn minus(self, other: Interval) -> Interval {
        Interval { low: self.low - other.high, high: self.high - other.low }.sound()
    }

    pub(in crate::analysis) fn times(self, other: Interval) -> Interval {
        // 0 times infinity is 0: infinite ends stand for arbitrarily large finite numbers.
        self.corners(other, |a, b| if a == 0.0 || b == 0.0 { 0.0 } else { a * b })
    }

    /// The square of one number, unlike `self.times(self)`.
    pub(in crate::analysis) fn square(self) -> Interval {
        let (a, b) = (self.low * self.low, self.high * self.high);
        if self.contains(0.0) { Interval { low: 0.0, high: a.greatest(b) } } else { Interval::between(a, b) }
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

/// Maximum number of intervals in a set.
const MAX_INTERVALS: usize = 8;

/// A set of numbers: disjoint intervals in order.
#[derive(Clone, Copy)]
pub struct Values {
    len: u8,
    items: [Interval; MAX_INTERVALS],
}

impl Values {
    /// All numbers.
    pub const fn all() -> Self {
        Values::one(Interval::ALL)
    }

    /// One number.
    pub const fn point(x: f64) -> Self {
        Values::one(Interval::point(x))
    }

    /// The numbers of a discrete variable's range.
    pub(in crate::analysis) fn range((low, high): (i32, i32)) -> Self {
        Values::from(Interval { low: f64::from(low), high: f64::from(high) })
    }

    const fn one(interval: Interval) -> Self {
        Values { len: 1, items: [interval; MAX_INTERVALS] }
    }

    /// No number.
    pub const fn none() -> Self {
        Values { len: 0, items: [Interval::point(0.0); MAX_INTERVALS] }
    }

    /// The union of some intervals.
    pub fn any(intervals: impl IntoIterator<Item = Interval>) -> Self {
        let mut union = Union::new();
        for interval in intervals {
            union.add(interval);
        }
        union.values()
    }

    /// The intervals in order.
    pub fn intervals(&self) -> &[Interval] {
        self.items.get(..usize::from(self.len)).unwrap_or(&self.items)
    }

    /// Whether the set is empty.
    pub fn is_none(&self) -> bool {
        self.len == 0
    }

    /// The number, if the set is a single one.
    pub fn constant(&self) -> Option<f64> {
        match self.intervals() {
            [only] if only.is_point() => Some(only.low),
            _ => None,
        }
    }

    /// The smallest interval that contains the set, if the set is not empty.
    pub fn hull(&self) -> Option<Interval> {
        Some(Interval { low: self.intervals().first()?.low, high: self.intervals().last()?.high })
    }

    /// Whether the set contains a number.
    pub fn contains(&self, x: f64) -> bool {
        self.intervals().iter().any(|i| i.contains(x))
    }

    /// Whether the set is a subset of another.
    pub fn is_within(&self, others: &Values) -> bool {
        self.intervals().iter().all(|a| others.intervals().iter().any(|b| b.low <= a.low && a.high <= b.high))
    }

    /// The union.
    #[must_use]
    pub fn or(&self, other: &Values) -> Values {
        if self.is_within(other) {
            return *other;
        }
        if other.is_within(self) {
            return *self;
        }
        if let ([a], [b]) = (self.intervals(), other.intervals()) {
            let (a, b) = if a.low <= b.low { (*a, *b) } else { (*b, *a) };
            return if b.low <= a.high { Values::one(a.or(b)) } else { Values::two(a, b) };
        }
        Values::any(self.intervals().iter().chain(other.intervals()).copied())
    }

    /// Two intervals with a gap between them, in order.
    fn two(a: Interval, b: Interval) -> Values {
        let mut out = Values { len: 2, items: [b; MAX_INTERVALS] };
        out.items[0] = a;
        out
    }

    /// The intersection.
    #[must_use]
    pub fn and(&self, other: &Values) -> Values {
        match (self.intervals(), other.intervals()) {
            ([only], _) => return other.within(*only),
            (_, [only]) => return self.within(*only),
            _ => {}
        }
        Values::any(self.intervals().iter().flat_map(|a| other.intervals().iter().filter_map(|b| a.and(*b))))
    }

    /// The numbers and their negatives.
    #[must_use]
    pub fn mirrored(&self) -> Values {
        self.or(&self.map(|i| i.map(|x| -x)))
    }

    /// The intersection with an interval.
    #[must_use]
    pub fn within(&self, interval: Interval) -> Values {
        self.keep(|a| a.and(interval))
    }

    /// Removes a number, if the remaining set is closed.
    #[must_use]
    pub fn without(&self, x: f64) -> Values {
        self.keep(|i| (!i.is_point() || i.low != x).then_some(i))
    }

    /// Maps each interval to a part of it.
    fn keep(&self, left: impl Fn(Interval) -> Option<Interval>) -> Values {
        if let [only] = self.intervals() {
            return left(*only).map_or(Values::none(), Values::one);
        }
        let mut out = Values::none();
        let kept = self.intervals().iter().filter_map(|i| left(*i));
        for (place, interval) in out.items.iter_mut().zip(kept) {
            *place = interval;
            out.len += 1;
        }
        out
    }

    /// The image under a function on intervals.
    #[must_use]
    pub(in crate::analysis) fn map(&self, f: impl Fn(Interval) -> Interval) -> Values {
        match self.intervals() {
            [only] => Values::one(f(*only)),
            several => Values::any(several.iter().map(|i| f(*i))),
        }
    }

    /// The image of all pairs under a function on intervals.
    #[must_use]
    pub(in crate::analysis) fn pairs(&self, other: &Values, f: impl Fn(Interval, Interval) -> Interval) -> Values {
        match (self.intervals(), other.intervals()) {
            ([a], [b]) => Values::one(f(*a, *b)),
            (these, those) => {
                let f = &f;
                Values::any(these.iter().flat_map(|a| those.iter().map(move |b| f(*a, *b))))
            }
        }
    }
}

impl Default for Values {
    fn default() -> Self {
        Values::none()
    }
}

impl PartialEq for Values {
    fn eq(&self, other: &Values) -> bool {
        self.intervals() == other.intervals()
    }
}

impl fmt::Debug for Values {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_list().entries(self.intervals()).finish()
    }
}

/// A union under construction: disjoint intervals in order, with room for all pairs of two sets.
struct Union {
    len: usize,
    items: [Interval; MAX_INTERVALS * MAX_INTERVALS],
}

impl Union {
    fn new() -> Self {
        Union { len: 0, items: [Interval::point(0.0); MAX_INTERVALS * MAX_INTERVALS] }
    }

    fn add(&mut self, mut new: Interval) {
        let items = self.items.get(..self.len).unwrap_or_default();
        // The intervals that it overlaps or touches are `from..to`.
        let from = items.partition_point(|i| i.high < new.low);
        let to = items.partition_point(|i| i.low <= new.high);
        if from < to {
            new = new.or(Interval { low: items[from].low, high: items[to - 1].high });
            self.items.copy_within(to..self.len, from + 1);
            self.len -= to - from - 1;
        } else {
            if self.len == self.items.len() {
                self.reduce();
                return self.add(new);
            }
            self.items.copy_within(from..self.len, from + 1);
            self.len += 1;
        }
        self.items[from] = new;
    }

    /// Closes the narrowest gaps until few enough intervals are left.
    fn reduce(&mut self) {
        let items = &mut self.items[..self.len];
        let mut gaps = [(0.0_f64, 0_usize); MAX_INTERVALS * MAX_INTERVALS];
        let count = items.len().saturating_sub(1);
        for (at, gap) in gaps[..count].iter_mut().enumerate() {
            *gap = (items[at + 1].low - items[at].high, at + 1);
        }
        if count < MAX_INTERVALS {
            return;
        }
        gaps[..count].sort_unstable_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
        let cuts = &mut gaps[..MAX_INTERVALS - 1];
        cuts.sort_unstable_by_key(|(_, at)| *at);
        let mut from = 0;
        for (index, to) in cuts.iter().map(|(_, at)| *at).chain([items.len()]).enumerate() {
            items[index] = Interval { low: items[from].low, high: items[to - 1].high };
            from = to;
        }
        self.len = MAX_INTERVALS;
    }

    fn values(mut self) -> Values {
        self.reduce();
        let mut out = Values::none();
        out.items.copy_from_slice(&self.items[..MAX_INTERVALS]);
        out.len = self.len as u8;
        out
    }
}

impl From<Interval> for Values {
    fn from(interval: Interval) -> Self {
        Values::one(interval)
    }
}

impl fmt::Display for Values {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.intervals() {
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
