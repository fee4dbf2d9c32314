//! The checked program: what `sema` makes of the syntax tree. Every name is an id, every expression has a type,
//! the hierarchy of modes is kept; flattening it is the work of `ir`.

use std::rc::Rc;

use serde::Serialize;

use crate::level::TileMap;
use crate::source::Span;
use crate::syntax::ast::Dimension;
pub use crate::syntax::ast::{CompareOp, Name};

use super::ids::{
    AxisId, ButtonId, ColliderId, DiscreteId, EdgeId, EntityId, EnvelopeId, GoalId, GroupId, IdVec, ModeId, NeverId,
    ParamId, PlayerId, SlotId, SpaceId, TagId, VarId, WorldId,
};

/// A program without errors.
#[derive(Debug, Clone, Default)]
pub struct Checked {
    /// All tags that occur, in order of first use.
    pub tags: IdVec<TagId, Name>,
    /// All entities.
    pub entities: IdVec<EntityId, Rc<Entity>>,
    /// All worlds, those of the root file first.
    pub worlds: IdVec<WorldId, World>,
}

/// A type of values.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Type {
    /// A number with a fraction and perhaps a dimension.
    Real,
    /// A whole number.
    Int,
    /// `true` or `false`.
    Bool,
    /// One of a list of names, kept as its index.
    Set(Vec<String>),
}

/// Whose variable, contact or mode an expression reads.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Subject {
    /// The instance that the code runs for.
    Me,
    /// A named instance of the world.
    Slot(SlotId),
}

/// An expression with its type.
#[derive(Debug, Clone, PartialEq)]
pub struct Term {
    /// What it computes.
    pub kind: TermKind,
    /// The type of its value.
    pub ty: Type,
    /// Where it stands.
    pub span: Span,
}

/// Arithmetic on two numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize)]
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
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize)]
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
    /// `if(condition, a, b)`
    If,
}

/// When a button counts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize)]
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
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
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

/// What an expression computes.
#[derive(Debug, Clone, PartialEq)]
pub enum TermKind {
    /// A number, or the index of a set's value.
    Number(f64),
    /// A number with a dimension of its own: the exponents of px and of s.
    Quantity(f64, i32, i32),
    /// So many steps of the world, in seconds.
    Frames(f64),
    /// A truth value.
    Bool(bool),
    /// A parameter of the instance.
    Param(ParamId),
    /// A continuous variable (degree 0) or its first or second derivative.
    Var(Subject, VarId, u8),
    /// A discrete variable.
    Discrete(Subject, DiscreteId),
    /// An axis, -1..1.
    Axis(AxisId),
    /// Seconds since a mode was entered; 0 while it is not active.
    Timer(ModeId),
    /// `-a`
    Negate(Box<Term>),
    /// Arithmetic.
    Arithmetic(Arithmetic, Box<Term>, Box<Term>),
    /// A function.
    Call(Function, Vec<Term>),
    /// A comparison.
    Compare(CompareOp, Box<Term>, Box<Term>),
    /// Both; the second is not looked at if the first is false.
    And(Box<Term>, Box<Term>),
    /// One of both; the second is not looked at if the first is true.
    Or(Box<Term>, Box<Term>),
    /// Not.
    Not(Box<Term>),
    /// A button.
    Button(Press, ButtonId),
    /// A contact of a collider tagged `mine` (any if none) with something tagged `other`, on a side of mine.
    Touching {
        /// Whose collider.
        of: Subject,
        /// The tag of one's own collider.
        mine: Option<TagId>,
        /// The tag of what is touched.
        other: TagId,
        /// The side of one's own collider.
        side: Option<Side>,
    },
    /// A mode is active.
    InMode(Subject, ModeId),
    /// The instance is in a space.
    InSpace(Subject, SpaceId),
    /// The Euclidean distance of the position to a point is at most a radius.
    Near {
        /// Whose position.
        of: Subject,
        /// The point, px.
        x: Box<Term>,
        /// The point, px.
        y: Box<Term>,
        /// The radius, px.
        radius: Box<Term>,
    },
}

/// An entity.
#[derive(Debug, Clone)]
pub struct Entity {
    /// Its name.
    pub name: Name,
    /// Its documentation.
    pub doc: Option<String>,
    /// Parameters; a default may read earlier ones.
    pub params: IdVec<ParamId, Param>,
    /// Continuous variables, `x` and `y` first.
    pub vars: IdVec<VarId, Var>,
    /// Discrete variables.
    pub discretes: IdVec<DiscreteId, Discrete>,
    /// Buttons that it reads.
    pub buttons: IdVec<ButtonId, Name>,
    /// Axes that it reads.
    pub axes: IdVec<AxisId, Name>,
    /// Colliders.
    pub colliders: IdVec<ColliderId, Collider>,
    /// Groups; the anonymous one has no name.
    pub groups: IdVec<GroupId, Group>,
    /// Modes of all groups in preorder.
    pub modes: IdVec<ModeId, Mode>,
    /// Edges of all modes in source order.
    pub edges: IdVec<EdgeId, Edge>,
    /// Envelopes.
    pub envelopes: IdVec<EnvelopeId, Envelope>,
    /// Flows and envelopes at the entity's own level.
    pub drives: Vec<Drive>,
}

