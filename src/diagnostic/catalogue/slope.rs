//! Facts about tiles that are solid up to a line.

use crate::diagnostic::{Code, Diagnostic, Fact};
use crate::source::Span;

/// A line that does not divide its tile.
pub struct BadSlope {
    /// `slope (x, y)-(x, y)`.
    pub at: Span,
    /// Its first end, px.
    pub left: (f64, f64),
    /// Its second end.
    pub right: (f64, f64),
    /// Width and height of the tile, px.
    pub tile: (f64, f64),
    /// The reason.
    pub why: WhyNoSlope,
}

/// Why a line does not divide a tile.
#[derive(Clone, Copy)]
pub enum WhyNoSlope {
    /// It runs from the right to the left.
    Backwards,
    /// It does not run from side to side.
    Width,
    /// It leaves the tile.
    Height,
    /// All of the tile is below it.
    Full,
    /// Nothing of the tile is below it.
    Empty,
}

impl Fact for BadSlope {
    fn into_diagnostic(self) -> Diagnostic {
        let BadSlope { at, left, right, tile: (width, height), why } = self;
        let new = |message: String, label: &str| Diagnostic::new(Code::BadSlope, message).at(at, label);
        match why {
            WhyNoSlope::Backwards => {
                new("the line of a slope runs from left to right".into(), "begins at the right side of the tile")
                    .help(format!("write `slope (0, {})-({width}, {})`", right.1, left.1))
                    .or_write(at, format!("slope (0, {})-({width}, {})", right.1, left.1))
            }
            WhyNoSlope::Width => new(
                format!(
                    "a slope is as wide as its tile: from x = 0 to x = {width}, not from {} to {}",
                    left.0, right.0
                ),
                "leaves a part of the tile open",
            )
            .help(format!("write `slope (0, {})-({width}, {})`; smaller tiles make shorter slopes", left.1, right.1))
            .or_write(at, format!("slope (0, {})-({width}, {})", left.1, right.1)),
            WhyNoSlope::Height => {
                new(format!("a slope stays inside of its tile: y is from 0 to {height}"), "leaves the tile").help(
                    "a longer slope is several tiles, one beside the other: `(0, 0)-(16, 8)` and `(0, 8)-(16, 16)`",
                )
            }
            WhyNoSlope::Full => new("all of the tile is below the line".into(), "its upper edge")
                .help("leave out `slope`: a tile is solid up to its upper edge")
                .or_remove("`slope`", at),
            WhyNoSlope::Empty => new("nothing of the tile is below the line".into(), "its lower edge").help(format!(
                "raise an end of the line, as in `slope (0, 0)-({width}, {height})`, or make the tile `empty`"
            )),
        }
    }
}
