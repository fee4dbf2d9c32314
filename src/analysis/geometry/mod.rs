//! Geometry: bodies, tiles, static obstacles, and summaries of all instances of a kind.

pub(in crate::analysis) mod body;
pub(in crate::analysis) mod breakable;
pub(in crate::analysis) mod cells;
pub(in crate::analysis) mod grid;
pub(in crate::analysis) mod kind_summary;
pub(in crate::analysis) mod local;
pub(in crate::analysis) mod placement;
pub(in crate::analysis) mod presence;
pub(in crate::analysis) mod probe_lines;
pub(in crate::analysis) mod region;
pub(in crate::analysis) mod scene;
pub(in crate::analysis) mod seam;
pub(in crate::analysis) mod statics;
pub(in crate::analysis) mod surroundings;
pub(in crate::analysis) mod tiles;
