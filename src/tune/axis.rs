//! The numbers that are varied: the values that are tried, and the ways from what the program has to them.

use crate::ir::Extremes;

use serde::{Deserialize, Serialize};

/// Number of steps into which a range is divided if no step is given, at least.
const STEPS: f64 = 500.0;
/// Maximum number of values of a number.
const MAX_VALUES: f64 = 1e6;
/// Maximum number of decimals of a value.
const MAX_DIGITS: usize = 12;
/// Relative tolerance for a last value that rounding misses.
const ROUNDING: f64 = 1e-9;
/// Number of changes of several numbers together on each way.
const JOINT_STEPS: usize = 200;

/// A number of the program that is varied.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct Axis {
    /// `Hero.jump_speed` of a parameter, `gravity` of a constant.
    pub name: String,
    /// The unit in which the program writes it; all values here have it.
    pub unit: String,
    /// What the program has.
    pub base: f64,
    /// The least value.
    pub low: f64,
    /// The greatest value.
    pub high: f64,
    /// The distance between two neighbouring values.
    pub step: f64,
}

impl Axis {
    /// A number with its range. Without a step, it is at most a 500th of the range, and round.
    ///
    /// Why there are no values to try.
    pub fn new(name: &str, unit: &str, base: f64, (low, high): (f64, f64), step: Option<f64>) -> Result<Axis, String> {
        let ends = [base, low, high].into_iter().chain(step);
        if !ends.into_iter().all(f64::is_finite) || high <= low {
            return Err(format!("the range of `{name}` is empty: write the smaller number first, as in `100..400`"));
        }
        let step = step.unwrap_or_else(|| round_step((high - low) / STEPS));
        if step <= 0.0 || (high - low) / step > MAX_VALUES {
            return Err(format!("the step of `{name}` is above 0, and gives at most {MAX_VALUES} values"));
        }
        Ok(Axis { name: name.to_string(), unit: unit.to_string(), base, low, high, step })
    }

    /// The value nearest to a number that has not more decimals than the step and the range.
    fn written(&self, value: f64) -> f64 {
        let digits = digits(self.low).max(digits(self.step)).min(MAX_DIGITS);
        format!("{value:.digits$}").parse().unwrap_or(value)
    }

    /// All values, in order.
    fn values(&self) -> Vec<f64> {
        let count = ((self.high - self.low) / self.step * (1.0 + ROUNDING)).floor().greatest(0.0) as usize;
        let mut values: Vec<f64> = (0..=count).map(|at| self.written(self.low + at as f64 * self.step)).collect();
        values.retain(|value| *value < self.high);
        values.push(self.high);
        values
    }

    /// A value as it is written after `--set`.
    pub fn text(value: f64) -> String {
        // Without an exponent, and read back as the same number.
        format!("{value}")
    }

    /// The value halfway between two, if there is one.
    pub(super) fn between(&self, a: f64, b: f64) -> Option<f64> {
        let steps = (a.midpoint(b) - self.low) / self.step;
        let middle = self.written(self.low + steps.round() * self.step);
        (a.least(b) < middle && middle < a.greatest(b)).then_some(middle)
    }

    /// How large a change is: relative to what the program has, or to the range if that is 0.
    pub fn size(&self, value: f64) -> f64 {
        (value - self.base).abs() / self.scale()
    }

    fn scale(&self) -> f64 {
        if self.base == 0.0 { self.high - self.low } else { self.base.abs() }
    }
}

/// The number of decimals of a number.
fn digits(value: f64) -> usize {
    Axis::text(value).split_once('.').map_or(0, |(_, decimals)| decimals.len())
}

/// The greatest of 1, 2 and 5 times a power of ten that is at most a number.
fn round_step(most: f64) -> f64 {
    let power = 10_f64.powi(most.log10().floor() as i32);
    let fits = |times: &f64| times * power <= most * (1.0 + ROUNDING);
    let times = [5.0, 2.0, 1.0].into_iter().find(fits).unwrap_or(1.0);
    // Decimal: `0.5`, not `0.5000000000000001`.
    format!("{:.*}", MAX_DIGITS, times * power).parse().unwrap_or(power)
}

/// A way from what the program has: ever larger changes of one number, or of several together.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Way {
    /// The values of all numbers, and the size of the change: the greatest of any number.
    pub points: Vec<(Vec<f64>, f64)>,
    /// The numbers that change.
    pub changes: Vec<usize>,
}

