//! Text from diagnostics: [`human`] with excerpts of the source, [`short`] with one line a finding, and for tools one
//! JSON object for a whole run: [`json`], our own, and [`sarif`], the exchange format of checkers. From the pages that
//! explain them: [`page()`].

mod human;
mod json;
mod page;
mod sarif;
mod short;

use std::path::Path;

pub use human::human;
pub use json::json;
pub use page::page;
pub use sarif::sarif;
pub use short::short;

use super::{Diagnostic, Diagnostics};
use crate::source::SourceMap;

/// What was found in one program of a run.
#[derive(Debug, Clone, Copy)]
pub struct Found<'a> {
    /// The program, as it was named.
    pub path: &'a Path,
    /// Its files.
    pub sources: &'a SourceMap,
    /// What was found in them.
    pub diagnostics: &'a Diagnostics,
}

/// All findings of a run in order, each made by `make`; one that several programs share, in a file that they all
/// import, comes once.
fn distinct<'a, T: PartialEq>(run: &[Found<'a>], make: impl Fn(&Found<'a>, &Diagnostic) -> T) -> Vec<T> {
    let mut all: Vec<T> = Vec::new();
    for found in run {
        // A program never has a finding twice.
        let earlier = all.len();
        for d in found.diagnostics.iter() {
            let made = make(found, &d.clone().traced(found.sources));
            if !all.iter().take(earlier).any(|known| *known == made) {
                all.push(made);
            }
        }
    }
    all
}
