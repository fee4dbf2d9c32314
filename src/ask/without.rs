//! What paths are asked to be without: states in which a predicate holds, or inputs with a button, `held(run)`.

use crate::compile::is_name;
use crate::diagnostic::catalogue::run::NoQuestion;
use crate::diagnostic::similar;
use crate::ir::{Entity, Program, World};

/// What is left out.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Without<'a> {
    /// States in which a predicate of the world holds.
    Predicate(&'a str),
    /// Inputs in which players hold a button of this name.
    Button(&'a str),
}

impl<'a> Without<'a> {
    /// `held(run)` and `pressed(run)` are about inputs, which no predicate of a world reads; all else is a predicate.
    pub fn read(text: &'a str) -> Without<'a> {
        let inside = ["held", "pressed"].iter().find_map(|word| {
            let rest = text.trim().strip_prefix(word)?.trim_start();
            Some(rest.strip_prefix('(')?.strip_suffix(')')?.trim())
        });
        inside.filter(|name| is_name(name)).map_or(Without::Predicate(text), Without::Button)
    }

    /// The predicate, if it is one.
    pub fn predicate(self) -> Option<&'a str> {
        match self {
            Without::Predicate(text) => Some(text),
            Without::Button(_) => None,
        }
    }

    /// For each player of a world the buttons that are left out; empty for a predicate.
    pub fn buttons(self, program: &Program, world: &World) -> Result<Vec<u64>, NoQuestion> {
        let Without::Button(name) = self else { return Ok(Vec::new()) };
        let entities = || world.players.iter().map(|player| &*program.entities[world.slots[player.slot].entity]);
        let mask = |entity: &Entity| {
            let named = entity.buttons.pairs().filter(|(_, button)| *button == name);
            named.fold(0, |mask, (id, _)| mask | 1 << id.0)
        };
        let masks: Vec<u64> = entities().map(mask).collect();
        if masks.iter().any(|mask| *mask != 0) {
            return Ok(masks);
        }
        let known: Vec<&str> = entities().flat_map(|entity| entity.buttons.iter().map(String::as_str)).collect();
        let list: Vec<String> = known.iter().map(|button| format!("`{button}`")).collect();
        Err(NoQuestion {
            why: format!("no player of `{}` has a button `{name}`", world.name),
            near: similar(name, known.iter().copied()),
            help: (!list.is_empty()).then(|| format!("there is {}", list.join(", "))),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_button_is_told_from_a_predicate() {
        for text in ["held(run)", " pressed( run )", "held (run)"] {
            assert_eq!(Without::read(text), Without::Button("run"), "{text}");
        }
        for text in ["hero.x > 3", "held(run) and hero.x > 3", "held(hero.run)", "held()", "holds(run)"] {
            assert_eq!(Without::read(text), Without::Predicate(text));
        }
    }
}
