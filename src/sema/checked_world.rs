//! The checked program's worlds: spaces, instances with their initial values, contact rules, predicates.

use crate::ir::Period;
use crate::ir::{
    DiscreteId, EntityId, GoalId, IdVec, Look, MapLook, NeverId, Origin, ParamId, PlayerId, RefId, Response, SlotId,
    SpaceId, TagId, TileMap, VarId,
};

use crate::source::Span;
use crate::syntax::ast::Name;

use super::checked::{Condition, Term, Test};

/// A world.
#[derive(Debug, Clone)]
pub struct World {
    /// Its name.
    pub name: Name,
    /// The length of a step as a fraction of seconds.
    pub step: (u64, u64),
    /// Terms that must be lengths: the sides of tiles.
    pub lengths: Vec<Term>,
    /// Terms that must be times: after how long broken tiles are back, and the times of tests.
    pub times: Vec<Term>,
    /// `collide` lines in source order.
    pub collide: Vec<CollideRule>,
    /// The name of the first set of tiles or space: `collide` lines are usually written before it.
    pub body: Option<Span>,
    /// Its spaces.
    pub spaces: IdVec<SpaceId, Space>,
    /// Its placed instances.
    pub instances: IdVec<SlotId, Instance>,
    /// The most instances of an entity that may be alive at once.
    pub limits: Vec<(EntityId, u32)>,
    /// The looks of tags, in source order.
    pub looks: Vec<(Name, Look)>,
    /// What maps of level editors show; their world is not known yet.
    pub map_looks: Vec<MapLook>,
    /// Its players.
    pub players: IdVec<PlayerId, Player>,
    /// What is looked for.
    pub goals: IdVec<GoalId, Question>,
    /// What must not happen.
    pub nevers: IdVec<NeverId, Question>,
    /// Its tests, in source order.
    pub tests: Vec<Test>,
    /// Named conditions, which their uses have replaced.
    pub conditions: Box<[Condition]>,
    /// The space whose map the command line must provide.
    pub open: Option<SpaceId>,
    /// The whole.
    pub span: Span,
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
    /// The bounds of players: x and y of the lower-left corner, width, height; px.
    pub bounds: Option<[f64; 4]>,
    /// Whether the left and the right border are one, and the lower and the upper one.
    pub wraps: [bool; 2],
    /// Links to other spaces, in source order.
    pub links: Vec<Link>,
}

impl Space {
    /// What repeats along each axis; unknown while the map is.
    pub fn periods(&self) -> [Option<Period>; 2] {
        let map = self.map.as_ref().map(|map| [0.0, 0.0, map.size().0, map.size().1]);
        let extent = self.bounds.or(map);
        let of = |axis: usize, sides: [f64; 4]| Period { low: sides[axis], high: sides[axis] + sides[axis + 2] };
        [0, 1].map(|axis| extent.filter(|_| self.wraps[axis]).map(|sides| of(axis, sides)))
    }
}

/// A link to another space.
#[derive(Debug, Clone)]
pub struct Link {
    /// The source rectangle: x and y of the lower-left corner, width, height; px.
    pub from: [f64; 4],
    /// The target space.
    pub space: SpaceId,
    /// The target rectangle.
    pub to: [f64; 4],
    /// When it is open.
    pub guard: Option<Term>,
    /// The line.
    pub span: Span,
}

/// Free-standing static geometry.
#[derive(Debug, Clone)]
pub struct Solid {
    /// Its tags.
    pub tags: Vec<TagId>,
    /// x and y of the lower-left corner, width, height; px.
    pub rect: [f64; 4],
    /// The line.
    pub span: Span,
}

/// A slot: a placed instance, one made by a tile, or free for a spawn.
#[derive(Debug, Clone)]
pub struct Instance {
    /// Its name.
    pub name: Name,
    /// The origin of its instance.
    pub origin: Origin,
    /// Its entity.
    pub entity: EntityId,
    /// The space it is in.
    pub space: SpaceId,
    /// The values of its parameters.
    pub params: IdVec<ParamId, f64>,
    /// Position, velocity and acceleration of each continuous variable.
    pub vars: IdVec<VarId, [f64; 3]>,
    /// The values of its discrete variables.
    pub discretes: IdVec<DiscreteId, i32>,
    /// The targets of its references.
    pub refs: IdVec<RefId, Option<SlotId>>,
    /// The values set at its placement, as written.
    pub given: Vec<(Given, Term)>,
    /// Where it is placed.
    pub span: Span,
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

/// A name in a level of an editor that became a tag.
#[derive(Debug, Clone)]
pub struct LevelName {
    /// The name.
    pub name: String,
    /// The map.
    pub map: Span,
    /// Whether an object of the level has it, which may be meant to be an instance.
    pub is_object: bool,
    /// The nearest name in the map's block, and what it stands for.
    pub near: Option<(String, String)>,
}
