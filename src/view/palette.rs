//! The colours of animations, and the table of colours that a GIF file has room for.

use crate::ordered::Ordered;

use std::collections::BTreeMap;

use super::canvas::{Canvas, Paint};

/// Number of colours of players.
pub(super) const PLAYERS: usize = 4;
/// Number of colours of a table; one more stands for what does not change.
const MAX_COLORS: usize = 255;

/// The colours of an animation.
#[derive(Debug, Clone, Copy)]
pub(super) struct Scheme {
    is_dark: bool,
    pub paper: Paint,
    pub air: Paint,
    pub players: [Paint; PLAYERS],
    pub thing: Paint,
    pub block: Paint,
    pub asked: Paint,
    pub goal: Paint,
    pub reached: Paint,
    pub crack: Paint,
    /// Area and border.
    pub link: (Paint, Paint),
}

impl Scheme {
    /// The light or the dark one.
    pub fn new(is_dark: bool) -> Scheme {
        let pick = |light: u32, dark: u32| Paint::solid(if is_dark { dark } else { light });
        Scheme {
            is_dark,
            paper: pick(0xdd_e2_e8, 0x06_08_0c),
            air: pick(0xf3_f5_f8, 0x13_18_20),
            players: [
                pick(0xe8_59_0c, 0xff_8c_38),
                pick(0xbf_39_89, 0xff_80_c8),
                pick(0x0b_72_85, 0x4a_c9_dd),
                pick(0x7d_66_08, 0xd9_b9_49),
            ],
            thing: pick(0x81_5a_d1, 0xab_7d_f8),
            block: pick(0x6e_78_85, 0x7a_84_91),
            asked: pick(0x2d_a4_4e, 0x3f_b9_50),
            goal: pick(0x1a_7f_37, 0x3f_b9_50),
            reached: pick(0x2d_a4_4e, 0x56_d364),
            crack: Paint { opacity: 0.35, ..pick(0xff_ff_ff, 0x00_00_00) },
            link: (
                Paint { opacity: 0.16, ..pick(0x82_50_df, 0xab_7d_f8) },
                Paint { opacity: 0.8, ..pick(0x82_50_df, 0xab_7d_f8) },
            ),
        }
    }

    /// The colour of a class of tiles, as in the style sheet of the SVG picture.
    pub fn tile(&self, class: &str) -> Paint {
        let (light, dark, opacity) = match class {
            "ground0" => (0x52_5c_68, 0x56_60_6c, 1.0),
            "ground1" => (0x7d_6b_5d, 0x77_67_5a, 1.0),
            "ground2" => (0x5d_73_68, 0x56_6f_63, 1.0),
            "ground3" => (0x71_64_82, 0x6c_5f_80, 1.0),
            "cloud" => (0x52_5c_68, 0x8b_94_9e, 0.28),
            "lip" => (0x52_5c_68, 0x9a_a4_b0, 1.0),
            "wanted" => (0x2d_a4_4e, 0x2d_a4_4e, 0.6),
            "feared" => (0xd1_24_2f, 0xd1_24_2f, 0.7),
            "accent0" => (0x82_50_df, 0x82_50_df, 0.45),
            "accent1" => (0x1b_9a_aa, 0x1b_9a_aa, 0.45),
            "accent2" => (0x9a_67_00, 0x9a_67_00, 0.45),
            "accent3" => (0xc2_55_9d, 0xc2_55_9d, 0.45),
            "accent4" => (0x7d_85_30, 0x7d_85_30, 0.45),
            "accent5" => (0x3d_7a_8c, 0x3d_7a_8c, 0.45),
            "dim" => (0xb4_bc_c5, 0x36_3d_47, 1.0),
            _ => (0x8c_95_9f, 0x8c_95_9f, 0.28),
        };
        Paint::tint(if self.is_dark { dark } else { light }, opacity)
    }
}

/// A darker colour for the border of a shape.
pub(super) fn edge(paint: Paint) -> Paint {
    Paint { rgb: paint.rgb.map(|part| (u16::from(part) * 7 / 10) as u8), ..paint }
}

