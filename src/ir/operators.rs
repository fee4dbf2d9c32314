//! The parts of expressions: subjects, operators and functions; sides and responses of contacts.

use std::cmp::Ordering;
use std::hash::{Hash, Hasher};

use serde::{Deserialize, Serialize};

use super::{DiscreteId, EntityId, ProbeId, RefId, SlotId, TouchId, VarId};

/// Whose variable, contact or mode an expression reads.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Subject {
    /// The instance that the code runs for.
    Me,
    /// A named instance of the world.
    Slot(SlotId),
    /// What a reference of the instance refers to.
    Ref(RefId),
    /// The instance that a contact query of the instance found (`touching(…) as e`).
    Touched(TouchId),
    /// The instance that a probe of the instance finds (`touching(… at (x, y), …) as e`, `nearest … as e`).
    Probed(ProbeId),
    /// The instance of an entity about which a question to each of them asks.
    Member(EntityId),
}

/// Arithmetic on two numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Arithmetic {
    /// `a + b`
    Add,
    /// `a - b`
    Subtract,
    /// `a * b`
    Multiply,
    /// `a / b`; dividing by zero stops the step.
    Divide,
}

/// Functions of numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Function {
    /// The smaller of two.
    Min,
    /// The larger of two.
    Max,
    /// The size without the sign.
    Abs,
    /// -1, 0 or 1.
    Sign,
    /// `clamp(x, low, high)`
    Clamp,
    /// The next whole number below.
    Floor,
    /// The next whole number above.
    Ceil,
    /// The nearest whole number, half away from zero.
    Round,
    /// The square root; of a negative number it stops the step.
    Sqrt,
    /// The sine of an angle in radians, as a portable library computes it.
    Sin,
    /// The cosine of an angle in radians.
    Cos,
    /// `atan2(y, x)`: the angle of a direction, in radians.
    Atan2,
    /// `mod(a, b)`: `a` less the whole multiple of `b` below it, from 0 to before `b`.
    Mod,
    /// `if(condition, a, b)`
    If,
}

/// When a button counts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Press {
    /// It went down at this step.
    Pressed,
    /// It is down.
    Held,
    /// It went up at this step.
    Released,
}

/// A side of a collider.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Side {
    /// Towards smaller x.
    Left,
    /// Towards larger x.
    Right,
    /// Towards larger y.
    Above,
    /// Towards smaller y.
    Below,
}

impl Side {
    /// Every side.
    pub const ALL: [Side; 4] = [Side::Left, Side::Right, Side::Above, Side::Below];

    /// Its word.
    pub fn name(self) -> &'static str {
        match self {
            Side::Left => "left",
            Side::Right => "right",
            Side::Above => "above",
            Side::Below => "below",
        }
    }

    /// The side of a word.
    pub fn named(word: &str) -> Option<Side> {
        Side::ALL.into_iter().find(|side| side.name() == word)
    }
}

/// What an update can write.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Place {
    /// A continuous variable or one of its derivatives.
    Var(VarId, u8),
    /// A discrete variable.
    Discrete(DiscreteId),
    /// A reference.
    Ref(RefId),
}

/// What a contact does.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Push {
    /// Contacts are reported; nothing is pushed.
    Sense,
    /// One way: only a body that was above is pushed, up.
    FromAbove,
    /// Movable bodies are pushed out.
    Block,
}

/// What a contact does. The order is that of strength.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct Response {
    /// Whether it is pushed.
    pub push: Push,
    /// The velocity into the surface is set to 0.
    pub stop: bool,
    /// What is on the other moves along.
    pub carry: bool,
    /// The share of a stopped velocity that is turned back.
    #[serde(default, skip_serializing_if = "Bounce::is_none")]
    pub bounce: Bounce,
}

impl Response {
    /// Whether a contact can move what it is of.
    pub fn moves(self) -> bool {
        self.push != Push::Sense || self.carry
    }
}

/// The share of the velocity into a surface that a contact turns back, from 0 to 1.
#[derive(Debug, Clone, Copy, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
#[serde(try_from = "f64", into = "f64")]
#[cfg_attr(feature = "testing", schemars(with = "f64"))]
pub struct Bounce(f64);

impl Bounce {
    /// Nothing is turned back.
    pub const NONE: Bounce = Bounce(0.0);

    /// `None` if the share is not between 0 and 1: more could leave the finite numbers.
    pub fn new(share: f64) -> Option<Self> {
        // Both zeros are one share.
        (0.0..=1.0).contains(&share).then_some(Bounce(share + 0.0))
    }

    /// The share.
    pub fn share(self) -> f64 {
        self.0
    }

    /// Whether nothing is turned back.
    pub fn is_none(&self) -> bool {
        self.0 == 0.0
    }

    /// What becomes of a velocity.
    pub fn turned(self, velocity: f64) -> f64 {
        // Not `-share * velocity`, which can be the negative zero.
        0.0 - self.0 * velocity
    }
}

impl PartialEq for Bounce {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Bounce {}

impl PartialOrd for Bounce {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Bounce {
    fn cmp(&self, other: &Self) -> Ordering {
        self.0.total_cmp(&other.0)
    }
}

impl Hash for Bounce {
    fn hash<H: Hasher>(&self, state: &mut H) {
        self.0.to_bits().hash(state);
    }
}

impl TryFrom<f64> for Bounce {
    type Error = &'static str;

    fn try_from(share: f64) -> Result<Self, Self::Error> {
        Bounce::new(share).ok_or("a bounce is a number from 0 to 1")
    }
}

impl From<Bounce> for f64 {
    fn from(bounce: Bounce) -> f64 {
        bounce.0
    }
}

/// How an instance comes to be.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Origin {
    /// It has a name; its slot is never used again.
    Named,
    /// A tile makes it; once it is destroyed its slot is free.
    Tile,
    /// Nothing is there at first.
    Free,
}

/// Comparisons.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, Deserialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum CompareOp {
    /// `==`
    Equal,
    /// `!=`
    Unequal,
    /// `<`
    Less,
    /// `<=`
    AtMost,
    /// `>`
    Greater,
    /// `>=`
    AtLeast,
}

impl CompareOp {
    /// As it is written.
    pub fn symbol(self) -> &'static str {
        match self {
            CompareOp::Equal => "==",
            CompareOp::Unequal => "!=",
            CompareOp::Less => "<",
            CompareOp::AtMost => "<=",
            CompareOp::Greater => ">",
            CompareOp::AtLeast => ">=",
        }
    }

    /// The negation.
    #[must_use]
    pub fn negated(self) -> Self {
        match self {
            CompareOp::Equal => CompareOp::Unequal,
            CompareOp::Unequal => CompareOp::Equal,
            CompareOp::Less => CompareOp::AtLeast,
            CompareOp::AtMost => CompareOp::Greater,
            CompareOp::Greater => CompareOp::AtMost,
            CompareOp::AtLeast => CompareOp::Less,
        }
    }

    /// `b op a` for `a op b`.
    #[must_use]
    pub fn mirrored(self) -> Self {
        match self {
            CompareOp::Equal | CompareOp::Unequal => self,
            CompareOp::Less => CompareOp::Greater,
            CompareOp::AtMost => CompareOp::AtLeast,
            CompareOp::Greater => CompareOp::Less,
            CompareOp::AtLeast => CompareOp::AtMost,
        }
    }
}
