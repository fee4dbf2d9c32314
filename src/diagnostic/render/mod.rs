//! Text from diagnostics: [`human`] with excerpts of the source, [`short`] with one line a finding, and for tools one
//! JSON object for a whole run: [`json`], our own, and [`sarif`], the exchange format of checkers. From the pages that
//! explain them: [`page()`]; from the descriptions of words: [`word`].

#[cfg(feature = "ask")]
mod human;
mod json;
mod page;
#[cfg(feature = "cli")]
mod sarif;
#[cfg(feature = "ask")]
mod short;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

#[cfg(feature = "ask")]
pub use human::human;
pub use json::json;
#[cfg(feature = "testing")]
pub(crate) use json::json_schema;
pub use page::{page, word};
#[cfg(feature = "cli")]
pub use sarif::sarif;
#[cfg(feature = "ask")]
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

/// All findings of a run in order, each converted by `make`; a finding of several programs in a file that they all
/// import is included once.
fn distinct<'a, T: PartialEq>(run: &[Found<'a>], make: impl Fn(&Found<'a>, &Diagnostic) -> T) -> Vec<T> {
    let mut all: Vec<T> = Vec::new();
    // The indices in `all` of the findings that begin at a place with a message.
    type Place = Option<(PathBuf, u32)>;
    let mut known: BTreeMap<(Place, String), Vec<usize>> = BTreeMap::new();
    for found in run {
        // A program never has a finding twice.
        let earlier = all.len();
        for d in found.diagnostics.iter() {
            let d = d.clone().traced(found.sources);
            let place = d.primary.as_ref().map(|l| (found.sources.file(l.span.file()).path.clone(), l.span.start()));
            let made = make(found, &d);
            let alike = known.entry((place, d.message)).or_default();
            if !alike.iter().any(|at| *at < earlier && all[*at] == made) {
                alike.push(all.len());
                all.push(made);
            }
        }
    }
    all
}
