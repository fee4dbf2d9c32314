//! Ways that were found before: they are replayed first, and searched for again only if they no longer lead there. A replay
//! is a witness like any other, so a way that is out of date costs time and changes no verdict.

use crate::ir::Program;

/// What a way was found for.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct WayName<'a> {
    /// The world.
    pub world: &'a str,
    /// The question: its kind, its predicate, what it leaves out, and its limits.
    pub question: String,
    /// The settings of the search: another search may find nothing.
    pub settings: String,
}

/// Keeps the ways that were found.
pub trait Ways: Sync {
    /// A script that was found for a question of a program.
    fn find(&self, program: &Program, name: &WayName<'_>) -> Option<String>;

    /// Keeps a script.
    fn keep(&self, program: &Program, name: &WayName<'_>, script: &str);
}

/// Keeps nothing.
#[derive(Debug, Clone, Copy, Default)]
pub struct NoWays;

impl Ways for NoWays {
    fn find(&self, _: &Program, _: &WayName<'_>) -> Option<String> {
        None
    }

    fn keep(&self, _: &Program, _: &WayName<'_>, _: &str) {}
}
