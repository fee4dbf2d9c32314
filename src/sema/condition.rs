//! Named conditions: `condition on_floor = touching(body, wall, below)`. A use stands for the expression, which is checked
//! again in the scope of the use: what it may read is decided there.

use std::collections::BTreeMap;

use crate::diagnostic::catalogue::file::TooMany;
use crate::diagnostic::catalogue::names::{ConditionCycle, DuplicateName};
use crate::ir::ModeId;
use crate::source::Span;
use crate::syntax::ast::{self, Expr, Name, Word};
use crate::syntax::occurrence::NameKind;

use super::Checker;
use super::checked::{Entity, Term};
use super::expression::Scope;

/// Maximum number of expressions that the conditions of a program stand for, counted at each use.
const MAX_EXPANDED: usize = 200_000;

/// The conditions of the entity or world at hand.
#[derive(Debug, Default)]
pub(super) struct Conditions {
    declared: Vec<Declared>,
    named: BTreeMap<Word, Vec<usize>>,
    /// Those whose expressions are being checked, from the outside in.
    active: Vec<usize>,
    /// Number of expressions of all uses so far, in all entities and worlds.
    expanded: usize,
}

#[derive(Debug)]
struct Declared {
    name: Name,
    value: Option<Expr>,
    /// The mode that holds it.
    mode: Option<ModeId>,
    /// Whether its own check reported errors: uses report none.
    is_broken: bool,
}
