//! The checked program, continued: questions about contacts and places.

use crate::ir::{EntityId, ProbeId, Side, Subject, TagId, TouchId};
use crate::source::Span;

use super::checked::Term;

/// A contact of a collider tagged `mine` (any if none) with something tagged `other`, on a side of mine.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Touching {
    /// Whose collider.
    pub of: Subject,
    /// The tag of the instance's own collider.
    pub mine: Option<TagId>,
    /// The tag of the touched object.
    pub other: TagId,
    /// The side of the instance's own collider.
    pub side: Option<Side>,
    /// The bound query (`as`); it matches only instances.
    pub bound: Option<TouchId>,
}

/// A collider tagged `mine`, moved by an offset, overlaps something tagged `other`.
#[derive(Debug, Clone, PartialEq)]
pub struct Probe {
    /// The tag of the instance's own collider.
    pub mine: TagId,
    /// The tag of what is there.
    pub other: TagId,
    /// The offset along x and y, px.
    pub offset: [Term; 2],
    /// The bound probe (`as`); it matches only instances.
    pub bound: Option<ProbeId>,
}

/// A contact query bound by `as`.
#[derive(Debug, Clone)]
pub struct BoundTouch {
    /// The tag of the instance's own collider.
    pub mine: Option<TagId>,
    /// The tag of the touched object.
    pub other: TagId,
    /// The side of the instance's own collider.
    pub side: Option<Side>,
    /// Its place.
    pub span: Span,
}

/// The living instances of an entity for which something holds.
#[derive(Debug, Clone, PartialEq)]
pub struct Members {
    /// The entity.
    pub of: EntityId,
    /// What holds; it reads the instance as [`Subject::Member`].
    pub holds: Term,
}

/// The nearest other instance of an entity, in the same space, for which something holds.
#[derive(Debug, Clone, PartialEq)]
pub struct Nearest {
    /// The entity.
    pub of: EntityId,
    /// What holds; it reads the instance as [`Subject::Member`].
    pub holds: Term,
    /// The bound name (`as`).
    pub bound: Option<ProbeId>,
}

/// A question bound by `as` that is answered where it is asked.
#[derive(Debug, Clone)]
pub enum BoundProbe {
    /// What is at a place.
    Place(Probe, Span),
    /// What is nearest.
    Nearest(Nearest, Span),
}

impl BoundProbe {
    /// Its place.
    pub fn span(&self) -> Span {
        match self {
            BoundProbe::Place(_, span) | BoundProbe::Nearest(_, span) => *span,
        }
    }
}
