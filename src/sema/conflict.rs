//! Reports variables that two flows or envelopes drive at once.

use std::collections::BTreeMap;

use crate::diagnostic::catalogue::structure::FlowConflict;
use crate::ir::{GroupId, IdVec, VarId};

use super::Checker;
use super::checked::{Drive, Entity};

impl Checker<'_> {
    /// Reports two drives of one variable in one mode, or in modes of two groups.
    pub(super) fn flow_conflicts(&mut self, entity: &Entity) {
        self.within(entity, &entity.drives);
        let mut owners: IdVec<VarId, Option<(GroupId, &Drive)>> = entity.vars.iter().map(|_| None).collect();
        let mut reported = vec![false; entity.vars.len()];
        for mode in entity.modes.iter() {
            self.within(entity, &mode.drives);
            for drive in &mode.drives {
                match owners[drive.var] {
                    None => owners[drive.var] = Some((mode.group, drive)),
                    Some((group, first)) if group != mode.group && !reported[drive.var.0 as usize] => {
                        reported[drive.var.0 as usize] = true;
                        self.conflict(entity, first, drive, true);
                    }
                    Some(_) => {}
                }
            }
        }
    }

    fn within(&mut self, entity: &Entity, drives: &[Drive]) {
        let mut first: BTreeMap<VarId, &Drive> = BTreeMap::new();
        for drive in drives {
            match first.get(&drive.var) {
                Some(first) => self.conflict(entity, first, drive, false),
                None => drop(first.insert(drive.var, drive)),
            }
        }
    }

    fn conflict(&mut self, entity: &Entity, first: &Drive, second: &Drive, across_groups: bool) {
        self.diagnostics.report(FlowConflict {
            variable: entity.vars[second.var].name.text.to_string(),
            first: first.span,
            second: second.span,
            across_groups,
        });
    }
}
