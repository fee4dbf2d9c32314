//! The checked program, the output of `sema`: every name is an id, every expression has a type, the hierarchy of modes
//! is kept; `ir` flattens it.

use std::collections::BTreeSet;
use std::path::PathBuf;
use std::sync::Arc;

use crate::ir::{
    Arithmetic, AxisId, ButtonId, ChanceId, ColliderId, CompareOp, DiscreteId, EdgeId, EntityId, EntityLook,
    EnvelopeId, Function, GroupId, Id, IdVec, ModeId, ParamId, Place, Press, ProbeId, RareVec, RefId, SignalId, SlotId,
    SpaceId, Subject, TagId, TouchId, VarId, WorldId,
};

pub use super::annotation::Annotation;
pub use super::checked_contact::*;
pub use super::checked_envelope::*;
pub use super::checked_test::*;
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
    /// Tags of tiles that no map of the program uses.
    pub other_tags: BTreeSet<String>,
    /// The looks of entities.
    pub entity_looks: Vec<EntityLook>,
    /// Where looks name pictures, and the paths of their files.
    pub pictures: Vec<(Name, PathBuf)>,
    /// Tags of tiles that are declared breakable.
    pub breakable: BTreeSet<TagId>,
    /// Whether a world takes its map from the command line.
    pub has_open_map: bool,
    /// Whether an entity asks something of the instances of an entity.
    pub asks_members: bool,
    /// Tags that levels and legends name.
    pub level_tags: BTreeSet<String>,
    /// Names in levels of editors that the levels' maps do not explain.
    pub level_names: Vec<LevelName>,
    /// Where names occur.
    pub occurrences: Occurrences,
    /// The inferred dimensions.
    pub dimensions: Dimensions,
}

impl Checked {
    /// A copy without what editors alone read.
    pub fn without_names(&mut self) -> Self {
        let (occurrences, dimensions) = (std::mem::take(&mut self.occurrences), std::mem::take(&mut self.dimensions));
        let copy = self.clone();
        (self.occurrences, self.dimensions) = (occurrences, dimensions);
        copy
    }
}

/// A set of names over which discrete variables range.
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
    /// The type of a reference to an entity, or to any.
    pub fn reference(entity: Option<EntityId>) -> Self {
        entity.map_or(Type::AnyRef, Type::Ref)
    }
}

/// An expression with its type.
#[derive(Debug, Clone, PartialEq)]
pub struct Term {
    /// Its operation.
    pub kind: TermKind,
    /// The type of its value.
    pub ty: Type,
    /// Its place.
    pub span: Span,
}

// There are about as many terms as bytes of source text.
const _: () = assert!(size_of::<Term>() <= 32);

impl Term {
    /// Its direct operands.
    pub fn operands(&self) -> &[Term] {
        match &self.kind {
            TermKind::Negate(a) | TermKind::Not(a) => std::slice::from_ref(a),
            TermKind::Arithmetic(_, sides)
            | TermKind::Compare(_, sides)
            | TermKind::And(sides)
            | TermKind::Or(sides) => sides.as_slice(),
            TermKind::Call(call) => &call.1,
            TermKind::Near(asked) => &asked.1,
            TermKind::Distance(asked) => &asked.1,
            TermKind::Members(asked) => std::slice::from_ref(&asked.holds),
            TermKind::Nearest(asked) => std::slice::from_ref(&asked.holds),
            TermKind::Probe(asked) => &asked.offset,
            TermKind::Count(of) => of,
            _ => &[],
        }
    }
}

/// The operation of a term. There are many of them, so rare or large parts are boxed.
#[derive(Debug, Clone, PartialEq)]
pub enum TermKind {
    /// A number, or the index of a set's value.
    Number(f64),
    /// A number with a dimension: the exponents of px and of s.
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
    /// What is drawn in this step.
    Chance(ChanceId),
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
    /// Conjunction; the second operand is not evaluated if the first is false.
    And(Box<[Term; 2]>),
    /// Disjunction; the second operand is not evaluated if the first is true.
    Or(Box<[Term; 2]>),
    /// Not.
    Not(Box<Term>),
    /// A button.
    Button(Press, ButtonId),
    /// A contact.
    Touching(Box<Touching>),
    /// Whether a place is taken.
    Probe(Box<Probe>),
    /// A mode of another group is entered (or exited) in this step.
    Joint {
        /// The mode.
        mode: ModeId,
        /// Entered, not left.
        entering: bool,
    },
    /// A signal of the entity was sent to the instance in the step before.
    Received(SignalId),
    /// The sum of the numbers that came with a signal.
    Sum(SignalId),
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
    /// The number of tiles with a tag that are there.
    Tiles(TagId),
    /// The Euclidean distance of the position to a point, px.
    Distance(Box<(Subject, [Term; 2])>),
    /// In an entity: the number of living instances of an entity for which something holds.
    Members(Box<Members>),
    /// There is an instance of an entity for which something holds; the nearest one is bound.
    Nearest(Box<Nearest>),
    /// The number of truth values that hold: of the instances of a world, each asked whether it lives as well.
    #[allow(clippy::box_collection, reason = "terms are small, and there are many")]
    Count(Box<Vec<Term>>),
}

