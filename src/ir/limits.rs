//! How much the tables and a state can hold: sets are single words, ids of modes and instances two bytes in a state.

/// The most distinct tags of a program: a set of tags is one machine word.
pub const MAX_TAGS: usize = 64;
/// The most buttons one entity may read.
pub const MAX_BUTTONS: usize = 64;
/// The most axes one entity may read.
pub const MAX_AXES: usize = 4;
/// The most modes one entity may have.
pub const MAX_MODES: usize = 4_096;
/// The most instances one world may have.
pub const MAX_INSTANCES: usize = 10_000;
