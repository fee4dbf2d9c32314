//! Parsing: from text to the syntax tree. The grammar is `grammar/hyped.pest`; it accepts every text, including errors.
//!
//! [`parse`] never fails: a linear scan first enforces limits that protect the parser's stack, collects comments and
//! repairs unbalanced braces; then pest parses, and parts that match no rule are reported and skipped.

pub mod ast;
mod ast_expression;
mod ast_path;
mod ast_test;
mod ast_world;
mod build;
mod build_block;
mod build_envelope;
mod build_test;
mod build_world;
mod expand;
mod expression;
mod foreign;
mod foreign_statement;
mod import;
mod keyword;
mod likely_fix;
mod message;
mod moved;
mod number;
pub mod occurrence;
mod part;
mod repair;
mod reparse;
mod scan;
mod substitute;
mod word;

use pest::Parser;
use pest::iterators::Pairs;

use crate::diagnostic::Diagnostics;
use crate::source::FileId;

pub use expand::{MAX_EXPANDED_MEMBERS, expand};
pub(crate) use foreign::NO_POWER;
use hyped_grammar::Grammar;
// Only this stage and the formatter use it.
pub(crate) use hyped_grammar::Rule;
pub use import::{Trees, Unshared, load};
pub use keyword::{Keyword, keywords, opening_keywords};
pub(crate) use number::set_number;
pub use number::{Number, numbers, unit_of};
pub(crate) use part::{ANY_SYMBOL, symbol_name};
pub use reparse::{Parsed, reparse};
pub use scan::{MAX_NESTING, MAX_OPERATORS, MAX_WORD};
pub use word::{is_name, is_reserved};

/// The pairs of a text, including parts that match no rule; `None` if [`parse`] has to change the text first.
pub(crate) fn pairs(file: FileId, text: &str) -> Option<Pairs<'_, Rule>> {
    let mut diagnostics = Diagnostics::new();
    scan::scan(file, text, &mut diagnostics);
    if diagnostics.has_errors() { None } else { Grammar::parse(Rule::file, text).ok() }
}

/// Parses a single predicate, as in `goal` and `never`. `None` if the diagnostics contain an error.
pub fn parse_predicate(file: FileId, text: &str) -> (Option<ast::Expr>, Diagnostics) {
    let mut diagnostics = Diagnostics::new();
    let scanned = scan::scan(file, text, &mut diagnostics);
    let predicate = build::predicate(file, text, scanned, &mut diagnostics);
    (predicate.filter(|_| !diagnostics.has_errors()), diagnostics)
}

/// Parses one file. The tree contains the readable parts; the diagnostics describe the others.
pub fn parse(file: FileId, text: &str) -> (ast::File, Diagnostics) {
    let mut diagnostics = Diagnostics::new();
    let mut scanned = scan::scan(file, text, &mut diagnostics);
    let mended = scanned.text.take();
    let (tree, _) = build::file(file, text, (&scanned, mended.as_deref()), None, &mut diagnostics);
    (tree, diagnostics)
}
