//! The larger parts of expressions in the syntax tree: calls, questions to the instances of an entity.

use super::ast::{Expr, Name, Path};

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
