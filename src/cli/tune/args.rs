//! The arguments of `hypedc tune`, as data.

use std::path::PathBuf;

use clap::{ArgGroup, Args, ValueEnum};

use crate::cli::args::level::{LevelArgs, seconds};
use crate::cli::args::output::output;
use crate::cli::args::set::SetArgs;
use crate::cli::args::{ResultFormat, chance_seed};
use crate::cli::time::Time;

#[derive(Debug, Args)]
#[command(
    after_help = "A range is written `Hero.jump_speed=100..400`, or `Door.locks=1..5/1` with the step between two values. \
Several numbers are varied one at a time; together only if none of them is enough alone. With `--tiles`, the fewest tiles are \
sought instead, in maps that are text.

Exit codes: 0 if a change is found, or none is needed; 1 if none is found; 2 if the question could not be asked.",
    group(ArgGroup::new("change").required(true).multiple(true).args(["vary", "tiles"]))
)]
pub(in crate::cli) struct TuneArgs {
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
    /// A number to vary, with its range and perhaps the step between two values; up to four times.
    #[arg(long, value_name = "NAME=A..B[/STEP]", value_parser = Vary::read, help_heading = "The change")]
    pub vary: Vec<Vary>,
    /// Changes tiles of the level instead of numbers.
    #[arg(long, value_enum, value_name = "HOW", conflicts_with_all = ["vary", "never", "csv", "svg"], help_heading = "The change")]
    pub tiles: Option<TilesName>,
    /// The character of the tile to add or to remove [default: any that blocks players; the most frequent one is added].
    #[arg(long, value_name = "CHARACTER", requires = "tiles", help_heading = "The change")]
    pub symbol: Option<char>,
    /// Maximum number of tiles that are changed.
    #[arg(long, value_name = "N", default_value_t = 3, value_parser = clap::value_parser!(u8).range(1..=5), requires = "tiles", help_heading = "The change")]
    pub max: u8,
    /// The distance up to which the smallest change is narrowed down, in the unit of the number [default: a round number, at
    /// most a 500th of the range].
    #[arg(long, value_name = "NUMBER", value_parser = positive, help_heading = "The change")]
    pub precision: Option<f64>,
    /// Number of values over the whole range that are tried first.
    #[arg(long, value_name = "N", default_value_t = 8, value_parser = clap::value_parser!(u16).range(1..=1000), help_heading = "The change")]
    pub samples: u16,
    /// The goal, or a predicate that is to hold [default: the only goal of the world].
    #[arg(long, value_name = "NAME|PREDICATE", help_heading = "The question")]
    pub goal: Option<String>,
    /// Seeks a change with which the goal is proven unreachable, instead of one with which it is reached.
    #[arg(long, help_heading = "The question")]
    pub prevent: bool,
    /// A `never`, or a predicate that should never hold: a change with which it is broken does not count. Can be given several
    /// times.
    #[arg(long, value_name = "NAME|PREDICATE", help_heading = "The question")]
    pub never: Vec<String>,
    /// Only paths on which this predicate never holds, such as `hero in dead`.
    #[arg(long, value_name = "PREDICATE", help_heading = "The question")]
    pub without: Option<String>,
    /// Begins in the state that an input script leads to; can be given several times.
    #[arg(long, value_name = "SCRIPT", allow_hyphen_values = true, help_heading = "The question")]
    pub after: Vec<String>,
    /// Only paths that take at most this time, such as `600frames` or `10s`.
    #[arg(long, value_name = "TIME", value_parser = Time::read, help_heading = "The question")]
    pub within: Option<Time>,
    /// Only inputs that are held for at least this time, such as `12frames` or `200ms`.
    #[arg(long, value_name = "TIME", value_parser = Time::read, help_heading = "The question")]
    pub min_hold: Option<Time>,
    /// What nature draws, as `hypedc sim` draws it: `seed=7` [default: the search is free to choose it].
    #[arg(long, value_name = "seed=N", value_parser = chance_seed, help_heading = "The question")]
    pub chance: Option<u64>,
    /// The seed of the searches.
    #[arg(long, value_name = "N", default_value_t = 1, help_heading = "The budget")]
    pub seed: u64,
    /// Maximum number of nodes for each value.
    #[arg(long, value_name = "N", default_value_t = 50_000, help_heading = "The budget")]
    pub nodes: u64,
    /// Maximum time for each value, s.
    #[arg(long, value_name = "S", value_parser = seconds, help_heading = "The budget")]
    pub seconds: Option<f64>,
    /// Maximum memory for trees, MiB.
    #[arg(long, value_name = "MIB", default_value_t = 2048, help_heading = "The budget")]
    pub memory: u64,
    /// As text for people, or as JSON.
    #[arg(long, value_enum, default_value = "human", help_heading = "The result")]
    pub format: ResultFormat,
    /// Shows whole input scripts on a terminal, too, where they are otherwise cut to a line.
    #[arg(short, long, help_heading = "The result")]
    pub verbose: bool,
    /// Writes the values that were tried to a CSV file.
    #[arg(long, value_name = "PATH", value_parser = output(), help_heading = "The result")]
    pub csv: Option<PathBuf>,
    /// Draws the verdicts of the values that were tried to an SVG file; for one number.
    #[arg(long, value_name = "PATH", value_parser = output(), help_heading = "The result")]
    pub svg: Option<PathBuf>,
    /// Writes the inputs that reach the goal after the change to a file.
    #[arg(long, value_name = "PATH", value_parser = output(), conflicts_with = "prevent", help_heading = "The result")]
    pub save_inputs: Option<PathBuf>,
    /// Writes the file that holds the map, with the changed tiles, to another file.
    #[arg(long, value_name = "PATH", value_parser = output(), requires = "tiles", help_heading = "The result")]
    pub save_map: Option<PathBuf>,
}

