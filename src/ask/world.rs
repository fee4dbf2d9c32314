//! Worlds by name.

use std::path::Path;

use crate::diagnostic::catalogue::run::NoQuestion;
use crate::diagnostic::similar;
use crate::ir::{Program, World, WorldId};

/// Why a world cannot be run: it leaves its map open.
pub fn open_world(world: &World) -> Option<NoQuestion> {
    world.open.is_some().then(|| NoQuestion {
        why: format!("the world `{}` leaves its map to the command line", world.name),
        near: None,
        help: Some("give one with `--map PATH`".to_string()),
    })
}

/// The named world, or the only one.
///
/// # Errors
/// Why there is none.
pub fn find_world(program: &Program, path: &Path, name: Option<&str>) -> Result<WorldId, NoQuestion> {
    let worlds = &program.worlds;
    let names: Vec<&str> = worlds.iter().map(|w| w.name.as_str()).collect();
    let list = || format!("there is {}", names.iter().map(|n| format!("`{n}`")).collect::<Vec<_>>().join(", "));
    let found = match name {
        Some(name) => program.world_named(name),
        None => worlds.ids().next().filter(|_| worlds.len() == 1),
    };
    found.ok_or_else(|| match name {
        Some(name) => NoQuestion {
            why: format!("no world `{name}` in `{}`", path.display()),
            near: similar(name, names.iter().copied()),
            help: (!names.is_empty()).then(list),
        },
        None if names.is_empty() => NoQuestion {
            why: format!("`{}` has no world", path.display()),
            near: None,
            help: Some("add `world NAME { … }`".into()),
        },
        None => NoQuestion {
            why: format!("`{}` has several worlds", path.display()),
            near: None,
            help: Some(format!("choose one with `--world NAME`; {}", list())),
        },
    })
}
