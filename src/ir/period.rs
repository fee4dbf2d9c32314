//! The stretch of an axis that repeats in a space that wraps. A position is brought into it at the end of a step.

use serde::{Deserialize, Serialize};

/// What repeats along an axis, px: all from `low` up to, but not including, `high`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct Period {
    /// The lower border.
    pub low: f64,
    /// The upper border, which is the same place.
    pub high: f64,
}

impl Period {
    /// Its length, px.
    pub fn size(self) -> f64 {
        self.high - self.low
    }

    /// Whether a coordinate is in it.
    pub fn contains(self, x: f64) -> bool {
        self.low <= x && x < self.high
    }

    /// The same place inside: `x` less whole periods. What rounding leaves outside lies on the seam.
    pub fn wrapped(self, x: f64) -> f64 {
        if self.contains(x) {
            return x;
        }
        let moved = x - self.size() * ((x - self.low) / self.size()).floor();
        if self.contains(moved) { moved } else { self.low }
    }

    /// The shortest way round that leads as far as a way.
    pub fn shortest(self, way: f64) -> f64 {
        way - self.size() * (way / self.size()).round()
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn a_place_is_the_same_one_inside(low in -1e3..1e3, size in 1.0..1e4, x in -1e6..1e6) {
            let period = Period { low, high: low + size };
            let inside = period.wrapped(x);
            prop_assert!(period.contains(inside));
            prop_assert_eq!(period.wrapped(inside), inside);
            let turns = (x - inside) / period.size();
            prop_assert!((turns - turns.round()).abs() < 1e-6, "{} turns", turns);
            prop_assert!(period.shortest(x - inside).abs() < 1e-5);
            prop_assert!(period.shortest(x).abs() <= period.size() * 0.500_001);
        }
    }

    #[test]
    fn borders_are_one_place() {
        let period = Period { low: -16.0, high: 240.0 };
        assert_eq!([-16.0, 240.0, 496.0, -272.0].map(|x| period.wrapped(x)), [-16.0; 4]);
        assert_eq!(period.wrapped(-17.0), 239.0);
        // Nothing lies between this number and the border.
        assert_eq!(period.wrapped((-16.0_f64).next_down()), -16.0);
        for x in [f64::MAX, f64::MIN, 1e300, -1e300, f64::MIN_POSITIVE] {
            assert!(period.contains(period.wrapped(x)), "{x}");
        }
        assert_eq!(period.shortest(200.0), -56.0);
    }
}
