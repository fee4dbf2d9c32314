//! A list of choices from which a program is drawn: with all of them used up, the first alternative is taken everywhere.

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

/// The choices of the program with a number.
pub fn choices(seed: u64) -> Vec<u16> {
    let mut rng = Pcg64::seed_from_u64(seed);
    let length = rng.random_range(200..1_600);
    (0..length).map(|_| rng.random()).collect()
}

/// Draws from a list of choices.
pub struct Draw<'c>(std::slice::Iter<'c, u16>);

impl<'c> Draw<'c> {
    pub fn new(choices: &'c [u16]) -> Self {
        Draw(choices.iter())
    }

    /// A number below `count`.
    pub fn pick(&mut self, count: usize) -> usize {
        self.0.next().map_or(0, |c| usize::from(*c) % count.max(1))
    }

    /// True in so many of a hundred cases.
    pub fn chance(&mut self, percent: usize) -> bool {
        self.0.next().is_some_and(|c| usize::from(*c) % 100 < percent)
    }

    /// One of some texts.
    pub fn one<'s>(&mut self, of: &[&'s str]) -> &'s str {
        of[self.pick(of.len())]
    }
}
