//! Decoder of the numbers of a layer's tiles: a list with commas, or base64 of little-endian words, compressed or not.

use std::ops::Range;

use super::node::LevelError;

/// The numbers of a list, each with its bytes; brackets and white space are skipped.
pub(super) fn listed(text: &str, text_at: usize) -> impl Iterator<Item = (&str, Range<usize>)> {
    let mut start = 0;
    let parts = text.split(',').map(move |part| {
        let begin = start;
        start += part.len() + 1;
        let cut = part.trim_start_matches(|c: char| c.is_whitespace() || c == '[');
        let begin = begin + (part.len() - cut.len());
        let cut = cut.trim_end_matches(|c: char| c.is_whitespace() || c == ']');
        (cut, text_at + begin..text_at + begin + cut.len())
    });
    parts.filter(|(part, _)| !part.is_empty())
}

/// The encoded numbers of a layer.
pub(super) struct Data<'t> {
    /// As written.
    pub text: &'t str,
    /// The byte where it begins.
    pub text_at: usize,
    /// `csv` or `base64`; empty for a list.
    pub encoding: &'t str,
    /// `zlib` or `gzip`; empty for none.
    pub compression: &'t str,
    /// The bytes that a finding about the whole points at.
    pub at: Range<usize>,
}

impl Data<'_> {
    /// The numbers; their count must be `count`. At most one number more is decompressed.
    pub fn numbers(&self, count: usize) -> Result<Vec<u32>, LevelError> {
        let wrong = |why: String| LevelError::new(self.at.clone(), why);
        let mut numbers = Vec::new();
        match (self.encoding, self.compression) {
            ("csv" | "", "") => {
                for (part, at) in listed(self.text, self.text_at) {
                    let number = part.parse::<u32>();
                    numbers.push(number.map_err(|_| LevelError::new(at, format!("`{part}` is no number of a tile")))?);
                    if numbers.len() > count {
                        break;
                    }
                }
            }
            ("base64", compression) => {
                let bytes = decompress(self.text, compression, 4 * (count as u64 + 1)).map_err(wrong)?;
                numbers.extend(
                    bytes
                        .chunks(4)
                        .map(|word| word.iter().rev().fold(0u32, |number, byte| number << 8 | u32::from(*byte))),
                );
            }
            (other, _) => return Err(wrong(format!("the encoding `{other}` is not read"))),
        }
        match numbers.len() {
            found if found == count => Ok(numbers),
            found if found > count => Err(wrong(format!("there are more numbers of tiles than {count}"))),
            found => Err(wrong(format!("there are {found} numbers of tiles, {count} are needed"))),
        }
    }

    /// The bytes of a number in a list; otherwise of the whole.
    pub fn place(&self, index: usize) -> Range<usize> {
        match self.encoding {
            "csv" | "" => listed(self.text, self.text_at).nth(index).map_or(self.at.clone(), |(_, at)| at),
            _ => self.at.clone(),
        }
    }
}

/// Decodes base64 and decompresses at most `most` bytes, one number more than is allowed.
#[cfg(feature = "tiled")]
fn decompress(text: &str, compression: &str, most: u64) -> Result<Vec<u8>, String> {
    use std::io::Read;

    use base64::Engine as _;
    use base64::engine::general_purpose::STANDARD;

    let packed = STANDARD.decode(text.trim()).map_err(|error| format!("no base64: {error}"))?;
    let mut bytes = Vec::new();
    let read = match compression {
        "" => packed.as_slice().take(most).read_to_end(&mut bytes),
        "zlib" => flate2::read::ZlibDecoder::new(packed.as_slice()).take(most).read_to_end(&mut bytes),
        "gzip" => flate2::read::GzDecoder::new(packed.as_slice()).take(most).read_to_end(&mut bytes),
        other => {
            return Err(format!("the compression `{other}` is not read: choose zlib, gzip or none in the editor"));
        }
    };
    read.map(|_| bytes).map_err(|error| format!("cannot be decompressed: {error}"))
}

#[cfg(not(feature = "tiled"))]
fn decompress(_: &str, _: &str, _: u64) -> Result<Vec<u8>, String> {
    Err("this build of `hypedc` reads no packed tiles (feature `tiled`): choose CSV in the editor".to_string())
}
