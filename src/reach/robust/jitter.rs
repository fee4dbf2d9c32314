//! Errors of timing: a normal distribution, rounded to steps. One error is drawn for each change of an input; after the
//! motor model of Isaksen, Gopstein and Nealen, *Exploring Game Space Using Survival Analysis*, 2015, in which a player's
//! precision is the standard deviation of a normal distribution around the planned time.

use super::super::coverage::mix;
use crate::ir::Extremes;

/// Errors beyond this number of standard deviations do not occur: one in 10¹⁵.
const REACH: f64 = 8.0;
/// Standard deviations within which each error of one change is tried on its own.
const TRIED: f64 = 5.0;

/// The distribution of an error, in whole steps.
#[derive(Debug, Clone, PartialEq)]
pub struct Jitter {
    sigma: f64,
    /// The probability that an error is at most `-most`, `1 - most`, …, in units of 2⁻⁶⁴.
    cumulative: Vec<u64>,
    most: i32,
}

impl Jitter {
    /// Maximum standard deviation, steps.
    pub const MAX_SIGMA: f64 = 10_000.0;

    /// Errors of this standard deviation, in steps: above 0, at most [`Jitter::MAX_SIGMA`].
    pub fn new(sigma: f64) -> Jitter {
        let sigma = if sigma > 0.0 { sigma.least(Jitter::MAX_SIGMA) } else { f64::MIN_POSITIVE };
        let most = (REACH * sigma).ceil().greatest(1.0) as i32;
        let whole = 2.0_f64.powi(64);
        // Conversions to integers saturate.
        let at_most = |error: i32| (below(f64::from(error) + 0.5, sigma) * whole) as u64;
        Jitter { sigma, cumulative: (-most..most).map(at_most).collect(), most }
    }

    /// The standard deviation before rounding, steps.
    pub fn sigma(&self) -> f64 {
        self.sigma
    }

    /// The probability of an error.
    pub fn probability(&self, error: i32) -> f64 {
        below(f64::from(error) + 0.5, self.sigma) - below(f64::from(error) - 0.5, self.sigma)
    }

    /// The largest error that is worth trying by itself; all larger ones together have a probability of 10⁻⁶.
    pub(super) fn tried(&self) -> i32 {
        ((TRIED * self.sigma).ceil() as i32).min(self.most)
    }

    /// The error of a change in a trial, by the seed and the numbers of both alone: neither the order of trials nor the
    /// number of changes plays a part.
    pub(super) fn draw(&self, seed: u64, trial: u64, change: u64) -> i32 {
        let bits = mix(mix(mix(seed, trial), change), change);
        self.cumulative.partition_point(|at_most| *at_most <= bits) as i32 - self.most
    }
}

/// The probability that a normally distributed error is below a number.
fn below(error: f64, sigma: f64) -> f64 {
    0.5 * libm::erfc(-error / (sigma * std::f64::consts::SQRT_2))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_are_as_probable_as_they_should_be() {
        for sigma in [0.3, 1.0, 1.5, 6.0] {
            let jitter = Jitter::new(sigma);
            let all: f64 = (-jitter.most..=jitter.most).map(|error| jitter.probability(error)).sum();
            assert!((all - 1.0).abs() < 1e-12, "{sigma}: {all}");
            let mut count = [0_u32; 3];
            for trial in 0..1000 {
                for error in (0..100).map(|change| jitter.draw(7, trial, change)) {
                    assert!(error.abs() <= jitter.most);
                    count[0] += u32::from(error == 0);
                    count[1] += u32::from(error == 1);
                    count[2] += u32::from(error == -2);
                }
            }
            for (count, error) in count.into_iter().zip([0, 1, -2]) {
                let (p, share) = (jitter.probability(error), f64::from(count) / 1e5);
                // What is hardly ever expected may happen once or twice.
                assert!((share - p).abs() < 5.0 * (p / 1e5).sqrt() + 2.5e-5, "{sigma}, {error}: {share}, not {p}");
            }
        }
        // Of an error of one standard deviation: the normal distribution from -0.5 to 0.5.
        assert!((Jitter::new(1.0).probability(0) - 0.382_924_922_548_026).abs() < 1e-12);
    }

    #[test]
    fn tiny_errors_are_none() {
        let jitter = Jitter::new(0.01);
        assert!((0..50).all(|change| jitter.draw(1, 1, change) == 0));
    }
}