/// How often each colour occurs in some pictures.
#[derive(Debug, Clone, Default)]
pub struct Colors(BTreeMap<[u8; 3], u64>);

impl Colors {
    /// Counts the colours of a picture.
    pub fn count(&mut self, canvas: &Canvas) {
        for run in canvas.pixels().chunk_by(PartialEq::eq) {
            *self.0.entry(run[0]).or_insert(0) += run.len() as u64;
        }
    }

    /// The table of the most frequent colours.
    pub fn table(self) -> ColorTable {
        let mut colors: Vec<([u8; 3], u64)> = self.0.into_iter().collect();
        colors.order_by_key(|(color, count)| (std::cmp::Reverse(*count), *color));
        let list: Vec<[u8; 3]> = colors.iter().take(MAX_COLORS).map(|(color, _)| *color).collect();
        let near = |color: [u8; 3]| {
            let far =
                |other: &[u8; 3]| other.iter().zip(color).map(|(a, b)| u32::from(a.abs_diff(b)).pow(2)).sum::<u32>();
            (0u8..).zip(&list).min_by_key(|(_, other)| far(other)).map_or(0, |(index, _)| index)
        };
        let index = colors.iter().map(|(color, _)| (*color, near(*color))).collect();
        ColorTable { list, index, is_complete: true }
    }
}

/// At most 255 colours. An empty table takes colours as they come.
#[derive(Debug, Clone, Default)]
pub struct ColorTable {
    list: Vec<[u8; 3]>,
    index: BTreeMap<[u8; 3], u8>,
    /// Whether it was made from all colours: then it takes no more.
    is_complete: bool,
}

impl ColorTable {
    /// The colours.
    pub fn colors(&self) -> &[[u8; 3]] {
        &self.list
    }

    /// The number of each pixel's colour in the table: of a complete table, the nearest one. Nothing if there is no room
    /// for a colour.
    pub fn indices(&mut self, canvas: &Canvas) -> Option<Vec<u8>> {
        let mut indices = Vec::with_capacity(canvas.pixels().len());
        for run in canvas.pixels().chunk_by(PartialEq::eq) {
            let index = self.number(run[0])?;
            indices.resize(indices.len() + run.len(), index);
        }
        Some(indices)
    }

    fn number(&mut self, color: [u8; 3]) -> Option<u8> {
        match self.index.get(&color) {
            Some(index) => Some(*index),
            None if self.is_complete => Some(0),
            None if self.list.len() >= MAX_COLORS => None,
            None => {
                let index = u8::try_from(self.list.len()).ok()?;
                self.list.push(color);
                self.index.insert(color, index);
                Some(index)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rare_colors_become_the_nearest_frequent_one() {
        let mut colors = Colors::default();
        for gray in 0..=255u8 {
            let mut canvas = Canvas::new(2, 2, Paint::solid(0));
            canvas.clear(Paint { rgb: [gray, gray, gray], opacity: 1.0 });
            colors.count(&canvas);
        }
        let mut canvas = Canvas::new(1, 1, Paint::solid(0xff_00_00));
        colors.count(&canvas);
        let mut table = colors.table();
        assert_eq!(table.colors().len(), MAX_COLORS);
        let mut color = |canvas: &Canvas| {
            let index = table.indices(canvas).unwrap()[0];
            table.colors()[usize::from(index)]
        };
        assert_ne!(color(&canvas), [255, 0, 0]);
        canvas.clear(Paint::solid(0x07_07_07));
        assert_eq!(color(&canvas), [7, 7, 7]);
    }

    #[test]
    fn an_empty_table_takes_colors_until_it_is_full() {
        let mut table = ColorTable::default();
        let mut canvas = Canvas::new(2, 2, Paint::solid(0));
        for gray in 0..=255u8 {
            canvas.clear(Paint { rgb: [gray, gray, gray], opacity: 1.0 });
            let expected = (usize::from(gray) < MAX_COLORS).then(|| vec![gray; 4]);
            assert_eq!(table.indices(&canvas), expected);
        }
        assert_eq!(table.colors().len(), MAX_COLORS);
    }
}
