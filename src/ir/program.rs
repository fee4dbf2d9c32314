//! The tables. Their fields say what they mean at run time and what always holds of them.

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::Spans;
use super::actions::{Actions, Send, Signal, Spawn};
use super::{
    Arena, Arithmetic, AxisId, ButtonId, Chance, ChanceId, Collider, ColliderId, CompareOp, DiscreteId, EdgeId,
    EntityId, EnvelopeId, ExprId, FollowId, Function, GroupId, IdRange, IdVec, Inputs, LeafId, Looks, ModeId, ParamId,
    Press, ProbeId, RareVec, RefId, SendId, SignalId, SlotId, SpaceId, SpawnId, Subject, TagId, TimerId, Touch,
    TouchId, VarId, World, WorldId,
};

/// A compiled program.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct Program {
    /// All tags, in order of first use; at most 64.
    pub tags: IdVec<TagId, String>,
    /// All expressions. An operand has a lower id than its operator, so ids are in evaluation order.
    pub exprs: Arena<ExprId, Expr>,
    /// All entities.
    pub entities: IdVec<EntityId, Arc<Entity>>,
    /// All worlds.
    pub worlds: IdVec<WorldId, Arc<World>>,
    /// What things look like; no part of its meaning.
    #[serde(default, skip_serializing_if = "Looks::is_empty")]
    pub looks: Looks,
    /// Where each entry comes from.
    #[serde(default)]
    pub spans: Spans,
}

/// An expression. Numbers are `f64`; a whole number or the index of a set's value is one, too.
/// Guards are read as truth values; reading a truth value as a number gives 0 or 1.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Expr {
    /// A number; always finite.
    Number(f64),
    /// A number of steps of the running world, in seconds.
    Frames(f64),
    /// A truth value.
    Bool(bool),
    /// A parameter.
    Param(Subject, ParamId),
    /// A continuous variable (0), its velocity (1) or acceleration (2).
    Var(Subject, VarId, u8),
    /// A discrete variable.
    Discrete(Subject, DiscreteId),
    /// An axis of the player who controls the instance, 0 if there is none.
    Axis(AxisId),
    /// What nature draws for the instance in this step.
    Chance(ChanceId),
    /// A timer in seconds: its count times the step's fraction, rounded once.
    Timer(TimerId),
    /// `-a`
    Negate(ExprId),
    /// Arithmetic; dividing by zero and leaving the finite numbers stop the step.
    Arithmetic(Arithmetic, ExprId, ExprId),
    /// A function; unused arguments repeat the last one.
    Call(Function, [ExprId; 3]),
    /// A comparison.
    Compare(CompareOp, ExprId, ExprId),
    /// Both; the second is not read if the first is false.
    And(ExprId, ExprId),
    /// One of both; the second is not read if the first is true.
    Or(ExprId, ExprId),
    /// Not.
    Not(ExprId),
    /// A button of the player who controls the instance, up if there is none.
    Button(Press, ButtonId),
    /// A bit that the last collision phase set.
    Touching(Subject, TouchId),
    /// A collider of the instance tagged `mine`, moved by `offset`, overlaps something tagged `other`.
    Probe {
        /// The tag of one's own collider.
        mine: TagId,
        /// The tag of what is there.
        other: TagId,
        /// Along x and y, px; it reads only the instance itself.
        offset: [ExprId; 2],
        /// Only instances count, and perhaps tiles that can be broken.
        bound: bool,
        /// Tiles that can be broken count as well, where only instances do.
        #[serde(default, skip_serializing_if = "is_false")]
        tiles: bool,
    },
    /// The number of living instances of an entity for which a condition holds; it reads the instance as
    /// [`Subject::Member`], and asks no such question itself.
    Count {
        /// The entity.
        of: EntityId,
        /// The condition.
        holds: ExprId,
    },
    /// There is a living instance of an entity, in the space of the instance itself and another one, for which a
    /// condition holds, as above. It reads nothing but the instance itself and the member.
    Nearest {
        /// The entity.
        of: EntityId,
        /// The condition.
        holds: ExprId,
    },
    /// A mode of another group of the instance is entered (true) or left in this step.
    Joint(ModeId, bool),
    /// A signal was sent to the instance in the step before.
    Received(SignalId),
    /// The sum of the numbers that were sent to the instance with a signal in the step before, 0 of none.
    Sum(SignalId),
    /// There is no such instance.
    IsNone(Subject),
    /// There is one, of this entity.
    Is(Subject, EntityId),
    /// The slot's instance is alive.
    Alive(SlotId),
    /// The active leaf of the mode's group lies in the mode; false of none.
    InMode(Subject, ModeId),
    /// The number of broken tiles with a tag.
    Broken(TagId),
    /// The number of tiles with a tag in the maps of the world, broken ones included.
    Tiles(TagId),
    /// The instance is in a space.
    InSpace(Subject, SpaceId),
    /// The Euclidean distance of the position to (`x`, `y`) is at most `radius`; px.
    Near {
        /// Whose position.
        of: Subject,
        /// The point.
        x: ExprId,
        /// The point.
        y: ExprId,
        /// The radius.
        radius: ExprId,
    },
    /// The Euclidean distance of the position to (`x`, `y`), by the shorter way in a space that wraps; px.
    Distance {
        /// Whose position.
        of: Subject,
        /// The point.
        x: ExprId,
        /// The point.
        y: ExprId,
    },
}

