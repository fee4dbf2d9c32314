//! From text to the syntax tree. The grammar is `grammar/hyped.pest`; it parses everything, errors included.
//!
//! [`parse`] never fails: a linear scan first keeps the limits that protect the parser's stack, collects the
//! comments and mends unbalanced braces; then pest parses, and what fit no rule is reported and left out.

pub mod ast;
mod ast_path;
mod ast_world;
mod build;
mod build_world;
mod expand;
mod expression;
mod import;
mod keyword;
mod mend;
mod message;
pub mod occurrence;
mod part;
mod scan;
mod slip;
mod substitute;
mod word;

use pest::Parser;
use pest::iterators::Pairs;

use crate::diagnostic::Diagnostics;
use crate::source::FileId;

pub use expand::{MAX_PUT, expand};
use grammar::Grammar;
pub(crate) use grammar::Rule;
pub use import::load;
pub use keyword::{Keyword, keywords, opening_keywords};
pub use scan::{MAX_NESTING, MAX_OPERATORS, MAX_WORD};
pub use word::{is_name, is_reserved};

/// The parser that pest derives from the grammar; its `Rule` is known to this stage and to the formatter only.
#[allow(missing_docs, reason = "derived code")]
mod grammar {
    #[derive(pest_derive::Parser)]
    #[grammar = "../grammar/hyped.pest"]
    pub struct Grammar;
}

/// What the grammar makes of a text: nothing if [`parse`] does not give it to the grammar as it is. Slices that fit no
/// rule are among the pairs.
pub(crate) fn pairs(file: FileId, text: &str) -> Option<Pairs<'_, Rule>> {
    let mut diagnostics = Diagnostics::new();
    scan::scan(file, text, &mut diagnostics);
    if diagnostics.has_errors() { None } else { Grammar::parse(Rule::file, text).ok() }
}

/// Parses a text that is a predicate and nothing else: what `goal` and `never` ask. None if the diagnostics hold an error.
pub fn parse_predicate(file: FileId, text: &str) -> (Option<ast::Expr>, Diagnostics) {
    let mut diagnostics = Diagnostics::new();
    let scanned = scan::scan(file, text, &mut diagnostics);
    let predicate = build::predicate(file, text, scanned, &mut diagnostics);
    (predicate.filter(|_| !diagnostics.has_errors()), diagnostics)
}

/// Parses one file. The tree holds what could be read; the diagnostics say what could not.
pub fn parse(file: FileId, text: &str) -> (ast::File, Diagnostics) {
    let mut diagnostics = Diagnostics::new();
    let scanned = scan::scan(file, text, &mut diagnostics);
    let tree = build::file(file, text, scanned, &mut diagnostics);
    (tree, diagnostics)
}
