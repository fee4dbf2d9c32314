//! The arguments of commands. Documents and levels are paths here; the protocol has URIs.

use std::path::PathBuf;

use serde::Deserialize;

use crate::lsp::verdicts::level::ChosenLevel;

/// The program that a command is about.
#[derive(Debug, Clone, Default, PartialEq)]
pub(in crate::lsp) struct Program {
    /// Its file.
    pub path: PathBuf,
    /// The world; optional if there is one only.
    pub world: Option<String>,
    /// The level of worlds that leave their map open.
    pub level: Option<ChosenLevel>,
    /// Numbers that are set, such as `Hero.jump_speed=310`.
    pub set: Vec<String>,
}

/// The arguments of `sim`.
#[derive(Debug, Clone, Default, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub(in crate::lsp) struct SimArguments {
    #[serde(skip)]
    pub program: Program,
    /// The inputs, as a script.
    pub inputs: String,
    /// Number of steps; those of the script if it is left out.
    pub steps: Option<u64>,
    /// The seed of what nature draws.
    pub chance: Option<u64>,
    /// Whether a picture of the run is wanted.
    pub picture: bool,
}

/// The arguments of `reach`.
#[derive(Debug, Clone, Default, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub(in crate::lsp) struct ReachArguments {
    #[serde(skip)]
    pub program: Program,
    /// Goals to reach, by name or as predicates; all of the world if there are no `nevers` either.
    pub goals: Vec<String>,
    /// `never`s to break, by name or as predicates.
    pub nevers: Vec<String>,
    /// Only paths on which this predicate never holds.
    pub without: Option<String>,
    /// Where searches begin: after these scripts.
    pub after: Vec<String>,
    /// Maximum number of nodes of each search.
    pub nodes: Option<u64>,
    /// The seed.
    pub seed: Option<u64>,
    /// The seed of what nature draws.
    pub chance: Option<u64>,
    /// Whether paths are made faster and simpler.
    pub minimize: bool,
    /// Whether a picture of each search is wanted.
    pub picture: bool,
}

/// The arguments of `test`.
#[derive(Debug, Clone, Default, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub(in crate::lsp) struct TestArguments {
    #[serde(skip)]
    pub program: Program,
    /// The names of the tests; all if there are none.
    pub tests: Vec<String>,
    /// Maximum number of nodes of each search.
    pub nodes: Option<u64>,
    /// The seed of searches.
    pub seed: Option<u64>,
    /// Whether the coverage is told.
    pub coverage: bool,
}

/// The arguments of `why`.
#[derive(Debug, Clone, Default, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub(in crate::lsp) struct WhyArguments {
    #[serde(skip)]
    pub program: Program,
    /// The inputs, as a script.
    pub inputs: String,
    /// The step; the last one if it is left out.
    pub at: Option<u64>,
    /// The instance; that of player 1 if it is left out.
    pub instance: Option<String>,
    /// Only edges that lead to this mode.
    pub mode: Option<String>,
    /// Only edges on this line.
    pub edge: Option<String>,
    /// Why the mode was never entered, or the edge never taken.
    pub not: bool,
    /// The seed of what nature draws.
    pub chance: Option<u64>,
}
