//! The checked program: what `sema` makes of the syntax tree. Every name is an id, every expression has a type,
//! the hierarchy of modes is kept; flattening it is the work of `ir`.

use std::collections::BTreeSet;
use std::sync::Arc;

use crate::ir::{
    Arithmetic, AxisId, ButtonId, ColliderId, CompareOp, DiscreteId, EdgeId, EntityId, EnvelopeId, Function, GroupId,
    Id, IdVec, ModeId, ParamId, Place, Press, RareVec, RefId, Side, SlotId, SpaceId, Subject, TagId, TouchId, VarId,
    WorldId,
};

pub use super::annotation::Annotation;
pub use super::checked_world::*;
use crate::source::Span;
pub use crate::syntax::ast::Name;
use crate::syntax::occurrence::Occurrences;

use super::dimension::Dimensions;

/// A program without errors.
#[derive(Debug, Clone, Default)]
pub struct Checked {
    /// All tags that occur, in order of first use.
    pub tags: IdVec<TagId, Name>,
    /// All entities.
    pub entities: IdVec<EntityId, Arc<Entity>>,
    /// All worlds, those of the root file first.
    pub worlds: IdVec<WorldId, World>,
    /// Tags that tiles could carry which no map of the program has.
    pub other_tags: BTreeSet<String>,
    /// Whether a world leaves its map to the command line.
    pub has_open_map: bool,
    /// Tags that levels and legends name.
    pub level_tags: BTreeSet<String>,
    /// Where names occur.
    pub occurrences: Occurrences,
    /// What was found of dimensions.
    pub dimensions: Dimensions,
}

/// A list of names that discrete variables range over.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SetId(pub u32);

impl Id for SetId {
    fn from_index(index: usize) -> Self {
        SetId(index as u32)
    }

    fn index(self) -> usize {
        self.0 as usize
    }
}

/// A type of values.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Type {
    /// A number with a fraction and perhaps a dimension.
    Real,
    /// A whole number.
    Int,
    /// `true` or `false`.
    Bool,
    /// One of a list of names, kept as its index.
    Set(SetId),
    /// An instance of an entity, or none.
    Ref(EntityId),
    /// An instance of any entity, or none.
    AnyRef,
}

impl Type {
    /// That of a reference to an entity, or to any.
    pub fn reference(entity: Option<EntityId>) -> Self {
        entity.map_or(Type::AnyRef, Type::Ref)
    }
}

/// An expression with its type.
#[derive(Debug, Clone, PartialEq)]
pub struct Term {
    /// What it computes.
    pub kind: TermKind,
    /// The type of its value.
    pub ty: Type,
    /// Its place.
    pub span: Span,
}

// A large program has as many of them as its text has bytes.
const _: () = assert!(size_of::<Term>() <= 32);

impl Term {
    /// The terms directly inside of it.
    pub fn operands(&self) -> &[Term] {
        match &self.kind {
            TermKind::Negate(a) | TermKind::Not(a) => std::slice::from_ref(a),
            TermKind::Arithmetic(_, sides)
            | TermKind::Compare(_, sides)
            | TermKind::And(sides)
            | TermKind::Or(sides) => sides.as_slice(),
            TermKind::Call(call) => &call.1,
            TermKind::Near(asked) => &asked.1,
            _ => &[],
        }
    }

    /// The term, and nothing in its place.
    pub fn take(&mut self) -> Term {
        Term { kind: std::mem::replace(&mut self.kind, TermKind::NoneRef), ty: self.ty, span: self.span }
    }
}

/// What an expression computes. A large text has many of them, so what is seldom or large is in boxes.
#[derive(Debug, Clone, PartialEq)]
pub enum TermKind {
    /// A number, or the index of a set's value.
    Number(f64),
    /// A number with a dimension of its own: the exponents of px and of s.
    Quantity(Box<(f64, i32, i32)>),
    /// A number of steps of the world, in seconds.
    Frames(f64),
    /// A truth value.
    Bool(bool),
    /// A parameter.
    Param(Subject, ParamId),
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
    Arithmetic(Arithmetic, Box<[Term; 2]>),
    /// A function.
    Call(Box<(Function, Box<[Term]>)>),
    /// A comparison.
    Compare(CompareOp, Box<[Term; 2]>),
    /// Both; the second is not looked at if the first is false.
    And(Box<[Term; 2]>),
    /// One of both; the second is not looked at if the first is true.
    Or(Box<[Term; 2]>),
    /// Not.
    Not(Box<Term>),
    /// A button.
    Button(Press, ButtonId),
    /// A contact.
    Touching(Box<Touching>),
    /// A mode of another group is entered (or left) in this very step.
    Joint {
        /// The mode.
        mode: ModeId,
        /// Entered, not left.
        entering: bool,
    },
    /// The reference is none.
    IsNone(Subject),
    /// The reference is to an instance of an entity.
    Is(Subject, EntityId),
    /// The instance is alive.
    Alive(SlotId),
    /// No instance, as a value.
    NoneRef,
    /// An instance, as a value.
    Instance(Subject),
    /// A mode is active.
    InMode(Subject, ModeId),
    /// The instance is in a space.
    InSpace(Subject, SpaceId),
    /// The Euclidean distance of the position to a point is at most a radius: the point and the radius, px.
    Near(Box<(Subject, [Term; 3])>),
}

/// A contact of a collider tagged `mine` (any if none) with something tagged `other`, on a side of mine.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Touching {
    /// Whose collider.
    pub of: Subject,
    /// The tag of one's own collider.
    pub mine: Option<TagId>,
    /// The tag of what is touched.
    pub other: TagId,
    /// The side of one's own collider.
    pub side: Option<Side>,
    /// The question whose answer is named (`as`); it asks for instances only.
    pub bound: Option<TouchId>,
}

