//! Looks in pictures: colours as style, and the files of pictures, which are in the SVG once and used by their number.

use std::collections::BTreeMap;

use crate::ir::Look;

use super::canvas::Image;
use super::frame::Rect;
use super::svg::{Number, put};

/// The pictures that a program names, by their paths.
#[derive(Debug, Clone, Default)]
pub struct Images(BTreeMap<String, PictureFile>);

/// A picture from a file.
#[derive(Debug, Clone)]
struct PictureFile {
    image: Image,
    /// The file as an address that holds its own data.
    address: String,
}

impl Images {
    /// Adds the picture of a path; `address` is a `data:` address with the contents of the file.
    pub fn add(&mut self, path: &str, image: Image, address: String) {
        self.0.insert(path.to_string(), PictureFile { image, address });
    }

    /// The picture of a look, if it is one and its file is known.
    pub(super) fn image(&self, look: &Look) -> Option<&Image> {
        self.0.get(look.picture()?).map(|file| &file.image)
    }

    /// The name of the symbol of a look, if it is a picture whose file is known.
    pub(super) fn symbol(&self, look: &Look) -> Option<String> {
        let path = look.picture()?;
        self.0.keys().position(|known| known == path).map(|index| format!("look{index}"))
    }

    /// Defines a symbol for each picture.
    pub(super) fn define(&self, out: &mut String) {
        for (index, PictureFile { image: Image { width, height, .. }, address }) in self.0.values().enumerate() {
            put!(
                out,
                "<symbol id=\"look{index}\" viewBox=\"0 0 {width} {height}\" preserveAspectRatio=\"none\">\
                 <image width=\"{width}\" height=\"{height}\" href=\"{address}\" style=\"image-rendering:pixelated\"/>\
                 </symbol>\n"
            );
        }
    }
}

/// The style of a filled shape with the colour of a look; nothing for a picture.
pub(super) fn fill(look: Option<&Look>) -> String {
    look.and_then(Look::rgb).map_or(String::new(), |rgb| format!(" style=\"fill:{};fill-opacity:1\"", hex(rgb)))
}

/// The style of a body with the colour of a look: a sensor of what has a body has a border only.
pub(super) fn body(look: Option<&Look>, is_sensor: bool, has_body: bool) -> String {
    let Some(rgb) = look.and_then(Look::rgb) else { return String::new() };
    let edge = rgb.map(|part| (u16::from(part) * 7 / 10) as u8);
    match (is_sensor, has_body) {
        (true, true) => format!(" style=\"stroke:{}\"", hex(rgb)),
        (true, false) => format!(" style=\"fill:{};fill-opacity:.5;stroke:{}\"", hex(rgb), hex(edge)),
        (false, _) => format!(" style=\"fill:{};fill-opacity:.9;stroke:{}\"", hex(rgb), hex(edge)),
    }
}

/// Draws a symbol in a rectangle.
pub(super) fn draw(out: &mut String, symbol: &str, r: Rect) {
    let (x, y, width, height) = (Number(r.x), Number(r.y), Number(r.width), Number(r.height));
    put!(out, "<use href=\"#{symbol}\" x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\"/>\n");
}

fn hex([red, green, blue]: [u8; 3]) -> String {
    format!("#{red:02x}{green:02x}{blue:02x}")
}
