//! Live verdicts: the goals and `never`s of the open programs are asked again whenever their texts are whole and at
//! rest. Nothing is claimed about a text that was not asked about.
//!
//! | file | holds |
//! |---|---|
//! | `ask` | the questions of a world, asked again: replay, proof, search |
//! | `verdict` | what came of a question, in data and in a few words |
//! | `memory` | ways and verdicts that outlive the server |
//! | `shown` | the verdicts as they are shown, and whether they are about the text as it is now |
//! | `paint` | what was seen of each tile of a map, and whether one can get to a tile |
//! | `level` | the levels that an open map may get, and the one that was chosen |
//!
//! It is all work for a thread of its own, below everything else; `protocol` runs it and tells the editor.

pub(in crate::lsp) mod ask;
pub(in crate::lsp) mod level;
pub(in crate::lsp) mod memory;
pub(in crate::lsp) mod paint;
pub(in crate::lsp) mod shown;
pub(in crate::lsp) mod verdict;
