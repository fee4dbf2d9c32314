//! The tables of a world: spaces, slots with their initial values, contact rules, predicates.

use std::cmp::Ordering;

use crate::ir::TileMap;
use serde::{Deserialize, Serialize};

use super::{
    DiscreteId, EntityId, ExprId, Extremes, GoalId, IdVec, Layout, NeverId, Origin, ParamId, Period, PlayerId, Program,
    Push, RefId, Response, SlotId, SpaceId, TagId, TagSet, TimerId, VarId,
};

/// A world, ready to run.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct World {
    /// Its name.
    pub name: String,
    /// The length of a step.
    pub step: Step,
    /// Its spaces.
    pub spaces: IdVec<SpaceId, Space>,
    /// Its slots.
    pub slots: IdVec<SlotId, Slot>,
    /// Its players.
    pub players: IdVec<PlayerId, Player>,
    /// Which colliders meet, and what a contact does.
    pub collide: Vec<Collide>,
    /// How many instances may be alive at once; an entity without an entry has no limit but its slots.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub limits: Vec<Limit>,
    /// What is looked for.
    pub goals: IdVec<GoalId, Predicate>,
    /// What must not happen.
    pub nevers: IdVec<NeverId, Predicate>,
    /// The space whose map is not given: the world cannot be run.
    pub open: Option<SpaceId>,
    /// Where everything is in a state.
    pub layout: Layout,
}

/// At most `count` instances of an entity are alive at once, whatever the origin of their slots.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct Limit {
    /// The entity.
    pub entity: EntityId,
    /// How many: a spawn is refused if as many are alive.
    pub count: u32,
}

/// The length of a step as a fraction in lowest terms, s.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct Step {
    /// Numerator, more than 0.
    pub numerator: u64,
    /// Denominator, more than 0.
    pub denominator: u64,
}

impl Step {
    /// The length, s.
    pub fn seconds(self) -> f64 {
        self.numerator as f64 / self.denominator as f64
    }

    /// The length of a number of steps, s, rounded once.
    pub fn times(self, count: u32) -> f64 {
        self.frames(f64::from(count))
    }

    /// As [`Step::times`], of a number with a fraction.
    pub fn frames(self, count: f64) -> f64 {
        (count * self.numerator as f64) / self.denominator as f64
    }
}

/// A room.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct Space {
    /// Its name.
    pub name: String,
    /// Its map.
    pub map: Option<TileMap<TagId>>,
    /// Free-standing static geometry.
    pub solids: Vec<Solid>,
    /// The bounds that are written: a run ends where a player leaves them below or beside. None: it ends at no border.
    pub bounds: Option<Bounds>,
    /// What repeats along each axis: the left and the right border of the extent are one, the lower and the upper one.
    #[serde(default, skip_serializing_if = "repeats_nowhere")]
    pub periods: [Option<Period>; 2],
    /// Ways into other spaces.
    pub links: Vec<Link>,
}

#[allow(clippy::trivially_copy_pass_by_ref, reason = "the form that serde asks for")]
fn repeats_nowhere(periods: &[Option<Period>; 2]) -> bool {
    *periods == [None; 2]
}

impl Space {
    /// Whether it wraps at all.
    pub fn wraps(&self) -> bool {
        self.periods != [None; 2]
    }

    /// The rectangle that the map covers. It does not end a run.
    pub fn map_rectangle(&self) -> Option<Bounds> {
        self.map.as_ref().map(|map| Bounds::new([0.0, 0.0, map.size().0, map.size().1]))
    }

    /// The size of the space where one is needed: the written bounds, or the map's rectangle.
    pub fn extent(&self) -> Option<Bounds> {
        self.bounds.or_else(|| self.map_rectangle())
    }
}

/// A way into another space: from a place to the same place relative to another rectangle.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct Link {
    /// Where it begins.
    pub from: Bounds,
    /// The space it leads to.
    pub space: SpaceId,
    /// Where it leads to.
    pub to: Bounds,
    /// When it is open; reads instances, no inputs.
    pub guard: Option<ExprId>,
}

/// Free-standing static geometry.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct Solid {
    /// What it counts as.
    pub tags: TagSet,
    /// Where it is.
    pub bounds: Bounds,
}

/// A rectangle, px.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct Bounds {
    /// Its least x.
    pub left: f64,
    /// Its greatest x.
    pub right: f64,
    /// Its least y.
    pub bottom: f64,
    /// Its greatest y.
    pub top: f64,
}

impl Bounds {
    /// From the lower-left corner, width and height.
    pub fn new([x, y, width, height]: [f64; 4]) -> Self {
        Bounds { left: x, right: x + width, bottom: y, top: y + height }
    }

