//! Arguments that give an input script.

use std::path::PathBuf;

use clap::Args;

/// An input script, or where it stands.
#[derive(Debug, Args)]
pub(in crate::cli) struct ScriptArgs {
    /// An input script.
    #[arg(long, value_name = "SCRIPT", conflicts_with = "inputs_file", allow_hyphen_values = true)]
    pub inputs: Option<String>,
    /// A file that holds an input script.
    #[arg(long, value_name = "PATH")]
    pub inputs_file: Option<PathBuf>,
}
