//! Which editor a level is of, what other files it names, and reading it, whichever it is.

use std::path::Path;

use crate::diagnostic::Diagnostics;
use crate::diagnostic::catalogue::file::{TooMany, Unreadable};
use crate::diagnostic::catalogue::world::BadLevel;
use crate::source::{FileId, Files, SourceMap, Span};

use super::drawn::{Drawn, Meaning};
use super::node::{Node, Trouble};
use super::tiled::Broken;
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
    // What is wrong with the level itself is reported when it is read.
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

/// Reads a level: of a project of LDtk the one that `part` names. `meaning` tells what a name stands for in the program.
/// Returns none if it cannot be read; the finding points at the place in its file.
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
    match read.and_then(|level| within_limits(level, file)) {
        Ok(level) => Some(level),
        Err((file, trouble)) => {
            let at = Span::new(file, trouble.at.start, trouble.at.end);
            trouble.why.into_iter().for_each(|why| diagnostics.report(BadLevel { at, why }));
            None
        }
    }
}

/// A level that is no larger than levels may be, and in which nothing lies farther away.
fn within_limits(level: Drawn, file: FileId) -> Result<Drawn, Broken> {
    let is_far = |length: f64| length.is_nan() || length.abs() > MAX_LENGTH;
    let size = [level.columns as f64 * level.tile.0, level.rows as f64 * level.tile.1];
    if let Some(size) = size.into_iter().find(|size| is_far(*size)) {
        let why = format!("a level of {size} px: at most {MAX_LENGTH} px are possible");
        return Err((file, Trouble::new(0..0, why)));
    }
    let rectangles = level.rectangles.iter().map(|(_, [x, y, width, height], at)| {
        ([*x, *y, x + width, y + height].into_iter().find(|length| is_far(*length)), at)
    });
    let positions = level.things.iter().map(|t| ([t.position.0, t.position.1].into_iter().find(|p| is_far(*p)), &t.at));
    match rectangles.chain(positions).find_map(|(far, at)| Some((far?, at))) {
        None => Ok(level),
        Some((far, at)) => {
            let why = format!("something at {far} px: at most {MAX_LENGTH} px from the origin are possible");
            Err((at.file(), Trouble::new(at.range(), why)))
        }
    }
}