/// An entity.
#[derive(Debug, Clone)]
pub struct Entity {
    /// Its name.
    pub name: Name,
    /// Its documentation.
    pub doc: Option<Box<str>>,
    /// Parameters; a default may read earlier ones.
    pub params: RareVec<ParamId, Param>,
    /// Whether the first two of them keep where the instance was placed.
    pub reads_start: bool,
    /// Continuous variables, `x` and `y` first.
    pub vars: IdVec<VarId, Var>,
    /// Discrete variables.
    pub discretes: RareVec<DiscreteId, Discrete>,
    /// References.
    pub refs: RareVec<RefId, Reference>,
    /// Signals that it receives; those with a number first.
    pub signals: RareVec<SignalId, Signal>,
    /// Bound contact queries (`as`).
    pub bound: RareVec<TouchId, BoundTouch>,
    /// Bound probes (`as`), and nearest instances.
    pub probes: RareVec<ProbeId, BoundProbe>,
    /// Buttons that it reads.
    pub buttons: RareVec<ButtonId, Name>,
    /// Axes that it reads.
    pub axes: RareVec<AxisId, Name>,
    /// What is drawn in each step.
    pub chances: RareVec<ChanceId, Chance>,
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
    pub clamps: Box<[Clamp]>,
    /// Predicates that must always hold.
    pub invariants: Box<[Term]>,
    /// Named conditions, which their uses have replaced.
    pub conditions: Box<[Condition]>,
    /// The groups in the order of decision: a group comes after those that its guards depend on.
    pub order: Box<[GroupId]>,
}

impl Entity {
    /// The modes beside a mode, itself included.
    pub fn siblings(&self, mode: ModeId) -> &[ModeId] {
        match self.modes[mode].parent {
            Some(parent) => &self.modes[parent].children,
            None => &self.groups[self.modes[mode].group].modes,
        }
    }

    /// All that edges, entries of modes and `follow links` do.
    pub fn actions(&self) -> impl Iterator<Item = &Action> {
        let entries = self.modes.iter().flat_map(|m| m.entry.iter().chain(m.follows.iter().flat_map(|f| &f.actions)));
        self.edges.iter().flat_map(|edge| &edge.actions).chain(entries)
    }

    /// The entity of the instances that a bound probe finds, if it is known.
    pub fn probed(&self, probe: ProbeId) -> Option<EntityId> {
        match self.probes.get(probe)? {
            BoundProbe::Nearest(nearest, _) => Some(nearest.of),
            BoundProbe::Place(..) => None,
        }
    }

    /// The mode among siblings that is entered if no `initial when` chooses one: the one marked `initial`, else the first
    /// that is entered without a condition, else the first.
    pub fn default_mode(&self, siblings: &[ModeId]) -> Option<ModeId> {
        let find = |is_default: fn(&Mode) -> bool| siblings.iter().copied().find(|mode| is_default(&self.modes[*mode]));
        let marked = find(|mode| mode.marked_initial);
        marked.or_else(|| find(|mode| mode.initial_when.is_none())).or(siblings.first().copied())
    }
}

/// A reference to another instance.
#[derive(Debug, Clone)]
pub struct Reference {
    /// Its name.
    pub name: Name,
    /// The entity of its targets; `None` for any.
    pub entity: Option<EntityId>,
}

/// A signal.
#[derive(Debug, Clone)]
pub struct Signal {
    /// Its name.
    pub name: Name,
    /// The number that comes with it.
    pub number: Option<Sum>,
}

/// The number of a signal, added up over all that is sent in a step.
#[derive(Debug, Clone)]
pub struct Sum {
    /// Its name.
    pub name: Name,
    /// Its dimension; a number without one is whole.
    pub dimension: Option<Annotation>,
}

