//! The readers of level editors' files: the format of a file, the other files that it names, and its level.

use std::path::Path;

use crate::diagnostic::Diagnostics;
use crate::diagnostic::catalogue::file::{TooMany, Unreadable};
use crate::diagnostic::catalogue::world::BadLevel;
use crate::source::{FileId, Files, SourceMap, Span};

use super::editor_level::{EditorLevel, Meaning};
use super::node::{LevelError, Node};
use super::tiled::FileError;
use super::{MAX_LENGTH, ldtk, tiled};

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

/// The names of the levels in the text of a level editor's file; empty if the file is one level.
pub fn level_names(format: Format, text: &str) -> Vec<String> {
    match format {
        Format::Tiled => Vec::new(),
        Format::Ldtk => ldtk::level_names(text),
    }
}

/// Reads the files that a level names, by paths relative to its own: tilesets, or the separate file of the level `part`
/// of a project. Files that were read before are skipped.
pub fn read_dependencies(
    format: Format,
    file: FileId,
    part: Option<&str>,
    sources: &mut SourceMap,
    files: &dyn Files,
    diagnostics: &mut Diagnostics,
) {
    // Errors in the level itself are reported when it is read.
    let Ok(root) = Node::read(sources.file(file).text()) else { return };
    let dependencies = match format {
        Format::Tiled => tiled::dependencies(&root),
        Format::Ldtk => ldtk::dependencies(&root, part),
    };
    let folder = sources.file(file).path.parent().unwrap_or(Path::new("")).to_path_buf();
    for (name, at) in dependencies {
        let path = folder.join(name);
        if sources.find(&path).is_some() {
            continue;
        }
        let at = Span::new(file, at.start, at.end);
        if sources.is_full() {
            diagnostics.report(TooMany::sources(at));
            return;
        }
        match files.read(&path) {
            Ok(text) => drop(sources.add(path, text)),
            Err(error) => {
                diagnostics.report(Unreadable { path, import: Some(at), error });
            }
        }
    }
}

/// Reads a level: of a project of LDtk the one named `part`. `meaning` gives the meaning of a name in the program.
/// Returns none if the level cannot be read; the finding points at the place in its file.
pub fn read_level(
    format: Format,
    file: FileId,
    part: Option<&str>,
    sources: &SourceMap,
    meaning: &dyn Fn(&str) -> Meaning,
    diagnostics: &mut Diagnostics,
) -> Option<EditorLevel> {
    let source = sources.file(file);
    let folder = source.path.parent().unwrap_or(Path::new(""));
    let beside = |name: &str| sources.find(&folder.join(name));
    let read = Node::read(source.text()).map_err(|error| (file, error));
    let read = read.and_then(|root| match format {
        Format::Tiled => tiled::tiled(&root, file, sources, &beside, meaning),
        Format::Ldtk => ldtk::ldtk(&root, part, file, sources, &beside, meaning),
    });
    match read.and_then(|level| within_limits(level, file)) {
        Ok(level) => Some(level),
        Err((file, error)) => {
            let at = Span::new(file, error.at.start, error.at.end);
            error.why.into_iter().for_each(|why| diagnostics.report(BadLevel { at, why }));
            None
        }
    }
}

/// The level, if its size and the positions in it are within the limits.
fn within_limits(level: EditorLevel, file: FileId) -> Result<EditorLevel, FileError> {
    let is_far = |length: f64| length.is_nan() || length.abs() > MAX_LENGTH;
    let size = [level.columns as f64 * level.tile.0, level.rows as f64 * level.tile.1];
    if let Some(size) = size.into_iter().find(|size| is_far(*size)) {
        let why = format!("a level of {size} px: at most {MAX_LENGTH} px are possible");
        return Err((file, LevelError::new(0..0, why)));
    }
    let rectangles = level.rectangles.iter().map(|(_, [x, y, width, height], at)| {
        ([*x, *y, x + width, y + height].into_iter().find(|length| is_far(*length)), at)
    });
    let positions =
        level.objects.iter().map(|t| ([t.position.0, t.position.1].into_iter().find(|p| is_far(*p)), &t.at));
    match rectangles.chain(positions).find_map(|(far, at)| Some((far?, at))) {
        None => Ok(level),
        Some((far, at)) => {
            let why = format!("something at {far} px: at most {MAX_LENGTH} px from the origin are possible");
            Err((at.file(), LevelError::new(at.range(), why)))
        }
    }
}
