//! The linear scan before parsing: limits on nesting and length (pest recurses on the thread's stack), comments as
//! trivia, unterminated maps, and unbalanced braces.
//!
//! Unbalanced braces are repaired by indentation, so that one missing brace gives one diagnostic and the rest of the
//! file is still checked. The repaired text has additional lines; [`Scan::position`] maps back.

use crate::diagnostic::Diagnostics;
use crate::diagnostic::catalogue::syntax::{
    ExpressionTooLong, LongWord, NestingTooDeep, TooManyTokens, UnterminatedMap,
};
use crate::source::{FileId, Span};

use super::repair::{Brace, Insert, LineStart, repair_braces};

/// Maximum number of open brackets.
pub const MAX_NESTING: usize = 64;
/// Maximum number of operators of an expression.
pub const MAX_OPERATORS: usize = 256;
/// Maximum length of a name or a number, bytes.
pub const MAX_WORD: usize = 255;
/// Maximum number of tokens of a file: each takes far more memory than its text.
pub const MAX_TOKENS: usize = 4_000_000;

/// A `///` comment: it documents what follows.
#[derive(Debug, Clone, Copy)]
pub(super) struct Comment {
    /// Its first byte in the source.
    pub start: u32,
    /// One past its last non-blank byte.
    pub end: u32,
}

/// The output of the scan.
pub(super) struct Scan {
    /// The text to parse; `None` if a limit was exceeded.
    pub text: Option<String>,
    /// All documentation comments.
    pub docs: Vec<Comment>,
    /// Regions whose syntax errors are already reported.
    pub explained: Vec<Span>,
    /// Inserted lines: the position in the repaired text, the number of bytes, and the cumulative number.
    insertions: Vec<(usize, usize, usize)>,
    length: usize,
}

impl Scan {
    /// The source position of a byte of the repaired text.
    pub fn position(&self, mended: usize) -> usize {
        let before = self.insertions.partition_point(|(at, ..)| *at < mended);
        let shift = match before.checked_sub(1).and_then(|last| self.insertions.get(last)) {
            // The byte may be inside an insertion.
            Some(&(at, length, sum)) => sum - length + length.min(mended - at),
            None => 0,
        };
        (mended - shift).min(self.length)
    }

    /// Whether the error at a span is already reported.
    pub fn is_explained(&self, span: Span) -> bool {
        // The regions are sorted and disjoint.
        let before = self.explained.partition_point(|e| e.start() <= span.start());
        before.checked_sub(1).and_then(|last| self.explained.get(last)).is_some_and(|e| e.contains(span))
    }
}

/// Keywords of lines that open a block.
const HEADERS: &[&str] = &["entity", "world", "behavior", "mode", "group", "space", "tiles", "envelope"];

/// Scans a file.
pub(super) fn scan(file: FileId, text: &str, diagnostics: &mut Diagnostics) -> Scan {
    let mut scanner = Scanner::new(file, text, diagnostics);
    scanner.run();
    let is_balanced = scanner.is_balanced && scanner.depth == 0;
    let Scanner { docs, blanks, explained, within_limits, .. } = scanner;
    let mut scan = Scan { text: None, docs, explained, insertions: Vec::new(), length: text.len() };
    if within_limits {
        let mut mended = text.as_bytes().to_vec();
        for (from, to) in blanks {
            for byte in mended.iter_mut().take(to).skip(from) {
                if *byte != b'\n' && *byte != b'\r' {
                    *byte = b' ';
                }
            }
        }
        let inserts = if is_balanced {
            Vec::new()
        } else {
            // Lines and braces are collected only now; all other errors have been reported.
            let mut ignored = Diagnostics::new();
            let mut scanner = Scanner { is_repairing: true, ..Scanner::new(file, text, &mut ignored) };
            scanner.run();
            let Scanner { braces, lines, .. } = scanner;
            repair_braces(file, text.len(), &braces, &lines, &mut mended, diagnostics)
        };
        let mut out = String::with_capacity(mended.len() + 2 * inserts.len());
        let mut done = 0;
        for Insert { at, text } in inserts {
            out.push_str(&String::from_utf8_lossy(&mended[done..at]));
            let sum = scan.insertions.last().map_or(0, |(.., sum)| *sum);
            scan.insertions.push((out.len(), text.len(), sum + text.len()));
            out.push_str(text);
            done = at;
        }
        out.push_str(&String::from_utf8_lossy(&mended[done..]));
        scan.text = Some(out);
    }
    scan
}

