//! JSON as text, compact or indented. One serializer for all types: the code that writes a type is compiled once for each
//! serializer that it meets.

use std::io::{self, Write};

use serde::ser::Error;
use serde::{Serialize, de::DeserializeOwned};
use serde_json::Serializer;
use serde_json::ser::{CompactFormatter, Formatter, PrettyFormatter};

/// How JSON is laid out.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Layout {
    /// On one line.
    Compact,
    /// A line for each value, indented by two spaces.
    Indented,
}

/// Writes a value, without a line end.
///
/// # Errors
/// Those of the writer.
pub fn write(value: &impl Serialize, layout: Layout, out: &mut dyn Write) -> serde_json::Result<()> {
    let formatter = match layout {
        Layout::Compact => Either::Compact(CompactFormatter),
        Layout::Indented => Either::Indented(PrettyFormatter::new()),
    };
    value.serialize(&mut Serializer::with_formatter(out, formatter))
}

/// A value as bytes of UTF-8.
///
/// # Errors
/// Infallible for values whose keys are text.
pub fn bytes(value: &impl Serialize, layout: Layout) -> serde_json::Result<Vec<u8>> {
    let mut out = Vec::new();
    write(value, layout, &mut out)?;
    Ok(out)
}

/// A value as text.
///
/// # Errors
/// As [`bytes`].
pub fn text(value: &impl Serialize, layout: Layout) -> serde_json::Result<String> {
    String::from_utf8(bytes(value, layout)?).map_err(Error::custom)
}

/// Reads a value.
///
/// # Errors
/// Why the text is no such value.
pub fn read<T: DeserializeOwned>(text: &str) -> serde_json::Result<T> {
    serde_json::from_str(text)
}

enum Either {
    Compact(CompactFormatter),
    Indented(PrettyFormatter<'static>),
}

/// Passes calls on to the formatter of a layout.
macro_rules! pass_on {
    ($($name:ident($($argument:ident: $kind:ty)?);)*) => {$(
        fn $name<W: ?Sized + Write>(&mut self, out: &mut W $(, $argument: $kind)?) -> io::Result<()> {
            match self {
                Either::Compact(formatter) => formatter.$name(out $(, $argument)?),
                Either::Indented(formatter) => formatter.$name(out $(, $argument)?),
            }
        }
    )*};
}

impl Formatter for Either {
    pass_on! {
        begin_array();
        end_array();
        begin_array_value(first: bool);
        end_array_value();
        begin_object();
        end_object();
        begin_object_key(first: bool);
        begin_object_value();
        end_object_value();
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn both_layouts_are_those_of_serde_json() {
        let value = json!({ "a": [1, 2.5, []], "b": {}, "c": { "d": null, "e": "\"x\"" } });
        assert_eq!(text(&value, Layout::Compact).unwrap_or_default(), value.to_string());
        let indented = serde_json::to_string_pretty(&value).unwrap_or_default();
        assert_eq!(text(&value, Layout::Indented).unwrap_or_default(), indented);
    }
}
