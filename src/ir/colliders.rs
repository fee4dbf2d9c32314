//! Colliders: their tags, shapes, and the contact queries about them.

use serde::{Deserialize, Serialize};

use super::program::is_false;
use super::{ExprId, Side, TagId};

/// A set of tags, one bit each.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct TagSet(pub u64);

impl TagSet {
    /// Every tag.
    pub const ALL: TagSet = TagSet(u64::MAX);

    /// The set of one tag.
    pub fn of(tag: TagId) -> TagSet {
        TagSet(1u64.checked_shl(tag.0).unwrap_or(0))
    }

    /// Both sets together.
    #[must_use]
    pub fn with(self, other: TagSet) -> TagSet {
        TagSet(self.0 | other.0)
    }

    /// Whether the sets share a tag.
    pub fn meets(self, other: TagSet) -> bool {
        self.0 & other.0 != 0
    }

    /// The tags in order.
    pub fn iter(self) -> impl Iterator<Item = TagId> {
        (0..64).filter(move |bit| self.0 >> bit & 1 == 1).map(TagId)
    }
}

impl FromIterator<TagId> for TagSet {
    fn from_iter<A: IntoIterator<Item = TagId>>(tags: A) -> TagSet {
        tags.into_iter().fold(TagSet::default(), |set, tag| set.with(TagSet::of(tag)))
    }
}

/// The shape of a collider relative to the position, px; read at the start of the collision phase.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Shape {
    /// x and y of the lower-left corner, width, height.
    Rect([ExprId; 4]),
    /// x and y of the centre, radius.
    Circle([ExprId; 3]),
}

impl Shape {
    /// Its bounding box relative to the position: x and y of the lower-left corner, width, height, px. `None` if a
    /// number is not known.
    pub fn sides(&self, number: impl Fn(ExprId) -> Option<f64>) -> Option<[f64; 4]> {
        Some(match *self {
            Shape::Rect([x, y, width, height]) => [number(x)?, number(y)?, number(width)?, number(height)?],
            Shape::Circle([x, y, radius]) => {
                let (x, y, radius) = (number(x)?, number(y)?, number(radius)?);
                [x - radius, y - radius, 2.0 * radius, 2.0 * radius]
            }
        })
    }

    /// Its bounding box along one axis (0 or 1): the lower end and the length, px. `None` if a number is not known.
    pub fn along(&self, axis: usize, number: impl Fn(ExprId) -> Option<f64>) -> Option<(f64, f64)> {
        match *self {
            Shape::Rect([x, y, width, height]) => {
                let (from, length) = [(x, width), (y, height)][axis];
                Some((number(from)?, number(length)?))
            }
            Shape::Circle([x, y, radius]) => {
                let radius = number(radius)?;
                Some((number([x, y][axis])? - radius, 2.0 * radius))
            }
        }
    }

    /// Whether it is round.
    pub fn is_round(&self) -> bool {
        matches!(self, Shape::Circle(_))
    }

    /// Its numbers.
    pub fn numbers(&self) -> &[ExprId] {
        match self {
            Shape::Rect(numbers) => numbers,
            Shape::Circle(numbers) => numbers,
        }
    }
}

/// A collider.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct Collider {
    /// What it counts as.
    pub tags: TagSet,
    /// Whether it is never pushed.
    pub kinematic: bool,
    /// Its shape.
    pub shape: Shape,
    /// While this holds it is there; read at the start of the collision phase.
    pub guard: Option<ExprId>,
}

/// A contact query: a collider of one's own tagged with one of `mine`, something tagged `other`, on a side.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct Touch {
    /// Tags of one's own collider.
    pub mine: TagSet,
    /// The tag of what is touched.
    pub other: TagId,
    /// The side of one's own collider, if it matters.
    pub side: Option<Side>,
    /// Only instances count, and the lowest one is kept.
    pub bound: bool,
    /// Tiles that can be broken count as well, and the one touched along the longest edge is kept.
    #[serde(default, skip_serializing_if = "is_false")]
    pub tiles: bool,
}
