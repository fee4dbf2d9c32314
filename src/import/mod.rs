//! What other systems describe, as `.hyped` text in its canonical layout. Each format has a module of its own; all give
//! an [`Import`]. What cannot be carried over is reported, with its place in the imported file.

pub mod xml;
pub mod zelda;

use crate::diagnostic::Diagnostics;

/// What came of a file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Import {
    /// The program's text, in its canonical layout; none if nothing could be read.
    pub text: Option<String>,
    /// What was found: errors are what the text lacks, warnings what it says otherwise.
    pub diagnostics: Diagnostics,
}