struct Scanner<'a> {
    file: FileId,
    text: &'a str,
    bytes: &'a [u8],
    diagnostics: &'a mut Diagnostics,
    docs: Vec<Comment>,
    braces: Vec<Brace>,
    lines: Vec<LineStart>,
    /// Byte ranges to replace by blanks.
    blanks: Vec<(usize, usize)>,
    explained: Vec<Span>,
    within_limits: bool,
    /// Whether braces and lines are collected.
    is_repairing: bool,
    /// Number of open braces.
    depth: i64,
    /// Whether all closing braces so far had an opener.
    is_balanced: bool,
    /// Open parentheses of each open brace, outermost first.
    parens: Vec<usize>,
    tokens: usize,
    operators: usize,
    /// A newline followed the last token, outside parentheses.
    newline: bool,
    /// The last token continues the statement in the next line.
    continues: bool,
    line_start: usize,
    indent: usize,
    line_is_empty: bool,
    /// The end of the last searched line.
    line_end: usize,
    /// No row before this position closes a map without an opening quote.
    no_quote_before: usize,
}

impl<'a> Scanner<'a> {
    fn new(file: FileId, text: &'a str, diagnostics: &'a mut Diagnostics) -> Self {
        Scanner {
            file,
            text,
            bytes: text.as_bytes(),
            diagnostics,
            docs: Vec::new(),
            braces: Vec::new(),
            lines: Vec::new(),
            blanks: Vec::new(),
            explained: Vec::new(),
            within_limits: true,
            is_repairing: false,
            depth: 0,
            is_balanced: true,
            parens: vec![0],
            tokens: 0,
            operators: 0,
            newline: false,
            continues: false,
            line_start: 0,
            indent: 0,
            line_is_empty: true,
            line_end: 0,
            no_quote_before: 0,
        }
    }

    fn run(&mut self) {
        let mut i = 0;
        while i < self.bytes.len() && self.within_limits {
            i = match self.bytes[i] {
                b'\n' => {
                    self.newline = true;
                    self.line_start = i + 1;
                    self.indent = 0;
                    self.line_is_empty = true;
                    i + 1
                }
                b' ' | b'\t' | b'\r' => {
                    if self.line_is_empty {
                        self.indent += 1;
                    }
                    i + 1
                }
                b'/' if self.bytes.get(i + 1) == Some(&b'/') => self.comment(i),
                _ => self.token(i),
            };
        }
    }

    fn line_end(&self, from: usize) -> usize {
        self.bytes[from..].iter().position(|&b| b == b'\n').map_or(self.bytes.len(), |n| from + n)
    }

    /// The end of the current line; a long line is searched once.
    fn this_line_end(&mut self, from: usize) -> usize {
        if self.line_end <= from {
            self.line_end = self.line_end(from);
        }
        self.line_end
    }

    fn comment(&mut self, start: usize) -> usize {
        let end = self.this_line_end(start);
        let body = self.text.get(start..end).unwrap_or("").trim_end();
        if body.starts_with("///") && !body.starts_with("////") {
            // File sizes are limited, so the casts are lossless.
            self.docs.push(Comment { start: start as u32, end: (start + body.len()) as u32 });
        }
        end
    }

