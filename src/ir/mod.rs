//! The flat intermediate representation: tables indexed by ids, no pointers, no names in the hot part.
//!
//! Everything that can be decided at compile time is decided here: for each leaf mode the drives of its variables and
//! the edges to try, for each world the slots with their initial values and the layout of a state. The simulator, the
//! planners and all backends read only these tables.

mod actions;
mod arena;
mod arithmetic;
mod breakable;
mod colliders;
mod expressions;
mod ids;
mod inputs;
mod json;
mod layout;
mod limits;
mod looks;
mod lower;
mod meaning;
mod names;
mod operators;
mod period;
mod program;
mod rare;
mod slope;
mod spans;
mod still;
mod targets;
mod text;
mod tile_map;
mod transition;
mod verify;
mod world_tables;

pub use actions::{Actions, RefUpdate, RefValue, Send, Signal, Spawn, Sum, Update};
pub use arena::Arena;
pub use arithmetic::{Extremes, arithmetic, call, compare};
pub use breakable::{Breakable, BreakableKind, BreakableTiles};
pub use colliders::{Collider, Shape, TagSet, Touch};
pub use ids::{
    AxisId, ButtonId, ChanceId, ColliderId, DiscreteId, EdgeId, EntityId, EnvelopeId, ExprId, FollowId, GoalId,
    GroupId, Id, IdRange, IdVec, LeafId, ModeId, NeverId, ParamId, PlayerId, ProbeId, RefId, SendId, SignalId, SlotId,
    SpaceId, SpawnId, TagId, TileId, TimerId, TouchId, VarId, WorldId,
};
pub use inputs::{Chance, Inputs};
pub use json::{JSON_VERSION, NotAProgram};
pub use layout::{Layout, Rest, SlotLayout, TileLayout};
pub use limits::{MAX_AXES, MAX_BUTTONS, MAX_CHANCES, MAX_COLLIDE_LINES, MAX_INSTANCES, MAX_INT, MAX_MODES, MAX_TAGS};
pub use looks::{EntityLook, Look, Looks, MapLook, TagLook, TilePicture};
pub use lower::lower;
pub use operators::{Arithmetic, Bounce, CompareOp, Function, Origin, Place, Press, Push, Response, Side, Subject};
pub use period::Period;
pub use program::{
    By, Choice, Clamp, Discrete, Domain, Drive, Edge, Entity, Envelope, Expr, Follow, Group, Leaf, Mode, Param,
    Program, Reference, Release, Timer,
};
pub use rare::RareVec;
pub use slope::{Misfit, Slope};
pub use spans::{EntitySpans, Spans, WorldSpans};
pub use still::MANY_STILL;
pub use text::text;
pub use tile_map::{TileKind, TileMap};
pub use transition::Transition;
pub use verify::{Invalid, verify};
pub use world_tables::{Bounds, Collide, Limit, Link, Meeting, Player, Predicate, Slot, Solid, Space, Step, World};
