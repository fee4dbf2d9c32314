//! The inputs of one step: for each player, the pressed buttons and the axes; of nature, what is drawn.

use crate::ir::MAX_AXES;
use crate::ir::{AxisId, ButtonId, Id, PlayerId, Press};

use super::chance::Draws;
use super::simulator::Simulator;

/// The input of one player in one step.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct PlayerInput {
    /// One bit per pressed button of the controlled entity.
    pub buttons: u64,
    /// The axes of the controlled entity, -1..1.
    pub axes: [f64; MAX_AXES],
}

/// The inputs of all players in one step, in the order of the world's players; missing entries are empty. Then the draws
/// of nature that are fixed: [`Simulator::draw`] draws the others, and one that is still open is the least value.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Input(pub Vec<PlayerInput>, pub Draws);

impl Input {
    /// The input of a player.
    #[inline]
    pub fn of(&self, player: PlayerId) -> PlayerInput {
        self.0.get(player.index()).copied().unwrap_or_default()
    }

    /// The inputs of players, with all draws open.
    pub fn of_players(players: Vec<PlayerInput>) -> Input {
        Input(players, Draws::default())
    }

    /// The number of buttons and axes in which the inputs of the players differ.
    pub fn difference(&self, other: &Input) -> u32 {
        let players = self.0.iter().zip(&other.0);
        let of_player = |(one, other): (&PlayerInput, &PlayerInput)| {
            let axes = one.axes.iter().zip(&other.axes).filter(|(a, b)| a != b).count() as u32;
            (one.buttons ^ other.buttons).count_ones() + axes
        };
        players.map(of_player).sum()
    }

    /// Empty input for a number of players.
    pub fn nothing(players: usize) -> Input {
        Input(vec![PlayerInput::default(); players], Draws::default())
    }
}

/// A button or an axis of the entity that a player controls.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Control {
    /// A button.
    Button(PlayerId, ButtonId),
    /// An axis.
    Axis(PlayerId, AxisId),
}

impl Simulator {
    /// The buttons and axes of a player, each in the order of its entity.
    pub fn controls(&self, player: PlayerId) -> impl Iterator<Item = Control> + use<'_> {
        let entity = self.entity(self.world().players[player].slot);
        let buttons = entity.buttons.ids().map(move |button| Control::Button(player, button));
        buttons.chain(entity.axes.ids().map(move |axis| Control::Axis(player, axis)))
    }

    /// Finds a button or axis by name, for a player by number.
    pub fn control(&self, player: u32, name: &str) -> Option<Control> {
        let id = self.world().players.find(|p| p.number == player)?;
        let entity = self.entity(self.world().players[id].slot);
        let button = entity.button_named(name).map(|button| Control::Button(id, button));
        button.or_else(|| entity.axis_named(name).map(|axis| Control::Axis(id, axis)))
    }
}

impl Input {
    /// An axis, from -1 to 1, or a button: 1 if it is pressed, else 0.
    pub fn get(&self, control: Control) -> f64 {
        match control {
            Control::Button(player, button) => f64::from(u8::from(self.of(player).buttons >> button.index() & 1 == 1)),
            Control::Axis(player, axis) => self.of(player).axes[axis.index()],
        }
    }

    /// Sets an axis, from -1 to 1, or a button, which is pressed unless the value is 0.
    pub fn set(&mut self, control: Control, value: f64) {
        let (Control::Button(player, _) | Control::Axis(player, _)) = control;
        let Some(input) = self.0.get_mut(player.index()) else { return };
        match control {
            Control::Button(_, button) if value != 0.0 => input.buttons |= 1 << button.index(),
            Control::Button(_, button) => input.buttons &= !(1 << button.index()),
            // NaN is no direction.
            Control::Axis(_, axis) if value.is_nan() => input.axes[axis.index()] = 0.0,
            Control::Axis(_, axis) => input.axes[axis.index()] = value.clamp(-1.0, 1.0),
        }
    }
}

/// A player's input for guards, including changes since the last step.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Frame {
    /// The buttons, by [`Press`].
    buttons: [u64; 3],
    pub axes: [f64; MAX_AXES],
}

impl Frame {
    #[inline]
    pub fn new(now: PlayerInput, last: u64) -> Frame {
        let mut buttons = [0; 3];
        buttons[Press::Pressed as usize] = now.buttons & !last;
        buttons[Press::Held as usize] = now.buttons;
        buttons[Press::Released as usize] = last & !now.buttons;
        Frame { buttons, axes: now.axes }
    }

    /// Whether any button is as asked: those that must be so and those that must not, by [`Press`].
    #[inline]
    pub fn any(&self, asked: &[[u64; 2]; 3]) -> bool {
        let all = self.buttons.iter().zip(asked);
        all.fold(0, |any, (buttons, [so, not])| any | buttons & so | !buttons & not) != 0
    }

    /// Whether a button is as asked.
    #[inline]
    pub fn button(&self, press: Press, button: ButtonId) -> bool {
        self.buttons[press as usize] >> button.index() & 1 == 1
    }
}