/// A parameter.
#[derive(Debug, Clone)]
pub struct Param {
    /// Its name.
    pub name: Name,
    /// Its default.
    pub default: Term,
    /// Its annotated dimension.
    pub dimension: Option<Annotation>,
}

/// A continuous variable.
#[derive(Debug, Clone)]
pub struct Var {
    /// Its name.
    pub name: Name,
    /// Its first value; none for `x` and `y`, which are placed.
    pub initial: Option<Term>,
    /// Its annotated dimension.
    pub dimension: Option<Annotation>,
}

/// A discrete variable.
#[derive(Debug, Clone)]
pub struct Discrete {
    /// Its name.
    pub name: Name,
    /// Its type.
    pub ty: Type,
    /// The least and the greatest value that it may take.
    pub range: (i32, i32),
    /// Its first value.
    pub initial: Term,
}

/// A collider: a rectangle relative to the position.
#[derive(Debug, Clone)]
pub struct Collider {
    /// What it counts as.
    pub tags: Vec<TagId>,
    /// Whether it is never pushed.
    pub kinematic: bool,
    /// x and y of the lower-left corner, width, height; px.
    pub rect: [Term; 4],
    /// While this holds it is there.
    pub guard: Option<Term>,
    /// The whole.
    pub span: Span,
}

/// A group.
#[derive(Debug, Clone)]
pub struct Group {
    /// Its name; none for the anonymous one.
    pub name: Option<Name>,
    /// Its outermost modes.
    pub modes: Vec<ModeId>,
}

/// A mode.
#[derive(Debug, Clone)]
pub struct Mode {
    /// Its name.
    pub name: Name,
    /// Its documentation.
    pub doc: Option<String>,
    /// Its full path, the group's name first.
    pub path: Vec<String>,
    /// The group it belongs to.
    pub group: GroupId,
    /// The mode around it.
    pub parent: Option<ModeId>,
    /// The modes directly inside.
    pub children: Vec<ModeId>,
    /// Marked `initial` without a guard.
    pub marked_initial: bool,
    /// Guard of `initial when`.
    pub initial_when: Option<Term>,
    /// Flows and envelopes.
    pub drives: Vec<Drive>,
    /// Entry updates.
    pub entry: Vec<Update>,
    /// Edges in source order.
    pub edges: Vec<EdgeId>,
    /// The whole.
    pub span: Span,
}

/// What drives a variable.
#[derive(Debug, Clone)]
pub struct Drive {
    /// The variable.
    pub var: VarId,
    /// 0 position, 1 velocity, 2 acceleration.
    pub degree: u8,
    /// By what.
    pub by: DriveBy,
    /// Where it says so.
    pub span: Span,
}

/// By what a variable is driven.
#[derive(Debug, Clone)]
pub enum DriveBy {
    /// The value of an expression.
    Flow(Term),
    /// An envelope.
    Envelope(EnvelopeId),
}

/// An edge.
#[derive(Debug, Clone)]
pub struct Edge {
    /// The mode that holds it.
    pub source: ModeId,
    /// Where it leads; none if it stays.
    pub target: Option<ModeId>,
    /// When it is taken.
    pub guard: Term,
    /// What it changes.
    pub updates: Vec<Update>,
    /// The whole.
    pub span: Span,
}

/// An update of a variable.
#[derive(Debug, Clone)]
pub struct Update {
    /// What is updated.
    pub place: Place,
    /// Its new value.
    pub value: Term,
    /// The whole.
    pub span: Span,
}

/// What an update can write.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Place {
    /// A continuous variable or one of its derivatives.
    Var(VarId, u8),
    /// A discrete variable.
    Discrete(DiscreteId),
}

/// A two-way envelope: the sign of an axis mirrors it.
#[derive(Debug, Clone)]
pub struct Envelope {
    /// What it drives.
    pub var: VarId,
    /// Of which degree.
    pub degree: u8,
    /// The axis.
    pub axis: AxisId,
    /// How it rises.
    pub attack: Rate,
    /// The level it rises to.
    pub sustain: Term,
    /// How it falls.
    pub release: Release,
    /// Holds while it can be driven.
    pub driven_while: Option<Term>,
    /// The whole.
    pub span: Span,
}

