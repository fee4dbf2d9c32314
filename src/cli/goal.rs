//! The one goal that a command asks about.

use crate::compile::question_name;
use crate::diagnostic::catalogue::run::NoQuestion;
use crate::diagnostic::similar;
use crate::ir::{GoalId, World};

/// The goal of the arguments, or the only one.
pub(super) fn chosen_goal(world: &World, text: Option<&str>) -> Result<GoalId, NoQuestion> {
    let names: Vec<&str> = world.goals.iter().map(|goal| goal.name.as_str()).collect();
    let list = || format!("there is {}", names.iter().map(|n| format!("`{n}`")).collect::<Vec<_>>().join(", "));
    match text.map(question_name) {
        Some(name) => world.goal_named(&name).ok_or_else(|| NoQuestion {
            why: format!("no goal `{name}` in `{}`", world.name),
            near: similar(&name, names.iter().copied()),
            help: (!names.is_empty()).then(list),
        }),
        None => world.goals.ids().next().filter(|_| names.len() == 1).ok_or_else(|| match names.is_empty() {
            true => NoQuestion {
                why: format!("`{}` has no goal", world.name),
                near: None,
                help: Some(
                    "add one, such as `goal arrive: near(hero, (416, 48), 16)`, or ask a predicate with `--goal`"
                        .into(),
                ),
            },
            false => NoQuestion {
                why: format!("`{}` has several goals", world.name),
                near: None,
                help: Some(format!("choose one with `--goal NAME`; {}", list())),
            },
        }),
    }
}
