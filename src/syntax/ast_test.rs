//! Tests of worlds in the syntax tree.

use crate::source::Span;

use super::ast::{Expr, Name};

/// `test "name" { … }`
#[derive(Debug, Clone, PartialEq)]
pub struct Test {
    /// Its name, without the quotes.
    pub name: Name,
    /// Its statements.
    pub items: Vec<TestItem>,
    /// Whether statements are missing in `items`, because they could not be read.
    pub is_broken: bool,
    /// The whole.
    pub span: Span,
}

/// A statement of a test.
#[derive(Debug, Clone, PartialEq)]
pub enum TestItem {
    /// `inputs "right*40"`
    Inputs(Box<TestInputs>),
    /// `chance seed 7`
    Seed(Box<Seed>),
    /// `expect predicate at end`
    Expect(Box<Expect>),
    /// `reachable predicate within 20s`
    Search(Box<Search>),
}

/// `inputs "right*40"`, `inputs from "walk.inputs"`
#[derive(Debug, Clone, PartialEq)]
pub struct TestInputs {
    /// The script, or the path of its file.
    pub text: Name,
    /// Whether it is a path.
    pub is_file: bool,
    /// The whole.
    pub span: Span,
}

/// `chance seed 7`
#[derive(Debug, Clone, PartialEq)]
pub struct Seed {
    /// The number as written.
    pub number: Name,
    /// The whole.
    pub span: Span,
}

/// `expect predicate at end`
#[derive(Debug, Clone, PartialEq)]
pub struct Expect {
    /// The predicate.
    pub predicate: Expr,
    /// When it holds.
    pub moment: Moment,
    /// The whole.
    pub span: Span,
}

/// When something is expected.
#[derive(Debug, Clone, PartialEq)]
pub enum Moment {
    /// `at 2s`; `at end` if there is no time.
    At(Option<Expr>),
    /// `by 2s`; `by end` if there is no time.
    By(Option<Expr>),
    /// `always`
    Always,
    /// `never`
    Never,
}

/// What a search is asked.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SearchKind {
    /// `reachable`: a way is found.
    Reachable,
    /// `unreachable`: it is proven that there is no way.
    Unreachable,
    /// `never`: it is proven that it never holds.
    Never,
    /// `unfound`: a search finds no way, which proves nothing.
    Unfound,
}

impl SearchKind {
    /// Its keyword.
    pub fn word(self) -> &'static str {
        match self {
            SearchKind::Reachable => "reachable",
            SearchKind::Unreachable => "unreachable",
            SearchKind::Never => "never",
            SearchKind::Unfound => "unfound",
        }
    }
}

/// `reachable predicate without other within 20s`
#[derive(Debug, Clone, PartialEq)]
pub struct Search {
    /// What is asked.
    pub kind: SearchKind,
    /// The predicate.
    pub predicate: Expr,
    /// What never holds on the way.
    pub without: Option<Without>,
    /// Maximum time of a way.
    pub within: Option<Expr>,
    /// The whole.
    pub span: Span,
}

/// `without predicate`, `not without predicate`
#[derive(Debug, Clone, PartialEq)]
pub struct Without {
    /// Whether it is `not without`: there is a way, and none without it.
    pub is_needed: bool,
    /// The predicate.
    pub predicate: Expr,
}
