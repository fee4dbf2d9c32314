//! Formatting of documents: edits that bring a text into its canonical layout, hunk by hunk.

use std::ops::{Range, RangeInclusive};

use crate::format::format;
use crate::source::FileId;

use crate::lsp::text::alignment::hunks;
use crate::lsp::text::document_text::Text;
use crate::lsp::text::lexer::tokens;

/// The edits that format a text; with `lines`, only those that touch these lines. `None` if the text has syntax
/// errors.
pub(in crate::lsp) fn formatting(
    text: &Text,
    lines: Option<&RangeInclusive<u32>>,
) -> Option<Vec<(Range<usize>, String)>> {
    formatted(text).map(|new| edits(text, &new, lines))
}

/// The edits after a character was typed at a line: after `}` in the lines of its block, after a line break in the line
/// before. The line of the cursor stays, so that its indentation is not lost.
pub(in crate::lsp) fn on_type(text: &Text, line: u32, typed: &str) -> Option<Vec<(Range<usize>, String)>> {
    let code = text.code();
    let starts: Vec<usize> = std::iter::once(0).chain(code.match_indices('\n').map(|(at, _)| at + 1)).collect();
    let start = starts.get(line as usize).copied()?;
    if typed == "}" {
        let end = starts.get(line as usize + 1).copied().unwrap_or(code.len());
        let close = start + code.get(start..end)?.rfind('}')?;
        let first = opening_line(code, close)?;
        return formatting(text, Some(&(first..=line)));
    }
    let before = line.checked_sub(1)?;
    // Blanks in the line of the cursor are no reason to touch it.
    let rest = code.get(start..)?;
    let end = start + rest.find('\n').unwrap_or(rest.len());
    let is_blank = code.get(start..end)?.trim().is_empty();
    let shown = if is_blank { Text::new(format!("{}{}", &code[..start], &code[end..])) } else { text.clone() };
    let edits = formatting(&shown, Some(&(before..=before)))?;
    Some(edits.into_iter().filter(|(bytes, _)| bytes.end <= start).collect())
}

/// The line of the brace that a closing brace closes.
fn opening_line(code: &str, close: usize) -> Option<u32> {
    let mut open = Vec::new();
    for token in tokens(code) {
        match token.text(code) {
            "{" => open.push(token.at.start),
            "}" if token.at.start == close => {
                let at = open.pop()?;
                return Some(code.get(..at)?.matches('\n').count() as u32);
            }
            "}" => drop(open.pop()),
            _ => {}
        }
    }
    None
}

/// The formatted text; `None` if the text has syntax errors.
fn formatted(text: &Text) -> Option<String> {
    // The formatter accepts LF and CRLF. A lone CR, which occurs only in texts of editors, becomes LF.
    let code = text.code();
    let only_feeds = || code.replace("\r\n", "\u{0}\n").replace('\r', "\n").replace("\u{0}\n", "\r\n");
    let code = if code.contains('\r') { only_feeds() } else { code.to_string() };
    format(FileId(0), &code).ok()
}

/// One edit per hunk of changed lines, so that cursors and folds elsewhere are kept. With `lines`, only hunks that
/// touch these lines.
pub(in crate::lsp) fn edits(
    text: &Text,
    new: &str,
    lines: Option<&RangeInclusive<u32>>,
) -> Vec<(Range<usize>, String)> {
    let old: Vec<&str> = text.code().split_inclusive('\n').collect();
    let new: Vec<&str> = new.split_inclusive('\n').collect();
    let mut out = Vec::new();
    // The offset of each old line.
    let mut starts = vec![0];
    for line in &old {
        starts.push(starts.last().copied().unwrap_or(0) + line.len());
    }
    for (from, put) in hunks(&old, &new) {
        let touched = from.start as u32..=(from.end.max(from.start + 1) - 1) as u32;
        if lines.is_some_and(|l| touched.start() > l.end() || l.start() > touched.end()) {
            continue;
        }
        let bytes = starts.get(from.start).copied().unwrap_or(0)..starts.get(from.end).copied().unwrap_or(0);
        out.push((bytes, new.get(put).unwrap_or_default().concat()));
    }
    out
}
