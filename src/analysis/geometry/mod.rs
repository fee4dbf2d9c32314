//! Where things are: bodies, tiles, what never moves, what the instances of a kind are together.

pub(in crate::analysis) mod body;
pub(in crate::analysis) mod cells;
pub(in crate::analysis) mod crowd;
pub(in crate::analysis) mod landing;
pub(in crate::analysis) mod local;
pub(in crate::analysis) mod presence;
pub(in crate::analysis) mod region;
pub(in crate::analysis) mod scene;
pub(in crate::analysis) mod statics;
pub(in crate::analysis) mod surroundings;
pub(in crate::analysis) mod tiles;
