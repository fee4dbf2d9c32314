//! The arguments of `hypedc merge`, as data.

use std::path::PathBuf;

use clap::Args;

use crate::cli::args::output::output;

#[derive(Debug, Args)]
pub(in crate::cli) struct MergeArgs {
    /// The `--results` files of all shards of a run; or of runs over different levels with the same settings.
    #[arg(required = true, value_name = "FILE.jsonl")]
    pub files: Vec<PathBuf>,
    /// Writes the rows to this file, in the order in which one run on one machine has them.
    #[arg(short, long, required = true, value_name = "FILE.jsonl", value_parser = output())]
    pub output: PathBuf,
}