    /// Consumes the token at `i` and returns the position after it.
    fn token(&mut self, i: usize) -> usize {
        self.tokens += 1;
        if self.tokens == MAX_TOKENS + 1 {
            self.within_limits = false;
            self.diagnostics.report(TooManyTokens { at: Span::new(self.file, i, i + 1), limit: MAX_TOKENS });
        }
        let rest = &self.bytes[i..];
        let word = word_length(rest);
        let is_word = |w: &str| word == w.len() && rest.starts_with(w.as_bytes());
        // A line that begins with an operator or an arrow goes on with what is before, as the grammar says.
        let joins = is_word("and") || is_word("or") || operator_length(rest) > 0 || rest[0] == b'{';
        let inside = self.parens.last().is_some_and(|&p| p > 0);
        if self.newline && !inside && !self.continues && !joins {
            self.operators = 0;
        }
        self.newline = false;
        self.continues = false;
        if self.line_is_empty {
            self.line_is_empty = false;
            if self.is_repairing && !inside && rest[0] != b'}' && rest[0] != b'{' {
                let bare_header = HEADERS.iter().any(|h| is_word(h));
                self.lines.push(LineStart {
                    line: self.line_start,
                    token: i,
                    indent: self.indent,
                    end: i,
                    bare_header,
                });
            }
            self.one_token(i, true, word)
        } else {
            self.one_token(i, false, word)
        }
    }

    fn one_token(&mut self, i: usize, leads: bool, word: usize) -> usize {
        let is_brace = matches!(self.bytes[i], b'{' | b'}');
        let after = self.brace_or_other(i, leads, word);
        // An opening brace may be alone on the next line.
        let belongs = !leads || self.bytes[i] == b'{' || self.lines.last().is_some_and(|l| l.token == i);
        if let Some(line) = self.lines.last_mut().filter(|_| belongs) {
            line.bare_header &= !is_brace;
            line.end = line.end.max(after);
        }
        after
    }

    fn brace_or_other(&mut self, i: usize, leads: bool, word: usize) -> usize {
        let rest = &self.bytes[i..];
        match rest[0] {
            open @ (b'{' | b'}') => {
                self.depth += if open == b'{' { 1 } else { -1 };
                self.is_balanced &= self.depth >= 0;
                if self.is_repairing {
                    self.braces.push(Brace {
                        at: i,
                        open: open == b'{',
                        indent: self.indent,
                        leads,
                        line: self.line_start,
                    });
                }
                self.operators = 0;
                if open == b'{' {
                    self.parens.push(0);
                    self.check_nesting(i);
                } else if self.parens.len() > 1 {
                    self.parens.pop();
                }
                i + 1
            }
            b'(' => {
                if let Some(depth) = self.parens.last_mut() {
                    *depth += 1;
                }
                self.check_nesting(i);
                i + 1
            }
            b')' => {
                if let Some(depth) = self.parens.last_mut() {
                    *depth = depth.saturating_sub(1);
                }
                i + 1
            }
            b';' => {
                self.operators = 0;
                i + 1
            }
            b',' => {
                self.continues = true;
                i + 1
            }
            b'"' => self.text_or_map(i),
            b'\'' => self.tile_or_prime(i),
            b'-' if rest.starts_with(b"->") => {
                self.continues = true;
                i + 2
            }
            b':' if rest.starts_with(b":=") => {
                self.continues = true;
                i + 2
            }
            _ if operator_length(rest) > 0 => self.operator(i, operator_length(rest)),
            b'=' => {
                self.continues = true;
                i + 1
            }
            _ if word > MAX_WORD => {
                self.within_limits = false;
                self.diagnostics.report(LongWord { at: Span::new(self.file, i, i + 1), length: word, limit: MAX_WORD });
                i + word
            }
            _ if leads && &rest[..word] == b"map" => self.map_without_quote(i, word),
            _ if word > 0 => {
                if matches!(&rest[..word], b"and" | b"or" | b"not") {
                    self.operator(i, word)
                } else {
                    i + word
                }
            }
            _ => i + char_length(rest),
        }
    }

    fn operator(&mut self, i: usize, length: usize) -> usize {
        self.operators += 1;
        self.continues = true;
        if self.operators > MAX_OPERATORS {
            self.within_limits = false;
            self.diagnostics.report(ExpressionTooLong {
                at: Span::new(self.file, i, i + length),
                limit: MAX_OPERATORS,
                unread: true,
            });
        }
        i + length
    }

    fn check_nesting(&mut self, i: usize) {
        let depth = self.parens.len() - 1 + self.parens.iter().sum::<usize>();
        if depth > MAX_NESTING {
            self.within_limits = false;
            self.diagnostics.report(NestingTooDeep { at: Span::new(self.file, i, i + 1), limit: MAX_NESTING });
        }
    }

