//! Shows findings, and loads runnable programs from a file and a world's name.

use std::fs;
use std::io::{self, IsTerminal, Write};
use std::path::Path;
use std::sync::Arc;

use crate::ask::open_world;
use crate::compile::{Changes, Compilation, LevelFile, compile_changed, is_name, level_file};
use crate::diagnostic::catalogue::file::Unreadable;
use crate::diagnostic::catalogue::run::NoQuestion;
use crate::diagnostic::{Diagnostics, Fact, render};
use crate::ir::{Program, World, WorldId};
use crate::source::{ReadError, SourceMap};

use super::disk::{Disk, bytes, compiled};

pub(super) use crate::ask::{Loaded, find_world, program_sha256, sha256};

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

/// The SHA-256 of a level's file; none if it cannot be read.
pub(super) fn level_sha256(path: &Path) -> Option<String> {
    bytes(level_file(path)).ok().map(|bytes| sha256(&bytes))
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
    let Some(fact) = worlds.into_iter().find_map(|world| open_world(world)) else { return Ok(true) };
    show_fact(&loaded.sources, fact)?;
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