    /// The same rectangle from a position, to which it was relative.
    #[must_use]
    pub fn placed(self, (x, y): (f64, f64)) -> Self {
        Bounds { left: x + self.left, right: x + self.right, bottom: y + self.bottom, top: y + self.top }
    }

    /// The smallest rectangle around both.
    #[must_use]
    pub fn join(self, other: Bounds) -> Self {
        Bounds {
            left: self.left.least(other.left),
            right: self.right.greatest(other.right),
            bottom: self.bottom.least(other.bottom),
            top: self.top.greatest(other.top),
        }
    }

    /// Whether a position lies below or beside; above is open.
    pub fn is_left_at(&self, (x, y): (f64, f64)) -> bool {
        !((self.left..=self.right).contains(&x) && y >= self.bottom)
    }
}

/// A place for an instance, with the instance's first values.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct Slot {
    /// The instance's name.
    pub name: String,
    /// How an instance comes to be there.
    pub origin: Origin,
    /// Whether its parameters never change: it is placed, or nothing makes new instances of its entity.
    pub is_fixed: bool,
    /// Its entity.
    pub entity: EntityId,
    /// The space it is in at first.
    pub space: SpaceId,
    /// Who controls it.
    pub player: Option<PlayerId>,
    /// The values of its parameters.
    pub params: IdVec<ParamId, f64>,
    /// Position, velocity and acceleration of each continuous variable.
    pub vars: IdVec<VarId, [f64; 3]>,
    /// The values of its discrete variables, within their ranges.
    pub discretes: IdVec<DiscreteId, i32>,
    /// What its references refer to.
    pub refs: IdVec<RefId, Option<SlotId>>,
    /// Where each timer's count saturates.
    pub timer_limits: IdVec<TimerId, u32>,
}

/// A player.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct Player {
    /// The number as written.
    pub number: u32,
    /// The slot it controls; no other player does.
    pub slot: SlotId,
}

/// Colliders with a tag of `left` and one with a tag of `right` meet.
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct Collide {
    /// The one side.
    pub left: TagSet,
    /// The other.
    pub right: TagSet,
    /// What a contact does.
    pub response: Response,
}

/// A `goal` or a `never`.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct Predicate {
    /// Its name.
    pub name: String,
    /// When it holds; reads instances, no inputs.
    pub holds: ExprId,
}

/// How colliders of two kinds meet.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Meeting {
    /// What a contact does.
    pub response: Response,
    /// The first may be on the second: it has the tags on the left of the line.
    pub first_on_second: bool,
    /// The second may be on the first.
    pub second_on_first: bool,
}

impl World {
    /// The strongest response of colliders of some entities to something with some tags; none if no rule pairs them.
    pub fn strongest_push(
        &self,
        program: &Program,
        entities: impl IntoIterator<Item = EntityId>,
        tags: TagSet,
    ) -> Option<Push> {
        let colliders = entities.into_iter().flat_map(|entity| program.entities[entity].colliders.iter());
        colliders.filter_map(|collider| self.meeting(collider.tags, tags)).map(|meeting| meeting.response.push).max()
    }

    /// The entities of the players.
    pub fn player_entities(&self) -> impl Iterator<Item = EntityId> {
        self.players.iter().map(|player| self.slots[player.slot].entity)
    }

    /// The number of tiles with a tag in the maps of all spaces, broken or not.
    pub fn tiles_with(&self, tag: TagId) -> usize {
        let maps = self.spaces.iter().filter_map(|space| space.map.as_ref());
        maps.map(|map| map.count(|kind| kind.tags.contains(&tag))).sum()
    }

    /// The rule of a contact between colliders with these tags, if there is one. The strongest rule wins; equally
    /// strong ones are combined.
    pub fn meeting(&self, a: TagSet, b: TagSet) -> Option<Meeting> {
        let meetings = self.collide.iter().filter_map(|c| {
            let first_on_second = c.left.meets(a) && c.right.meets(b);
            let second_on_first = c.left.meets(b) && c.right.meets(a);
            (first_on_second || second_on_first).then_some(Meeting {
                response: c.response,
                first_on_second,
                second_on_first,
            })
        });
        meetings.reduce(|best, next| match next.response.cmp(&best.response) {
            Ordering::Less => best,
            Ordering::Greater => next,
            Ordering::Equal => Meeting {
                first_on_second: best.first_on_second || next.first_on_second,
                second_on_first: best.second_on_first || next.second_on_first,
                ..best
            },
        })
    }
}
