//! Comma-separated values (RFC 4180): writes and parses lines.

use std::borrow::Cow;

/// A cell, in quotes if it contains a delimiter.
pub fn quoted(text: &str) -> Cow<'_, str> {
    if text.contains(['"', ',', '\n', '\r']) {
        Cow::Owned(format!("\"{}\"", text.replace('"', "\"\"")))
    } else {
        Cow::Borrowed(text)
    }
}

/// Cells as a line, without the line's end.
pub fn line<S: AsRef<str>>(cells: impl IntoIterator<Item = S>) -> String {
    let mut out = String::new();
    for (index, cell) in cells.into_iter().enumerate() {
        if index > 0 {
            out.push(',');
        }
        out.push_str(&quoted(cell.as_ref()));
    }
    out
}

/// The cells of a line that [`line()`] made.
pub fn cells(line: &str) -> Vec<String> {
    let mut cells = vec![String::new()];
    let mut is_quoted = false;
    let mut rest = line.chars().peekable();
    while let Some(c) = rest.next() {
        let last = cells.len() - 1;
        match c {
            '"' if is_quoted && rest.next_if_eq(&'"').is_some() => cells[last].push('"'),
            '"' => is_quoted = !is_quoted,
            ',' if !is_quoted => cells.push(String::new()),
            c => cells[last].push(c),
        }
    }
    cells
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_would_end_a_cell_is_quoted() {
        assert_eq!(quoted("a b:W"), "a b:W");
        assert_eq!(quoted("a,b"), "\"a,b\"");
        assert_eq!(quoted("a\"b"), "\"a\"\"b\"");
    }

    #[test]
    fn a_line_is_taken_apart_into_what_it_was_made_of() {
        for row in [vec![""], vec!["a", "", "b"], vec!["1,5", "say \"no\"", "\"", ",", "two\nlines"]] {
            assert_eq!(cells(&line(&row)), row);
        }
    }
}
