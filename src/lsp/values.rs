//! The value ranges of variables that the analysis found, by entity and mode: for hovers and inlay hints.

use std::collections::BTreeMap;

use crate::analysis::{Spaces, Values};
use crate::ir::Program;

/// The values of a variable while a mode is active; those of a continuous variable include its derivatives.
#[derive(Debug, Clone)]
pub(in crate::lsp) struct ModeValues {
    /// The mode's path; empty in an entity without modes.
    pub mode: String,
    /// The variable, its velocity, its acceleration.
    pub values: Vec<Values>,
}

/// The values of variables, joined over all worlds of a program.
#[derive(Debug, Clone, Default)]
pub(in crate::lsp) struct Ranges {
    /// By entity and variable; modes in the order in which they were found.
    by_variable: BTreeMap<(String, String), Vec<ModeValues>>,
}

impl Ranges {
    /// Joins the results of all worlds. Drops an entity if its analysis was given up in one of them.
    pub fn of(program: &Program, spaces: &Spaces) -> Self {
        let mut out = Ranges::default();
        let mut given_up = Vec::new();
        for (world, table) in program.worlds.pairs() {
            let Some(space) = spaces.get(&world) else {
                given_up.extend(table.slots.iter().map(|s| s.entity));
                continue;
            };
            for (slot, found) in space.slots.pairs() {
                let id = table.slots[slot].entity;
                if found.is_given_up {
                    given_up.push(id);
                    continue;
                }
                let entity = &program.entities[id];
                for at in &found.configurations {
                    for leaf in &*at.leaves {
                        let mode = &entity.modes[entity.leaves[*leaf].mode].path;
                        for (var, values) in at.vars.pairs() {
                            out.add((&entity.name, &entity.vars[var]), mode, values);
                        }
                        for (discrete, values) in at.discretes.pairs() {
                            let name = &entity.discretes[discrete].name;
                            out.add((&entity.name, name), mode, std::slice::from_ref(values));
                        }
                    }
                }
            }
        }
        out.by_variable.retain(|(entity, _), _| !given_up.iter().any(|id| *program.entities[*id].name == **entity));
        out
    }

    fn add(&mut self, (entity, name): (&str, &str), mode: &str, values: &[Values]) {
        let modes = self.by_variable.entry((entity.to_string(), name.to_string())).or_default();
        match modes.iter_mut().find(|m| m.mode == mode) {
            Some(known) => known.values.iter_mut().zip(values).for_each(|(old, new)| *old = old.or(new)),
            None => modes.push(ModeValues { mode: mode.to_string(), values: values.to_vec() }),
        }
    }

    /// The values of a variable of an entity in each mode; empty if unknown.
    pub fn get(&self, entity: &str, name: &str) -> &[ModeValues] {
        self.by_variable.get(&(entity.to_string(), name.to_string())).map_or(&[], Vec::as_slice)
    }
}

/// Values as text: intervals joined by "or".
pub(in crate::lsp) fn format_values(values: &Values) -> String {
    let parts: Vec<String> = values.intervals().iter().map(ToString::to_string).collect();
    if parts.is_empty() { "none".into() } else { parts.join(" or ") }
}
