//! Expressions in the syntax tree.

use crate::source::Span;

use super::ast::{Dotted, Name, Path};
use super::word::Word;

/// An expression with its span.
#[derive(Debug, Clone, PartialEq)]
pub struct Expr {
    /// What it is.
    pub kind: ExprKind,
    /// Its place.
    pub span: Span,
}

// There are about as many expressions as bytes of source text.
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

/// The kind of an expression. There are many of them, so rare or large parts are boxed.
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
    /// `a`, `x'`: the expression's span is that of the name and its primes; read through [`Expr::path`], like the next
    /// variant.
    Name(Word, u8),
    /// `a.b`, `a.b'`
    Path(Box<Dotted>),
    /// `f(a, b) as c`
    Call(Box<Call>),
    /// `in mode`
    InMode(Box<Path>),
    /// `any Entity`
    Any(Box<Name>),
    /// `all Entity`
    All(Box<Name>),
    /// `any Entity.x`, `all Entity.x`
    Each(Box<Each>),
    /// `nearest Entity in mode within a as b`
    Nearest(Box<Nearest>),
    /// `(a, b)`
    Point(Box<[Expr; 2]>),
    /// `a at (b, c)`: an argument, and the offset by which it is moved.
    Moved(Box<[Expr; 2]>),
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
    /// `else`, the guard of an edge: the negation of the one before in the same mode.
    Else,
}

/// `function(arguments) as binding`
#[derive(Debug, Clone, PartialEq)]
pub struct Call {
    /// What is called.
    pub function: Name,
    /// With what.
    pub arguments: Box<[Expr]>,
    /// The bound name.
    pub binding: Option<Box<Name>>,
}

/// `any Entity.x`, `all Entity.x`: what each instance has.
#[derive(Debug, Clone, PartialEq)]
pub struct Each {
    /// Whether it is `all`.
    pub is_all: bool,
    /// The entity, and what is read of it.
    pub path: Path,
}

/// `nearest Entity in mode within limit as binding`
#[derive(Debug, Clone, PartialEq)]
pub struct Nearest {
    /// The entity.
    pub entity: Name,
    /// The mode that it is in.
    pub mode: Option<Path>,
    /// The greatest distance.
    pub within: Option<Expr>,
    /// The bound name.
    pub binding: Option<Name>,
}
