//! Offsets of a browser's editor, which count UTF-16 code units from the start of the text, and those of bytes.

use std::ops::Range;

/// The byte of an offset; one inside a character is its start, one past the end is the end.
pub(super) fn byte_of(code: &str, units: usize) -> usize {
    let mut before = 0;
    for (byte, c) in code.char_indices() {
        before += c.len_utf16();
        if before > units {
            return byte;
        }
    }
    code.len()
}

/// The offsets of a range of bytes.
pub(super) fn units_of(code: &str, bytes: &Range<usize>) -> Range<usize> {
    let units = |text: &str| text.chars().map(char::len_utf16).sum::<usize>();
    let boundary = |byte: usize| (0..=byte.min(code.len())).rev().find(|at| code.is_char_boundary(*at)).unwrap_or(0);
    let (start, end) = (boundary(bytes.start), boundary(bytes.end.max(bytes.start)));
    let before = units(&code[..start]);
    before..before + units(&code[start..end])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn offsets_count_code_units() {
        let code = "é\u{1f40a}x\n";
        assert_eq!([0, 1, 2, 3, 4, 5, 9].map(|units| byte_of(code, units)), [0, 2, 2, 6, 7, 8, 8]);
        assert_eq!(units_of(code, &(2..6)), 1..3);
        assert_eq!(units_of(code, &(3..7)), 1..4, "a byte inside a character counts as its start");
        assert_eq!(units_of(code, &(8..99)), 5..5);
    }
}
