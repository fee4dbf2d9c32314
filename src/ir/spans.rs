//! Where the entries of the tables come from, for diagnostics of running and analysed programs.

use serde::Serialize;

use super::{
    AxisId, ButtonId, ColliderId, DiscreteId, EdgeId, EntityId, EnvelopeId, ExprId, FollowId, GoalId, GroupId, IdVec,
    ModeId, NeverId, ParamId, PlayerId, RefId, SlotId, SpaceId, SpawnId, TagId, TouchId, VarId, WorldId,
};
use crate::source::Span;

/// Where the entries of the tables come from.
#[derive(Debug, Clone, Default, Serialize)]
pub struct Spans {
    /// Of each tag: its first use.
    pub tags: IdVec<TagId, Span>,
    /// Of each expression.
    pub exprs: IdVec<ExprId, Span>,
    /// Of each entity's entries.
    pub entities: IdVec<EntityId, EntitySpans>,
    /// Of each world's entries.
    pub worlds: IdVec<WorldId, WorldSpans>,
}

/// Where an entity's entries come from; a leaf and a timer come from their modes.
#[derive(Debug, Clone, Serialize)]
pub struct EntitySpans {
    /// The entity's name.
    pub name: Span,
    /// Of each parameter's name.
    pub params: IdVec<ParamId, Span>,
    /// Of each variable's name (of `x` and `y`: the entity's).
    pub vars: IdVec<VarId, Span>,
    /// Of each discrete variable's name.
    pub discretes: IdVec<DiscreteId, Span>,
    /// Of each reference's name.
    pub refs: IdVec<RefId, Span>,
    /// Of each `spawn`.
    pub spawns: IdVec<SpawnId, Span>,
    /// Of each `follow links`.
    pub follows: IdVec<FollowId, Span>,
    /// Of each invariant.
    pub invariants: Vec<Span>,
    /// Of each button's name.
    pub buttons: IdVec<ButtonId, Span>,
    /// Of each axis' name.
    pub axes: IdVec<AxisId, Span>,
    /// Of each collider.
    pub colliders: IdVec<ColliderId, Span>,
    /// Of each group's name (of the anonymous one: the entity's).
    pub groups: IdVec<GroupId, Span>,
    /// Of each contact question: where it is first asked.
    pub touches: IdVec<TouchId, Span>,
    /// Of each mode's name.
    pub modes: IdVec<ModeId, Span>,
    /// Of each edge.
    pub edges: IdVec<EdgeId, Span>,
    /// Of each envelope.
    pub envelopes: IdVec<EnvelopeId, Span>,
}

/// Where a world's entries come from.
#[derive(Debug, Clone, Serialize)]
pub struct WorldSpans {
    /// The world's name.
    pub name: Span,
    /// Of each space's name.
    pub spaces: IdVec<SpaceId, Span>,
    /// Of each space's free-standing geometry.
    pub solids: IdVec<SpaceId, Vec<Span>>,
    /// Of each space's links.
    pub links: IdVec<SpaceId, Vec<Span>>,
    /// Of each slot.
    pub slots: IdVec<SlotId, Span>,
    /// Of each player's line.
    pub players: IdVec<PlayerId, Span>,
    /// Of each goal's name.
    pub goals: IdVec<GoalId, Span>,
    /// Of each never's name.
    pub nevers: IdVec<NeverId, Span>,
}
