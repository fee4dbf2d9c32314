//! The checked program's worlds: spaces, instances with their first values, who meets whom, what is asked.

use serde::Serialize;

use crate::level::TileMap;
use crate::source::Span;
use crate::syntax::ast::Name;

use super::checked::Term;
use super::ids::{
    DiscreteId, EntityId, GoalId, IdVec, NeverId, ParamId, PlayerId, RefId, SlotId, SpaceId, TagId, VarId,
};

/// A world.
#[derive(Debug, Clone)]
pub struct World {
    /// Its name.
    pub name: Name,
    /// The length of a step as a fraction of seconds.
    pub step: (u64, u64),
    /// What must be lengths: the sides of tiles.
    pub lengths: Vec<Term>,
    /// `collide` lines in source order.
    pub collide: Vec<CollideRule>,
    /// Its spaces.
    pub spaces: IdVec<SpaceId, Space>,
    /// Its placed instances.
    pub instances: IdVec<SlotId, Instance>,
    /// Its players.
    pub players: IdVec<PlayerId, Player>,
    /// What is looked for.
    pub goals: IdVec<GoalId, Question>,
    /// What must not happen.
    pub nevers: IdVec<NeverId, Question>,
    /// The space whose map the command line was to give, and did not.
    pub open: Option<SpaceId>,
    /// The whole.
    pub span: Span,
}

/// What a contact does.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Push {
    /// It is noticed.
    Sense,
    /// What came from above is held up by what is below.
    FromAbove,
    /// The one that can move is pushed out.
    Block,
}

/// What a contact does. The order is that of strength.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
pub struct Response {
    /// Whether it is pushed.
    pub push: Push,
    /// The velocity into the surface is set to 0.
    pub stop: bool,
    /// What stands on the other moves along.
    pub carry: bool,
}

/// A `collide` line.
#[derive(Debug, Clone)]
pub struct CollideRule {
    /// The tags on one side.
    pub left: Vec<TagId>,
    /// The tags on the other.
    pub right: Vec<TagId>,
    /// What a contact does.
    pub response: Response,
    /// The line.
    pub span: Span,
}

/// A space.
#[derive(Debug, Clone)]
pub struct Space {
    /// Its name.
    pub name: Name,
    /// Its map, with the tags of each kind of tile.
    pub map: Option<TileMap<TagId>>,
    /// Free-standing static geometry.
    pub solids: Vec<Solid>,
    /// Where a player may be: x and y of the lower-left corner, width, height; px.
    pub bounds: Option<[f64; 4]>,
    /// Ways into other spaces, in source order.
    pub links: Vec<Link>,
}

/// A way into another space.
#[derive(Debug, Clone)]
pub struct Link {
    /// Where it begins: x and y of the lower-left corner, width, height; px.
    pub from: [f64; 4],
    /// The space it leads to.
    pub space: SpaceId,
    /// Where it leads to.
    pub to: [f64; 4],
    /// When it is open.
    pub guard: Option<Term>,
    /// The line.
    pub span: Span,
}

/// Free-standing static geometry.
#[derive(Debug, Clone)]
pub struct Solid {
    /// What it counts as.
    pub tags: Vec<TagId>,
    /// x and y of the lower-left corner, width, height; px.
    pub rect: [f64; 4],
    /// The line.
    pub span: Span,
}

/// A place for an instance: placed, made by a tile, or left free for a spawn.
#[derive(Debug, Clone)]
pub struct Instance {
    /// Its name.
    pub name: Name,
    /// How it comes to be.
    pub origin: Origin,
    /// Its entity.
    pub entity: EntityId,
    /// The space it stands in.
    pub space: SpaceId,
    /// The values of its parameters.
    pub params: IdVec<ParamId, f64>,
    /// Position, velocity and acceleration of each continuous variable.
    pub vars: IdVec<VarId, [f64; 3]>,
    /// The values of its discrete variables.
    pub discretes: IdVec<DiscreteId, i32>,
    /// What its references refer to.
    pub refs: IdVec<RefId, Option<SlotId>>,
    /// What its place sets, as written.
    pub given: Vec<(Given, Term)>,
    /// Where it is placed.
    pub span: Span,
}

/// How an instance comes to be.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Origin {
    /// It has a name; its slot is never used again.
    Named,
    /// A tile makes it; once it is destroyed its slot is free.
    Tile,
    /// Nothing is there at first.
    Free,
}

/// What a `place` or a `spawn` can set.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Given {
    /// A parameter.
    Param(ParamId),
    /// A continuous variable or one of its derivatives.
    Var(VarId, u8),
    /// A discrete variable.
    Discrete(DiscreteId),
    /// A reference.
    Ref(RefId),
}

/// A player.
#[derive(Debug, Clone)]
pub struct Player {
    /// The number as written.
    pub number: u32,
    /// The instance it controls.
    pub slot: SlotId,
    /// The line.
    pub span: Span,
}

/// A `goal` or a `never`.
#[derive(Debug, Clone)]
pub struct Question {
    /// Its name.
    pub name: Name,
    /// The predicate.
    pub predicate: Term,
}
