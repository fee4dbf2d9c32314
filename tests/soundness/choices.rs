//! The random choices of a program with a number.

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

/// The choices of the program with a number.
pub fn choices(seed: u64) -> Vec<u16> {
    let mut rng = Pcg64::seed_from_u64(seed);
    let length = rng.random_range(200..1_600);
    (0..length).map(|_| rng.random()).collect()
}
