//! A picture of pixels, and the few shapes that an animation needs: rectangles on whole pixels, discs and slopes with
//! smooth edges, images. Small enough to be our own: a library for vector graphics would cost more to build than the rest
//! of the animation.

use crate::ir::Extremes;

/// A colour with the opacity from 0 to 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Paint {
    /// Red, green, blue.
    pub rgb: [u8; 3],
    /// How much it covers.
    pub opacity: f64,
}

impl Paint {
    /// An opaque colour from a number such as `0xe0_40_30`.
    pub const fn solid(rgb: u32) -> Paint {
        Paint::tint(rgb, 1.0)
    }

    /// A colour with an opacity.
    pub const fn tint(rgb: u32, opacity: f64) -> Paint {
        let [_, red, green, blue] = rgb.to_be_bytes();
        Paint { rgb: [red, green, blue], opacity }
    }
}

/// A decoded picture: rows from the top, four bytes a pixel: red, green, blue, opacity.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Image {
    /// Its width in pixels.
    pub width: usize,
    /// Its height in pixels.
    pub height: usize,
    /// The pixels.
    pub rgba: Vec<u8>,
}

/// A rectangle of the canvas in pixels: left, top, right, bottom; y points down.
pub(super) type Area = [f64; 4];

/// A picture of pixels.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Canvas {
    width: usize,
    height: usize,
    pixels: Vec<[u8; 3]>,
}

/// Subpixels per side of a pixel at the edge of a disc.
const SAMPLES: usize = 4;

impl Canvas {
    /// A canvas of one colour.
    pub fn new(width: usize, height: usize, paint: Paint) -> Canvas {
        Canvas { width, height, pixels: vec![paint.rgb; width * height] }
    }

    /// Its width in pixels.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Its height in pixels.
    pub fn height(&self) -> usize {
        self.height
    }

    /// The pixels, row by row from the top.
    pub fn pixels(&self) -> &[[u8; 3]] {
        &self.pixels
    }

    /// Colours everything.
    pub(super) fn clear(&mut self, paint: Paint) {
        self.pixels.fill(paint.rgb);
    }

    fn blend(&mut self, x: usize, y: usize, paint: Paint, coverage: f64) {
        let weight = (paint.opacity * coverage * 256.0) as u32;
        if let Some(pixel) = self.pixels.get_mut(y * self.width + x) {
            for (old, new) in pixel.iter_mut().zip(paint.rgb) {
                *old = ((u32::from(*old) * (256 - weight.min(256)) + u32::from(new) * weight.min(256)) >> 8) as u8;
            }
        }
    }

    /// The pixels of an area: columns and rows.
    fn cells(&self, [left, top, right, bottom]: Area) -> (std::ops::Range<usize>, std::ops::Range<usize>) {
        let within =
            |value: f64, most: usize| if value.is_nan() { 0 } else { value.round().clamp(0.0, most as f64) as usize };
        (within(left, self.width)..within(right, self.width), within(top, self.height)..within(bottom, self.height))
    }

    /// Fills a rectangle; its edges are moved to whole pixels.
    pub(super) fn fill(&mut self, area: Area, paint: Paint) {
        let (columns, rows) = self.cells(area);
        for y in rows {
            if paint.opacity >= 1.0 {
                let (from, to) = (y * self.width + columns.start, y * self.width + columns.end);
                if let Some(row) = self.pixels.get_mut(from..to) {
                    row.fill(paint.rgb);
                }
                continue;
            }
            for x in columns.clone() {
                self.blend(x, y, paint, 1.0);
            }
        }
    }

    /// Draws the border of a rectangle inside of it. With `dash` only so many pixels are drawn, and as many left out.
    pub(super) fn border(
        &mut self,
        [left, top, right, bottom]: Area,
        thickness: f64,
        dash: Option<usize>,
        paint: Paint,
    ) {
        let thick = thickness.least((right - left) / 2.0).least((bottom - top) / 2.0).greatest(0.5);
        let (left, top, right, bottom) = (left.round(), top.round(), right.round(), bottom.round());
        let sides = [
            [left, top, right, top + thick],
            [left, bottom - thick, right, bottom],
            [left, top + thick, left + thick, bottom - thick],
            [right - thick, top + thick, right, bottom - thick],
        ];
        for side in sides {
            let (columns, rows) = self.cells(side);
            for y in rows {
                for x in columns.clone() {
                    if dash.is_none_or(|dash| (x + y) / dash.max(1) % 2 == 0) {
                        self.blend(x, y, paint, 1.0);
                    }
                }
            }
        }
    }

