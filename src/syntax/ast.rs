//! The abstract syntax tree: what the author wrote, with the span of every part. Made by [`super::parse`],
//! read by `sema` and the formatter. Names are not resolved here, and nothing is checked but shape.

use std::collections::BTreeSet;
use std::fmt;

use crate::source::{FileId, Span};

pub use super::ast_path::*;
pub use super::ast_world::*;
pub use super::word::Word;

/// One parsed file.
#[derive(Debug, Clone, PartialEq)]
pub struct File {
    /// Which file.
    pub id: FileId,
    /// Its items, in source order, those that could be read.
    pub items: Vec<Item>,
    /// Whether some slice of it fit no rule, or some import could not be read.
    pub is_broken: bool,
    /// The names that such a slice was probably about to declare, `*` if they can be any: later stages keep quiet about
    /// them.
    pub poisoned_names: BTreeSet<String>,
    /// The files that its maps name, where they are named.
    pub texts: Vec<(Span, FileId)>,
}

/// A name and where it is.
#[derive(Debug, Clone, PartialEq)]
pub struct Name {
    /// The word; all that are equal in a file share it.
    pub text: Word,
    /// Its place.
    pub span: Span,
}

/// A top-level item.
#[derive(Debug, Clone, PartialEq)]
pub enum Item {
    /// `import "path"`
    Import(Import),
    /// `const name = expression`
    Constant(Box<Constant>),
    /// `entity Name { … }`
    Entity(Box<Entity>),
    /// `behavior Name(parameters) { … }`
    Behavior(Box<Behavior>),
    /// `world Name { … }`
    World(Box<World>),
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
    /// What it holds.
    pub members: Vec<Member>,
    /// The text of the `///` lines above it.
    pub doc: Option<String>,
    /// The whole.
    pub span: Span,
}

/// `behavior Name(parameters) { … }`: what it holds is put in place wherever it is used.
#[derive(Debug, Clone, PartialEq)]
pub struct Behavior {
    /// Its name.
    pub name: Name,
    /// Names that stand for expressions inside.
    pub parameters: Vec<Name>,
    /// What it holds.
    pub members: Vec<Member>,
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

/// What an entity, a group or a mode may hold; where which is allowed is checked by `sema`. A large text has many of them,
/// so each has a box of its own size.
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
    /// `collider tags: shape when guard`
    Collider(Box<Collider>),
    /// `group name { … }`
    Group(Box<Group>),
    /// `mode name { … }`
    Mode(Box<Mode>),
    /// `x' = e`
    Flow(Box<Assignment>),
    /// `ref name: Entity`
    Reference(Box<Reference>),
    /// `clamp x' in low..high`
    Clamp(Box<Clamp>),
    /// `invariant predicate`
    Invariant(Box<Invariant>),
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

/// `ref name: Entity`, or `any`.
#[derive(Debug, Clone, PartialEq)]
pub struct Reference {
    /// Its name.
    pub name: Name,
    /// What it refers to.
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

/// `follow links when guard { updates }`
#[derive(Debug, Clone, PartialEq)]
pub struct Follow {
    /// When.
    pub guard: Option<Expr>,
    /// What it changes.
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
    /// What it counts as.
    pub tags: Vec<Name>,
    /// The name of the shape: `rect`.
    pub shape: Name,
    /// The shape's numbers.
    pub arguments: Vec<Expr>,
    /// While this holds it is there.
    pub guard: Option<Expr>,
    /// The whole.
    pub span: Span,
}

/// `group name { modes }`
#[derive(Debug, Clone, PartialEq)]
pub struct Group {
    /// Its name.
    pub name: Name,
    /// Its modes, and what else is there by mistake.
    pub members: Vec<Member>,
    /// The whole.
    pub span: Span,
}

/// Whether a mode is marked as the first one.
#[derive(Debug, Clone, PartialEq)]
pub enum Initial {
    /// Not marked.
    No,
    /// `initial`
    Plain,
    /// `initial when guard`
    When(Box<Expr>),
}

/// `mode name { … }`
#[derive(Debug, Clone, PartialEq)]
pub struct Mode {
    /// Whether it is marked `initial`.
    pub initial: Initial,
    /// Its name.
    pub name: Name,
    /// What it holds.
    pub members: Vec<Member>,
    /// The text of the `///` lines above it.
    pub doc: Option<Box<str>>,
    /// The whole.
    pub span: Span,
}

/// `variable = value` or `variable := value`
#[derive(Clone, PartialEq)]
pub struct Assignment {
    /// The left side.
    pub variable: Variable,
    /// The right side.
    pub value: Expr,
    /// Where it ends; it begins with the variable.
    end: u32,
}

impl Assignment {
    /// An assignment that begins with its variable and ends where `span` does.
    pub fn new(variable: Variable, value: Expr, span: Span) -> Self {
        Assignment { variable, value, end: span.end() }
    }

