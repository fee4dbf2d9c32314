//! Which editor a level is of, what other files it names, and reading it, whichever it is.

use std::path::Path;

use crate::diagnostic::Diagnostics;
use crate::diagnostic::catalogue::file::Unreadable;
use crate::diagnostic::catalogue::world::BadLevel;
use crate::source::{FileId, Files, SourceMap, Span};

use super::drawn::{Drawn, Meaning};
use super::node::Node;
use super::{ldtk, tiled};

/// The editor of a level.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    /// Tiled, as XML or JSON.
    Tiled,
    /// LDtk.
    Ldtk,
}

impl Format {
    /// The format that a path's extension names; none for rows of text.
    pub fn of(path: &Path) -> Option<Self> {
        match path.extension()?.to_str()?.to_ascii_lowercase().as_str() {
            "tmx" | "tmj" => Some(Format::Tiled),
            "ldtk" => Some(Format::Ldtk),
            _ => None,
        }
    }
}

/// Reads the files that a level names, by paths relative to its own: tilesets, or the file that holds the level `part`
/// of a project. Those that were read before are left alone.
pub fn read_beside(
    format: Format,
    file: FileId,
    part: Option<&str>,
    sources: &mut SourceMap,
    files: &dyn Files,
    diagnostics: &mut Diagnostics,
) {
    // What is wrong with the level itself is said when it is read.
    let Ok(root) = Node::read(sources.file(file).text()) else { return };
    let named = match format {
        Format::Tiled => tiled::named(&root),
        Format::Ldtk => ldtk::named(&root, part),
    };
    let folder = sources.file(file).path.parent().unwrap_or(Path::new("")).to_path_buf();
    for (name, at) in named {
        let path = folder.join(name);
        if sources.find(&path).is_some() {
            continue;
        }
        match files.read(&path) {
            Ok(text) => drop(sources.add(path, text)),
            Err(error) => {
                diagnostics.report(Unreadable { path, import: Some(Span::new(file, at.start, at.end)), error });
            }
        }
    }
}

/// Reads a level: of a project of LDtk the one that `part` names. `meaning` tells what a name stands for in the program.
/// Gives none if it cannot be read; the finding points at the place in its file.
pub fn drawn(
    format: Format,
    file: FileId,
    part: Option<&str>,
    sources: &SourceMap,
    meaning: &dyn Fn(&str) -> Meaning,
    diagnostics: &mut Diagnostics,
) -> Option<Drawn> {
    let source = sources.file(file);
    let folder = source.path.parent().unwrap_or(Path::new(""));
    let beside = |name: &str| sources.find(&folder.join(name));
    let read = Node::read(source.text()).map_err(|trouble| (file, trouble));
    let read = read.and_then(|root| match format {
        Format::Tiled => tiled::tiled(&root, file, sources, &beside, meaning),
        Format::Ldtk => ldtk::ldtk(&root, part, file, sources, &beside, meaning),
    });
    match read {
        Ok(level) => Some(level),
        Err((file, trouble)) => {
            let at = Span::new(file, trouble.at.start, trouble.at.end);
            trouble.why.into_iter().for_each(|why| diagnostics.report(BadLevel { at, why }));
            None
        }
    }
}
