//! Arguments of animations.

use std::path::PathBuf;

use clap::Args;

use crate::cli::args::output::output;

/// The animation of a run.
#[derive(Debug, Args)]
pub(in crate::cli) struct GifArgs {
    /// Writes the run to a GIF file: an animation. Where a room is larger than the picture, the camera follows player 1.
    #[arg(long, value_name = "PATH", value_parser = output(), help_heading = "The animation")]
    pub gif: Option<PathBuf>,
    /// Pixels for each px of the game [default: 4 or less, so that all rooms fit into 640x480; 2 if one does not fit].
    #[arg(
        long,
        value_name = "N",
        requires = "gif",
        value_parser = clap::value_parser!(u32).range(1..=32),
        help_heading = "The animation"
    )]
    pub scale: Option<u32>,
    /// Width and height of the pictures in pixels; they are smaller if all rooms are [default: 640x480].
    #[arg(long, value_name = "WxH", requires = "gif", value_parser = size, help_heading = "The animation")]
    pub size: Option<(u32, u32)>,
    /// One picture every so many steps [default: as few as browsers can show, which is 2 at 1/60 s].
    #[arg(
        long,
        value_name = "N",
        requires = "gif",
        value_parser = clap::value_parser!(u64).range(1..),
        help_heading = "The animation"
    )]
    pub every: Option<u64>,
    /// Dark colours.
    #[arg(long, requires = "gif", help_heading = "The animation")]
    pub dark: bool,
    /// Maximum size of the file, MiB.
    #[arg(
        long,
        value_name = "MIB",
        requires = "gif",
        default_value_t = 16,
        value_parser = clap::value_parser!(u64).range(1..=4096),
        help_heading = "The animation"
    )]
    pub max_size: u64,
}

/// `640x480`, both at most 4096.
fn size(text: &str) -> Result<(u32, u32), String> {
    let side = |text: &str| text.trim().parse::<u32>().ok().filter(|side| (16..=4096).contains(side));
    let sides = text.split_once('x').and_then(|(width, height)| side(width).zip(side(height)));
    sides.ok_or_else(|| "two numbers of pixels from 16 to 4096, such as `640x480`".to_string())
}
