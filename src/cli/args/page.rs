//! Arguments of a report as a page.

use std::path::PathBuf;

use clap::Args;

use crate::cli::args::output::output;

/// The page of a report.
#[derive(Debug, Args)]
pub(in crate::cli) struct PageArgs {
    /// Writes a page: one HTML file that shows what was printed and plays it, without a network and without hypedc.
    #[arg(long, value_name = "PATH", value_parser = output(), conflicts_with = "set", help_heading = "The page")]
    pub html: Option<PathBuf>,
    /// The engine for the page, a module of WebAssembly; needed if hypedc was built without one.
    #[arg(long, value_name = "PATH", requires = "html", help_heading = "The page")]
    pub engine: Option<PathBuf>,
}
