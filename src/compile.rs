//! The compiler driver: files, syntax trees, checked program, flat IR. All entry points use it; `check_with` adds the
//! analysis of values.

mod changes;
mod tests;

use std::path::Path;
use std::sync::Arc;

use crate::analysis;
use crate::diagnostic::Diagnostics;
use crate::diagnostic::catalogue::file::Unreadable;
use crate::diagnostic::catalogue::look::NoPicture;
use crate::diagnostic::catalogue::run::NoQuestion;
use crate::ir::{self, Program};
use crate::level::{Format, read_dependencies};
use crate::lint;
use crate::sema::checked::Checked;
use crate::sema::{self, Level};
use crate::source::{FileId, Files, SourceMap};
use crate::syntax::ast::{self, MapSource};
use crate::syntax::occurrence::{Occurrence, Occurrences};
use crate::syntax::{self, Trees, Unshared};

pub use crate::sema::checked::When;
pub use crate::syntax::ast::SearchKind;
pub use changes::{
    Asked, Changes, ExtraConstraint, ExtraQuestion, NumberSetting, WrittenNumber, added_nevers, is_name, question_name,
    written_number,
};

pub use tests::{TestCase, TestClaim, TestClaimKind, TestSearch};

/// The result of compiling a file and its imports.
#[derive(Debug, Clone)]
pub struct Compilation {
    /// All files that were read.
    pub sources: SourceMap,
    /// The program; none if there are errors.
    pub program: Option<Arc<Program>>,
    /// All findings.
    pub diagnostics: Diagnostics,
    /// The tests of the worlds of the file, not of its imports; none if there are errors.
    pub tests: Vec<TestCase>,
}

/// The options of the command line for the maps of worlds that leave theirs open.
#[derive(Debug, Clone, Copy, Default)]
pub struct LevelFile<'a> {
    /// The level; without one, worlds stay open. Of a project of LDtk, `world.ldtk#Level_0` is one level.
    pub map: Option<&'a Path>,
    /// A legend for the characters of the level that the program does not define.
    pub legend: Option<&'a Path>,
    /// Width and height of a tile, px; takes precedence over the program's.
    pub tile: Option<(f64, f64)>,
}

impl<'a> LevelFile<'a> {
    /// A level without further options.
    pub fn new(map: &'a Path) -> Self {
        LevelFile { map: Some(map), ..LevelFile::default() }
    }

    /// The options that are set, as written on the command line.
    fn options(&self) -> impl Iterator<Item = &'static str> {
        let given =
            [(self.map.is_some(), "--map"), (self.legend.is_some(), "--legend"), (self.tile.is_some(), "--tile")];
        given.into_iter().filter(|(is_given, _)| *is_given).map(|(_, option)| option)
    }
}

/// Compiles a file and what it imports. Worlds that leave their map open stay open.
pub fn compile(root: &Path, files: &dyn Files) -> Compilation {
    compile_with(root, LevelFile::default(), files)
}

/// Compiles a file and what it imports; worlds that leave their map open get this one.
pub fn compile_with(root: &Path, level: LevelFile<'_>, files: &dyn Files) -> Compilation {
    compile_constrained(root, level, None, files)
}

/// As [`compile_with`], with one more `never` in each world of the root file, or in the named world: a predicate of the
/// command line. It is the last `never` of its world.
pub fn compile_constrained(
    root: &Path,
    level: LevelFile<'_>,
    constraint: Option<ExtraConstraint<'_>>,
    files: &dyn Files,
) -> Compilation {
    compile_changed(root, level, &Changes { constraint, ..Changes::default() }, files)
}

/// As [`compile_with`], with changes of the program: further questions, and numbers that are set.
pub fn compile_changed(root: &Path, level: LevelFile<'_>, changes: &Changes<'_>, files: &dyn Files) -> Compilation {
    stages(root, level, changes, (files, &Unshared), Occurrences::default()).0.0
}

/// A compilation with the names that its stages resolved: for editors.
#[derive(Debug, Clone)]
pub struct IdeCompilation {
    /// The compilation.
    pub compilation: Compilation,
    /// The checked program; incomplete if there are errors.
    pub checked: Checked,
    /// Where names occur, in order.
    pub occurrences: Vec<Occurrence>,
}

/// As [`compile`], and keeps the resolved names.
pub fn compile_for_ide(root: &Path, files: &dyn Files) -> IdeCompilation {
    compile_parsed(root, files, &Unshared)
}

/// As [`compile_for_ide`]; `trees` parses, as an editor has parsed most of a text before.
pub fn compile_parsed(root: &Path, files: &dyn Files, trees: &dyn Trees) -> IdeCompilation {
    let ((mut compilation, mut checked), trees) =
        stages(root, LevelFile::default(), &Changes::default(), (files, trees), Occurrences::kept());
    let mut occurrences = std::mem::take(&mut checked.occurrences).sorted(&compilation.sources);
    occurrences.extend(sema::names_of_unused(trees, &mut compilation.sources, &occurrences));
    occurrences.sort_unstable();
    IdeCompilation { compilation, checked, occurrences }
}

