//! Repairs unbalanced braces by indentation: one missing brace gives one diagnostic, and everything around it is still
//! checked. Used by the scan, before parsing.

use crate::diagnostic::Diagnostics;
use crate::diagnostic::catalogue::syntax::{MissingOpenBrace, StrayBrace, TooManyErrors, UnclosedBrace};
use crate::ordered::Ordered;
use crate::source::{FileId, Span};

/// One brace of the text.
#[derive(Clone, Copy)]
pub(super) struct Brace {
    pub at: usize,
    pub open: bool,
    /// The indentation of its line.
    pub indent: usize,
    /// Whether it is the first token of its line.
    pub leads: bool,
    /// The start of its line.
    pub line: usize,
}

/// The first token of a line outside parentheses and text.
#[derive(Clone, Copy)]
pub(super) struct LineStart {
    pub line: usize,
    pub token: usize,
    pub indent: usize,
    /// One past the last token of the line.
    pub end: usize,
    /// Whether it is the header of a block and has no brace.
    pub bare_header: bool,
}

/// Text to insert before a byte.
pub(super) struct Insert {
    pub at: usize,
    pub text: &'static str,
}

/// Maximum number of reported unmatched closing braces.
const MAX_STRAYS: usize = 100;

const CLOSE: &str = "\n}\n";
const OPEN: &str = " {";

/// Finds unmatched braces and the positions of missing ones; replaces extra ones in `text` by blanks. Returns the
/// insertions in order.
pub(super) fn repair_braces(
    file: FileId,
    length: usize,
    braces: &[Brace],
    lines: &[LineStart],
    text: &mut [u8],
    diagnostics: &mut Diagnostics,
) -> Vec<Insert> {
    let mut mender =
        BraceRepairer { file, text, diagnostics, inserts: Vec::new(), open: Vec::new(), strays: 0, candidate: None };
    let mut lines = lines.iter().peekable();
    for brace in braces {
        while let Some(line) = lines.next_if(|l| l.token < brace.at) {
            mender.line(*line);
        }
        mender.brace(*brace);
    }
    for line in lines {
        mender.line(*line);
    }
    mender.end(length);
    // A brace missing at an earlier line may be noticed only later.
    mender.inserts.order_by_key(|insert| insert.at);
    mender.inserts
}

struct BraceRepairer<'a> {
    file: FileId,
    text: &'a mut [u8],
    diagnostics: &'a mut Diagnostics,
    inserts: Vec<Insert>,
    open: Vec<Brace>,
    strays: usize,
    /// A closing brace in the middle of its line that closed a block of an earlier line, and that block's opener.
    candidate: Option<(Brace, Brace)>,
}

impl BraceRepairer<'_> {
    fn at(&self, byte: usize) -> Span {
        Span::new(self.file, byte, byte + 1)
    }

    /// Closes open braces, until `keep` holds.
    fn close_until(&mut self, at: usize, seen: usize, keep: impl Fn(&Brace) -> bool) {
        while let Some(top) = self.open.last().copied().filter(|top| !keep(top)) {
            self.unclosed(top, Some(seen));
            self.inserts.push(Insert { at, text: CLOSE });
            self.open.pop();
        }
    }

    fn line(&mut self, line: LineStart) {
        if let Some((stray, opener)) = self.candidate.filter(|(_, opener)| line.indent > opener.indent)
            && self.open.last().is_none_or(|top| top.indent < opener.indent)
        {
            self.stray(stray);
            self.open.push(opener);
        }
        self.candidate = None;
        self.close_until(line.line, line.token, |top| line.indent > top.indent);
        if line.bare_header {
            // The last character, which may have several bytes.
            let last = self.text[..line.end].iter().rposition(|byte| byte & 0xc0 != 0x80);
            let end = Span::new(self.file, last.unwrap_or(0), line.end);
            self.diagnostics.report(MissingOpenBrace { header: end });
            self.inserts.push(Insert { at: line.end, text: OPEN });
            self.open.push(Brace { at: line.end, open: true, indent: line.indent, leads: false, line: line.line });
        }
    }

    fn brace(&mut self, brace: Brace) {
        if brace.open {
            self.open.push(brace);
            return;
        }
        if brace.leads && self.open.iter().any(|o| o.indent == brace.indent) {
            // The brace is aligned with its opener: braces opened inside it are missing theirs.
            self.close_until(brace.at, brace.at, |top| top.indent <= brace.indent);
        }
        if let Some((stray, _)) = self.candidate.filter(|(_, opener)| brace.leads && opener.indent == brace.indent)
            && self.open.last().is_none_or(|top| top.indent < brace.indent)
        {
            // This one matches the opener that the candidate closed.
            self.stray(stray);
            self.candidate = None;
            return;
        }
        match self.open.pop() {
            Some(opener) if opener.line != brace.line && !(brace.leads && opener.indent == brace.indent) => {
                self.candidate = Some((brace, opener));
            }
            Some(_) => {}
            None => self.stray(brace),
        }
    }

    /// Reports an opener, unless it was inserted and already reported as missing.
    fn unclosed(&mut self, opener: Brace, here: Option<usize>) {
        if self.text.get(opener.at) == Some(&b'{') {
            let here = here.map(|byte| self.at(last(&self.text[..byte])));
            let end = self.at(last(self.text));
            self.diagnostics.report(UnclosedBrace { open: self.at(opener.at), here, end });
        }
    }

    fn stray(&mut self, brace: Brace) {
        self.strays += 1;
        if self.strays <= MAX_STRAYS {
            self.diagnostics.report(StrayBrace { at: self.at(brace.at) });
        } else if self.strays == MAX_STRAYS + 1 {
            self.diagnostics.report(TooManyErrors { at: self.at(brace.at) });
        }
        self.text[brace.at] = b' ';
    }

    fn end(&mut self, length: usize) {
        while let Some(top) = self.open.pop() {
            self.unclosed(top, None);
            self.inserts.push(Insert { at: length, text: CLOSE });
        }
    }
}

/// The last byte of a text that is neither white space nor in a comment-only line.
fn last(text: &[u8]) -> usize {
    let mut end = text.len();
    while end > 0 {
        let start = text[..end].iter().rposition(|&b| b == b'\n').map_or(0, |at| at + 1);
        let line = &text[start..end];
        if !line.trim_ascii().is_empty() && !line.trim_ascii().starts_with(b"//") {
            return start + line.trim_ascii_end().len() - 1;
        }
        end = start.saturating_sub(1);
    }
    0
}
