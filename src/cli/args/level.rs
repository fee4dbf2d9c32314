//! Arguments shared by several subcommands: the level of a world, a number of seconds.

use std::path::{Path, PathBuf};

use clap::Args;

use crate::compile::LevelFile;

/// The level of worlds that leave their map open, and how it is read.
#[derive(Debug, Args)]
pub(in crate::cli) struct LevelArgs {
    /// The level of worlds that leave their map open.
    #[arg(long, value_name = "PATH")]
    pub map: Option<PathBuf>,
    #[command(flatten)]
    pub reading: ReadingArgs,
}

impl LevelArgs {
    /// The compiler's input.
    pub fn file(&self) -> LevelFile<'_> {
        self.reading.of(self.map.as_deref())
    }
}

/// How the level of worlds that leave their map open is read.
#[derive(Debug, Args)]
pub(in crate::cli) struct ReadingArgs {
    /// The meaning of the level's characters: a legend of the VGLC. A meaning in the program itself takes precedence.
    #[arg(long, value_name = "PATH")]
    pub legend: Option<PathBuf>,
    /// Width and height of a tile of the level, px.
    #[arg(long, value_name = "WxH", value_parser = tile)]
    pub tile: Option<(f64, f64)>,
}

impl ReadingArgs {
    /// The compiler's input, with a level.
    pub fn of<'a>(&'a self, map: Option<&'a Path>) -> LevelFile<'a> {
        LevelFile { map, legend: self.legend.as_deref(), tile: self.tile }
    }
}

/// `16x16`, or `16` for both sides.
fn tile(text: &str) -> Result<(f64, f64), String> {
    let side = |text: &str| text.trim().parse::<f64>().ok().filter(|side| side.is_finite() && *side > 0.0);
    let (width, height) = text.split_once('x').unwrap_or((text, text));
    side(width).zip(side(height)).ok_or_else(|| "two lengths in px above 0, such as `16x16`".to_string())
}

pub(in crate::cli) fn seconds(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if value.is_finite() && value >= 0.0 => Ok(value),
        _ => Err("a number of seconds, such as 2.5".to_string()),
    }
}
