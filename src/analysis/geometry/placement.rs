//! Placements: positions to which an event moves an instance, and the colliders that may then overlap an obstacle.

use std::collections::BTreeSet;
use std::sync::Arc;

use crate::ir::{ColliderId, LeafId, SpaceId, VarId};

use crate::analysis::domain::configuration::Configuration;
use crate::analysis::domain::values::Interval;

/// A set of positions at which an instance is placed, px.
#[derive(Debug)]
pub(in crate::analysis) struct Placement {
    pub spaces: Arc<BTreeSet<SpaceId>>,
    pub at: [Interval; 2],
    pub colliders: PlacedColliders,
}

/// The colliders that may overlap an obstacle there.
#[derive(Debug, Clone)]
pub(in crate::analysis) enum PlacedColliders {
    All,
    /// Those that are active in some leaves.
    While(Vec<LeafId>),
    /// The instance does not move; one collider is switched on.
    One {
        collider: ColliderId,
        /// Whether nothing kept the instance out of obstacles before.
        was_unblocked: bool,
    },
}

impl Placement {
    /// The positions of a configuration; `None` if it is impossible.
    pub fn of(at: &Configuration) -> Option<Placement> {
        let hull = |axis: u32| at.vars[VarId(axis)][0].hull();
        Some(Placement { spaces: at.spaces.clone(), at: [hull(0)?, hull(1)?], colliders: PlacedColliders::All })
    }
}
