//! The tables. Their fields say what they mean at run time and what always holds of them.

use serde::Serialize;

use super::layout::Layout;
use super::{
    Arithmetic, AxisId, ButtonId, ColliderId, CompareOp, DiscreteId, EdgeId, EntityId, EnvelopeId, ExprId, Function,
    GoalId, GroupId, IdVec, LeafId, ModeId, NeverId, ParamId, Place, PlayerId, Press, Response, Side, SlotId, SpaceId,
    Subject, TagId, TimerId, TouchId, VarId, WorldId,
};
use crate::level::TileMap;
use crate::source::Span;

/// A compiled program.
#[derive(Debug, Clone, Default, Serialize)]
pub struct Program {
    /// All tags, in order of first use; at most 64.
    pub tags: IdVec<TagId, String>,
    /// All expressions. An operand has a lower id than its operator, so ids are in evaluation order.
    pub exprs: IdVec<ExprId, Expr>,
    /// All entities.
    pub entities: IdVec<EntityId, Entity>,
    /// All worlds.
    pub worlds: IdVec<WorldId, World>,
    /// Where each entry comes from.
    pub spans: Spans,
}

/// A set of tags, one bit each.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
pub struct TagSet(pub u64);

impl TagSet {
    /// Every tag.
    pub const ALL: TagSet = TagSet(u64::MAX);

    /// The set of one tag.
    pub fn of(tag: TagId) -> TagSet {
        TagSet(1u64.checked_shl(tag.0).unwrap_or(0))
    }

    /// Both sets together.
    #[must_use]
    pub fn with(self, other: TagSet) -> TagSet {
        TagSet(self.0 | other.0)
    }

    /// Whether the sets share a tag.
    pub fn meets(self, other: TagSet) -> bool {
        self.0 & other.0 != 0
    }

    /// The tags in order.
    pub fn iter(self) -> impl Iterator<Item = TagId> {
        (0..64).filter(move |bit| self.0 >> bit & 1 == 1).map(TagId)
    }
}

impl FromIterator<TagId> for TagSet {
    fn from_iter<A: IntoIterator<Item = TagId>>(tags: A) -> TagSet {
        tags.into_iter().fold(TagSet::default(), |set, tag| set.with(TagSet::of(tag)))
    }
}

/// An expression. Numbers are `f64`; a whole number or the index of a set's value is one, too.
/// Guards are read as truth values; reading a truth value as a number gives 0 or 1.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Expr {
    /// A number; always finite.
    Number(f64),
    /// So many steps of the running world, in seconds.
    Frames(f64),
    /// A truth value.
    Bool(bool),
    /// A parameter of the instance.
    Param(ParamId),
    /// A continuous variable (0), its velocity (1) or acceleration (2).
    Var(Subject, VarId, u8),
    /// A discrete variable.
    Discrete(Subject, DiscreteId),
    /// An axis of the player who controls the instance, 0 if there is none.
    Axis(AxisId),
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
    /// The active leaf of the mode's group lies in the mode.
    InMode(Subject, ModeId),
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
}

/// One automaton with every name resolved and every group flattened.
#[derive(Debug, Clone, Serialize)]
pub struct Entity {
    /// Its name.
    pub name: String,
    /// Its documentation.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub doc: Option<String>,
    /// Parameters: constant per instance, see [`Slot::params`].
    pub params: IdVec<ParamId, Param>,
    /// Continuous variables by name; `x` and `y` are the first two.
    pub vars: IdVec<VarId, String>,
    /// Discrete variables.
    pub discretes: IdVec<DiscreteId, Discrete>,
    /// Buttons that it reads; at most 64.
    pub buttons: IdVec<ButtonId, String>,
    /// Axes that it reads; at most 4.
    pub axes: IdVec<AxisId, String>,
    /// Colliders.
    pub colliders: IdVec<ColliderId, Collider>,
    /// Groups; one leaf of each is active.
    pub groups: IdVec<GroupId, Group>,
    /// Modes in preorder, group by group.
    pub modes: IdVec<ModeId, Mode>,
    /// Edges in source order.
    pub edges: IdVec<EdgeId, Edge>,
    /// Envelopes.
    pub envelopes: IdVec<EnvelopeId, Envelope>,
    /// Leaves in preorder, group by group.
    pub leaves: IdVec<LeafId, Leaf>,
    /// The distinct contact questions of the entity and of the goals about it: one bit each.
    pub touches: IdVec<TouchId, Touch>,
    /// The modes whose time is read: one counter each.
    pub timers: IdVec<TimerId, Timer>,
    /// Drives of the variables that no group drives, one for each of them.
    pub free: Vec<Drive>,
    /// Inputs that it reads in whatever mode.
    pub inputs: Inputs,
}

