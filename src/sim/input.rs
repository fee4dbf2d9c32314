//! The inputs of one step: for each player the buttons that are down and the axes.

use crate::ir::MAX_AXES;
use crate::ir::{Id, PlayerId};

/// What one player gives at one step.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct PlayerInput {
    /// One bit for each button of the controlled entity that is down.
    pub buttons: u64,
    /// The axes of the controlled entity, -1..1.
    pub axes: [f64; MAX_AXES],
}

/// What all players give at one step, in the order of the world's players; missing ones give nothing.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Input(pub Vec<PlayerInput>);

impl Input {
    /// What a player gives.
    pub fn of(&self, player: PlayerId) -> PlayerInput {
        self.0.get(player.index()).copied().unwrap_or_default()
    }

    /// Nothing from so many players.
    pub fn nothing(players: usize) -> Input {
        Input(vec![PlayerInput::default(); players])
    }
}

/// A player's input as guards see it: with what changed since the last step.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Frame {
    pub held: u64,
    pub pressed: u64,
    pub released: u64,
    pub axes: [f64; MAX_AXES],
}

impl Frame {
    pub fn new(now: PlayerInput, last: u64) -> Frame {
        Frame { held: now.buttons, pressed: now.buttons & !last, released: last & !now.buttons, axes: now.axes }
    }
}
