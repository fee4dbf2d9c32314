//! The thresholds of widening: the numbers that a program compares with or writes, and the ends of pushes.

use std::collections::BTreeMap;

use crate::ir::{EntityId, ExprId};

use crate::analysis::domain::unknown::ends;
use crate::analysis::domain::widen::Thresholds;
use crate::analysis::fixpoint::Analysis;

impl Analysis<'_> {
    /// The thresholds of a world whose instances have begun.
    pub(super) fn thresholds(&self) -> Thresholds {
        let (program, world) = (self.program, self.world);
        let mut numbers = vec![0.0];
        let mut read: BTreeMap<EntityId, Vec<ExprId>> = BTreeMap::new();
        for kind in &self.scene.kinds {
            let Some(first) = kind.slots.first() else { continue };
            let exprs =
                read.entry(kind.entity).or_insert_with(|| program.with_operands(program.entities[kind.entity].exprs()));
            for params in ends(&self.slots[*first].params) {
                let constants = exprs.iter().filter_map(|id| program.constant(*id, &params, world.step));
                numbers.extend(constants.flat_map(|c| [c, -c]));
            }
        }
        numbers.extend(self.scene.edges().flat_map(|e| [e.low, e.high]));
        Thresholds::new(numbers)
    }
}
