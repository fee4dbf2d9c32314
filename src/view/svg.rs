//! Building blocks of SVG text: numbers with two decimals, rectangles as path data, escaped text and its estimated
//! width.

use std::fmt::{self, Display, Formatter, Write};

use super::frame::Rect;

/// A number with at most two decimals.
#[derive(Debug, Clone, Copy)]
pub(super) struct Number(pub f64);

impl Display for Number {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let hundredths = (self.0 * 100.0).round() as i64;
        let (sign, size) = (if hundredths < 0 { "-" } else { "" }, hundredths.unsigned_abs());
        let (whole, rest) = (size / 100, size % 100);
        match rest {
            0 => write!(f, "{sign}{whole}"),
            _ if rest % 10 == 0 => write!(f, "{sign}{whole}.{}", rest / 10),
            _ => write!(f, "{sign}{whole}.{rest:02}"),
        }
    }
}

/// Appends formatted text. Infallible: writes to a string.
macro_rules! put {
    ($out:expr, $($format:tt)*) => {{
        use std::fmt::Write as _;
        let _ = write!($out, $($format)*);
    }};
}
pub(super) use put;

/// Appends a rectangle to the data of a path.
pub(super) fn box_data(data: &mut String, r: Rect) {
    let (x, y, width, height) = (Number(r.x), Number(r.y), Number(r.width), Number(r.height));
    let _ = write!(data, "M{x} {y}h{width}v{height}h{}z", Number(-r.width));
}

/// Appends a line through some points, from the end of the data or from its own first point.
pub(super) fn line_data(data: &mut String, points: &[[f64; 2]]) {
    for (index, [x, y]) in points.iter().enumerate() {
        let _ = write!(data, "{}{} {}", if index == 0 { 'M' } else { 'L' }, Number(*x), Number(*y));
    }
}

/// Appends a path of a class; appends nothing without data.
pub(super) fn path(out: &mut String, class: &str, data: &str) {
    styled_path(out, class, "", data);
}

/// As [`path`], with a style of its own.
pub(super) fn styled_path(out: &mut String, class: &str, style: &str, data: &str) {
    if !data.is_empty() {
        put!(out, "<path class=\"{class}\"{style} d=\"{data}\"/>\n");
    }
}

/// Text escaped for XML and its attributes; characters outside of XML become U+FFFD.
pub fn escaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\t' | '\n' | '\r' => out.push(' '),
            '\0'..'\u{20}' | '\u{fffe}' | '\u{ffff}' => out.push('\u{fffd}'),
            _ => out.push(c),
        }
    }
    out
}

/// The estimated width of a text in a sans-serif font of a size; rather too wide than too narrow.
pub(super) fn text_width(text: &str, size: f64) -> f64 {
    let em = |c: char| match c {
        'i' | 'j' | 'l' | 'I' | '.' | ',' | ':' | ';' | '\'' | '|' | '!' => 0.33,
        'f' | 't' | 'r' | ' ' | '(' | ')' | '-' => 0.42,
        'm' | 'w' | 'M' | 'W' | '@' | '%' => 0.98,
        'A'..='Z' => 0.74,
        '\0'..='\u{24f}' => 0.63,
        // Scripts with square letters, arrows, pictographs.
        _ => 1.05,
    };
    text.chars().map(em).sum::<f64>() * size
}

/// Width of bold letters relative to normal ones.
pub(super) const BOLD: f64 = 1.12;

/// A text wrapped between words to a limited width and number of lines; the rest is cut.
pub(super) fn wrapped(text: &str, size: f64, width: f64, most: usize) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split_whitespace() {
        let joined = lines.last().map(|line| format!("{line} {word}"));
        match joined.filter(|joined| lines.len() == most || text_width(joined, size) <= width) {
            Some(joined) => {
                let full = text_width(&joined, size) > width;
                lines.pop();
                lines.push(shortened(&joined, size, width));
                if full {
                    break;
                }
            }
            None => lines.push(shortened(word, size, width)),
        }
    }
    lines
}

/// A text cut to a width.
pub(super) fn shortened(text: &str, size: f64, width: f64) -> String {
    if text_width(text, size) <= width {
        return text.to_string();
    }
    let mut out = String::new();
    let mut taken = text_width("…", size);
    for c in text.chars() {
        taken += text_width(c.encode_utf8(&mut [0; 4]), size);
        if taken > width {
            break;
        }
        out.push(c);
    }
    out.push('…');
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short() {
        let shown = |x: f64| Number(x).to_string();
        assert_eq!(shown(3.0), "3");
        assert_eq!(shown(-0.001), "0");
        assert_eq!(shown(-0.5), "-0.5");
        assert_eq!(shown(12.346), "12.35");
        assert_eq!(shown(7.05), "7.05");
    }

    #[test]
    fn text_is_cut_and_wrapped_to_a_width() {
        assert_eq!(shortened("short", 12.0, 100.0), "short");
        assert!(text_width(&shortened(&"w".repeat(50), 12.0, 100.0), 12.0) <= 100.0);
        let text = "one two three four five six seven";
        let lines = wrapped(text, 12.0, 80.0, 9);
        assert!(lines.len() > 2 && lines.iter().all(|line| text_width(line, 12.0) <= 80.0), "{lines:?}");
        assert_eq!(lines.join(" "), text);
        let cut = wrapped(text, 12.0, 80.0, 2);
        assert!(cut.len() == 2 && cut[0] == lines[0] && cut[1].ends_with('…'), "{cut:?}");
        assert!(text_width(&cut[1], 12.0) <= 80.0);
    }
}
