//! The arrangement of the panels, all at one scale: several spaces in rows of equal length; a long level folded into
//! rows, a high one into columns.

use crate::ir::{Bounds, Extremes, TagId, TileMap};

/// Margin of the picture, and distance between panels.
pub(super) const MARGIN: f64 = 20.0;
/// Target width and height of all panels together.
const TARGET: (f64, f64) = (1400.0, 860.0);
/// Maximum height of a folded level.
const FOLDED: f64 = 1500.0;
/// A level is folded if its scale would be smaller.
const FOLD_BELOW: f64 = 0.8;
/// Ratio of the sides from which a level is folded, and the scale that is enough.
const LONG: f64 = 2.5;
const ENOUGH: f64 = 1.2;
/// Maximum number of parts of a level.
const MAX_PARTS: usize = 40;
/// Minimum width of the longest of several panels.
const SMALL: f64 = 260.0;
/// Maximum scale: px of the picture per px of the game.
const MAX_SCALE: f64 = 4.0;
/// Height of a panel's title, and of the room for marks above and below columns.
pub(super) const HEAD: f64 = 24.0;

/// How the parts of a level continue each other.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Fold {
    /// From left to right, row by row.
    Rows,
    /// From the bottom to the top, column by column.
    Columns,
}

/// The arrangement of the panels.
#[derive(Debug, Clone)]
pub(super) struct Grid {
    columns: Vec<f64>,
    rows: Vec<f64>,
    /// The size of a px of the game in the picture.
    pub scale: f64,
    heads: f64,
}

/// Cuts a level that would be drawn too small into parts, in the order in which they are read.
pub(super) fn folded(view: Bounds, map: Option<&TileMap<TagId>>) -> Option<(Fold, Vec<Bounds>)> {
    let (width, height) = (view.right - view.left, view.top - view.bottom);
    let (fold, long, short) =
        if width >= height { (Fold::Rows, width, height) } else { (Fold::Columns, height, width) };
    let scale = |parts: usize| {
        let (count, margins) = (parts as f64, (parts - 1) as f64 * MARGIN);
        match fold {
            Fold::Rows => (TARGET.0 * count / long).least((FOLDED - margins) / (count * short)),
            Fold::Columns => (FOLDED.least(TARGET.1) * count / long).least((TARGET.0 - margins) / (count * short)),
        }
    };
    if long < LONG * short || scale(1) >= FOLD_BELOW {
        return None;
    }
    let best = (1..=MAX_PARTS).map(scale).fold(0.0, f64::greatest).least(ENOUGH);
    let parts = (1..=MAX_PARTS).find(|&parts| scale(parts) >= best).filter(|&parts| parts > 1)?;
    // Cuts go between tiles.
    let tile = map.map_or(1.0, |map| if fold == Fold::Rows { map.tile.0 } else { map.tile.1 }).greatest(1.0);
    let length = (long / parts as f64 / tile).ceil() * tile;
    let begin = if fold == Fold::Rows { view.left } else { view.bottom };
    let cuts = (0..parts).map(|part| (begin + part as f64 * length, begin + (part + 1) as f64 * length));
    let cuts = cuts.filter(|(from, _)| from - begin < long);
    let views = cuts.map(|(from, to)| match fold {
        Fold::Rows => Bounds { left: from, right: to.least(view.right), ..view },
        Fold::Columns => Bounds { bottom: from, top: to.least(view.top), ..view },
    });
    Some((fold, views.collect()))
}

impl Grid {
    /// The arrangement of the parts of one level.
    pub fn of_parts(fold: Fold, parts: &[Bounds]) -> Grid {
        let (mut widths, mut heights): (Vec<f64>, Vec<f64>) =
            parts.iter().map(|b| (b.right - b.left, b.top - b.bottom)).unzip();
        let longest = |sizes: &[f64]| sizes.iter().copied().fold(1.0, f64::greatest);
        let margins = (parts.len().saturating_sub(1)) as f64 * MARGIN;
        let scale = match fold {
            Fold::Rows => {
                widths = vec![longest(&widths)];
                (TARGET.0 / widths[0]).least((FOLDED - margins) / heights.iter().sum::<f64>())
            }
            Fold::Columns => {
                heights = vec![longest(&heights)];
                (TARGET.1 / heights[0]).least((TARGET.0 - margins) / widths.iter().sum::<f64>())
            }
        };
        let scale = scale.clamp(0.01, MAX_SCALE);
        let scaled = |sizes: Vec<f64>| sizes.into_iter().map(|size| size * scale).collect();
        let heads = if fold == Fold::Columns { HEAD } else { 0.0 };
        Grid { columns: scaled(widths), rows: scaled(heights), scale, heads }
    }

