//! What an entity reads of its inputs: the buttons and axes of its player, and the numbers that nature draws.

use serde::{Deserialize, Serialize};

/// A whole number that is drawn anew in each step: uniformly, and independently of all others.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct Chance {
    /// Its name.
    pub name: String,
    /// The least and the greatest value.
    pub range: (i32, i32),
}

/// Buttons, axes and chances.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct Inputs {
    /// One bit for each button.
    pub buttons: u64,
    /// One bit for each axis.
    pub axes: u8,
    /// One bit for each chance.
    #[serde(default, skip_serializing_if = "is_none")]
    pub chances: u32,
}

fn is_none(set: &u32) -> bool {
    *set == 0
}

impl Inputs {
    /// Both together.
    #[must_use]
    pub fn with(self, other: Inputs) -> Inputs {
        Inputs {
            buttons: self.buttons | other.buttons,
            axes: self.axes | other.axes,
            chances: self.chances | other.chances,
        }
    }
}