/// What may be done to tiles.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(in crate::cli) enum TilesName {
    /// Empty tiles become solid.
    Add,
    /// Solid tiles become empty.
    Remove,
    /// Either.
    Change,
}

/// A number with its range.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::cli) struct Vary {
    /// `Hero.jump_speed`
    pub path: String,
    /// The least and the greatest value.
    pub range: (f64, f64),
    /// The step between two values.
    pub step: Option<f64>,
}

impl Vary {
    /// `NAME=FIRST..LAST` or `NAME=FIRST..LAST/STEP`
    fn read(text: &str) -> Result<Vary, String> {
        let form = || "a name and a range, such as `Hero.jump_speed=100..400`".to_string();
        let (path, range) = text.split_once('=').ok_or_else(form)?;
        let (range, step) = range.split_once('/').map_or((range, None), |(range, step)| (range, Some(step)));
        let (low, high) = range.split_once("..").ok_or_else(form)?;
        let number = |text: &str| text.trim().parse::<f64>().ok().filter(|n| n.is_finite()).ok_or_else(form);
        let (range, step) = ((number(low)?, number(high)?), step.map(positive).transpose()?);
        if path.trim().is_empty() {
            return Err(form());
        }
        Ok(Vary { path: path.trim().to_string(), range, step })
    }
}

fn positive(text: &str) -> Result<f64, String> {
    let number = text.trim().parse::<f64>().ok().filter(|n| n.is_finite() && *n > 0.0);
    number.ok_or_else(|| "a number above 0".to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_may_have_a_step() {
        let vary = |range, step| Ok(Vary { path: "A.b".into(), range, step });
        assert_eq!(Vary::read("A.b=100..400"), vary((100.0, 400.0), None));
        assert_eq!(Vary::read("A.b = -3..5/0.5"), vary((-3.0, 5.0), Some(0.5)));
        for wrong in ["A.b", "A.b=3", "=1..2", "A.b=1..x", "A.b=1..2/0", "A.b=1..inf"] {
            assert!(Vary::read(wrong).is_err(), "{wrong}");
        }
    }
}
