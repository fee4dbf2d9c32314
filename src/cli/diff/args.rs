//! The arguments of `hypedc diff`.

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};

use crate::cli::args::{ReadingArgs, SetArgs};

#[derive(Debug, Args)]
#[command(
    after_help = "Exit codes: 0 if nothing got worse; 1 if something did: a goal that was reached is proven unreachable, or \
a `never` is violated in a way in which it was not; 2 if the programs could not be compared.

A goal that is not found any more is lost, not worse: a longer search may find it. `--deny lost` fails then, too."
)]
pub(in crate::cli) struct DiffArgs {
    /// The program before the change.
    #[arg(value_name = "OLD")]
    pub old: PathBuf,
    /// The program after it [default: with `--set` the same one].
    #[arg(value_name = "NEW", required_unless_present = "set")]
    pub new: Option<PathBuf>,
    #[command(flatten)]
    pub numbers: SetArgs,
    /// The levels of worlds that leave their map open, as `hypedc reach` takes them: files and folders.
    #[arg(long, value_name = "PATH", num_args(1..))]
    pub map: Vec<PathBuf>,
    /// The same levels before the change, by the same names of files [default: they did not change].
    #[arg(long, value_name = "PATH", num_args(1..), requires = "map")]
    pub old_map: Vec<PathBuf>,
    #[command(flatten)]
    pub reading: ReadingArgs,
    /// The world [default: all].
    #[arg(long, value_name = "NAME")]
    pub world: Option<String>,
    /// A goal, or a predicate; can be given several times [default: all goals and `never`s].
    #[arg(long, value_name = "NAME|PREDICATE")]
    pub goal: Vec<String>,
    /// A `never`, or a predicate that should never hold; can be given several times.
    #[arg(long, value_name = "NAME|PREDICATE")]
    pub never: Vec<String>,
    /// Maximum number of nodes of each search; the second search for what is lost may take twice as many.
    #[arg(long, value_name = "N", default_value_t = 200_000, value_parser = clap::value_parser!(u64).range(1..))]
    pub nodes: u64,
    /// Maximum memory for trees, MiB.
    #[arg(long, value_name = "MIB", default_value_t = 2048)]
    pub memory: u64,
    /// The seed: the same seed gives the same searches.
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub seed: u64,
    /// The number of levels that are compared in parallel; the result does not depend on it [default: the number of
    /// cores].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    pub threads: Option<u16>,
    /// Only what changed and how players move: asks no question.
    #[arg(long, conflicts_with_all = ["goal", "never"])]
    pub no_search: bool,
    /// What makes the command fail (exit code 1), in addition to what got worse.
    #[arg(long, value_enum, value_name = "WHAT")]
    pub deny: Option<DeniedChange>,
    /// Shows whole input scripts on a terminal, too, where they are otherwise cut to a line.
    #[arg(short, long)]
    pub verbose: bool,
    /// As text for people, as JSON, or as Markdown for a comment on a pull request.
    #[arg(long, value_enum, default_value = "human")]
    pub format: DiffFormat,
}

/// What `--deny` rejects.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(in crate::cli) enum DeniedChange {
    /// Expected answers that are not found any more.
    Lost,
    /// Any difference of what the programs mean.
    Changes,
}

/// How a comparison is shown.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(in crate::cli) enum DiffFormat {
    /// For people.
    Human,
    /// For programs.
    Json,
    /// For comments on code hosts.
    Markdown,
}

impl DiffArgs {
    /// The program after the change.
    pub fn after(&self) -> &Path {
        self.new.as_deref().unwrap_or(&self.old)
    }
}
