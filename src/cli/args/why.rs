//! The arguments of `hypedc why`.

use std::path::PathBuf;

use clap::Args;

use super::{LevelArgs, ResultFormat, ScriptArgs, SetArgs, chance_seed};

#[derive(Debug, Args)]
#[command(
    after_help = "Step N is the one that leads from the state after N-1 steps to that after N. Its edges read the state before \
it. Scripts are those of `hypedc sim`.

Exit codes: 0 if there is an answer; 1 with `--not`, if the mode was entered or the edge was taken after all; 2 if the question \
could not be asked."
)]
pub(in crate::cli) struct WhyArgs {
    /// The program.
    #[arg(value_name = "FILE")]
    pub file: PathBuf,
    #[command(flatten)]
    pub level: LevelArgs,
    /// The world, where the program has several.
    #[arg(long, value_name = "NAME")]
    pub world: Option<String>,
    #[command(flatten)]
    pub numbers: SetArgs,
    #[command(flatten)]
    pub script: ScriptArgs,
    /// The seed of what nature draws where the script leaves it open: `seed=7` [default: seed=0].
    #[arg(long, value_name = "seed=N", value_parser = chance_seed)]
    pub chance: Option<u64>,
    /// The step to explain; with `--not`, the last step of the run [default: the last step of the script]. After the
    /// script there is no input.
    #[arg(long, value_name = "STEP")]
    pub at: Option<u64>,
    /// The instance [default: that of player 1].
    #[arg(long, value_name = "NAME")]
    pub instance: Option<String>,
    /// Only edges that lead to this mode, such as `air.rising`.
    #[arg(long, value_name = "MODE", conflicts_with = "edge")]
    pub mode: Option<String>,
    /// Only the edge on this line of the program: `24`, or `entities/mario.hyped:24`.
    #[arg(long, value_name = "LINE")]
    pub edge: Option<String>,
    /// Why was the mode never entered, or the edge never taken? Shows how near its guards came in the whole run.
    #[arg(long)]
    pub not: bool,
    /// As text for people, or as JSON.
    #[arg(long, value_enum, default_value = "human")]
    pub format: ResultFormat,
}
