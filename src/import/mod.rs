//! Importers: files of other systems as `.hyped` text in its canonical layout. Each format has its own module; all
//! return an [`Import`]. Parts that cannot be imported are reported, with their place in the imported file.

pub mod xml;
pub mod zelda;

use crate::diagnostic::Diagnostics;

/// The result of an import.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Import {
    /// The program's text, in its canonical layout; none if the file cannot be parsed.
    pub text: Option<String>,
    /// The findings: errors are omitted parts, warnings are changed parts.
    pub diagnostics: Diagnostics,
}
