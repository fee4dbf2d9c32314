//! Shows findings, and loads runnable programs from a file and a world's name.

use std::fs;
use std::io::{self, IsTerminal, Write};
use std::path::Path;
use std::sync::Arc;

use sha2::{Digest, Sha256};

use crate::compile::{Changes, Compilation, LevelFile, compile_changed, is_name, level_file};
use crate::diagnostic::catalogue::file::Unreadable;
use crate::diagnostic::catalogue::run::NoQuestion;
use crate::diagnostic::{Diagnostics, Fact, render, similar};
use crate::ir::{Program, World, WorldId};
use crate::json::{self, Layout};
use crate::source::{ReadError, SourceMap};

use super::disk::{Disk, bytes, compiled};

/// Whether to colour the output: only on a terminal, and not if `NO_COLOR` is set.
pub(super) fn colored(terminal: bool) -> bool {
    terminal && std::env::var_os("NO_COLOR").is_none_or(|v| v.is_empty())
}

/// Shows findings on standard error.
pub(super) fn show(sources: &SourceMap, found: &Diagnostics) -> io::Result<()> {
    let color = colored(io::stderr().is_terminal());
    write!(io::stderr(), "{}", render::human(sources, found.iter(), color))
}

/// Shows one fact on standard error.
pub(super) fn show_fact(sources: &SourceMap, fact: impl Fact) -> io::Result<()> {
    let mut found = Diagnostics::new();
    found.report(fact);
    show(sources, &found)
}

/// An error that belongs to no file.
pub(super) fn plain_error(message: &str) -> io::Result<()> {
    writeln!(io::stderr(), "error: {message}")
}

/// Writes a file; reports why it cannot be written.
pub(super) fn written(path: &Path, text: &str) -> io::Result<bool> {
    if let Err(error) = fs::write(path, text) {
        plain_error(&format!("cannot write `{}`: {error}", path.display()))?;
        return Ok(false);
    }
    Ok(true)
}

/// A program that compiled, and its files.
pub(super) struct Loaded {
    pub sources: SourceMap,
    pub program: Arc<Program>,
}

/// A hash of a program's meaning, in hexadecimal digits.
pub(super) fn program_sha256(program: &Program) -> String {
    let json = json::bytes(&program.meaning(), Layout::Compact).unwrap_or_default();
    sha256(&json)
}

/// The SHA-256 of a level's file; none if it cannot be read.
pub(super) fn level_sha256(path: &Path) -> Option<String> {
    bytes(level_file(path)).ok().map(|bytes| sha256(&bytes))
}

/// The SHA-256 of some bytes, in hexadecimal digits.
pub(super) fn sha256(bytes: &[u8]) -> String {
    Sha256::digest(bytes).iter().map(|byte| format!("{byte:02x}")).collect()
}

/// Compiles a file, with a level for worlds with an open map, and with changes of the program; shows findings, and returns
/// `None` if it cannot be run.
pub(super) fn load_changed(path: &Path, level: LevelFile<'_>, changes: &Changes<'_>) -> io::Result<Option<Loaded>> {
    if path.extension().is_some_and(|extension| extension == "json") {
        return load_compiled(path, level, changes);
    }
    let Compilation { sources, program, diagnostics, .. } = compile_changed(path, level, changes, &Disk);
    match diagnostics.counts() {
        (0, 0) => {}
        // Full warnings would clutter the output of repeated runs.
        (0, warnings) => {
            let count = if warnings == 1 { "1 warning".to_string() } else { format!("{warnings} warnings") };
            writeln!(io::stderr(), "{count}, shown by `hypedc check {}`", path.display())?;
        }
        _ => show(&sources, &diagnostics)?,
    }
    Ok(program.map(|program| Loaded { sources, program }))
}

/// As [`load_changed`], for a program that was loaded before with other changes: warnings are not counted again.
pub(super) fn load_again(path: &Path, level: LevelFile<'_>, changes: &Changes<'_>) -> io::Result<Option<Loaded>> {
    let Compilation { sources, program, diagnostics, .. } = compile_changed(path, level, changes, &Disk);
    if program.is_none() {
        show(&sources, &diagnostics)?;
    }
    Ok(program.map(|program| Loaded { sources, program }))
}

/// Reads a program written by `hypedc ir --format json`; shows findings, and returns `None` if it cannot be run.
fn load_compiled(path: &Path, level: LevelFile<'_>, changes: &Changes<'_>) -> io::Result<Option<Loaded>> {
    let mut sources = SourceMap::new();
    sources.add(path, "");
    let only = |what: &str| {
        let why = format!("`{}` is a compiled program, and {what}", path.display());
        NoQuestion { why, near: None, help: Some("give the `.hyped` file that it was made from".into()) }
    };
    if level.map.is_some() || level.legend.is_some() || level.tile.is_some() {
        show_fact(&sources, only("has all of its maps: `--map` has nothing to fill"))?;
        return Ok(None);
    }
    if changes.constraint.is_some() || changes.questions.iter().any(|question| !is_name(question.text)) {
        show_fact(&sources, only("a predicate is compiled with the text"))?;
        return Ok(None);
    }
    if !changes.numbers.is_empty() {
        show_fact(&sources, only("its numbers are compiled: `--set` has nothing to set"))?;
        return Ok(None);
    }
    let program =
        compiled(path).and_then(|text| Program::from_json(&text).map_err(|why| ReadError::Unreadable(why.to_string())));
    match program {
        Ok((program, sources)) => Ok(Some(Loaded { sources, program })),
        Err(error) => {
            show_fact(&sources, Unreadable::named(path, error))?;
            Ok(None)
        }
    }
}

/// Whether worlds have all their maps; reports the missing one.
pub(super) fn has_maps<'w>(loaded: &Loaded, worlds: impl IntoIterator<Item = &'w Arc<World>>) -> io::Result<bool> {
    let Some(open) = worlds.into_iter().find(|w| w.open.is_some()) else {
        return Ok(true);
    };
    let why = format!("the world `{}` leaves its map to the command line", open.name);
    let help = Some("give one with `--map PATH`".to_string());
    show_fact(&loaded.sources, NoQuestion { why, near: None, help })?;
    Ok(false)
}

/// The named world, or the only one, with all its maps; reports why if there is none.
pub(super) fn choose_world(loaded: &Loaded, path: &Path, name: Option<&str>) -> io::Result<Option<WorldId>> {
    match find_world(&loaded.program, path, name) {
        Ok(world) => Ok(has_maps(loaded, [&loaded.program.worlds[world]])?.then_some(world)),
        Err(fact) => {
            show_fact(&loaded.sources, fact)?;
            Ok(None)
        }
    }
}

/// The named world, or the only one.
pub(super) fn find_world(program: &Program, path: &Path, name: Option<&str>) -> Result<WorldId, NoQuestion> {
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