/// The ways of changing one number at a time: up and down.
pub(super) fn single_ways(axes: &[Axis]) -> Vec<Way> {
    let base: Vec<f64> = axes.iter().map(|axis| axis.base).collect();
    let mut ways = Vec::new();
    for (at, axis) in axes.iter().enumerate() {
        let values = axis.values();
        let point = |value: f64| {
            let mut point = base.clone();
            point[at] = value;
            (point, axis.size(value))
        };
        let down = values.iter().rev().filter(|value| **value < axis.base);
        let up = values.iter().filter(|value| **value > axis.base);
        let (down, up): (Vec<f64>, Vec<f64>) = (down.copied().collect(), up.copied().collect());
        for values in [up, down] {
            ways.push(Way { points: values.into_iter().map(point).collect(), changes: vec![at] });
        }
    }
    ways.retain(|way| !way.points.is_empty());
    ways
}

/// The ways of changing several numbers together: each by the same share of what it is, up or down, to the end of its
/// range.
pub(super) fn joint_ways(axes: &[Axis]) -> Vec<Way> {
    let values: Vec<Vec<f64>> = axes.iter().map(Axis::values).collect();
    let mut ways = Vec::new();
    // Each number goes down, stays or goes up.
    for number in 0..3_usize.pow(axes.len() as u32) {
        let signs: Vec<i32> = (0..axes.len() as u32).map(|at| (number / 3_usize.pow(at) % 3) as i32 - 1).collect();
        let is_side = |at: usize, value: f64| (value - axes[at].base) * f64::from(signs[at]) > 0.0;
        let changes: Vec<usize> = (0..axes.len()).filter(|at| signs[*at] != 0).collect();
        let can_change = |at: &usize| values[*at].iter().any(|value| is_side(*at, *value));
        if changes.len() < 2 || !changes.iter().all(can_change) {
            continue;
        }
        let far = |at: &usize| {
            let sizes = values[*at].iter().filter(|value| is_side(*at, **value)).map(|value| axes[*at].size(*value));
            sizes.fold(0.0, f64::greatest)
        };
        let whole = changes.iter().map(far).fold(0.0, f64::greatest);
        let mut points: Vec<(Vec<f64>, f64)> = Vec::new();
        for step in 1..=JOINT_STEPS {
            let share = whole * step as f64 / JOINT_STEPS as f64;
            // Of each number, the largest change that is not larger.
            let value = |at: usize| {
                let all = values[at].iter().copied().filter(|value| is_side(at, *value));
                let fitting = all.filter(|value| axes[at].size(*value) <= share * (1.0 + ROUNDING));
                fitting.max_by(|a, b| axes[at].size(*a).total_cmp(&axes[at].size(*b))).unwrap_or(axes[at].base)
            };
            let point: Vec<f64> = (0..axes.len()).map(value).collect();
            let size = axes.iter().zip(&point).map(|(axis, value)| axis.size(*value)).fold(0.0, f64::greatest);
            let has_all = changes.iter().all(|at| point[*at] != axes[*at].base);
            if has_all && points.last().is_none_or(|(last, _)| *last != point) {
                points.push((point, size));
            }
        }
        if !points.is_empty() {
            ways.push(Way { points, changes });
        }
    }
    ways
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_round_and_have_both_ends() {
        let axis = Axis::new("Hero.jump", "", 240.0, (100.0, 400.0), None).unwrap();
        assert_eq!(axis.step, 0.5);
        let values = axis.values();
        assert_eq!((values.first(), values.get(1), values.last()), (Some(&100.0), Some(&100.5), Some(&400.0)));
        let whole = Axis::new("lives", "", 3.0, (1.0, 5.0), Some(1.0)).unwrap();
        assert_eq!(whole.values(), [1.0, 2.0, 3.0, 4.0, 5.0]);
        let odd = Axis::new("k", "", 0.0, (-0.3, 0.45), Some(0.2)).unwrap();
        assert_eq!(odd.values(), [-0.3, -0.1, 0.1, 0.3, 0.45]);
        assert_eq!(Axis::text(0.1 + 0.2), "0.30000000000000004");
        assert!(Axis::new("k", "", 0.0, (2.0, 1.0), None).is_err());
        assert!(Axis::new("k", "", 0.0, (0.0, 1.0), Some(1e-9)).is_err());
    }

    #[test]
    fn ways_lead_away_from_what_the_program_has() {
        let axes = [
            Axis::new("a", "", 10.0, (8.0, 14.0), Some(1.0)).unwrap(),
            Axis::new("b", "", -4.0, (-8.0, -4.0), Some(1.0)).unwrap(),
        ];
        let ways = single_ways(&axes);
        let firsts: Vec<&[f64]> = ways.iter().map(|way| way.points[0].0.as_slice()).collect();
        assert_eq!(firsts, [[11.0, -4.0], [9.0, -4.0], [10.0, -5.0]]);
        let joint = joint_ways(&axes);
        assert_eq!(joint.len(), 2, "b can only go down");
        for way in &joint {
            assert!(way.points.is_sorted_by(|a, b| a.1 <= b.1), "{way:?}");
            assert!(way.points.iter().all(|(point, _)| point[0] != 10.0 && point[1] != -4.0));
        }
    }
}
