//! The flat intermediate representation: tables indexed by ids, no pointers, no names in the hot part.
//!
//! Everything that can be decided when a program is compiled is decided here: for each leaf mode the drives of its
//! variables and the edges to try, for each world the slots with their first values and the layout of a state. The
//! simulator, the planners and all later backends read these tables and nothing else.

mod actions;
mod expressions;
mod fold;
mod layout;
mod leaf;
mod lower;
mod program;
mod spans;
mod text;
mod verify;
mod world;
mod world_tables;

pub use layout::{Layout, SlotLayout};
pub use lower::lower;
pub use program::{
    Actions, By, Choice, Clamp, Collider, Discrete, Domain, Drive, Edge, Entity, Envelope, Expr, Follow, Group, Inputs,
    Leaf, Mode, Param, Program, RefUpdate, RefValue, Reference, Release, Shape, Spawn, TagSet, Timer, Touch, Update,
};
pub use spans::{EntitySpans, Spans, WorldSpans};
pub use text::text;
pub use world_tables::{Bounds, Collide, Link, Meeting, Player, Predicate, Slot, Solid, Space, Step, World};

pub use crate::level::TileMap;
pub use crate::sema::checked::{Arithmetic, CompareOp, Function, Origin, Place, Press, Push, Response, Side, Subject};
pub use crate::sema::ids::{
    AxisId, ButtonId, ColliderId, DiscreteId, EdgeId, EntityId, EnvelopeId, ExprId, FollowId, GoalId, GroupId, Id,
    IdVec, LeafId, ModeId, NeverId, ParamId, PlayerId, RefId, SlotId, SpaceId, SpawnId, TagId, TimerId, TouchId, VarId,
    WorldId,
};
pub use crate::sema::{MAX_AXES, arithmetic, call, compare};
