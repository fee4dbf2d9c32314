//! The arguments of `hypedc reach` about many levels, as data.

use std::path::PathBuf;

use clap::Args;

use crate::cli::args::output::output;
use crate::corpus::Shard;

#[derive(Debug, Args)]
#[command(next_help_heading = "Many levels")]
pub(in crate::cli) struct CorpusArgs {
    /// Appends a row for each level and goal to a file of JSON lines as soon as it is known; a later run with the same file
    /// does only what is missing or has changed.
    #[arg(long, value_name = "FILE.jsonl", value_parser = output())]
    pub results: Option<PathBuf>,
    /// Also writes the rows to a CSV file as they are found.
    #[arg(long, value_name = "FILE.csv", value_parser = output())]
    pub csv: Option<PathBuf>,
    /// Writes a JUnit report, with a case for each level and goal.
    #[arg(long, value_name = "FILE.xml", value_parser = output())]
    pub junit: Option<PathBuf>,
    /// Reports what changed since an older run, whose `--results` file this is; fails if something is worse or is not
    /// found any more.
    #[arg(long, value_name = "FILE.jsonl")]
    pub baseline: Option<PathBuf>,
    /// The difference in the length of a path, in percent of the baseline, above which it is listed.
    #[arg(long, value_name = "PERCENT", default_value_t = 10.0, value_parser = percent, requires = "baseline")]
    pub tolerance: f64,
    /// Asks one of several parts of the questions, for several machines: `3/8` is the third of eight. `hypedc merge`
    /// joins the files of all parts.
    #[arg(long, value_name = "I/N", value_parser = Shard::read, requires = "results")]
    pub shard: Option<Shard>,
    /// Divides the questions so that all shards take about as long, by the times of an older run, whose `--results`
    /// file this is. All shards need the same one.
    #[arg(long, value_name = "FILE.jsonl", requires = "shard")]
    pub costs: Option<PathBuf>,
}

fn percent(text: &str) -> Result<f64, String> {
    match text.trim_end_matches('%').parse::<f64>() {
        Ok(value) if value.is_finite() && value >= 0.0 => Ok(value),
        _ => Err("a number of percent, such as 10".to_string()),
    }
}
