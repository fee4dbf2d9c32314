//! The abstract syntax tree: the source with the span of every part. Built by [`super::parse`], read by `sema` and the
//! formatter. Names are not resolved, and only the form is checked.

use std::collections::BTreeSet;
use std::fmt;
use std::sync::Arc;

use crate::source::{FileId, Span};

pub use super::ast_expression::*;
pub use super::ast_path::*;
pub use super::ast_test::*;
pub use super::ast_world::*;
pub use super::word::Word;

/// One parsed file.
#[derive(Debug, Clone, PartialEq)]
pub struct File {
    /// Which file.
    pub id: FileId,
    /// Its readable items, in source order.
    pub items: Vec<Item>,
    /// Whether some part matched no rule, or some import could not be read.
    pub is_broken: bool,
    /// The names that unreadable parts may have declared, `*` for any: later stages do not report them.
    pub poisoned_names: BTreeSet<String>,
    /// The files of its maps, with the spans of their names.
    pub texts: Vec<(Span, FileId)>,
}

/// A name with its span.
#[derive(Debug, Clone, PartialEq)]
pub struct Name {
    /// The word; equal words of a file share it.
    pub text: Word,
    /// Its place.
    pub span: Span,
}

/// A top-level item. Large ones are shared with the trees of other versions of a text.
#[derive(Debug, Clone, PartialEq)]
pub enum Item {
    /// `import "path"`
    Import(Import),
    /// `const name = expression`
    Constant(Arc<Constant>),
    /// `entity Name { … }`
    Entity(Arc<Entity>),
    /// `behavior Name(parameters) { … }`
    Behavior(Arc<Behavior>),
    /// `world Name { … }`
    World(Arc<World>),
}

/// `import "path"`, relative to the importing file.
#[derive(Debug, Clone, PartialEq)]
pub struct Import {
    /// The path as written.
    pub path: Name,
}

/// `const name = expression`, also a `param` of an entity.
#[derive(Debug, Clone, PartialEq)]
pub struct Constant {
    /// Its name.
    pub name: Name,
    /// `: px/s`, if given.
    pub dimension: Option<Dimension>,
    /// Its value.
    pub value: Expr,
    /// The text of the `///` lines above it.
    pub doc: Option<String>,
}

/// A written dimension such as `px/s^2`.
#[derive(Debug, Clone, PartialEq)]
pub struct Dimension {
    /// Unit names with their exponents, divisions as negative ones.
    pub factors: Vec<(Name, i32)>,
    /// The whole.
    pub span: Span,
}

/// `entity Name { … }`
#[derive(Debug, Clone, PartialEq)]
pub struct Entity {
    /// Its name.
    pub name: Name,
    /// Its contents.
    pub members: Vec<Member>,
    /// Whether `start.x` or `start.y` occurs in it.
    pub reads_start: bool,
    /// The text of the `///` lines above it.
    pub doc: Option<String>,
    /// The whole.
    pub span: Span,
}

/// `behavior Name(parameters) { … }`: its members are copied wherever it is used.
#[derive(Debug, Clone, PartialEq)]
pub struct Behavior {
    /// Its name.
    pub name: Name,
    /// Names that stand for expressions inside.
    pub parameters: Vec<Name>,
    /// Its contents.
    pub members: Vec<Member>,
    /// As [`Entity::reads_start`].
    pub reads_start: bool,
    /// The text of the `///` lines above it.
    pub doc: Option<String>,
    /// The whole.
    pub span: Span,
}

/// `use Name(parameter = expression)`
#[derive(Debug, Clone, PartialEq)]
pub struct Use {
    /// The behaviour.
    pub behavior: Name,
    /// What its parameters stand for.
    pub arguments: Vec<Assignment>,
    /// The whole.
    pub span: Span,
}

/// A member of an entity, a group or a mode; `sema` checks which is allowed where. There are many of them, so each has
/// a box of its size.
#[derive(Debug, Clone, PartialEq)]
pub enum Member {
    /// `param name = value`
    Parameter(Box<Constant>),
    /// `continuous name = value`
    Continuous(Box<Continuous>),
    /// `discrete name: domain = value`
    Discrete(Box<Discrete>),
    /// `button a, b`
    Buttons(Box<(Vec<Name>, Span)>),
    /// `axis a, b`
    Axes(Box<(Vec<Name>, Span)>),
    /// `chance name: low..high`
    Chance(Box<Chance>),
    /// `collider tags: shape when guard`
    Collider(Box<Collider>),
    /// `group name { … }`
    Group(Box<Group>),
    /// `mode name { … }`, `always { … }`
    Mode(Box<Mode>),
    /// `x' = e`
    Flow(Box<Assignment>),
    /// `ref name: Entity`
    Reference(Box<Reference>),
    /// `clamp x' in low..high`
    Clamp(Box<Clamp>),
    /// `invariant predicate`
    Invariant(Box<Invariant>),
    /// `condition name = predicate`
    Condition(Box<Condition>),
    /// `signal a, b(number)`
    Signals(Box<(Vec<Signal>, Span)>),
    /// `look #e04030`
    Look(Box<Look>),
    /// `x' := e` at the head of a mode
    Entry(Box<Update>),
    /// `when guard -> target { … }`
    Edge(Box<Edge>),
    /// `envelope x' by axis { … }`
    Envelope(Box<Envelope>),
    /// `follow links when guard { … }`
    Follow(Box<Follow>),
    /// `use Name(…)`
    Use(Box<Use>),
}

