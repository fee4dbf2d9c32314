//! Fewer inputs than there are: some buttons always down or never, some axes only at some of their ends. A search among
//! them finds plans with few changes; what it does not find proves nothing.

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

use crate::ir::MAX_AXES;
use crate::sim::{Input, PlayerInput, Simulator};

/// The inputs that a search may use.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Restriction {
    /// Of each player.
    players: Vec<Allowed>,
}

#[derive(Debug, Clone, PartialEq)]
struct Allowed {
    /// Buttons that are always down.
    down: u64,
    /// Buttons that never are.
    up: u64,
    /// The range of each axis.
    axes: [(f64, f64); MAX_AXES],
}

impl Restriction {
    /// All inputs.
    pub fn none(sim: &Simulator) -> Restriction {
        let all = Allowed { down: 0, up: 0, axes: [(-1.0, 1.0); MAX_AXES] };
        Restriction { players: vec![all; sim.world().players.len()] }
    }

    /// A random one: two of three buttons are free, and two of three axes are held or used on one side.
    pub fn drawn(sim: &Simulator, seed: u64) -> Restriction {
        let mut rng = Pcg64::seed_from_u64(seed);
        let players = sim.world().players.iter().map(|_| {
            let (mut down, mut up) = (0, 0);
            for button in 0..64 {
                match rng.random_range(0..6) {
                    0 => down |= 1 << button,
                    1 => up |= 1 << button,
                    _ => {}
                }
            }
            let range = |rng: &mut Pcg64| match rng.random_range(0..6) {
                0 => (1.0, 1.0),
                1 => (0.0, 1.0),
                2 => (-1.0, 0.0),
                3 => (-1.0, -1.0),
                _ => (-1.0, 1.0),
            };
            Allowed { down, up, axes: [(); MAX_AXES].map(|()| range(&mut rng)) }
        });
        Restriction { players: players.collect() }
    }

    /// Whether an input may be used, of which `reads` tells the buttons and axes that are read.
    pub fn allows(&self, input: &Input, reads: &[(u64, u64)]) -> bool {
        let fits = |((given, allowed), (buttons, read)): ((&PlayerInput, &Allowed), &(u64, u64))| {
            let in_range = |axis: usize| {
                let (low, high) = allowed.axes[axis];
                read >> axis & 1 == 0 || (low..=high).contains(&given.axes[axis])
            };
            given.buttons & allowed.down == allowed.down & buttons
                && given.buttons & allowed.up == 0
                && (0..MAX_AXES).all(in_range)
        };
        input.0.iter().zip(&self.players).zip(reads).all(fits)
    }
}