    /// `'` after a name is a prime; `'c'` is a tile's character.
    fn tile_or_prime(&mut self, i: usize) -> usize {
        let before = i.checked_sub(1).map(|b| self.bytes[b]);
        if before.is_some_and(|b| b == b'\'' || is_word_byte(b)) {
            return i + 1;
        }
        let length = self.bytes.get(i + 1..).map_or(0, char_length);
        if self.bytes.get(i + 1 + length) == Some(&b'\'') { i + length + 2 } else { i + 1 }
    }

    /// Text on one line, or a map: its opening quote ends a line, its closing quote begins one.
    fn text_or_map(&mut self, i: usize) -> usize {
        let end = self.this_line_end(i);
        if let Some(close) = self.bytes[i + 1..end].iter().position(|&b| b == b'"') {
            return i + close + 2;
        }
        // Only the last quote of a line reaches this point.
        let after = self.text.get(i + 1..end).unwrap_or("x").trim();
        if !after.is_empty() && !after.starts_with("//") {
            return i + 1; // an unclosed text: the grammar reports it at its line's end
        }
        let mut line = end + 1;
        while line < self.bytes.len() {
            let line_end = self.line_end(line);
            let row = self.text.get(line..line_end).unwrap_or("").trim();
            if row.starts_with('"') {
                return line + self.bytes[line..line_end].iter().position(|&b| b == b'"').unwrap_or(0) + 1;
            }
            if row.ends_with('"') && !row.contains(char::is_whitespace) {
                // The closing quote is at the end of the last row.
                line = line_end + 1;
                break;
            }
            if is_no_row(row) {
                break;
            }
            line = line_end + 1;
        }
        let stop = line.min(self.bytes.len());
        self.diagnostics.report(UnterminatedMap { open: Span::new(self.file, i, i + 1), opening: false });
        self.explained.push(Span::new(self.file, self.line_start, stop));
        self.blanks.push((i, stop));
        stop.saturating_sub(1).max(i + 1)
    }

    /// `map NAME` whose rows follow without an opening quote, up to a closing one that is alone.
    fn map_without_quote(&mut self, i: usize, word: usize) -> usize {
        let end = self.this_line_end(i);
        let name = self.text.get(i + word..end).unwrap_or("").trim();
        if name.is_empty() || name.contains(|c: char| !(c.is_alphanumeric() || c == '_')) {
            return i + word;
        }
        if end < self.no_quote_before {
            return i + word;
        }
        let mut line = end + 1;
        while line < self.bytes.len() {
            let line_end = self.line_end(line);
            let row = self.text.get(line..line_end).unwrap_or("").trim();
            if row == "\"" {
                self.diagnostics.report(UnterminatedMap { open: Span::new(self.file, i, end), opening: true });
                self.explained.push(Span::new(self.file, self.line_start, line_end));
                self.blanks.push((end, line_end));
                return line_end;
            }
            if is_no_row(row) {
                break;
            }
            line = line_end + 1;
        }
        self.no_quote_before = line;
        i + word
    }
}

/// Whether a line cannot be a row of a map: a map that runs into it has lost a quote.
fn is_no_row(line: &str) -> bool {
    line.contains('"') || line.contains(": ") || line == "}"
}

/// The length of the operator of signs that a text begins with; 0 if there is none.
fn operator_length(bytes: &[u8]) -> usize {
    match bytes {
        [b'+' | b'-' | b'*' | b'/' | b'<' | b'>', ..] => 1,
        [b'=' | b'!', b'=', ..] => 2,
        _ => 0,
    }
}

fn is_word_byte(b: u8) -> bool {
    b.is_ascii_alphanumeric() || b == b'_' || b >= 0x80
}

fn word_length(bytes: &[u8]) -> usize {
    bytes.iter().take_while(|&&b| is_word_byte(b)).count()
}

fn char_length(bytes: &[u8]) -> usize {
    match bytes.first() {
        None => 0,
        Some(b) if *b < 0xc0 => 1,
        Some(b) if *b < 0xe0 => 2,
        Some(b) if *b < 0xf0 => 3,
        Some(_) => 4,
    }
}
