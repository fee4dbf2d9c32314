//! The checked envelopes of an entity: what drives them, how fast they rise and how they end.

use crate::ir::{AxisId, ButtonId, ModeId, VarId};
use crate::source::Span;

use super::checked::Term;

/// An envelope: attack, decay, sustain, release.
#[derive(Debug, Clone)]
pub struct Envelope {
    /// The driven variables: one, or the components of a vector.
    pub vars: Vec<VarId>,
    /// Of which degree.
    pub degree: u8,
    /// What drives it.
    pub by: By,
    /// How it rises.
    pub attack: Rate,
    /// The level it rises to first, if not to the sustained one.
    pub peak: Option<Term>,
    /// How it goes from the peak to the sustained level.
    pub decay: Rate,
    /// The level while it is driven; the peak of a `fixed` envelope.
    pub sustain: Term,
    /// How long a `fixed` envelope holds its peak; `None` is 0.
    pub sustain_for: Option<Term>,
    /// How it falls.
    pub release: Release,
    /// Holds while it can be driven.
    pub driven_while: Option<Term>,
    /// The whole.
    pub span: Span,
}

/// What drives an envelope.
#[derive(Debug, Clone, PartialEq)]
pub enum By {
    /// A button: while it is down.
    Button(ButtonId),
    /// The sign of an axis.
    Axis(AxisId),
    /// The direction of several axes, to the nearest of this number of directions, or as it is.
    Axes(Vec<AxisId>, Option<u32>),
    /// The clock of the mode that holds it.
    Clock(ModeId),
}

/// How fast a ramp is.
#[derive(Debug, Clone)]
pub enum Rate {
    /// At once.
    Instant,
    /// By an amount per second.
    Accel(Term),
    /// The complete ramp takes this time, s.
    Over(Term),
}

/// How an envelope ends.
#[derive(Debug, Clone)]
pub enum Release {
    /// It stays where it is.
    Hold,
    /// It goes to a level (`None` is 0).
    To(Rate, Option<Term>),
}