/// `chance name: low..high`
#[derive(Debug, Clone, PartialEq)]
pub struct Chance {
    /// Its name.
    pub name: Name,
    /// The least value.
    pub low: Expr,
    /// The greatest value.
    pub high: Expr,
    /// The whole.
    pub span: Span,
}

/// `ref name: Entity`, or `any`.
#[derive(Debug, Clone, PartialEq)]
pub struct Reference {
    /// Its name.
    pub name: Name,
    /// The entity of its targets.
    pub entity: Name,
}

/// `clamp variable in low..high`, `clamp variable <= high`
#[derive(Debug, Clone, PartialEq)]
pub struct Clamp {
    /// What is clipped.
    pub variable: Variable,
    /// The least value.
    pub low: Option<Expr>,
    /// The greatest value.
    pub high: Option<Expr>,
    /// The whole.
    pub span: Span,
}

/// `invariant predicate`
#[derive(Debug, Clone, PartialEq)]
pub struct Invariant {
    /// What always holds.
    pub predicate: Expr,
    /// The whole.
    pub span: Span,
}

/// `condition name = predicate`: a name for a truth value, in an entity, a mode, a behaviour or a world.
#[derive(Debug, Clone, PartialEq)]
pub struct Condition {
    /// Its name.
    pub name: Name,
    /// What it stands for.
    pub value: Expr,
    /// The whole.
    pub span: Span,
}

/// One of `signal name, name(number)`.
#[derive(Debug, Clone, PartialEq)]
pub struct Signal {
    /// Its name.
    pub name: Name,
    /// The number that is sent with it, and its dimension if given.
    pub number: Option<(Name, Option<Dimension>)>,
    /// The whole.
    pub span: Span,
}

/// `follow links when guard { updates }`
#[derive(Debug, Clone, PartialEq)]
pub struct Follow {
    /// When.
    pub guard: Option<Expr>,
    /// Its updates.
    pub updates: Vec<Update>,
    /// The whole.
    pub span: Span,
}

/// `continuous name = value`
#[derive(Debug, Clone, PartialEq)]
pub struct Continuous {
    /// Its name.
    pub name: Name,
    /// `: px`, if given.
    pub dimension: Option<Dimension>,
    /// Its first value; 0 if left out.
    pub initial: Option<Expr>,
}

/// `discrete name: domain = value`
#[derive(Debug, Clone, PartialEq)]
pub struct Discrete {
    /// Its name.
    pub name: Name,
    /// What it ranges over.
    pub domain: Domain,
    /// Its first value.
    pub initial: Expr,
}

/// What a discrete variable ranges over.
#[derive(Debug, Clone, PartialEq)]
pub enum Domain {
    /// `int low..high`, both ends included.
    Int(Box<Expr>, Box<Expr>),
    /// `bool`
    Bool,
    /// `{a, b, c}`
    Set(Vec<Name>),
}

/// `kinematic collider tags: shape when guard`
#[derive(Debug, Clone, PartialEq)]
pub struct Collider {
    /// Whether it is never pushed.
    pub kinematic: bool,
    /// Its tags.
    pub tags: Vec<Name>,
    /// The name of the shape: `rect`.
    pub shape: Name,
    /// The shape's numbers.
    pub arguments: Vec<Expr>,
    /// It is active while this holds.
    pub guard: Option<Expr>,
    /// The whole.
    pub span: Span,
}

/// `group name { modes }`
#[derive(Debug, Clone, PartialEq)]
pub struct Group {
    /// Its name.
    pub name: Name,
    /// Its modes, and misplaced members.
    pub members: Vec<Member>,
    /// The whole.
    pub span: Span,
}

/// The name of the mode that `always { … }` stands for.
pub const ALWAYS: &str = "always";

/// When a mode is entered.
#[derive(Debug, Clone, PartialEq)]
pub enum Initial {
    /// `always { … }`: a mode of that name, which is active as long as the instance is there.
    Always,
    /// Not marked.
    No,
    /// `initial`
    Plain,
    /// `initial when guard`
    When(Box<Expr>),
}

