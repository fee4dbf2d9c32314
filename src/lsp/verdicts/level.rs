//! The level of a world that leaves its map open: files near the program that may be levels, whether they fit, and the
//! choice of the author.

use std::ffi::OsString;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use crate::compile::{Compilation, LevelFile};
use crate::diagnostic::Severity;
use crate::level::{Format, level_names};
use crate::lsp::Workspace;
use crate::lsp::documents::OpenDocuments;
use crate::lsp::snapshot::Snapshot;
use crate::ordered::Ordered;
use crate::watch::Watch;

/// Maximum number of levels that are tried.
const MAX_LEVELS: usize = 200;

/// A level that was chosen, as the options of the command line name it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(in crate::lsp) struct ChosenLevel {
    /// The file; of a project of LDtk, with the name of a level: `world.ldtk#Level_0`.
    pub map: PathBuf,
    /// A legend for the characters that the program does not define.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub legend: Option<PathBuf>,
    /// Width and height of a tile, px.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tile: Option<(f64, f64)>,
}

impl ChosenLevel {
    /// The compiler's input.
    pub fn file(&self) -> LevelFile<'_> {
        LevelFile { map: Some(&self.map), legend: self.legend.as_deref(), tile: self.tile }
    }

    /// Its name beside a program.
    pub fn name(&self, root: &Path) -> String {
        name_beside(root, &self.map)
    }
}

/// A path as it is named beside a program, with `/` between its parts.
fn name_beside(root: &Path, path: &Path) -> String {
    let folder = root.parent().unwrap_or(Path::new(""));
    path.strip_prefix(folder).unwrap_or(path).to_string_lossy().replace('\\', "/")
}

/// A file that may be a level of a program.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(in crate::lsp) struct Candidate {
    /// As [`ChosenLevel::map`].
    pub map: PathBuf,
    /// Its name beside the program.
    pub name: String,
    /// Why the program cannot be compiled with it; `None` if it can.
    pub misfit: Option<String>,
}

/// Why a program cannot be compiled with a level; `None` if it can.
pub(in crate::lsp) fn misfit(compilation: &Compilation) -> Option<String> {
    let error = compilation.diagnostics.iter().find(|found| found.severity == Severity::Error);
    error.map(|error| error.message.clone())
}

/// The files near a program that may be levels of its open maps, those that fit first. `None` if the watch stops it.
pub(in crate::lsp) fn candidates(
    root: &Path,
    (open, disk): (&OpenDocuments, &dyn Workspace),
    watch: &dyn Watch,
) -> Option<Vec<Candidate>> {
    let folder = root.parent().unwrap_or(Path::new(""));
    let mut maps: Vec<PathBuf> = Vec::new();
    for file in disk.levels(folder) {
        let format = Format::of(&file);
        let names = format.and_then(|format| Some(level_names(format, &disk.read(&file).ok()?))).unwrap_or_default();
        if names.is_empty() {
            maps.push(file);
            continue;
        }
        for name in names {
            let mut part = OsString::from(&file);
            part.push(format!("#{name}"));
            maps.push(part.into());
        }
    }
    maps.truncate(MAX_LEVELS);
    let mut found = Vec::new();
    for map in maps {
        if watch.stop() {
            return None;
        }
        let (compilation, _) = Snapshot::with_level(root, LevelFile::new(&map), (open, disk));
        let misfit = misfit(&compilation);
        found.push(Candidate { name: name_beside(root, &map), map, misfit });
    }
    // The order of names is kept.
    found.order_by_key(|candidate| candidate.misfit.is_some());
    Some(found)
}