/// A parameter.
#[derive(Debug, Clone, Serialize)]
pub struct Param {
    /// Its name.
    pub name: String,
    /// Its default; reads only earlier parameters.
    pub default: ExprId,
}

/// A discrete variable.
#[derive(Debug, Clone, Serialize)]
pub struct Discrete {
    /// Its name.
    pub name: String,
    /// What its number stands for.
    pub domain: Domain,
    /// The least and the greatest value; leaving them stops the step.
    pub range: (i32, i32),
}

/// What a discrete variable's number stands for.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Domain {
    /// Itself.
    Int,
    /// 0 false, 1 true.
    Bool,
    /// The name with that index.
    Set(Vec<String>),
}

/// A rectangle relative to the position.
#[derive(Debug, Clone, Serialize)]
pub struct Collider {
    /// What it counts as.
    pub tags: TagSet,
    /// Whether it is never pushed.
    pub kinematic: bool,
    /// x and y of the lower-left corner, width, height; px; read at the start of the collision phase.
    pub rect: [ExprId; 4],
    /// While this holds it is there; read at the start of the collision phase.
    pub guard: Option<ExprId>,
}

/// A group of modes, one of whose leaves is active.
#[derive(Debug, Clone, Serialize)]
pub struct Group {
    /// Its name; none for the anonymous one.
    pub name: Option<String>,
    /// Its modes: from the first to before the second.
    pub modes: (ModeId, ModeId),
    /// The mode that is active at first, if no choice says otherwise.
    pub first: ModeId,
    /// Modes that are active at first instead, the first whose guard holds.
    pub choices: Vec<Choice>,
}

/// A mode that is the initial one where its guard holds; the guard reads parameters only.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct Choice {
    /// When it is.
    pub guard: ExprId,
    /// The mode.
    pub mode: ModeId,
}

/// A mode.
#[derive(Debug, Clone, Serialize)]
pub struct Mode {
    /// Its full path: `movement.air.rising`.
    pub path: String,
    /// The mode around it.
    pub parent: Option<ModeId>,
    /// The mode after its last descendant: descendants are the range up to here.
    pub end: ModeId,
    /// Its group.
    pub group: GroupId,
    /// The leaves inside it (itself, if it is one): from the first to before the second.
    pub leaves: (LeafId, LeafId),
    /// The leaf that becomes active when it is entered, if no choice inside says otherwise.
    pub initial: LeafId,
    /// Modes directly inside that are entered instead, the first whose guard holds.
    pub choices: Vec<Choice>,
    /// Whether it or a mode inside has choices.
    pub chooses: bool,
    /// The mode directly inside that is entered if no guard holds; none for a leaf.
    pub inner: Option<ModeId>,
    /// What happens when it is entered by an edge.
    pub entry: Vec<Update>,
}

/// An edge.
#[derive(Debug, Clone, Serialize)]
pub struct Edge {
    /// The mode that holds it.
    pub source: ModeId,
    /// Where it leads; none if it stays. Of the same group as `source`.
    pub target: Option<ModeId>,
    /// When it is taken.
    pub guard: ExprId,
    /// What it changes.
    pub updates: Vec<Update>,
}

/// An update; the right side reads the state before the step.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct Update {
    /// What is written.
    pub place: Place,
    /// The new value.
    pub value: ExprId,
}

/// What drives a variable during the continuous phase.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
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
    /// An envelope.
    Envelope(EnvelopeId),
}

