//! Applies the fixes of findings to texts: selects compatible fixes, and edits the text.

use std::collections::BTreeMap;

use super::{Diagnostic, Fix};
use crate::ordered::Ordered;
use crate::source::{FileId, Span};

/// The fixes that can be applied compatible_fixes: of two that touch each other the first is selected. Fixes that fail `may`
/// are skipped.
pub fn compatible_fixes<'d>(
    found: impl IntoIterator<Item = &'d Diagnostic>,
    may: impl Fn(&Fix) -> bool,
) -> Vec<(&'d Diagnostic, &'d Fix)> {
    let mut taken = DisjointSpans::default();
    let mut chosen = Vec::new();
    for d in found {
        let Some(fix) = d.fix.as_ref().filter(|fix| may(fix)) else { continue };
        if !fix.edits.iter().any(|(span, _)| taken.touches(*span)) {
            fix.edits.iter().for_each(|(span, _)| taken.add(*span));
            chosen.push((d, fix));
        }
    }
    chosen
}

/// The edits of fixes, file by file.
pub fn by_file<'d>(fixes: impl IntoIterator<Item = &'d Fix>) -> BTreeMap<FileId, Vec<(Span, &'d str)>> {
    let mut files: BTreeMap<FileId, Vec<(Span, &str)>> = BTreeMap::new();
    for (span, text) in fixes.into_iter().flat_map(|fix| &fix.edits) {
        files.entry(span.file()).or_default().push((*span, text));
    }
    files
}

/// Applies edits to a text; none if they overlap or do not fit it. The spans are places in this text.
pub fn apply_edits(text: &str, edits: &[(Span, &str)]) -> Option<String> {
    let mut edits = edits.to_vec();
    edits.order_by_key(|(span, _)| (span.start(), span.end()));
    let mut out = String::with_capacity(text.len());
    let mut done = 0;
    for (span, new) in edits {
        out.push_str(text.get(done..span.range().start)?);
        out.push_str(new);
        done = span.range().end.max(done);
        text.get(span.range())?;
    }
    out.push_str(text.get(done..)?);
    Some(out)
}

/// Disjoint spans: their ends by their starts.
#[derive(Default)]
struct DisjointSpans(BTreeMap<(FileId, u32), u32>);

impl DisjointSpans {
    fn add(&mut self, span: Span) {
        let end = self.0.entry((span.file(), span.start())).or_default();
        *end = span.end().max(*end);
    }

    /// Whether a span overlaps or touches one of these.
    fn touches(&self, span: Span) -> bool {
        let before = self.0.range((span.file(), 0)..=(span.file(), span.end())).next_back();
        before.is_some_and(|(_, end)| *end >= span.start())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnostic::Code;

    fn at(start: usize, end: usize) -> Span {
        Span::new(FileId(0), start, end)
    }

    #[test]
    fn edits_are_made_in_whatever_order() {
        let edits = [(at(4, 7), "two"), (at(0, 1), "one"), (at(7, 7), "!")];
        assert_eq!(apply_edits("1 + zwo.", &edits).as_deref(), Some("one + two!."));
        assert_eq!(apply_edits("abc", &[(at(0, 2), ""), (at(1, 3), "")]), None, "they overlap");
        assert_eq!(apply_edits("abc", &[(at(2, 9), "")]), None, "past the end");
        assert_eq!(apply_edits("é", &[(at(1, 2), "")]), None, "within a character");
    }

    #[test]
    fn of_fixes_that_touch_the_first_is_taken() {
        let finding = |start, end| Diagnostic::new(Code::UnknownName, "").fix("", at(start, end), "x");
        let found = [finding(0, 3), finding(3, 5), finding(6, 9), finding(6, 9)];
        let chosen = compatible_fixes(&found, |_| true);
        assert_eq!(chosen.iter().map(|(_, fix)| fix.edits[0].0.start()).collect::<Vec<_>>(), [0, 6]);
        assert!(compatible_fixes(&found, |_| false).is_empty());
        assert_eq!(by_file(chosen.iter().map(|(_, fix)| *fix))[&FileId(0)].len(), 2);
    }
}
