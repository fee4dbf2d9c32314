//! Size limits of the tables and states: sets are single words, ids of modes and instances take two bytes in a state.

/// Maximum number of distinct tags of a program: a set of tags is one machine word.
pub const MAX_TAGS: usize = 64;
/// Maximum number of buttons of an entity.
pub const MAX_BUTTONS: usize = 64;
/// Maximum number of axes of an entity.
pub const MAX_AXES: usize = 4;
/// Maximum number of chances of an entity.
pub const MAX_CHANCES: usize = 32;
/// Greatest size of a whole number that a range has.
pub const MAX_INT: i32 = 1_000_000_000;
/// Maximum number of modes of an entity.
pub const MAX_MODES: usize = 4_096;
/// Maximum number of instances of a world.
pub const MAX_INSTANCES: usize = 10_000;
/// Maximum number of `collide` lines of a world.
pub const MAX_COLLIDE_LINES: usize = 10_000;
