//! What the analysis knows of variables, by entity and mode: for hovering and for hints.

use std::collections::BTreeMap;

use crate::analysis::{Spaces, Values};
use crate::ir::Program;

/// What a variable can be while a mode is active: itself and, of a continuous one, its derivatives.
#[derive(Debug, Clone)]
pub(in crate::lsp) struct InMode {
    /// The mode's path; empty in an entity without modes.
    pub mode: String,
    /// The variable, its velocity, its acceleration.
    pub values: Vec<Values>,
}

/// What variables can be in all worlds of a program.
#[derive(Debug, Clone, Default)]
pub(in crate::lsp) struct Ranges {
    /// By entity and variable; modes in order.
    known: BTreeMap<(String, String), Vec<InMode>>,
}

impl Ranges {
    /// What all worlds have found. Nothing is kept of an entity that was given up in one of them.
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
                    for leaf in &at.leaves {
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
        out.known.retain(|(entity, _), _| !given_up.iter().any(|id| program.entities[*id].name == *entity));
        out
    }

    fn add(&mut self, (entity, name): (&str, &str), mode: &str, values: &[Values]) {
        let modes = self.known.entry((entity.to_string(), name.to_string())).or_default();
        match modes.iter_mut().find(|m| m.mode == mode) {
            Some(known) => known.values.iter_mut().zip(values).for_each(|(old, new)| *old = old.or(new)),
            None => modes.push(InMode { mode: mode.to_string(), values: values.to_vec() }),
        }
    }

    /// What a variable of an entity can be in each mode.
    pub fn get(&self, entity: &str, name: &str) -> &[InMode] {
        self.known.get(&(entity.to_string(), name.to_string())).map_or(&[], Vec::as_slice)
    }
}

/// Some values as one writes them.
pub(in crate::lsp) fn written(values: &Values) -> String {
    let parts: Vec<String> = values.intervals().iter().map(ToString::to_string).collect();
    if parts.is_empty() { "none".into() } else { parts.join(" or ") }
}
