//! Where something puts an instance, and which of its colliders can be inside of something there.

use std::collections::BTreeSet;
use std::sync::Arc;

use crate::ir::{ColliderId, LeafId, SpaceId, VarId};

use crate::analysis::domain::configuration::Configuration;
use crate::analysis::domain::values::Interval;

/// Where something puts an instance, px.
#[derive(Debug)]
pub(in crate::analysis) struct Landing {
    pub spaces: Arc<BTreeSet<SpaceId>>,
    pub at: [Interval; 2],
    pub whose: Whose,
}

/// The colliders that can be inside of something there.
#[derive(Debug, Clone)]
pub(in crate::analysis) enum Whose {
    All,
    /// Those that are there while some leaves are active.
    While(Vec<LeafId>),
    /// It is there already; a collider is new.
    One {
        collider: ColliderId,
        /// Whether it can have been anywhere before: nothing of it was kept out of what blocks.
        was_bare: bool,
    },
}

impl Landing {
    /// Where an instance is; none if it cannot be.
    pub fn of(at: &Configuration) -> Option<Landing> {
        let hull = |axis: u32| at.vars[VarId(axis)][0].hull();
        Some(Landing { spaces: at.spaces.clone(), at: [hull(0)?, hull(1)?], whose: Whose::All })
    }
}
