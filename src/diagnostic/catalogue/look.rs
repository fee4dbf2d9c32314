//! Facts about looks: colours and pictures.

use crate::diagnostic::{Code, Diagnostic, Fact};
use crate::source::Span;

/// A `look` that is no colour and no picture.
pub struct BadLook {
    /// The colour or the path.
    pub at: Span,
    /// As written.
    pub written: String,
    /// The reason.
    pub why: WhyNoLook,
}

/// Why something is no colour and no picture.
pub enum WhyNoLook {
    /// A colour has another sign than hexadecimal digits.
    NoDigits,
    /// A colour has another number of digits than 3 or 6.
    Length(usize),
    /// A path leads out of the folder of the file.
    OutsideFolder,
    /// A path does not end in `.png`.
    NoPng,
}

/// A `look` whose picture cannot be shown.
pub struct NoPicture {
    /// The path.
    pub at: Span,
    /// As written.
    pub written: String,
    /// The reason, in a few words.
    pub why: String,
}

impl Fact for NoPicture {
    fn into_diagnostic(self) -> Diagnostic {
        let NoPicture { at, written, why } = self;
        Diagnostic::new(Code::NoPicture, format!("the picture `{written}` cannot be shown: {why}"))
            .at(at, "this path is relative to the folder of this file")
            .or_remove("the look", at)
            .or_write(at, "#e04030")
            .help("put a PNG file there, correct the path, or write a colour such as `#e04030`")
    }
}

impl Fact for BadLook {
    fn into_diagnostic(self) -> Diagnostic {
        let BadLook { at, written, why } = self;
        let new = |message: String, label: &str| {
            let d = Diagnostic::new(Code::BadLook, message).at(at, label);
            d.or_write(at, "#e04030").or_remove("the look", at)
        };
        match why {
            WhyNoLook::NoDigits => {
                new(format!("`{written}` is not a colour"), "hexadecimal digits are 0 to 9 and a to f")
                    .help("write a colour as `#e04030`: two digits each for red, green and blue")
            }
            WhyNoLook::Length(count) => {
                let digits = if count == 1 { "digit" } else { "digits" };
                new(format!("`{written}` is not a colour: it has {count} {digits}"), "3 or 6 digits are a colour")
                    .help("write a colour as `#e04030`: two digits each for red, green and blue")
            }
            WhyNoLook::OutsideFolder => {
                new(format!("the picture `{written}` is not in the folder of the program"), "this leads out of it")
                    .help("put the picture into the folder of the file that names it, or below, and name it with `/`")
            }
            WhyNoLook::NoPng => new(format!("`{written}` is not the name of a PNG file"), "pictures end in `.png`")
                .help("save the picture as PNG: every place that shows looks can show it"),
        }
    }
}