/// One automaton with every name resolved and every group flattened.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct Entity {
    /// Its name.
    pub name: Box<str>,
    /// Its documentation.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub doc: Option<Box<str>>,
    /// Parameters: constant per instance, see [`super::Slot::params`].
    pub params: RareVec<ParamId, Param>,
    /// Continuous variables by name; `x` and `y` are the first two.
    pub vars: IdVec<VarId, Arc<str>>,
    /// Their first values, 0 where there is none; they read parameters only.
    pub first: IdVec<VarId, Option<ExprId>>,
    /// Discrete variables.
    pub discretes: RareVec<DiscreteId, Discrete>,
    /// References to other instances.
    pub refs: RareVec<RefId, Reference>,
    /// Buttons that it reads; at most 64.
    pub buttons: RareVec<ButtonId, String>,
    /// Axes that it reads; at most 4.
    pub axes: RareVec<AxisId, String>,
    /// What nature draws for it in each step; at most 64.
    #[serde(default, skip_serializing_if = "no_chances")]
    pub chances: RareVec<ChanceId, Chance>,
    /// Colliders.
    pub colliders: RareVec<ColliderId, Collider>,
    /// Groups; one leaf of each is active.
    pub groups: RareVec<GroupId, Group>,
    /// Modes in preorder, group by group.
    pub modes: RareVec<ModeId, Mode>,
    /// Edges in source order.
    pub edges: RareVec<EdgeId, Edge>,
    /// Envelopes.
    pub envelopes: RareVec<EnvelopeId, Envelope>,
    /// Leaves in preorder, group by group.
    pub leaves: RareVec<LeafId, Leaf>,
    /// The distinct contact queries of the entity and of the goals about it: one bit each.
    pub touches: RareVec<TouchId, Touch>,
    /// How many of them, the first ones, keep the instance that is touched.
    pub bound: usize,
    /// The probes that name the instance that they find: expressions of the kinds `probe` and `nearest`. Of several
    /// nearest instances it is the one with the lowest slot.
    #[serde(default, skip_serializing_if = "RareVec::is_none")]
    pub probes: RareVec<ProbeId, ExprId>,
    /// The modes whose time is read: one counter each.
    pub timers: RareVec<TimerId, Timer>,
    /// What is spawned on edges.
    pub spawns: RareVec<SpawnId, Spawn>,
    /// Signals that it receives; those with a number first.
    #[serde(default, skip_serializing_if = "RareVec::is_none")]
    pub signals: RareVec<SignalId, Signal>,
    /// What it sends.
    #[serde(default, skip_serializing_if = "RareVec::is_none")]
    pub sends: RareVec<SendId, Send>,
    /// `follow links` of all modes.
    pub follows: RareVec<FollowId, Follow>,
    /// Soft bounds of variables.
    pub clamps: Box<[Clamp]>,
    /// What must always hold.
    pub invariants: Box<[ExprId]>,
    /// The groups in the order in which they are decided.
    pub order: Box<[GroupId]>,
    /// Drives of the variables that no group drives, one for each of them.
    pub free: Box<[Drive]>,
    /// Inputs that it reads in whatever mode.
    pub inputs: Inputs,
    /// Its code in the arena.
    pub code: IdRange<ExprId>,
}

