//! The checked program's tests. They are no part of what is lowered: nothing that runs depends on them.

use crate::source::Span;
use crate::syntax::ast::{Name, SearchKind, TestInputs};

use super::checked::Term;

/// A test of a world.
#[derive(Debug, Clone)]
pub struct Test {
    /// Its name.
    pub name: Name,
    /// The inputs of its run, in order; the run has those of all of them.
    pub inputs: Vec<TestInputs>,
    /// The seed of what nature draws.
    pub seed: Option<u64>,
    /// What it claims, in source order.
    pub claims: Vec<Claim>,
    /// Its predicates.
    pub predicates: Vec<Term>,
    /// The whole.
    pub span: Span,
}

/// A claim of a test.
#[derive(Debug, Clone)]
pub struct Claim {
    /// The predicate.
    pub predicate: Span,
    /// What is claimed of it.
    pub kind: ClaimKind,
    /// The whole.
    pub span: Span,
}

/// What is claimed of a predicate.
#[derive(Debug, Clone)]
pub enum ClaimKind {
    /// Something of the run with the inputs of the test.
    Expect(When),
    /// Something of all runs.
    Search {
        /// What is asked.
        kind: SearchKind,
        /// The predicate that never holds on the way, and whether it is `not without`.
        without: Option<(Span, bool)>,
        /// Maximum number of steps of a way.
        within: Option<u32>,
    },
}

/// When a predicate holds in a run. Step 0 is the initial state.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum When {
    /// After a number of steps.
    At(u32),
    /// After the last step.
    AtEnd,
    /// After some step, up to a number of steps.
    By(u32),
    /// After some step.
    ByEnd,
    /// After every step.
    Always,
    /// After no step.
    Never,
}

impl When {
    /// Number of steps that the run needs at least.
    pub fn least_steps(self) -> u32 {
        match self {
            When::At(step) | When::By(step) => step,
            When::AtEnd | When::ByEnd | When::Always | When::Never => 0,
        }
    }
}
