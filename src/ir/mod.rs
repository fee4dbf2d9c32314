//! The flat intermediate representation: tables indexed by ids, no pointers, no names in the hot part.
//!
//! Everything that can be decided when a program is compiled is decided here: for each leaf mode the drives of its
//! variables and the edges to try, for each world the slots with their first values and the layout of a state. The
//! simulator, the planners and all later backends read these tables and nothing else.

mod fold;
mod layout;
mod leaf;
mod lower;
mod program;
mod text;
mod verify;
mod world;

pub use layout::{Layout, SlotLayout};
pub use lower::lower;
pub use program::{
    Bounds, Choice, Collide, Collider, Discrete, Domain, Drive, Edge, Entity, EntitySpans, Envelope, Expr, Group,
    Inputs, Leaf, Mode, Param, Player, Predicate, Program, Release, Slot, Solid, Space, Spans, Step, TagSet, Timer,
    Touch, Update, World, WorldSpans,
};
pub use text::text;

pub use crate::sema::checked::{Arithmetic, CompareOp, Function, Place, Press, Response, Side, Subject};
pub use crate::sema::ids::{
    AxisId, ButtonId, ColliderId, DiscreteId, EdgeId, EntityId, EnvelopeId, ExprId, GoalId, GroupId, Id, IdVec, LeafId,
    ModeId, NeverId, ParamId, PlayerId, SlotId, SpaceId, TagId, TimerId, TouchId, VarId, WorldId,
};
pub use crate::sema::{MAX_AXES, arithmetic, call, compare};
