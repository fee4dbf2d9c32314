//! Formatting of documents: edits that bring a text into its canonical layout, hunk by hunk.

use std::ops::{Range, RangeInclusive};

use crate::format::format;
use crate::source::FileId;

use crate::lsp::text::alignment::hunks;
use crate::lsp::text::document_text::Text;

/// The edits that format a text; with `lines`, only those that touch these lines. `None` if the text has syntax
/// errors.
pub(in crate::lsp) fn formatting(
    text: &Text,
    lines: Option<&RangeInclusive<u32>>,
) -> Option<Vec<(Range<usize>, String)>> {
    formatted(text).map(|new| edits(text, &new, lines))
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
pub(in crate::lsp) fn edits(text: &Text, new: &str, lines: Option<&RangeInclusive<u32>>) -> Vec<(Range<usize>, String)> {
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