/// A two-way envelope: while driven, towards the axis' sign times `sustain`.
#[derive(Debug, Clone, Serialize)]
pub struct Envelope {
    /// The variable.
    pub var: VarId,
    /// Which derivative is controlled.
    pub degree: u8,
    /// The axis that drives it.
    pub axis: AxisId,
    /// The level to be held.
    pub sustain: ExprId,
    /// How fast it rises, per second; none at once.
    pub attack: Option<ExprId>,
    /// How it ends.
    pub release: Release,
    /// It counts as released while this does not hold.
    pub guard: Option<ExprId>,
}

/// How an envelope ends.
#[derive(Debug, Clone, Serialize)]
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

/// Buttons and axes.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize)]
pub struct Inputs {
    /// One bit for each button.
    pub buttons: u64,
    /// One bit for each axis.
    pub axes: u8,
}

impl Inputs {
    /// Both together.
    #[must_use]
    pub fn with(self, other: Inputs) -> Inputs {
        Inputs { buttons: self.buttons | other.buttons, axes: self.axes | other.axes }
    }
}

/// A mode without modes inside, resolved: what is active and what to try while it is.
#[derive(Debug, Clone, Serialize)]
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
    /// Inputs that anything active reads.
    pub inputs: Inputs,
}

/// A contact question: a collider of one's own tagged with one of `mine`, something tagged `other`, on a side.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct Touch {
    /// Tags of one's own collider.
    pub mine: TagSet,
    /// The tag of what is touched.
    pub other: TagId,
    /// The side of one's own collider, if it matters.
    pub side: Option<Side>,
}

/// A mode whose time is read.
#[derive(Debug, Clone, Serialize)]
pub struct Timer {
    /// The mode.
    pub mode: ModeId,
    /// All that it is compared with, where all of it is known per instance: the count saturates above.
    pub thresholds: Option<Vec<ExprId>>,
}

/// A world, ready to run.
#[derive(Debug, Clone, Serialize)]
pub struct World {
    /// Its name.
    pub name: String,
    /// The length of a step.
    pub step: Step,
    /// Its spaces.
    pub spaces: IdVec<SpaceId, Space>,
    /// Its slots.
    pub slots: IdVec<SlotId, Slot>,
    /// Its players.
    pub players: IdVec<PlayerId, Player>,
    /// Which colliders meet, and what a contact does.
    pub collide: Vec<Collide>,
    /// What is looked for.
    pub goals: IdVec<GoalId, Predicate>,
    /// What must not happen.
    pub nevers: IdVec<NeverId, Predicate>,
    /// Where everything stands in a state.
    pub layout: Layout,
}

/// The length of a step as a fraction in lowest terms, s.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct Step {
    /// Numerator, more than 0.
    pub numerator: u64,
    /// Denominator, more than 0.
    pub denominator: u64,
}

impl Step {
    /// The length, s.
    pub fn seconds(self) -> f64 {
        self.numerator as f64 / self.denominator as f64
    }

    /// The length of so many steps, s, rounded once.
    pub fn times(self, count: u32) -> f64 {
        (f64::from(count) * self.numerator as f64) / self.denominator as f64
    }
}

/// A room.
#[derive(Debug, Clone, Serialize)]
pub struct Space {
    /// Its name.
    pub name: String,
    /// Its map.
    pub map: Option<TileMap<TagId>>,
    /// Free-standing static geometry.
    pub solids: Vec<Solid>,
    /// Where a player may be: a branch of a search ends below and beside; none where there is neither a map nor a word
    /// of it.
    pub bounds: Option<Bounds>,
}

/// Free-standing static geometry.
#[derive(Debug, Clone, Serialize)]
pub struct Solid {
    /// What it counts as.
    pub tags: TagSet,
    /// Where it is.
    pub bounds: Bounds,
}

/// A rectangle, px.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Bounds {
    /// Its least x.
    pub left: f64,
    /// Its greatest x.
    pub right: f64,
    /// Its least y.
    pub bottom: f64,
    /// Its greatest y.
    pub top: f64,
}

impl Bounds {
    /// From the lower-left corner, the width and the height.
    pub fn new([x, y, width, height]: [f64; 4]) -> Self {
        Bounds { left: x, right: x + width, bottom: y, top: y + height }
    }
}