#[allow(clippy::trivially_copy_pass_by_ref, reason = "the form that serde asks for")]
pub(super) fn is_false(value: &bool) -> bool {
    !value
}

fn no_chances(chances: &RareVec<ChanceId, Chance>) -> bool {
    chances.is_empty()
}

/// A parameter.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct Param {
    /// Its name.
    pub name: String,
    /// Its default; reads only earlier parameters.
    pub default: ExprId,
}

/// A discrete variable.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct Discrete {
    /// Its name.
    pub name: String,
    /// What its number stands for.
    pub domain: Domain,
    /// The least and the greatest value; leaving them stops the step.
    pub range: (i32, i32),
    /// Its first value; reads parameters only.
    pub first: ExprId,
}

/// What a discrete variable's number stands for.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Domain {
    /// Itself.
    Int,
    /// 0 false, 1 true.
    Bool,
    /// The name with that index.
    Set(Vec<String>),
}

impl Domain {
    /// A value as the language writes it; empty if it is none of a set.
    pub fn text(&self, value: i32) -> String {
        match self {
            Domain::Int => value.to_string(),
            Domain::Bool => (value != 0).to_string(),
            Domain::Set(names) => {
                usize::try_from(value).ok().and_then(|value| names.get(value)).cloned().unwrap_or_default()
            }
        }
    }
}

/// A reference to another instance.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct Reference {
    /// Its name.
    pub name: String,
    /// What it may refer to; any entity if none.
    pub entity: Option<EntityId>,
}

/// A soft bound, applied in the continuous phase: to a velocity before it moves the position, to a position after.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct Clamp {
    /// The variable.
    pub var: VarId,
    /// Position (0) or velocity (1).
    pub degree: u8,
    /// The least value, read before the phase.
    pub low: Option<ExprId>,
    /// The greatest value, read before the phase.
    pub high: Option<ExprId>,
}

/// A group of modes, one of whose leaves is active.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct Group {
    /// Its name; none for the anonymous one.
    pub name: Option<String>,
    /// Its modes.
    pub modes: IdRange<ModeId>,
    /// The mode that is active at first, if no choice says otherwise.
    pub first: ModeId,
    /// Modes that are active at first instead, the first whose guard holds.
    pub choices: Vec<Choice>,
}

/// A mode that is the initial one where its guard holds; the guard reads parameters only.
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct Choice {
    /// When it is.
    pub guard: ExprId,
    /// The mode.
    pub mode: ModeId,
}

/// A mode.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct Mode {
    /// Its full path: `movement.air.rising`.
    pub path: String,
    /// The mode around it.
    pub parent: Option<ModeId>,
    /// The mode after its last descendant: descendants are the range up to here.
    pub end: ModeId,
    /// Its group.
    pub group: GroupId,
    /// The leaves inside it (itself, if it is one).
    pub leaves: IdRange<LeafId>,
    /// The leaf that becomes active when it is entered, if no choice inside says otherwise.
    pub initial: LeafId,
    /// Modes directly inside that are entered instead, the first whose guard holds.
    pub choices: Vec<Choice>,
    /// Whether it or a mode inside has choices.
    pub chooses: bool,
    /// The mode directly inside that is entered if no guard holds; none for a leaf.
    pub inner: Option<ModeId>,
    /// What happens when it is entered by an edge.
    pub entry: Actions,
}

