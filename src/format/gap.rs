//! The text between two tokens: blanks, line breaks, `;` and comments.

/// A comment.
#[derive(Debug, Clone, Copy)]
pub(super) struct Comment<'t> {
    /// From its slashes to the end of its line, without blanks there.
    pub text: &'t str,
    /// Its first byte.
    pub start: usize,
    /// Whether it is at the end of the line of the token before it.
    pub trailing: bool,
    /// Whether a blank line is before it.
    pub blank: bool,
}

/// The text before a token.
#[derive(Debug, Default)]
pub(super) struct Gap<'t> {
    /// The comments, in order.
    pub comments: Vec<Comment<'t>>,
    /// Whether there is a line break.
    pub newline: bool,
    /// Whether a blank line is directly before the token.
    pub blank: bool,
}

/// Reads the gap between two bytes. A line break or blank line before the first token of a text does not count.
pub(super) fn gap(text: &str, start: usize, end: usize) -> Gap<'_> {
    let bytes = text.as_bytes();
    let mut gap = Gap::default();
    // Line breaks since the last comment, and whether there was a `;`.
    let (mut breaks, mut semicolon) = (0, false);
    let mut i = start;
    while i < end {
        match bytes[i] {
            b'/' => {
                let stop = bytes[i..end].iter().position(|b| matches!(b, b'\n' | b'\r')).map_or(end, |n| i + n);
                gap.comments.push(Comment {
                    text: text.get(i..stop).unwrap_or("").trim_end(),
                    start: i,
                    trailing: !gap.newline && start > 0,
                    blank: breaks > 1,
                });
                (breaks, semicolon) = (0, false);
                i = stop;
                continue;
            }
            b'\r' if bytes.get(i + 1) == Some(&b'\n') => {}
            b'\n' | b'\r' => {
                gap.newline = true;
                breaks += 1;
            }
            b';' => semicolon = true,
            _ => {}
        }
        i += 1;
    }
    // A `;` separates a comment from what follows, so that it does not document it.
    gap.blank = breaks > 1 || (semicolon && breaks > 0 && !gap.comments.is_empty());
    gap
}
