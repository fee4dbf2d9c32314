//! What instances do on edges: updates, references, spawns, signals, destruction.

use serde::{Deserialize, Serialize};

use super::{EntityId, ExprId, ParamId, Place, RefId, SendId, SignalId, SpawnId, Subject};

/// What happens on an edge, or when a mode is entered. All right sides read the state before the step.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct Actions {
    /// Variables that change.
    pub updates: Vec<Update>,
    /// References that change.
    pub refs: Vec<RefUpdate>,
    /// Instances that come to be.
    pub spawns: Vec<SpawnId>,
    /// Instances that cease to be.
    pub destroys: Vec<RefValue>,
    /// Signals that are sent.
    #[serde(default, skip_serializing_if = "<[SendId]>::is_empty")]
    pub sends: Box<[SendId]>,
}

/// A reference gets a value.
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct RefUpdate {
    /// The reference.
    pub reference: RefId,
    /// What it refers to from now on.
    pub value: RefValue,
}

/// An instance or none.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum RefValue {
    /// None.
    None,
    /// What a subject stands for, perhaps none.
    Of(Subject),
}

/// A new instance takes the lowest free slot of its entity; `x`, `y` and the space are the spawner's where not given.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct Spawn {
    /// The entity.
    pub entity: EntityId,
    /// The spawner's reference that is set to it, or to none where no slot is free.
    pub into: Option<RefId>,
    /// Parameters that are given; the expressions are the spawner's.
    pub params: Vec<(ParamId, ExprId)>,
    /// Variables that are given.
    pub updates: Vec<Update>,
    /// References that are given.
    pub refs: Vec<RefUpdate>,
}

/// A signal that instances of an entity receive.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct Signal {
    /// Its name.
    pub name: String,
    /// The number that comes with it.
    pub number: Option<Sum>,
}

/// The number of a signal, added up over all that is sent in a step.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct Sum {
    /// Its name.
    pub name: String,
    /// Whether what is sent is rounded to a whole number, half away from zero.
    pub is_whole: bool,
}

/// A signal is sent: its receivers have it in the next step. Sent to nobody, it is lost.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct Send {
    /// The receiver; all living instances of the entity if none.
    pub to: Option<Subject>,
    /// The entity of the receivers; an instance of another entity gets nothing.
    pub entity: EntityId,
    /// Which of its signals.
    pub signal: SignalId,
    /// The number that is added up, if the signal has one.
    pub value: Option<ExprId>,
}

/// An update; the right side reads the state before the step.
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct Update {
    /// What is written.
    pub place: Place,
    /// The new value.
    pub value: ExprId,
}