    /// The whole.
    pub fn span(&self) -> Span {
        self.variable.span.ending(self.end)
    }
}

impl fmt::Debug for Assignment {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut parts = f.debug_struct("Assignment");
        parts.field("variable", &self.variable).field("value", &self.value).field("span", &self.span()).finish()
    }
}

/// What happens on an edge, or when a mode is entered.
#[derive(Debug, Clone, PartialEq)]
pub enum Update {
    /// `variable := value`
    Assign(Box<Assignment>),
    /// `variable := spawn Entity(…)`
    Spawn(Box<Spawn>),
    /// `destroy self`, `destroy reference`
    Destroy(Box<Destroy>),
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
    /// What is destroyed.
    pub what: Expr,
    /// The whole.
    pub span: Span,
}

/// `when guard -> target { updates }`
#[derive(Debug, Clone, PartialEq)]
pub struct Edge {
    /// When it is taken.
    pub guard: Expr,
    /// The mode it leads to; none for an edge that stays.
    pub target: Option<Path>,
    /// What it changes, as far as it could be read.
    pub updates: Box<[Update]>,
    /// Whether it has no updates, readable or not.
    pub is_empty: bool,
    /// The whole.
    pub span: Span,
}

/// `envelope x' by axis { … }`
#[derive(Debug, Clone, PartialEq)]
pub struct Envelope {
    /// What it drives.
    pub controlled: Vec<Variable>,
    /// What drives it: an axis, several axes, or `held(button)`; none for `fixed`.
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

/// An expression and where it is.
#[derive(Debug, Clone, PartialEq)]
pub struct Expr {
    /// What it is.
    pub kind: ExprKind,
    /// Its place.
    pub span: Span,
}

// A large text has as many of them as bytes.
const _: () = assert!(size_of::<Expr>() <= 24);

/// A unit after a number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Unit {
    /// `s`
    Seconds,
    /// `ms`
    Milliseconds,
    /// `frames`, steps of the world
    Frames,
}

/// Binary operators that join two values.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BinaryOp {
    /// `+`
    Add,
    /// `-`
    Subtract,
    /// `*`
    Multiply,
    /// `/`
    Divide,
    /// `and`
    And,
    /// `or`
    Or,
}

/// Comparisons.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
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

/// `function(arguments) as binding`
#[derive(Debug, Clone, PartialEq)]
pub struct Call {
    /// What is called.
    pub function: Name,
    /// With what.
    pub arguments: Box<[Expr]>,
    /// What the answer is called.
    pub binding: Option<Box<Name>>,
}

/// What an expression is. A large text has many of them, so what is seldom or large is in boxes.
#[derive(Debug, Clone, PartialEq)]
pub enum ExprKind {
    /// `12`, `0.5s`
    Number(f64, Option<Unit>),
    /// `true`, `false`
    Bool(bool),
    /// `none`
    NoneRef,
    /// `self`
    SelfRef,
    /// `timer`
    Timer,
    /// `"text"`
    Text(Box<Word>),
    /// `a`, `x'`: the expression's span is that of the name and its primes; read by [`Expr::path`] as the next is.
    Name(Word, u8),
    /// `a.b`, `a.b'`
    Path(Box<Dotted>),
    /// `f(a, b) as c`
    Call(Box<Call>),
    /// `in mode`
    InMode(Box<Path>),
    /// `any Entity`
    Any(Box<Name>),
    /// `(a, b)`
    Point(Box<[Expr; 2]>),
    /// `(a)`
    Paren(Box<Expr>),
    /// `-a`
    Negate(Box<Expr>),
    /// `not a`
    Not(Box<Expr>),
    /// `a + b`
    Binary(BinaryOp, Box<[Expr; 2]>),
    /// `a < b`
    Compare(CompareOp, Box<[Expr; 2]>),
    /// `a <= b < c`
    Chain(Box<(Expr, Vec<(CompareOp, Expr)>)>),
    /// `a in mode`
    In(Box<(Expr, Path)>),
    /// `a is Entity`; none for `a is none`
    Is(Box<(Expr, Option<Name>)>),
    /// `a touching tag`
    Touching(Box<(Expr, Name)>),
}