/// A compilation, the checked program, and its syntax trees with behaviours expanded; no trees if there are no
/// behaviours or the caller does not need names.
fn stages(
    root: &Path,
    level: LevelFile<'_>,
    changes: &Changes<'_>,
    (files, trees): (&dyn Files, &dyn Trees),
    mut occurrences: Occurrences,
) -> ((Compilation, Checked), Vec<ast::File>) {
    let mut sources = SourceMap::new();
    let (mut trees, mut diagnostics) = syntax::load(root, (files, trees), &mut sources);
    changes::add_questions(changes, &mut trees, &mut sources, &mut diagnostics);
    diagnostics.append(syntax::expand(&mut trees, &mut sources, &mut occurrences));
    changes::set_numbers(changes, &mut trees, &mut sources, &mut diagnostics);
    for tree in &trees {
        for map in tree.maps() {
            let (format, path, part) = match &map.source {
                MapSource::Tiled(path, _) => (Format::Tiled, path, None),
                MapSource::Ldtk(path, part, _) => (Format::Ldtk, path, part.as_ref().map(|part| part.text.as_str())),
                _ => continue,
            };
            if let Some((_, file)) = tree.texts.iter().find(|(at, _)| *at == path.span) {
                read_dependencies(format, *file, part, &mut sources, files, &mut diagnostics);
            }
        }
    }
    let (path, part) = level.map.map_or((None, None), |path| parted(path).unwrap_or((Some(path), None)));
    let mut read = |path: &Path| match files.read(path) {
        Ok(text) => Some(sources.add(path, text)),
        Err(error) => {
            diagnostics.report(Unreadable { path: path.to_path_buf(), import: None, error });
            None
        }
    };
    let (map, legend) = (path.and_then(&mut read), level.legend.and_then(&mut read));
    if let (Some(format), Some(file)) = (path.and_then(Format::of), map) {
        read_dependencies(format, file, part, &mut sources, files, &mut diagnostics);
    }
    let is_unread = path.is_some() && map.is_none();
    let given = Level { map, is_unread, part: part.map(str::to_string), legend, tile: level.tile };
    let is_kept = occurrences.are_kept();
    let first = trees.first().map(|root| root.id);
    // Each stage's result of a large program is large: it is dropped as soon as it is no longer read.
    let is_behavior = |item: &ast::Item| matches!(item, ast::Item::Behavior(_));
    let has_behaviors = trees.iter().flat_map(|tree| &tree.items).any(is_behavior);
    let kept = if is_kept && has_behaviors { trees.clone() } else { Vec::new() };
    let (mut checked, found) = sema::check(trees, &sources, given, occurrences);
    diagnostics.append(found);
    for (name, path) in std::mem::take(&mut checked.pictures) {
        if let Some(why) = files.bad_picture(&path) {
            diagnostics.report(NoPicture { at: name.span, written: name.text.to_string(), why });
        }
    }
    if let (false, Some(root)) = (diagnostics.has_errors(), first) {
        diagnostics.append(lint::lint(&checked, root));
    }
    if let (Some(option), false, false) = (level.options().next(), checked.has_open_map, diagnostics.has_errors()) {
        let why = format!("`{option}` is for worlds with an open map, and `{}` has none", root.display());
        let help =
            Some("write `map level`, `map level TILES` or `map level legend \"FILE\" tile 16 x 16` in a space".into());
        diagnostics.report(NoQuestion { why, near: None, help });
    }
    diagnostics.trace(&sources);
    diagnostics.sort();
    let written = tests::checked_tests(&checked, first);
    let mut program = (!diagnostics.has_errors()).then(|| match is_kept {
        true => Arc::new(ir::lower(checked.without_names())),
        false => Arc::new(ir::lower(std::mem::take(&mut checked))),
    });
    let mut tests = Vec::new();
    if let Some(lowered) = program.as_ref().filter(|_| !written.is_empty()) {
        tests = tests::read_tests(written, lowered, &mut sources, files, &mut diagnostics);
        diagnostics.sort();
        // A script that cannot be given is an error as any other.
        if diagnostics.has_errors() {
            (program, tests) = (None, Vec::new());
        }
    }
    ((Compilation { sources, program, diagnostics, tests }, checked), kept)
}

/// The file that a level is in: `world.ldtk` of `world.ldtk#Level_0`.
pub fn level_file(path: &Path) -> &Path {
    parted(path).and_then(|(file, _)| file).unwrap_or(path)
}

/// The file and the level of `world.ldtk#Level_0`.
pub(crate) fn parted(path: &Path) -> Option<(Option<&Path>, Option<&str>)> {
    let (file, part) = path.to_str()?.rsplit_once('#')?;
    let file = Path::new(file);
    (Format::of(file) == Some(Format::Ldtk)).then_some((Some(file), Some(part)))
}

/// As [`compile_with`], with the analysis of the values in the running worlds.
pub fn check_with(root: &Path, level: LevelFile<'_>, files: &dyn Files) -> Compilation {
    let mut compilation = compile_with(root, level, files);
    let Compilation { sources, program: Some(program), diagnostics, .. } = &mut compilation else { return compilation };
    // The root file is read first.
    diagnostics.append(analysis::findings(program, sources, FileId(0), diagnostics));
    diagnostics.sort();
    compilation
}