/// An entity.
#[derive(Debug, Clone)]
pub struct Entity {
    /// Its name.
    pub name: Name,
    /// Its documentation.
    pub doc: Option<String>,
    /// Parameters; a default may read earlier ones.
    pub params: RareVec<ParamId, Param>,
    /// Continuous variables, `x` and `y` first.
    pub vars: IdVec<VarId, Var>,
    /// Discrete variables.
    pub discretes: RareVec<DiscreteId, Discrete>,
    /// References.
    pub refs: RareVec<RefId, Reference>,
    /// Contact questions whose answers are named.
    pub bound: RareVec<TouchId, BoundTouch>,
    /// Buttons that it reads.
    pub buttons: RareVec<ButtonId, Name>,
    /// Axes that it reads.
    pub axes: RareVec<AxisId, Name>,
    /// Colliders.
    pub colliders: RareVec<ColliderId, Collider>,
    /// Groups; the anonymous one has no name.
    pub groups: RareVec<GroupId, Group>,
    /// Modes of all groups in preorder.
    pub modes: RareVec<ModeId, Mode>,
    /// Edges of all modes in source order.
    pub edges: RareVec<EdgeId, Edge>,
    /// Envelopes.
    pub envelopes: RareVec<EnvelopeId, Envelope>,
    /// Flows and envelopes at the entity's own level.
    pub drives: Vec<Drive>,
    /// Soft bounds of variables.
    pub clamps: Vec<Clamp>,
    /// What must always hold.
    pub invariants: Vec<Term>,
    /// The groups in the order in which they are decided: what a guard waits for comes before it.
    pub order: Vec<GroupId>,
}

/// A reference to another instance.
#[derive(Debug, Clone)]
pub struct Reference {
    /// Its name.
    pub name: Name,
    /// What it may refer to; any entity if none.
    pub entity: Option<EntityId>,
}

/// A contact question whose answer is named by `as`.
#[derive(Debug, Clone)]
pub struct BoundTouch {
    /// The tag of one's own collider.
    pub mine: Option<TagId>,
    /// The tag of what is touched.
    pub other: TagId,
    /// The side of one's own collider.
    pub side: Option<Side>,
    /// Its place.
    pub span: Span,
}

/// A soft bound: what is outside is clipped in the continuous phase.
#[derive(Debug, Clone)]
pub struct Clamp {
    /// The variable.
    pub var: VarId,
    /// Position (0) or velocity (1).
    pub degree: u8,
    /// The least value.
    pub low: Option<Term>,
    /// The greatest value.
    pub high: Option<Term>,
    /// The line.
    pub span: Span,
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
    /// The names of its values, if it is of a set; all of the same set share them.
    pub values: Arc<Vec<String>>,
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
    /// Its shape.
    pub shape: Shape,
    /// While this holds it is there.
    pub guard: Option<Term>,
    /// The whole.
    pub span: Span,
}

/// A collider's shape, relative to the position, px.
#[derive(Debug, Clone)]
pub enum Shape {
    /// x and y of the lower-left corner, width, height.
    Rect([Term; 4]),
    /// x and y of the centre, radius.
    Circle([Term; 3]),
}

impl Shape {
    /// Its numbers, sizes last.
    pub fn numbers(&self) -> &[Term] {
        match self {
            Shape::Rect(numbers) => numbers,
            Shape::Circle(numbers) => numbers,
        }
    }

    /// The numbers that must be more than 0, with what they are called.
    pub fn sizes(&self) -> Vec<(&Term, &'static str)> {
        match self {
            Shape::Rect([_, _, width, height]) => vec![(width, "width"), (height, "height")],
            Shape::Circle([_, _, radius]) => vec![(radius, "radius")],
        }
    }
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
    /// What happens when an edge enters it.
    pub entry: Vec<Action>,
    /// Edges in source order.
    pub edges: Vec<EdgeId>,
    /// `follow links` in source order.
    pub follows: Vec<Follow>,
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
    pub actions: Vec<Action>,
    /// The reference that its whole guard says is lost: such edges are tried first.
    pub lost: Option<RefId>,
    /// References that it reads and nothing but an edge on `lost` covers.
    pub needs: Vec<RefId>,
    /// The whole.
    pub span: Span,
}

/// `follow links when guard { … }`
#[derive(Debug, Clone)]
pub struct Follow {
    /// When; always if none.
    pub guard: Option<Term>,
    /// What it changes when a link is followed.
    pub actions: Vec<Action>,
    /// References that it reads and nothing but an edge on `lost` covers.
    pub needs: Vec<RefId>,
    /// The whole.
    pub span: Span,
}

/// What happens on an edge, or when a mode is entered.
#[derive(Debug, Clone)]
pub enum Action {
    /// A variable or a reference changes.
    Update(Update),
    /// An instance comes to be.
    Spawn(Spawn),
    /// An instance ceases to be.
    Destroy(Term),
}

/// `into := spawn Entity(…)`
#[derive(Debug, Clone)]
pub struct Spawn {
    /// The reference that is set.
    pub into: Option<RefId>,
    /// The entity.
    pub entity: EntityId,
    /// Its own parameters and first values; the terms are the spawner's.
    pub given: Vec<(Given, Term)>,
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

/// An envelope: attack, decay, sustain, release.
#[derive(Debug, Clone)]
pub struct Envelope {
    /// What it drives: one variable, or the components of a vector.
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
    /// The level it holds while it is driven; of a `fixed` one the peak.
    pub sustain: Term,
    /// How long a `fixed` one holds its peak; 0 if none.
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
    /// By so much a second.
    Accel(Term),
    /// The whole way takes this time, s.
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