    /// The arrangement of spaces with the largest scale.
    pub fn of_spaces(views: &[Bounds]) -> Grid {
        let sizes: Vec<(f64, f64)> = views.iter().map(|b| (b.right - b.left, b.top - b.bottom)).collect();
        let arranged = |count: usize| {
            let mut columns = vec![0.0f64; count];
            for (index, size) in sizes.iter().enumerate() {
                columns[index % count] = columns[index % count].greatest(size.0);
            }
            let rows: Vec<f64> =
                sizes.chunks(count).map(|row| row.iter().map(|size| size.1).fold(0.0, f64::greatest)).collect();
            (columns, rows)
        };
        let fit = |(columns, rows): &(Vec<f64>, Vec<f64>)| {
            let (width, height): (f64, f64) = (columns.iter().sum(), rows.iter().sum());
            (TARGET.0 / width.greatest(1.0)).least(TARGET.1 / height.greatest(1.0))
        };
        let all = (1..=sizes.len().max(1)).map(arranged);
        let best = all.reduce(|best, next| if fit(&next) > fit(&best) { next } else { best });
        let best = best.unwrap_or_default();
        let longest = sizes.iter().map(|(width, height)| width.greatest(*height)).fold(1.0, f64::greatest);
        let least = if views.len() > 1 { SMALL / longest } else { 0.0 };
        let scale = fit(&best).greatest(least).least(MAX_SCALE);
        let scaled = |sizes: Vec<f64>| sizes.into_iter().map(|size| size * scale).collect();
        let heads = if views.len() > 1 { HEAD } else { 0.0 };
        Grid { columns: scaled(best.0), rows: scaled(best.1), scale, heads }
    }

    /// Width of all panels.
    pub fn width(&self) -> f64 {
        self.columns.iter().sum::<f64>() + MARGIN * self.columns.len().saturating_sub(1) as f64
    }

    /// Height of all panels.
    pub fn height(&self) -> f64 {
        self.rows.iter().map(|row| row + self.heads).sum::<f64>() + MARGIN * self.rows.len().saturating_sub(1) as f64
    }

    /// The upper left corner of a panel with its title.
    pub fn place(&self, index: usize) -> (f64, f64) {
        let (column, row) = (index % self.columns.len().max(1), index / self.columns.len().max(1));
        let x = self.columns.iter().take(column).map(|width| width + MARGIN).sum();
        let y = self.rows.iter().take(row).map(|height| height + self.heads + MARGIN).sum();
        (x, y)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn view(width: f64, height: f64) -> Bounds {
        Bounds { left: -8.0, right: width - 8.0, bottom: 0.0, top: height }
    }

    #[test]
    fn parts_of_a_long_level_cover_it_without_gaps() {
        for (width, height, fold) in [(3392.0, 240.0, Fold::Rows), (256.0, 3000.0, Fold::Columns)] {
            let (found, parts) = folded(view(width, height), None).unwrap();
            assert_eq!(found, fold);
            assert!(parts.len() > 1, "{parts:?}");
            let ends = |b: &Bounds| if fold == Fold::Rows { (b.left, b.right) } else { (b.bottom, b.top) };
            assert!(parts.windows(2).all(|pair| ends(&pair[0]).1 == ends(&pair[1]).0), "{parts:?}");
            assert_eq!((ends(&parts[0]).0, ends(parts.last().unwrap()).1), ends(&view(width, height)));
            let grid = Grid::of_parts(fold, &parts);
            assert!(grid.width() <= 1401.0 && grid.height() <= 1501.0, "{grid:?}");
            let whole = Grid::of_spaces(&[view(width, height)]);
            assert!(grid.scale > 1.4 * whole.scale, "{} and {}", grid.scale, whole.scale);
        }
    }

    #[test]
    fn levels_that_can_be_read_stay_in_one_piece() {
        assert_eq!(folded(view(1200.0, 200.0), None), None);
        assert_eq!(folded(view(4000.0, 3000.0), None), None);
    }
}
