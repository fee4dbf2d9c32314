//! The signals that instances can receive: over all that others, and they themselves, can send in one step.

use std::collections::{BTreeMap, BTreeSet};

use crate::ir::{EntityId, Extremes, Send, SendId, SignalId};

use crate::analysis::domain::values::Interval;

/// Number of times that the values of a `send` may grow before they are taken to be any: what is received can be sent
/// on, without a variable that widening would stop.
const MAX_GROWTHS: u32 = 24;

/// What an instance can send: for each `send`, the values of its number, 0 where there is none.
#[derive(Debug, Default, Clone)]
pub(in crate::analysis) struct Sent(BTreeMap<SendId, (Interval, u32)>);

impl Sent {
    /// Adds a value; returns whether it is new.
    pub fn add(&mut self, send: SendId, value: Interval) -> bool {
        let Some((known, growths)) = self.0.get_mut(&send) else {
            self.0.insert(send, (value, 0));
            return true;
        };
        let joined = known.or(value);
        if joined == *known {
            return false;
        }
        *growths += 1;
        *known = if *growths > MAX_GROWTHS { Interval::ALL } else { joined };
        true
    }

    /// The values of a `send`, if it can happen.
    pub fn get(&self, send: SendId) -> Option<Interval> {
        self.0.get(&send).map(|(value, _)| *value)
    }
}

/// What instances of each entity can receive in one step.
#[derive(Debug, Default, Clone, PartialEq)]
pub(in crate::analysis) struct Received {
    signals: BTreeSet<(EntityId, SignalId)>,
    sums: BTreeMap<(EntityId, SignalId), Total>,
}

/// A sum of numbers, each of which may be sent.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Total {
    value: Interval,
    /// The sum of the greatest absolute values, and their number: they bound what rounding can change, as the numbers
    /// may be added in another order.
    size: f64,
    count: f64,
    is_whole: bool,
}

impl Received {
    /// Adds what one instance can send at most once in a step; `is_whole` tells of its number, if the signal has
    /// one.
    pub fn add(&mut self, send: &Send, is_whole: Option<bool>, value: Interval) {
        self.signals.insert((send.entity, send.signal));
        let Some(is_whole) = is_whole else { return };
        let value = if is_whole { value.map(f64::round) } else { value };
        // It may not be sent.
        let value = value.or(Interval::point(0.0));
        let none = Total { value: Interval::point(0.0), size: 0.0, count: 0.0, is_whole };
        let total = self.sums.entry((send.entity, send.signal)).or_insert(none);
        total.value = total.value.plus(value);
        total.size += value.low.abs().greatest(value.high.abs());
        total.count += 1.0;
    }

    /// Whether a signal can be received.
    pub fn can_receive(&self, entity: EntityId, signal: SignalId) -> bool {
        self.signals.contains(&(entity, signal))
    }

    /// The values of a sum.
    pub fn sum(&self, entity: EntityId, signal: SignalId) -> Interval {
        self.sums.get(&(entity, signal)).map_or(Interval::point(0.0), Total::rounded)
    }

    /// Whether instances of an entity can receive something else than before.
    pub fn differs(&self, before: &Received, entity: EntityId) -> bool {
        let of = |received: &Received| {
            let signals = received.signals.range((entity, SignalId(0))..=(entity, SignalId(u32::MAX)));
            let sums = received.sums.range((entity, SignalId(0))..=(entity, SignalId(u32::MAX)));
            (signals.copied().collect::<Vec<_>>(), sums.map(|(k, v)| (*k, *v)).collect::<Vec<_>>())
        };
        of(self) != of(before)
    }
}

impl Total {
    /// All values of the sum, in whatever order the numbers are added.
    fn rounded(&self) -> Interval {
        // Whole numbers below it are added exactly.
        const EXACT: f64 = (1_u64 << 52) as f64;
        if (self.is_whole && self.size < EXACT) || self.count <= 1.0 {
            return self.value;
        }
        let error = self.size * self.count * f64::EPSILON;
        // However they are rounded, numbers of one sign have a sum of that sign.
        let beyond = |end: f64, error: f64| if end == 0.0 { end } else { end + error };
        Interval { low: beyond(self.value.low, -error), high: beyond(self.value.high, error) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sum_has_room_for_rounding() {
        let send = Send { to: None, entity: EntityId(0), signal: SignalId(0), value: None };
        let sum = |is_whole: bool, numbers: &[f64]| {
            let mut received = Received::default();
            for number in numbers {
                received.add(&send, Some(is_whole), Interval::point(*number));
            }
            received.sum(EntityId(0), SignalId(0))
        };
        assert_eq!(sum(true, &[3.0, 4.0, -2.0]), Interval { low: -2.0, high: 7.0 });
        assert_eq!(sum(true, &[2.5]), Interval { low: 0.0, high: 3.0 });
        // In this order and in the other one; a sum of positive numbers is positive.
        for (numbers, is_positive) in [([0.1, 0.2, 0.3, 1e16, 0.7], true), ([0.1, -0.2, 0.3, 1e16, -0.7], false)] {
            let all = sum(false, &numbers);
            assert_eq!(all.low == 0.0, is_positive);
            for total in [numbers.iter().sum::<f64>(), numbers.iter().rev().sum::<f64>()] {
                assert!(all.low <= total && total <= all.high, "{all:?} {total}");
            }
        }
        assert!(sum(false, &[1.0, f64::INFINITY]).high == f64::INFINITY);
    }

    #[test]
    fn what_is_sent_on_forever_is_anything() {
        let mut sent = Sent::default();
        let grown = (1..100).filter(|n| sent.add(SendId(0), Interval::point(f64::from(*n)))).count();
        assert!(grown <= MAX_GROWTHS as usize + 2 && sent.get(SendId(0)) == Some(Interval::ALL));
    }
}
