//! The files of pictures that a program's looks name.

use std::io;
use std::path::Path;

use base64::Engine;

use crate::ir::Program;
use crate::view::{Image, Images};

/// Maximum size of the file of a picture, and of its sides.
const MAX_BYTES: u64 = 4 << 20;
const MAX_SIDE: u32 = 4096;

/// Reads the pictures that looks name, from the folder of the program.
///
/// # Errors
/// A message if one of them cannot be read.
pub(super) fn images(program: &Program, file: &Path) -> Result<Images, String> {
    let mut images = Images::default();
    for name in program.looks.pictures() {
        let (image, address) = image(name, file)?;
        images.add(name, image, address);
    }
    Ok(images)
}

/// Reads the picture of a name, from the folder of a program; also returns an address that holds the whole file.
///
/// # Errors
/// A message if it cannot be read, or is no PNG file.
pub(super) fn image(name: &str, program: &Path) -> Result<(Image, String), String> {
    let path = program.parent().unwrap_or(Path::new("")).join(name);
    let why = |why: &dyn std::fmt::Display| format!("cannot show `{}`: {why}", path.display());
    let of = std::fs::metadata(&path).map_err(|error| why(&error))?;
    if !of.is_file() {
        return Err(why(&"it is no regular file"));
    }
    if of.len() > MAX_BYTES {
        return Err(why(&format!("it has more than {} MiB", MAX_BYTES >> 20)));
    }
    let bytes = std::fs::read(&path).map_err(|error| why(&error))?;
    let image = decoded(&bytes).map_err(|error| why(&error))?;
    Ok((image, data_uri("png", &bytes)))
}

/// The address of a picture that is its content.
pub(super) fn data_uri(format: &str, picture: &[u8]) -> String {
    format!("data:image/{format};base64,{}", base64::engine::general_purpose::STANDARD.encode(picture))
}

/// Decodes a PNG file.
fn decoded(bytes: &[u8]) -> Result<Image, String> {
    let mut decoder = png::Decoder::new(io::Cursor::new(bytes));
    decoder.set_transformations(png::Transformations::normalize_to_color8() | png::Transformations::ALPHA);
    let mut reader = decoder.read_info().map_err(|error| error.to_string())?;
    let (width, height) = reader.info().size();
    if width > MAX_SIDE || height > MAX_SIDE {
        return Err(format!("it is {width}x{height} pixels, at most {MAX_SIDE}x{MAX_SIDE} are shown"));
    }
    let mut data = vec![0; reader.output_buffer_size().ok_or("it is too large")?];
    let info = reader.next_frame(&mut data).map_err(|error| error.to_string())?;
    data.truncate(info.buffer_size());
    let rgba = match info.color_type {
        png::ColorType::Rgba => data,
        // Grey and opacity.
        _ => data.chunks_exact(2).flat_map(|pair| [pair[0], pair[0], pair[0], pair[1]]).collect(),
    };
    Ok(Image { width: width as usize, height: height as usize, rgba })
}
