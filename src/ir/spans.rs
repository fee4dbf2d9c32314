//! Where the entries of the tables come from, for diagnostics of running and analysed programs.

use serde::{Deserialize, Serialize};

use super::{
    Arena, AxisId, ButtonId, ChanceId, ColliderId, DiscreteId, EdgeId, Entity, EntityId, EnvelopeId, ExprId, FollowId,
    GoalId, GroupId, Id, IdVec, ModeId, NeverId, ParamId, PlayerId, Program, RareVec, RefId, SlotId, SpaceId, SpawnId,
    TagId, TouchId, VarId, World, WorldId,
};
use crate::source::{FileId, Span};

/// Where the entries of the tables come from.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct Spans {
    /// Of each tag: its first use.
    pub tags: IdVec<TagId, Span>,
    /// Of each expression.
    pub exprs: Arena<ExprId, Span>,
    /// Of each entity's entries.
    pub entities: IdVec<EntityId, Box<EntitySpans>>,
    /// Of each world's entries.
    pub worlds: IdVec<WorldId, WorldSpans>,
}

impl Spans {
    /// All of them.
    pub fn all(&self) -> impl Iterator<Item = Span> + '_ {
        let of_program = self.tags.iter().chain(self.exprs.iter()).copied();
        of_program
            .chain(self.entities.iter().flat_map(|of| of.all()))
            .chain(self.worlds.iter().flat_map(WorldSpans::all))
    }

    /// For a program whose text is not known: the beginning of the first file, for all entries.
    pub(super) fn nowhere(program: &Program) -> Spans {
        fn blank<I: Id, T, Blank: FromIterator<Span>>(table: &IdVec<I, T>) -> Blank {
            table.iter().map(|_| nowhere()).collect()
        }
        fn nowhere() -> Span {
            Span::new(FileId(0), 0, 0)
        }
        let entity = |e: &Entity| EntitySpans {
            name: nowhere(),
            params: blank(&e.params),
            vars: blank(&e.vars),
            discretes: blank(&e.discretes),
            refs: blank(&e.refs),
            spawns: blank(&e.spawns),
            follows: blank(&e.follows),
            invariants: e.invariants.iter().map(|_| nowhere()).collect(),
            buttons: blank(&e.buttons),
            axes: blank(&e.axes),
            chances: blank(&e.chances),
            colliders: blank(&e.colliders),
            groups: blank(&e.groups),
            touches: blank(&e.touches),
            modes: blank(&e.modes),
            edges: blank(&e.edges),
            envelopes: blank(&e.envelopes),
        };
        let world = |w: &World| WorldSpans {
            name: nowhere(),
            spaces: blank(&w.spaces),
            solids: w.spaces.iter().map(|s| s.solids.iter().map(|_| nowhere()).collect()).collect(),
            links: w.spaces.iter().map(|s| s.links.iter().map(|_| nowhere()).collect()).collect(),
            slots: blank(&w.slots),
            players: blank(&w.players),
            goals: blank(&w.goals),
            nevers: blank(&w.nevers),
        };
        Spans {
            tags: blank(&program.tags),
            exprs: program.exprs.iter().map(|_| nowhere()).collect(),
            entities: program.entities.iter().map(|e| entity(e).into()).collect(),
            worlds: program.worlds.iter().map(|w| world(w)).collect(),
        }
    }
}

/// Where an entity's entries come from; a leaf and a timer come from their modes.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct EntitySpans {
    /// The entity's name.
    pub name: Span,
    /// Of each parameter's name.
    pub params: RareVec<ParamId, Span>,
    /// Of each variable's name (of `x` and `y`: the entity's).
    pub vars: IdVec<VarId, Span>,
    /// Of each discrete variable's name.
    pub discretes: RareVec<DiscreteId, Span>,
    /// Of each reference's name.
    pub refs: RareVec<RefId, Span>,
    /// Of each `spawn`.
    pub spawns: RareVec<SpawnId, Span>,
    /// Of each `follow links`.
    pub follows: RareVec<FollowId, Span>,
    /// Of each invariant.
    pub invariants: Box<[Span]>,
    /// Of each button's name.
    pub buttons: RareVec<ButtonId, Span>,
    /// Of each axis' name.
    pub axes: RareVec<AxisId, Span>,
    /// Of each chance's name.
    #[serde(default, skip_serializing_if = "no_chances")]
    pub chances: RareVec<ChanceId, Span>,
    /// Of each collider.
    pub colliders: RareVec<ColliderId, Span>,
    /// Of each group's name (of the anonymous one: the entity's).
    pub groups: RareVec<GroupId, Span>,
    /// Of each contact query: where it is first asked.
    pub touches: RareVec<TouchId, Span>,
    /// Of each mode's name.
    pub modes: RareVec<ModeId, Span>,
    /// Of each edge.
    pub edges: RareVec<EdgeId, Span>,
    /// Of each envelope.
    pub envelopes: RareVec<EnvelopeId, Span>,
}

fn no_chances(chances: &RareVec<ChanceId, Span>) -> bool {
    chances.is_empty()
}

/// Where a world's entries come from.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
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

fn slice<I: Id>(table: &IdVec<I, Span>) -> &[Span] {
    table.iter().as_slice()
}

impl EntitySpans {
    fn all(&self) -> Vec<Span> {
        let EntitySpans {
            name,
            params,
            vars,
            discretes,
            refs,
            spawns,
            follows,
            invariants,
            buttons,
            axes,
            chances,
            colliders,
            groups,
            touches,
            modes,
            edges,
            envelopes,
        } = self;
        let first = [&[*name], slice(params), slice(vars), slice(discretes), slice(refs), slice(spawns)];
        let second = [slice(follows), invariants, slice(buttons), slice(axes), slice(colliders), slice(groups)];
        let third = [slice(touches), slice(modes), slice(edges), slice(envelopes), slice(chances)];
        [first.concat(), second.concat(), third.concat()].concat()
    }
}

impl WorldSpans {
    fn all(&self) -> Vec<Span> {
        let WorldSpans { name, spaces, solids, links, slots, players, goals, nevers } = self;
        let tables = [&[*name], slice(spaces), slice(slots), slice(players), slice(goals), slice(nevers)];
        let of_spaces = solids.iter().chain(links.iter()).flatten().copied();
        tables.concat().into_iter().chain(of_spaces).collect()
    }
}
