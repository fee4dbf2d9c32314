//! The arguments of `hypedc experiment`, as data.

use std::path::PathBuf;

use clap::builder::{PossibleValue, PossibleValuesParser};
use clap::{Args, Subcommand, ValueEnum};

use crate::experiment::Setup;
use crate::reach::{Measure, Planner, Sampling};

use crate::cli::args::level::{LevelArgs, seconds};
use crate::cli::args::output::output;
use crate::cli::args::set::SetArgs;
use crate::cli::time::{Hold, held};

/// What `--planners` calls all of them.
const ALL: &str = "all";

#[derive(Debug, Args)]
#[command(args_conflicts_with_subcommands = true, subcommand_negates_reqs = true)]
pub(in crate::cli) struct ExperimentArgs {
    #[command(subcommand)]
    pub known: Option<Known>,
    #[command(flatten)]
    pub files: FilesArgs,
}

/// An experiment that the binary carries with it.
#[derive(Debug, Subcommand)]
pub(in crate::cli) enum Known {
    /// Tables 1 and 2 of Osborn, Lambrigger and Mateas, HyPED, AIIDE 2017.
    Paper(PaperArgs),
}

#[derive(Debug, Args)]
pub(in crate::cli) struct PaperArgs {
    /// The tests to run.
    #[arg(long, value_name = "1,2", default_value = "1,2", value_delimiter = ',', value_parser = clap::value_parser!(u8).range(1..=2))]
    pub tests: Vec<u8>,
    /// The goal of Test 2: as the paper draws it, or as its code has it.
    #[arg(long, value_enum, value_name = "GOAL", default_value = "drawn")]
    pub goal: PaperGoal,
    #[command(flatten)]
    pub options: ExperimentOptions,
}

/// A goal of the paper's Test 2.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(in crate::cli) enum PaperGoal {
    /// The tile on the upper left, as in the paper's Figure 3.
    Drawn,
    /// As in the paper's code: a jump on the spot reaches it.
    Configured,
}

impl PaperGoal {
    /// Its name in the program.
    pub fn name(self) -> &'static str {
        match self {
            PaperGoal::Drawn => "drawn",
            PaperGoal::Configured => "configured",
        }
    }
}

#[derive(Debug, Args)]
pub(in crate::cli) struct FilesArgs {
    /// The programs: all goals of all their worlds.
    #[arg(required = true, value_name = "FILE")]
    pub files: Vec<PathBuf>,
    #[command(flatten)]
    pub level: LevelArgs,
    #[command(flatten)]
    pub numbers: SetArgs,
    /// Only goals with this name; or a predicate, which is a goal of all worlds.
    #[arg(long, value_name = "NAME|PREDICATE")]
    pub goal: Vec<String>,
    #[command(flatten)]
    pub options: ExperimentOptions,
}

/// What all experiments have.
#[derive(Debug, Args)]
pub(in crate::cli) struct ExperimentOptions {
    /// The number of runs of each planner, with the seeds 1 to N.
    #[arg(long, value_name = "N", default_value_t = 50, value_parser = clap::value_parser!(u32).range(1..))]
    pub seeds: u32,
    /// The planners, separated by commas, or `all` [default: the paper's four for `paper`, else all].
    #[arg(long, value_name = "NAME,…", value_delimiter = ',', value_parser = planners())]
    pub planners: Vec<String>,
    /// Where samples are drawn from.
    #[arg(long, value_enum, value_name = "BOUNDS", default_value = "both")]
    pub bounds: BoundsChoice,
    /// What distances are measured in.
    #[arg(long, value_enum, value_name = "METRIC", default_value = "full")]
    pub metric: MetricChoice,
    /// The number of steps for which an input is held: `10frames`, or `10..60frames` to draw it for each extension [default:
    /// as each planner does].
    #[arg(long, value_name = "STEPS|A..B", value_parser = hold)]
    pub hold: Option<(u16, u16)>,
    /// The most CPU seconds of a run.
    #[arg(long, value_name = "S", default_value_t = 1.0, value_parser = seconds, help_heading = "The budget")]
    pub seconds: f64,
    /// Maximum number of nodes of a run [default: no limit].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..), help_heading = "The budget")]
    pub nodes: Option<u64>,
    /// Maximum memory of a run, MiB.
    #[arg(long, value_name = "MIB", default_value_t = 2048, value_parser = clap::value_parser!(u64).range(1..=1 << 40), help_heading = "The budget")]
    pub memory: u64,
    /// The number of runs at the same time, each on a thread of its own [default: the number of cores].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..), help_heading = "The budget")]
    pub threads: Option<u16>,
    /// The format of standard output.
    #[arg(long, value_enum, default_value = "text", help_heading = "The result")]
    pub format: ExperimentFormat,
    /// Writes a line for each run to a file, as runs end.
    #[arg(long, value_name = "PATH", value_parser = output(), help_heading = "The result")]
    pub csv: Option<PathBuf>,
    /// Writes settings, runs and rows to a file.
    #[arg(long, value_name = "PATH", value_parser = output(), help_heading = "The result")]
    pub json: Option<PathBuf>,
}

impl ExperimentOptions {
    /// The ways to search; `own` are the planners if none are named.
    pub fn setups(&self, own: &[Planner]) -> Vec<Setup> {
        let is_named = |p: &Planner| self.planners.iter().any(|n| n == ALL || n == p.name());
        let planners = match self.planners.is_empty() {
            true => own.to_vec(),
            false => Planner::ALL.into_iter().filter(is_named).collect(),
        };
        let samplings: &[Sampling] = match self.bounds {
            BoundsChoice::Naive => &[Sampling::Naive],
            BoundsChoice::Reduced => &[Sampling::Reduced],
            BoundsChoice::Both => &[Sampling::Naive, Sampling::Reduced],
        };
        let measures: &[Measure] = match self.metric {
            MetricChoice::Full => &[Measure::Full],
            MetricChoice::Xy => &[Measure::Positions],
            MetricChoice::Both => &[Measure::Full, Measure::Positions],
        };
        Setup::all(&planners, samplings, measures, self.hold)
    }
}

/// Where the searches of an experiment draw their samples from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(in crate::cli) enum BoundsChoice {
    /// A box for everything.
    Naive,
    /// The values that the analysis finds possible.
    Reduced,
    /// Each in turn.
    Both,
}

/// What the searches of an experiment measure distances in.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(in crate::cli) enum MetricChoice {
    /// The whole state.
    Full,
    /// The players' positions.
    Xy,
    /// Each in turn.
    Both,
}

/// How an experiment is shown.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(in crate::cli) enum ExperimentFormat {
    /// A table for each goal.
    Text,
    /// A line for each run.
    Csv,
    /// Settings, runs and rows.
    Json,
}

/// Steps alone: those of several worlds need not last as long.
fn hold(text: &str) -> Result<(u16, u16), String> {
    let steps = Hold::read(text)?.frames();
    held(steps.ok_or("a number of steps such as `10frames`, or a range such as `10..60frames`")?)
}

fn planners() -> PossibleValuesParser {
    let each = Planner::ALL.map(|p| PossibleValue::new(p.name()).help(p.summary()));
    PossibleValuesParser::new(each.into_iter().chain([PossibleValue::new(ALL).help("all of them")]))
}