/// A place for an instance, with the instance's first values.
#[derive(Debug, Clone, Serialize)]
pub struct Slot {
    /// The instance's name.
    pub name: String,
    /// Its entity.
    pub entity: EntityId,
    /// The space it is in at first.
    pub space: SpaceId,
    /// Who controls it.
    pub player: Option<PlayerId>,
    /// The values of its parameters.
    pub params: IdVec<ParamId, f64>,
    /// Position, velocity and acceleration of each continuous variable.
    pub vars: IdVec<VarId, [f64; 3]>,
    /// The values of its discrete variables, within their ranges.
    pub discretes: IdVec<DiscreteId, i32>,
    /// Where each timer's count saturates.
    pub timer_limits: IdVec<TimerId, u32>,
}

/// A player.
#[derive(Debug, Clone, Serialize)]
pub struct Player {
    /// The number as written.
    pub number: u32,
    /// The slot it controls; no other player does.
    pub slot: SlotId,
}

/// Colliders with a tag of `left` and one with a tag of `right` meet.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct Collide {
    /// The one side.
    pub left: TagSet,
    /// The other.
    pub right: TagSet,
    /// What a contact does.
    pub response: Response,
}

/// A `goal` or a `never`.
#[derive(Debug, Clone, Serialize)]
pub struct Predicate {
    /// Its name.
    pub name: String,
    /// When it holds; reads instances, no inputs.
    pub holds: ExprId,
}

impl World {
    /// What a contact between colliders of these tags does; none if they do not meet. The strongest line holds.
    pub fn response(&self, a: TagSet, b: TagSet) -> Option<Response> {
        let strength = |r: &Response| match r {
            Response::Sense => 0,
            Response::Block { keep_velocity: true } => 1,
            Response::Block { keep_velocity: false } => 2,
        };
        self.collide
            .iter()
            .filter(|c| (c.left.meets(a) && c.right.meets(b)) || (c.left.meets(b) && c.right.meets(a)))
            .map(|c| c.response)
            .max_by_key(strength)
    }
}

/// Where the entries of the tables come from.
#[derive(Debug, Clone, Default, Serialize)]
pub struct Spans {
    /// Of each tag: its first use.
    pub tags: IdVec<TagId, Span>,
    /// Of each expression.
    pub exprs: IdVec<ExprId, Span>,
    /// Of each entity's entries.
    pub entities: IdVec<EntityId, EntitySpans>,
    /// Of each world's entries.
    pub worlds: IdVec<WorldId, WorldSpans>,
}

/// Where an entity's entries come from; a leaf and a timer come from their modes.
#[derive(Debug, Clone, Serialize)]
pub struct EntitySpans {
    /// The entity's name.
    pub name: Span,
    /// Of each parameter's name.
    pub params: IdVec<ParamId, Span>,
    /// Of each variable's name (of `x` and `y`: the entity's).
    pub vars: IdVec<VarId, Span>,
    /// Of each discrete variable's name.
    pub discretes: IdVec<DiscreteId, Span>,
    /// Of each button's name.
    pub buttons: IdVec<ButtonId, Span>,
    /// Of each axis' name.
    pub axes: IdVec<AxisId, Span>,
    /// Of each collider.
    pub colliders: IdVec<ColliderId, Span>,
    /// Of each group's name (of the anonymous one: the entity's).
    pub groups: IdVec<GroupId, Span>,
    /// Of each contact question: where it is first asked.
    pub touches: IdVec<TouchId, Span>,
    /// Of each mode's name.
    pub modes: IdVec<ModeId, Span>,
    /// Of each edge.
    pub edges: IdVec<EdgeId, Span>,
    /// Of each envelope.
    pub envelopes: IdVec<EnvelopeId, Span>,
}

/// Where a world's entries come from.
#[derive(Debug, Clone, Serialize)]
pub struct WorldSpans {
    /// The world's name.
    pub name: Span,
    /// Of each space's name.
    pub spaces: IdVec<SpaceId, Span>,
    /// Of each space's free-standing geometry.
    pub solids: IdVec<SpaceId, Vec<Span>>,
    /// Of each slot.
    pub slots: IdVec<SlotId, Span>,
    /// Of each player's line.
    pub players: IdVec<PlayerId, Span>,
    /// Of each goal's name.
    pub goals: IdVec<GoalId, Span>,
    /// Of each never's name.
    pub nevers: IdVec<NeverId, Span>,
}
