//! The arguments of `hypedc test`.

use std::path::PathBuf;

use clap::Args;

use crate::cli::args::output::output;
use crate::cli::args::{LevelArgs, ResultFormat, SetArgs, seconds};

#[derive(Debug, Args)]
#[command(
    after_help = "Exit codes: 0 if all tests pass; 1 if one fails; 2 if a program has errors or there is nothing to test.

Ways that are found are kept and replayed in the next run, before anything is searched. They are in `hypedc/ways` in the \
user's cache (`XDG_CACHE_HOME`), or in the folder of `--ways`. A kept way is never believed: it is replayed."
)]
pub(in crate::cli) struct TestArgs {
    /// The programs. Tests of the files that they import are not run.
    #[arg(required = true, value_name = "FILE")]
    pub files: Vec<PathBuf>,
    #[command(flatten)]
    pub numbers: SetArgs,
    #[command(flatten)]
    pub level: LevelArgs,
    /// Only tests of this world.
    #[arg(long, value_name = "NAME")]
    pub world: Option<String>,
    /// Only tests whose name contains this text, upper and lower case alike.
    #[arg(long, value_name = "TEXT")]
    pub filter: Option<String>,
    /// Searches for this goal, or this predicate, and writes a test with the inputs that are found into the program.
    #[arg(long, value_name = "NAME|PREDICATE", conflicts_with_all = ["filter", "junit", "coverage", "lcov"])]
    pub record: Option<String>,
    /// The name of the test that `--record` writes [default: that of the goal].
    #[arg(long, value_name = "NAME", requires = "record")]
    pub name: Option<String>,
    /// The seed of searches: the same seed gives the same search.
    #[arg(long, value_name = "N", default_value_t = 1, help_heading = "The search")]
    pub seed: u64,
    /// Maximum number of nodes for each claim that is searched.
    #[arg(long, value_name = "N", default_value_t = 200_000, value_parser = clap::value_parser!(u64).range(1..), help_heading = "The search")]
    pub nodes: u64,
    /// Maximum time for each test, s; a test that is stopped fails.
    #[arg(long, value_name = "S", value_parser = seconds, help_heading = "The search")]
    pub seconds: Option<f64>,
    /// The number of tests that run at the same time; the results do not depend on it [default: the number of
    /// cores].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..), help_heading = "The search")]
    pub threads: Option<u16>,
    /// The folder of the ways that were found, for instance beside the program and under version control.
    #[arg(long, value_name = "DIR", value_parser = output(), help_heading = "The search")]
    pub ways: Option<PathBuf>,
    /// Keeps no ways and replays none.
    #[arg(long, conflicts_with = "ways", help_heading = "The search")]
    pub no_ways: bool,
    /// As text for people, or as JSON.
    #[arg(long, value_enum, default_value = "human", help_heading = "The result")]
    pub format: ResultFormat,
    /// Tells which modes, edges and parts of guards the runs of the tests and the ways that they found cover.
    #[arg(long, help_heading = "The result")]
    pub coverage: bool,
    /// Writes the coverage as an lcov tracefile, which editors show beside the text.
    #[arg(long, value_name = "PATH", value_parser = output(), help_heading = "The result")]
    pub lcov: Option<PathBuf>,
    /// Writes a JUnit report.
    #[arg(long, value_name = "PATH", value_parser = output(), help_heading = "The result")]
    pub junit: Option<PathBuf>,
    /// Shows the failures and the summary only.
    #[arg(short, long, help_heading = "The result")]
    pub quiet: bool,
}