    /// Draws a ring between two radii; a disc if the inner one is 0.
    pub(super) fn disc(&mut self, [center_x, center_y]: [f64; 2], radius: f64, inner: f64, paint: Paint) {
        let around =
            [center_x - radius - 1.0, center_y - radius - 1.0, center_x + radius + 1.0, center_y + radius + 1.0];
        let (columns, rows) = self.cells(around);
        let (outer, inner) = (radius * radius, if inner > 0.0 { inner * inner } else { -1.0 });
        for y in rows {
            for x in columns.clone() {
                let mut hits = 0;
                for sample in 0..SAMPLES * SAMPLES {
                    let part = |index: usize| (index as f64 + 0.5) / SAMPLES as f64;
                    let dx = x as f64 + part(sample % SAMPLES) - center_x;
                    let dy = y as f64 + part(sample / SAMPLES) - center_y;
                    hits += usize::from((inner..=outer).contains(&(dx * dx + dy * dy)));
                }
                if hits > 0 {
                    self.blend(x, y, paint, hits as f64 / (SAMPLES * SAMPLES) as f64);
                }
            }
        }
    }

    /// Fills an area below a line from one height at its left edge to another one at its right edge.
    pub(super) fn slope(&mut self, area: Area, (left_top, right_top): (f64, f64), paint: Paint) {
        let [left, _, right, _] = area;
        let (columns, rows) = self.cells(area);
        for x in columns {
            let along = ((x as f64 + 0.5 - left) / (right - left)).clamp(0.0, 1.0);
            let top = left_top + (right_top - left_top) * along;
            for y in rows.clone() {
                let coverage = (y as f64 + 1.0 - top).clamp(0.0, 1.0);
                if coverage > 0.0 {
                    self.blend(x, y, paint, coverage);
                }
            }
        }
    }

    /// Draws a part of an image, given by its left upper corner and its size in pixels, into an area.
    pub(super) fn image(&mut self, area: Area, image: &Image, [part_x, part_y, width, height]: [usize; 4]) {
        let [left, top, right, bottom] = area.map(f64::round);
        let (columns, rows) = self.cells(area);
        let source = |at: usize, from: f64, to: f64, count: usize| {
            let share = (at as f64 + 0.5 - from) / (to - from).greatest(1.0);
            ((share * count as f64) as usize).min(count.saturating_sub(1))
        };
        for y in rows {
            for x in columns.clone() {
                let (column, row) = (part_x + source(x, left, right, width), part_y + source(y, top, bottom, height));
                let at = 4 * (row * image.width + column);
                if let (true, Some(&[red, green, blue, opacity])) = (column < image.width, image.rgba.get(at..at + 4)) {
                    let paint = Paint { rgb: [red, green, blue], opacity: f64::from(opacity) / 255.0 };
                    self.blend(x, y, paint, 1.0);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const WHITE: Paint = Paint::solid(0xff_ff_ff);
    const RED: Paint = Paint::solid(0xff_00_00);

    fn count(canvas: &Canvas, rgb: [u8; 3]) -> usize {
        canvas.pixels().iter().filter(|pixel| **pixel == rgb).count()
    }

    #[test]
    fn shapes_cover_what_they_should() {
        let mut canvas = Canvas::new(20, 10, WHITE);
        canvas.fill([2.2, 1.0, 6.4, 5.0], RED);
        assert_eq!(count(&canvas, RED.rgb), 4 * 4);
        canvas.clear(WHITE);
        canvas.border([0.0, 0.0, 5.0, 5.0], 1.0, None, RED);
        assert_eq!(count(&canvas, RED.rgb), 16);
        canvas.clear(WHITE);
        canvas.disc([10.0, 5.0], 4.0, 0.0, RED);
        let covered: f64 = canvas.pixels().iter().map(|pixel| f64::from(255 - pixel[1]) / 255.0).sum();
        assert!((covered - std::f64::consts::PI * 16.0).abs() < 1.0, "{covered}");
        canvas.clear(WHITE);
        canvas.slope([0.0, 0.0, 10.0, 10.0], (10.0, 0.0), RED);
        let covered: f64 = canvas.pixels().iter().map(|pixel| f64::from(255 - pixel[1]) / 255.0).sum();
        assert!((covered - 50.0).abs() < 1.0, "{covered}");
    }

    #[test]
    fn what_is_outside_is_cut() {
        let mut canvas = Canvas::new(4, 4, WHITE);
        canvas.fill([-1e9, -5.0, 2.0, f64::INFINITY], RED);
        assert_eq!(count(&canvas, RED.rgb), 8);
        canvas.fill([f64::NAN, 0.0, f64::NAN, 4.0], RED);
        canvas.disc([f64::NAN, 2.0], 3.0, 0.0, RED);
        assert_eq!(count(&canvas, RED.rgb), 8);
    }

    #[test]
    fn images_are_scaled_by_whole_pixels() {
        let rgba = vec![255, 0, 0, 255, 0, 255, 0, 255, 0, 0, 255, 255, 0, 0, 0, 0];
        let image = Image { width: 2, height: 2, rgba };
        let mut canvas = Canvas::new(6, 4, WHITE);
        canvas.image([1.0, 0.0, 5.0, 4.0], &image, [0, 0, 2, 2]);
        for rgb in [[255, 0, 0], [0, 255, 0], [0, 0, 255]] {
            assert_eq!(count(&canvas, rgb), 4);
        }
    }
}
