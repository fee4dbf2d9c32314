//! The stages in a row: files, syntax trees, checked program, flat IR. What every front door calls; who wants to know
//! all that is wrong adds the analysis of values.

use std::path::Path;

use crate::analysis;
use crate::diagnostic::Diagnostics;
use crate::diagnostic::catalogue::file::Unreadable;
use crate::diagnostic::catalogue::run::NoQuestion;
use crate::ir::{self, Program};
use crate::lint;
use crate::sema;
use crate::source::{FileId, Files, SourceMap};
use crate::syntax;

/// What came of compiling a file and all that it imports.
#[derive(Debug, Clone)]
pub struct Compilation {
    /// All files that were read.
    pub sources: SourceMap,
    /// The program; none if there are errors.
    pub program: Option<Program>,
    /// Everything that was found.
    pub diagnostics: Diagnostics,
}

/// Compiles a file and what it imports. Worlds that leave their map open stay open.
pub fn compile(root: &Path, files: &dyn Files) -> Compilation {
    compile_with(root, None, files)
}

/// Compiles a file and what it imports; worlds that leave their map open get this one.
pub fn compile_with(root: &Path, map: Option<&Path>, files: &dyn Files) -> Compilation {
    let mut sources = SourceMap::new();
    let (mut trees, mut diagnostics) = syntax::load(root, files, &mut sources);
    diagnostics.append(syntax::expand(&mut trees, &mut sources));
    let level = map.and_then(|path| match files.read(path) {
        Ok(text) => Some(sources.add(path, text)),
        Err(error) => {
            diagnostics.report(Unreadable { path: path.to_path_buf(), import: None, error });
            None
        }
    });
    let (checked, found) = sema::check(&trees, &sources, level);
    diagnostics.append(found);
    if let (false, Some(root)) = (diagnostics.has_errors(), trees.first()) {
        diagnostics.append(lint::lint(&checked, root.id));
    }
    if map.is_some() && !checked.has_open_map && !diagnostics.has_errors() {
        let why = format!("no world of `{}` leaves its map to the command line", root.display());
        let help = Some("write `map level TILES` or `map level legend \"FILE\" tile 16 x 16` in a space".into());
        diagnostics.report(NoQuestion { why, near: None, help });
    }
    diagnostics.trace(&sources);
    diagnostics.sort();
    let program = (!diagnostics.has_errors()).then(|| ir::lower(&checked));
    Compilation { sources, program, diagnostics }
}

/// As [`compile_with`], and looks at what values can be while the worlds run.
pub fn check_with(root: &Path, map: Option<&Path>, files: &dyn Files) -> Compilation {
    let mut compilation = compile_with(root, map, files);
    let Compilation { sources, program: Some(program), diagnostics } = &mut compilation else { return compilation };
    // The root is the first file that is read.
    diagnostics.append(analysis::findings(program, sources, FileId(0), diagnostics));
    diagnostics.sort();
    compilation
}
