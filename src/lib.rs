//! `hypedc` compiles `.hyped` text, a language in which a game entity is a hybrid automaton, into a flat
//! intermediate representation, simulates it, and searches what a player can reach in a level.
//!
//! ```text
//!  .hyped text ──syntax──▶ AST ──sema──▶ checked program ──ir──▶ Program (flat IR)
//!                  │               │                              │
//!                  └── diagnostic ─┘               graph, view ◀──┴──▶ sim ◀── reach
//! ```
//!
//! The modules below are in the order of the data flow. Each stage is a function from borrowed input to owned output
//! that returns its findings next to its result; none prints, reads a clock or ends the process. Only [`cli`] does.
//!
//! | module | holds |
//! |---|---|
//! | [`source`] | files, spans, line and column look-up |
//! | [`watch`] | progress and interruption of long work |
//! | [`parallel`] | tasks on several threads |
//! | [`tabular`] | tables in plain text and as CSV |
//! | [`json`] | JSON as text |
//! | [`ordered`] | stable sorts of short lists, compiled once |
//! | [`diagnostic`] | findings about a program: facts, messages, pages that explain them, renderers |
//! | [`syntax`] | the grammar's pairs as an abstract syntax tree, with recovery |
//! | [`format`] | the canonical layout of a text, comments kept |
//! | [`import`] | files of other systems, converted to program text |
//! | [`level`] | tile maps: inline, from text files, from levels and legends of the VGLC, from Tiled and LDtk |
//! | [`sema`] | names, types, structure: a program in which every name is an id |
//! | [`lint`] | warnings: valid but probably wrong programs |
//! | [`ir`] | the flat tables that all back ends share, and the layout of a state |
//! | [`analysis`] | abstract interpretation of the flat tables: the reachable values, and findings from them |
//! | [`sim`] | one step of time, input scripts, traces |
//! | [`batch`] | many runs of one world, stepped together: inputs and observations as arrays of numbers |
//! | [`compile`] | the driver of the stages above |
//! | [`why`] | why an instance did what it did in a step of a run, and what it nearly did |
//! | [`reach`] | reachability queries: proofs, planners over the simulator, replay |
//! | [`graph`] | statecharts of entities as DOT, Mermaid and SVG |
//! | [`view`] | pictures of searches |
//! | [`experiment`] | experiments: planners run many times, and tables of the results |
//! | [`corpus`] | one query on many levels: resumable rows, JUnit, comparison with a baseline |
//! | [`tune`] | the smallest change of a number that turns an answer |
//! | [`suite`] | tests of worlds: runs, questions, coverage |
//! | [`ask`] | questions by names, and their answers as records, for the command line and the language server |
//! | [`diff`] | two programs compared: what changed, how players move, which answers differ |
//! | [`studio`] | a play session: requests of a page over program, simulator and reach |
//! | [`lsp`] | the language server for editors |
//! | [`cli`] | the subcommands |
//!
//! Time is in seconds (s), length in pixels (px), y points up.
//!
//! [`format`]: mod@format

pub mod analysis;
#[cfg(any(feature = "ask", feature = "lsp"))]
pub mod ask;
pub mod batch;
#[cfg(feature = "cli")]
pub mod cli;
pub mod compile;
#[cfg(any(feature = "ask", feature = "lsp"))]
pub mod corpus;
pub mod diagnostic;
#[cfg(feature = "cli")]
pub mod diff;
pub mod experiment;
pub mod format;
pub mod graph;
#[cfg(feature = "cli")]
pub mod import;
pub mod ir;
pub mod json;
pub mod level;
pub mod lint;
#[cfg(feature = "language")]
pub mod lsp;
pub mod ordered;
pub mod parallel;
pub mod reach;
pub mod sema;
pub mod sim;
pub mod source;
pub mod studio;
#[cfg(any(feature = "cli", feature = "lsp"))]
pub mod suite;
pub mod syntax;
pub mod tabular;
#[cfg(feature = "ask")]
pub mod tune;
pub mod view;
pub mod watch;
pub mod why;
