//! The files of a program, with texts that replace some of them, and what a compilation finds in them.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use crate::compile::{Compilation, ExtraConstraint, LevelFile, compile_constrained};
use crate::diagnostic::{Diagnostic, Severity};
use crate::ordered::Ordered;
use crate::source::{Files, ReadError};
use crate::why::place;

use super::protocol::Finding;

/// Maximum number of findings that are shown.
const MAX_FINDINGS: usize = 50;

/// The level that an open world gets, as on the command line.
#[derive(Debug, Clone, Default)]
pub struct Level {
    /// The file of the map.
    pub map: Option<PathBuf>,
    /// The file of the legend.
    pub legend: Option<PathBuf>,
    /// Width and height of a tile, px.
    pub tile: Option<(f64, f64)>,
}

impl Level {
    fn as_file(&self) -> LevelFile<'_> {
        LevelFile { map: self.map.as_deref(), legend: self.legend.as_deref(), tile: self.tile }
    }
}

/// The files of a program.
pub(super) struct Project {
    files: Box<dyn Files + Send>,
    pub root: PathBuf,
    level: Level,
    /// Texts of an editor, which replace those of files.
    edited: BTreeMap<PathBuf, String>,
    /// Texts with numbers that were set, which replace both.
    adjusted: BTreeMap<PathBuf, String>,
}

/// The files with the texts that replace them.
struct Overlay<'p> {
    project: &'p Project,
    /// Whether numbers that were set count.
    is_adjusted: bool,
}

impl Files for Overlay<'_> {
    fn read(&self, path: &Path) -> Result<String, ReadError> {
        let adjusted = self.is_adjusted.then(|| self.project.adjusted.get(path)).flatten();
        match adjusted.or_else(|| self.project.edited.get(path)) {
            Some(text) => Ok(text.clone()),
            None => self.project.files.read(path),
        }
    }

    fn identity(&self, path: &Path) -> PathBuf {
        self.project.files.identity(path)
    }

    fn bad_picture(&self, path: &Path) -> Option<String> {
        self.project.files.bad_picture(path)
    }
}

impl Project {
    pub fn new(files: Box<dyn Files + Send>, root: PathBuf, level: Level) -> Self {
        Project { files, root, level, edited: BTreeMap::new(), adjusted: BTreeMap::new() }
    }

    /// Compiles the texts as they are now, with one more `never` if a question needs one.
    pub fn compile(&self, constraint: Option<ExtraConstraint<'_>>) -> Compilation {
        let overlay = Overlay { project: self, is_adjusted: true };
        compile_constrained(&self.root, self.level.as_file(), constraint, &overlay)
    }

    /// The files; with the numbers that were set or without them.
    pub fn files(&self, is_adjusted: bool) -> impl Files + '_ {
        Overlay { project: self, is_adjusted }
    }

    /// The file of the level from the command line.
    pub fn level_path(&self) -> Option<&Path> {
        self.level.map.as_deref()
    }

    /// The text that replaces a file, if one does.
    pub fn edited(&self, path: &Path) -> Option<&String> {
        self.edited.get(path)
    }

    /// The text of a file with numbers that were set, if there are any in it.
    pub fn adjusted(&self, path: &Path) -> Option<&String> {
        self.adjusted.get(path)
    }

    /// The files whose texts differ from the disk.
    pub fn unsaved(&self) -> impl Iterator<Item = &PathBuf> {
        let differs = |path: &&PathBuf| self.files.read(path).ok().as_ref() != self.edited.get(*path);
        self.edited.keys().filter(differs)
    }

    /// Reads a file from a text, or from the disk again. Numbers that were set in it are forgotten.
    pub fn edit(&mut self, path: PathBuf, text: Option<String>) {
        self.adjusted.remove(&path);
        match text {
            Some(text) => self.edited.insert(path, text),
            None => self.edited.remove(&path),
        };
    }

    /// Replaces the text of a file; numbers that were set in it stay set.
    pub fn write(&mut self, path: PathBuf, text: String) {
        self.edited.insert(path, text);
    }

    /// Forgets all numbers that were set.
    pub fn forget_adjusted(&mut self) {
        self.adjusted.clear();
    }

    /// Sets the text of a file with a number that was set.
    pub fn adjust(&mut self, path: PathBuf, text: String) {
        self.adjusted.insert(path, text);
    }
}

/// The findings of a compilation, errors first.
pub(super) fn findings(compilation: &Compilation) -> Vec<Finding> {
    let mut all: Vec<&Diagnostic> = compilation.diagnostics.iter().collect();
    all.order_by_key(|found| found.severity);
    let finding = |found: &Diagnostic| Finding {
        severity: if found.severity == Severity::Error { "error" } else { "warning" }.to_string(),
        code: found.code.to_string(),
        message: found.message.clone(),
        place: found.primary.as_ref().map(|label| place(&compilation.sources, label.span)),
        labels: found
            .primary
            .iter()
            .chain(&found.secondary)
            .map(|label| (place(&compilation.sources, label.span), label.text.clone()))
            .collect(),
        helps: found.helps.clone(),
    };
    all.into_iter().take(MAX_FINDINGS).map(finding).collect()
}
