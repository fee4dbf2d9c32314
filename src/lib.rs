//! `hypedc` compiles `.hyped` text, a language in which a game entity is a hybrid automaton, into a flat
//! intermediate representation, simulates it, and searches what a player can reach in a level.
//!
//! ```text
//!  .hyped text ──syntax──▶ AST ──sema──▶ checked program ──ir──▶ Program (flat IR)
//!                  │               │                              │
//!                  └── diagnostic ─┘               graph, view ◀──┴──▶ sim ◀── reach
//! ```
//!
//! The modules below are in the order in which the data passes through them. Each stage is a function from
//! borrowed input to owned output that returns what it found wrong beside what it made; none prints, reads a
//! clock or ends the process. Only [`cli`] does.
//!
//! | module | holds |
//! |---|---|
//! | [`source`] | files, spans, line and column look-up |
//! | [`watch`] | progress and interruption of long work |
//! | [`parallel`] | tasks done side by side |
//! | [`tabular`] | tables in plain text and as CSV |
//! | [`diagnostic`] | what is wrong with a program: facts, wording, pages that explain it, renderers |
//! | [`syntax`] | the grammar's pairs as an abstract syntax tree, with recovery |
//! | [`format`] | the canonical layout of a text, comments kept |
//! | [`import`] | what other systems describe, as text |
//! | [`level`] | tile maps: inline, from text files, from levels and legends of the VGLC, from Tiled and LDtk |
//! | [`sema`] | names, types, structure: a program in which every name is an id |
//! | [`lint`] | warnings: what has a meaning, but hardly the one that was meant |
//! | [`ir`] | the flat tables that all consumers share, and the layout of a state |
//! | [`analysis`] | what each part of a world can be: abstract interpretation of the flat tables, and what that tells |
//! | [`compile`] | the stages up to here in a row |
//! | [`sim`] | one step of time, input scripts, traces |
//! | [`reach`] | the way from a question to its answer: proofs, planners over the simulator, replay |
//! | [`graph`] | statecharts of entities as DOT, Mermaid and SVG |
//! | [`view`] | pictures of what a search found |
//! | [`experiment`] | planners run many times, and tables of what came of it |
//! | [`corpus`] | one question asked of many levels: rows that a later run resumes from, JUnit, what changed since |
//! | [`lsp`] | the language server: what editors ask of open texts |
//! | [`cli`] | the subcommands |
//!
//! Time is in seconds (s), length in pixels (px), y points up.
//!
//! [`format`]: mod@format

pub mod analysis;
#[cfg(feature = "cli")]
pub mod cli;
pub mod compile;
#[cfg(feature = "cli")]
pub mod corpus;
pub mod diagnostic;
pub mod experiment;
pub mod format;
pub mod graph;
#[cfg(feature = "cli")]
pub mod import;
pub mod ir;
pub mod level;
pub mod lint;
#[cfg(feature = "lsp")]
pub mod lsp;
pub mod parallel;
pub mod reach;
pub mod sema;
pub mod sim;
pub mod source;
pub mod syntax;
pub mod tabular;
pub mod view;
pub mod watch;