/// `mode name { … }`, `always { … }`
#[derive(Debug, Clone, PartialEq)]
pub struct Mode {
    /// When it is entered.
    pub initial: Initial,
    /// Its name.
    pub name: Name,
    /// Its contents.
    pub members: Vec<Member>,
    /// The text of the `///` lines above it.
    pub doc: Option<Box<str>>,
    /// The whole.
    pub span: Span,
}

/// `variable = value`, `variable := value`, `variable += value` or `variable -= value`
#[derive(Clone, PartialEq)]
pub struct Assignment {
    /// The left side.
    pub variable: Variable,
    /// The right side.
    pub value: Expr,
    /// Its end; it starts with the variable.
    pub(super) end: u32,
    /// The operator of `+=` and `-=`.
    pub operator: Option<BinaryOp>,
}

impl Assignment {
    /// An assignment from its variable to the end of `span`.
    pub fn new(variable: Variable, value: Expr, span: Span) -> Self {
        Assignment { variable, value, end: span.end(), operator: None }
    }

    /// The whole.
    pub fn span(&self) -> Span {
        self.variable.span.ending(self.end)
    }
}

impl fmt::Debug for Assignment {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut parts = f.debug_struct("Assignment");
        parts.field("variable", &self.variable).field("operator", &self.operator);
        parts.field("value", &self.value).field("span", &self.span()).finish()
    }
}

/// An action on an edge or on entry of a mode.
#[derive(Debug, Clone, PartialEq)]
pub enum Update {
    /// `variable := value`
    Assign(Box<Assignment>),
    /// `variable := spawn Entity(…)`
    Spawn(Box<Spawn>),
    /// `destroy self`, `destroy reference`
    Destroy(Box<Destroy>),
    /// `send reference.signal(number)`
    Send(Box<Send>),
}

/// `into := spawn Entity(settings)`
#[derive(Debug, Clone, PartialEq)]
pub struct Spawn {
    /// The reference that is set.
    pub into: Option<Variable>,
    /// The entity.
    pub entity: Name,
    /// Parameters and first values.
    pub settings: Vec<Assignment>,
    /// The whole.
    pub span: Span,
}

/// `destroy self`, `destroy reference`
#[derive(Debug, Clone, PartialEq)]
pub struct Destroy {
    /// The destroyed instance.
    pub what: Expr,
    /// The whole.
    pub span: Span,
}

/// `send reference.signal(number)`, `send all Entity.signal`
#[derive(Debug, Clone, PartialEq)]
pub struct Send {
    /// Who gets it.
    pub to: Receivers,
    /// The signal, of the receiver's entity.
    pub signal: Name,
    /// The number that is sent with it.
    pub number: Option<Expr>,
    /// The whole.
    pub span: Span,
}

/// Who gets a signal.
#[derive(Debug, Clone, PartialEq)]
pub enum Receivers {
    /// `self`, or what a reference refers to.
    One(Expr),
    /// All instances of an entity.
    All(Name),
}

/// `when guard -> target { updates }`
#[derive(Debug, Clone, PartialEq)]
pub struct Edge {
    /// When it is taken; [`ExprKind::Else`] for `else`.
    pub guard: Expr,
    /// The target mode; `None` for an internal edge.
    pub target: Option<Path>,
    /// Its readable updates.
    pub updates: Box<[Update]>,
    /// Whether it has no updates, readable or not.
    pub is_empty: bool,
    /// The whole.
    pub span: Span,
}

/// `envelope x' by axis { … }`
#[derive(Debug, Clone, PartialEq)]
pub struct Envelope {
    /// The driven variables.
    pub controlled: Vec<Variable>,
    /// The driver: an axis, several axes, or `held(button)`; `None` for `fixed`.
    pub by: Option<Expr>,
    /// `directions 4`, if given.
    pub directions: Option<Name>,
    /// Its parts in source order.
    pub ramps: Vec<Ramp>,
    /// Whether all of its parts could be read.
    pub complete: bool,
    /// The whole.
    pub span: Span,
}

/// A part of an envelope.
#[derive(Debug, Clone, PartialEq)]
pub struct Ramp {
    /// Which part, with its numbers.
    pub kind: RampKind,
    /// The whole.
    pub span: Span,
}

/// Which part of an envelope.
#[derive(Debug, Clone, PartialEq)]
pub enum RampKind {
    /// `attack rate to peak`
    Attack(Rate, Option<Expr>),
    /// `decay rate`
    Decay(Rate),
    /// `sustain level`
    Sustain(Expr),
    /// `sustain for time`
    SustainFor(Expr),
    /// `release rate to level`; without a rate it is instant.
    Release(Option<Rate>, Option<Expr>),
    /// `release hold`
    ReleaseHold,
    /// `while guard`
    While(Expr),
}

/// How fast a ramp is.
#[derive(Debug, Clone, PartialEq)]
pub enum Rate {
    /// At once.
    Instant,
    /// `accel a`: by `a` a second.
    Accel(Expr),
    /// `over t`: so that the whole way takes `t`.
    Over(Expr),
}