impl Sum {
    /// The type of what is sent, and of the sum.
    pub fn ty(&self) -> Type {
        if self.dimension.is_some() { Type::Real } else { Type::Int }
    }
}

/// A soft bound: values outside are clamped in the continuous phase.
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

/// A named condition of an entity, a mode or a world.
#[derive(Debug, Clone)]
pub struct Condition {
    /// Its name.
    pub name: Name,
    /// The mode that holds it.
    pub mode: Option<ModeId>,
    /// What its uses stand for.
    pub value: Term,
    /// Whether anything uses it.
    pub is_used: bool,
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
    /// Its initial value; `None` for `x` and `y`, which are placed.
    pub initial: Option<Term>,
    /// Its annotated dimension.
    pub dimension: Option<Annotation>,
}

/// A whole number that is drawn in each step.
#[derive(Debug, Clone)]
pub struct Chance {
    /// Its name.
    pub name: Name,
    /// The least and the greatest value.
    pub range: (i32, i32),
}

/// A discrete variable.
#[derive(Debug, Clone)]
pub struct Discrete {
    /// Its name.
    pub name: Name,
    /// Its type.
    pub ty: Type,
    /// The names of its values, if it ranges over a set; shared by all variables of that set.
    pub values: Arc<Vec<String>>,
    /// The minimum and maximum value.
    pub range: (i32, i32),
    /// Its first value.
    pub initial: Term,
}

/// A collider: a rectangle relative to the position.
#[derive(Debug, Clone)]
pub struct Collider {
    /// Its tags.
    pub tags: Vec<TagId>,
    /// Whether it is never pushed.
    pub kinematic: bool,
    /// Its shape.
    pub shape: Shape,
    /// It is active while this holds.
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

    /// The numbers that must be positive, with their names.
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
    /// Its name; `None` for the anonymous group.
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
    /// Its parent mode.
    pub parent: Option<ModeId>,
    /// Its child modes.
    pub children: Vec<ModeId>,
    /// Whether it stands for `always { … }`.
    pub is_always: bool,
    /// Marked `initial` without a guard.
    pub marked_initial: bool,
    /// Guard of `initial when`.
    pub initial_when: Option<Term>,
    /// Flows and envelopes.
    pub drives: Vec<Drive>,
    /// The entry actions.
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
    /// The span of the statement.
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
    /// Its target; `None` for an internal edge.
    pub target: Option<ModeId>,
    /// When it is taken.
    pub guard: Term,
    /// Its actions.
    pub actions: Vec<Action>,
    /// The reference, if its whole guard is `lost(…)`: such edges are tried first.
    pub lost: Option<RefId>,
    /// References that it reads and that only an edge on `lost` covers.
    pub needs: Vec<RefId>,
    /// The whole.
    pub span: Span,
}

/// `follow links when guard { … }`
#[derive(Debug, Clone)]
pub struct Follow {
    /// The guard; `None` means always.
    pub guard: Option<Term>,
    /// The actions when a link is followed.
    pub actions: Vec<Action>,
    /// References that it reads and that only an edge on `lost` covers.
    pub needs: Vec<RefId>,
    /// The whole.
    pub span: Span,
}

/// An action on an edge or on entry of a mode.
#[derive(Debug, Clone)]
pub enum Action {
    /// Updates a variable or a reference.
    Update(Update),
    /// Spawns an instance.
    Spawn(Spawn),
    /// Destroys an instance.
    Destroy(Term),
    /// Sends a signal.
    Send(Send),
}

/// `into := spawn Entity(…)`
#[derive(Debug, Clone)]
pub struct Spawn {
    /// The reference that is set.
    pub into: Option<RefId>,
    /// The entity.
    pub entity: EntityId,
    /// Given parameters and initial values; the terms belong to the spawner.
    pub given: Vec<(Given, Term)>,
    /// The whole.
    pub span: Span,
}

/// `send reference.signal(number)`
#[derive(Debug, Clone)]
pub struct Send {
    /// The receiver; `None` for all instances of the entity.
    pub to: Option<Term>,
    /// The entity of the receivers.
    pub entity: EntityId,
    /// Its signal.
    pub signal: SignalId,
    /// The number that comes with it.
    pub number: Option<Term>,
    /// The whole.
    pub span: Span,
}

/// An update of a variable.
#[derive(Debug, Clone)]
pub struct Update {
    /// The target.
    pub place: Place,
    /// Its new value.
    pub value: Term,
    /// The whole.
    pub span: Span,
}