/// An edge.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct Edge {
    /// The mode that holds it.
    pub source: ModeId,
    /// Where it leads; none if it stays. Of the same group as `source`.
    pub target: Option<ModeId>,
    /// When it is taken.
    pub guard: ExprId,
    /// What it changes.
    pub actions: Actions,
    /// References that must not be none for an edge without a target to run.
    pub needs: Vec<RefId>,
}

/// `follow links`: the instance goes where a link leads.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct Follow {
    /// When; always if none.
    pub guard: Option<ExprId>,
    /// What it changes when a link is followed.
    pub actions: Actions,
    /// References that must not be none.
    pub needs: Vec<RefId>,
}

/// What drives a variable during the continuous phase.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Drive {
    /// No flow: the last acceleration stays in force.
    Coast(VarId),
    /// `value` is its position (0), velocity (1) or acceleration (2).
    Flow {
        /// The variable.
        var: VarId,
        /// Which derivative is given.
        degree: u8,
        /// Its value.
        value: ExprId,
    },
    /// A component of an envelope.
    Envelope(EnvelopeId, u8),
}

/// An envelope: while driven, towards the direction times `sustain`.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct Envelope {
    /// The mode that holds it; none at the entity's own level.
    pub mode: Option<ModeId>,
    /// The variables: one, or the components of a vector.
    pub vars: Vec<VarId>,
    /// Which derivative is controlled.
    pub degree: u8,
    /// What drives it.
    pub by: By,
    /// The level to be held; by the clock: the peak.
    pub sustain: ExprId,
    /// How fast it rises, per second; none at once.
    pub attack: Option<ExprId>,
    /// The level it rises to first, if not to the one that is held.
    pub peak: Option<ExprId>,
    /// How fast it goes from the peak to the held level, per second; none at once.
    pub decay: Option<ExprId>,
    /// How it ends.
    pub release: Release,
    /// It counts as released while this does not hold.
    pub guard: Option<ExprId>,
}

/// What drives an envelope.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum By {
    /// A button: while it is down.
    Button(ButtonId),
    /// The sign of an axis.
    Axis(AxisId),
    /// The direction of two axes: the nearest of these unit vectors, or as it is if there are none.
    Axes([AxisId; 2], Vec<[f64; 2]>),
    /// The time since the mode was entered: it rises for `rise` seconds to `sustain`, stays for `hold`, falls for `fall`.
    Clock {
        /// Counts the steps.
        timer: TimerId,
        /// Seconds.
        rise: ExprId,
        /// Seconds.
        hold: ExprId,
        /// Seconds.
        fall: ExprId,
        /// All three together.
        total: ExprId,
    },
}

/// How an envelope ends.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Release {
    /// It stays.
    Hold,
    /// It goes to `level` with the sign it has, so fast per second, or at once.
    To {
        /// How fast.
        rate: Option<ExprId>,
        /// Where to.
        level: ExprId,
    },
}

/// A mode without modes inside, resolved: what is active and what to try while it is.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct Leaf {
    /// The mode.
    pub mode: ModeId,
    /// The active modes of the group, outermost first, the leaf's own last.
    pub path: Vec<ModeId>,
    /// One drive for each variable that the group drives anywhere.
    pub drives: Vec<Drive>,
    /// Edges with a target, in the order in which they are tried; the first that holds is taken.
    pub edges: Vec<EdgeId>,
    /// Edges without a target, in walk order; each that holds runs.
    pub internal: Vec<EdgeId>,
    /// `follow links`, in walk order; the first that holds counts.
    pub follows: Vec<FollowId>,
    /// Inputs that anything active reads.
    pub inputs: Inputs,
}

/// A mode whose time is read.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct Timer {
    /// The mode.
    pub mode: ModeId,
    /// All that it is compared with, where all of it is known per instance: the count saturates above.
    pub thresholds: Option<Vec<ExprId>>,
}
