//! The stages in a row: files, syntax trees, checked program, flat IR. What every front door calls.

use std::path::Path;

use crate::diagnostic::Diagnostics;
use crate::ir::{self, Program};
use crate::sema;
use crate::source::{Files, SourceMap};
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

/// Compiles a file and what it imports.
pub fn compile(root: &Path, files: &dyn Files) -> Compilation {
    let mut sources = SourceMap::new();
    let (mut trees, mut diagnostics) = syntax::load(root, files, &mut sources);
    diagnostics.append(syntax::expand(&mut trees, &mut sources));
    let (checked, found) = sema::check(&trees);
    diagnostics.append(found);
    diagnostics.trace(&sources);
    diagnostics.sort();
    let program = (!diagnostics.has_errors()).then(|| ir::lower(&checked));
    Compilation { sources, program, diagnostics }
}