/// How fast a ramp is.
#[derive(Debug, Clone)]
pub enum Rate {
    /// At once.
    Instant,
    /// By so much a second.
    Accel(Term),
    /// So that the whole way takes so many seconds.
    Over(Term),
}

/// How an envelope ends.
#[derive(Debug, Clone)]
pub enum Release {
    /// It stays where it is.
    Hold,
    /// It goes to a level (0 if none).
    To(Rate, Option<Term>),
}

/// A world.
#[derive(Debug, Clone)]
pub struct World {
    /// Its name.
    pub name: Name,
    /// The length of a step as a fraction of seconds.
    pub step: (u64, u64),
    /// What must be lengths: the sides of tiles.
    pub lengths: Vec<Term>,
    /// `collide` lines in source order.
    pub collide: Vec<CollideRule>,
    /// Its spaces.
    pub spaces: IdVec<SpaceId, Space>,
    /// Its placed instances.
    pub instances: IdVec<SlotId, Instance>,
    /// Its players.
    pub players: IdVec<PlayerId, Player>,
    /// What is looked for.
    pub goals: IdVec<GoalId, Question>,
    /// What must not happen.
    pub nevers: IdVec<NeverId, Question>,
    /// The whole.
    pub span: Span,
}

/// What a contact does.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Response {
    /// It is noticed.
    Sense,
    /// The one that can move is pushed out.
    Block {
        /// Its velocity into the surface is kept.
        keep_velocity: bool,
    },
}

/// A `collide` line.
#[derive(Debug, Clone)]
pub struct CollideRule {
    /// The tags on one side.
    pub left: Vec<TagId>,
    /// The tags on the other.
    pub right: Vec<TagId>,
    /// What a contact does.
    pub response: Response,
}

/// A space.
#[derive(Debug, Clone)]
pub struct Space {
    /// Its name.
    pub name: Name,
    /// Its map, with the tags of each kind of tile.
    pub map: Option<TileMap<TagId>>,
    /// Free-standing static geometry.
    pub solids: Vec<Solid>,
    /// Where a player may be: x and y of the lower-left corner, width, height; px.
    pub bounds: Option<[f64; 4]>,
}

/// Free-standing static geometry.
#[derive(Debug, Clone)]
pub struct Solid {
    /// What it counts as.
    pub tags: Vec<TagId>,
    /// x and y of the lower-left corner, width, height; px.
    pub rect: [f64; 4],
    /// The line.
    pub span: Span,
}

/// A placed instance with its first values.
#[derive(Debug, Clone)]
pub struct Instance {
    /// Its name.
    pub name: Name,
    /// Its entity.
    pub entity: EntityId,
    /// The space it stands in.
    pub space: SpaceId,
    /// The values of its parameters.
    pub params: IdVec<ParamId, f64>,
    /// Position, velocity and acceleration of each continuous variable.
    pub vars: IdVec<VarId, [f64; 3]>,
    /// The values of its discrete variables.
    pub discretes: IdVec<DiscreteId, i32>,
    /// What its place sets, as written.
    pub given: Vec<(Given, Term)>,
    /// Where it is placed.
    pub span: Span,
}

/// What a `place` can set.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Given {
    /// A parameter.
    Param(ParamId),
    /// A continuous variable or one of its derivatives.
    Var(VarId, u8),
    /// A discrete variable.
    Discrete(DiscreteId),
}

/// A player.
#[derive(Debug, Clone)]
pub struct Player {
    /// The number as written.
    pub number: u32,
    /// The instance it controls.
    pub slot: SlotId,
    /// The line.
    pub span: Span,
}

/// A `goal` or a `never`.
#[derive(Debug, Clone)]
pub struct Question {
    /// Its name.
    pub name: Name,
    /// The predicate.
    pub predicate: Term,
}

/// A dimension that the author wrote.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Annotation {
    /// Exponent of px.
    pub px: i32,
    /// Exponent of s.
    pub s: i32,
    /// Where it stands.
    pub span: Span,
}

impl Annotation {
    /// Reads `px/s^2`.
    ///
    /// # Errors
    /// The first name that is no unit.
    pub fn read(d: &Dimension) -> Result<Self, Name> {
        let mut out = Annotation { px: 0, s: 0, span: d.span };
        for (name, exponent) in &d.factors {
            match name.text.as_str() {
                "px" => out.px = out.px.saturating_add(*exponent),
                "s" => out.s = out.s.saturating_add(*exponent),
                "1" => {}
                _ => return Err(name.clone()),
            }
        }
        Ok(out)
    }
}
