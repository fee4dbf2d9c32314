//! The arguments of `hypedc stuck`.

use std::path::PathBuf;

use clap::Args;

use crate::cli::args::output::output;
use crate::cli::args::{LevelArgs, ResultFormat, SetArgs, seconds};

#[derive(Debug, Args)]
#[command(
    after_help = "Exit codes: 0 if all states were visited and none is stuck; 1 if some are, if there are candidates, or \
if nothing is known; 2 if the question could not be asked.

Stuck is where no inputs reach the goal, whatever nature draws. It is proven where all states of the world can be visited; \
elsewhere places are candidates, from which a search within its budget did not arrive."
)]
pub(in crate::cli) struct StuckArgs {
    /// The program.
    #[arg(value_name = "FILE")]
    pub file: PathBuf,
    #[command(flatten)]
    pub numbers: SetArgs,
    #[command(flatten)]
    pub level: LevelArgs,
    /// The world, where the program has several.
    #[arg(long, value_name = "NAME")]
    pub world: Option<String>,
    /// The goal, or a predicate such as `hero.x > 300` [default: the only goal of the world].
    #[arg(long, value_name = "NAME|PREDICATE")]
    pub goal: Option<String>,
    /// Maximum number of states: where there are more, nothing is proven, and places are looked for that may be stuck.
    #[arg(long, value_name = "N", default_value_t = 300_000, value_parser = clap::value_parser!(u64).range(1..))]
    pub states: u64,
    /// Maximum number of nodes of that search, and again of the searches from the places that it finds.
    #[arg(long, value_name = "N", default_value_t = 400_000, value_parser = clap::value_parser!(u64).range(1..))]
    pub nodes: u64,
    /// Maximum time, s; at most 40 % of it to visit all states.
    #[arg(long, value_name = "S", value_parser = seconds)]
    pub seconds: Option<f64>,
    /// Maximum memory for states, MiB.
    #[arg(long, value_name = "MIB", default_value_t = 2048)]
    pub memory: u64,
    /// The seed of the search for candidates: the same seed gives the same ones.
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub seed: u64,
    /// Shows whole input scripts on a terminal, too, where they are otherwise cut to a line.
    #[arg(short, long)]
    pub verbose: bool,
    /// As text for people, or as JSON.
    #[arg(long, value_enum, default_value = "human")]
    pub format: ResultFormat,
    /// Draws the level with the stuck places and the ways into them to an SVG file.
    #[arg(long, value_name = "PATH", value_parser = output())]
    pub svg: Option<PathBuf>,
}
