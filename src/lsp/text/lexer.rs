//! The lexer of the language server: tokens of any text, because incomplete texts have no useful syntax tree.
//! It never fails; unclosed strings end with their line.

use std::ops::Range;

use pest::unicode::{XID_CONTINUE, XID_START};

/// The kind of a token.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::lsp) enum Kind {
    /// A name or a keyword.
    Word,
    /// A number, its unit included.
    Number,
    /// A quoted string, or the rows of a map.
    Text,
    /// A character of a tile set, in single quotes.
    Tile,
    /// `//` to the end of the line.
    Comment,
    /// The primes of a derivative.
    Primes,
    /// Operators, brackets, separators.
    Symbol,
    /// The end of a line.
    Newline,
}

/// A token.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(in crate::lsp) struct Token {
    pub kind: Kind,
    /// Its range in bytes.
    pub at: Range<usize>,
}

impl Token {
    /// Its text.
    pub fn text<'t>(&self, text: &'t str) -> &'t str {
        text.get(self.at.clone()).unwrap_or_default()
    }
}

/// The words of a text, those in comments and quotes, too; some are empty.
pub(in crate::lsp) fn words(text: &str) -> impl Iterator<Item = &str> {
    text.split(|c: char| !(c.is_alphanumeric() || c == '_'))
}

/// Whether a name may start with a character.
pub(in crate::lsp) fn starts_name(c: char) -> bool {
    XID_START(c) || c == '_'
}

/// Whether a name may contain a character after the first one.
pub(in crate::lsp) fn continues_name(c: char) -> bool {
    XID_CONTINUE(c)
}

/// All tokens of a text, without white space other than line feeds.
pub(in crate::lsp) fn tokens(text: &str) -> Tokens<'_> {
    Tokens { text, at: 0, word_end: None }
}

/// The tokens of a text, one after the other: who needs those before a cursor does not wait for the rest.
#[derive(Debug, Clone)]
pub(in crate::lsp) struct Tokens<'t> {
    text: &'t str,
    at: usize,
    /// The end of the last token, if it was a word.
    word_end: Option<usize>,
}

impl Iterator for Tokens<'_> {
    type Item = Token;

    fn next(&mut self) -> Option<Token> {
        let bytes = self.text.as_bytes();
        while let Some(b' ' | b'\t' | b'\r') = bytes.get(self.at) {
            self.at += 1;
        }
        let mut rest = self.text.get(self.at..)?;
        let mut first = rest.chars().next()?;
        while first != '\n' && first.is_whitespace() {
            self.at += first.len_utf8();
            rest = self.text.get(self.at..)?;
            first = rest.chars().next()?;
        }
        let line = || rest.find(['\n', '\r']).unwrap_or(rest.len());
        let (kind, length) = match first {
            '\n' => (Kind::Newline, 1),
            '/' if rest.starts_with("//") => (Kind::Comment, line()),
            '"' => (Kind::Text, quoted(rest, line())),
            '\'' if self.word_end == Some(self.at) => {
                (Kind::Primes, rest.bytes().take_while(|byte| *byte == b'\'').count())
            }
            '\'' => match rest.char_indices().nth(2) {
                Some((second, '\'')) if !rest.get(..second).is_some_and(|tile| tile.contains(['\n', '\r'])) => {
                    (Kind::Tile, second + 1)
                }
                _ => (Kind::Symbol, 1),
            },
            c if starts_name(c) => (Kind::Word, word(rest)),
            c if c.is_ascii_digit() => (Kind::Number, number(rest)),
            c => {
                let two = [b":=", b"+=", b"-=", b"->", b"==", b"!=", b"<=", b">=", b".."];
                let is_two = rest.as_bytes().get(..2).is_some_and(|start| two.iter().any(|op| start == *op));
                (Kind::Symbol, if is_two { 2 } else { c.len_utf8() })
            }
        };
        let at = self.at..self.at + length;
        self.at = at.end;
        self.word_end = (kind == Kind::Word).then_some(at.end);
        Some(Token { kind, at })
    }
}

/// The length of a word. Almost all are ASCII.
fn word(rest: &str) -> usize {
    let ascii = rest.bytes().take_while(|byte| byte.is_ascii_alphanumeric() || *byte == b'_').count();
    match rest.as_bytes().get(ascii) {
        Some(byte) if !byte.is_ascii() => rest.find(|c| !continues_name(c)).unwrap_or(rest.len()),
        _ => ascii,
    }
}

/// The length of a quoted string. It ends in its line, unless that line holds at most a comment, as in maps.
fn quoted(rest: &str, line: usize) -> usize {
    if let Some(end) = rest.get(1..line).and_then(|inside| inside.find('"')) {
        return end + 2;
    }
    let is_map = rest.get(1..line).is_some_and(|inside| inside.trim().is_empty() || inside.trim().starts_with("//"));
    match rest.get(1..).and_then(|inside| inside.find('"')) {
        Some(end) if is_map => end + 2,
        _ => line,
    }
}

/// The length of a number with its unit.
fn number(rest: &str) -> usize {
    let bytes = rest.as_bytes();
    let digits = |from: usize| bytes.iter().skip(from).take_while(|b| b.is_ascii_digit()).count();
    let mut end = digits(0);
    if bytes.get(end) == Some(&b'.') && digits(end + 1) > 0 {
        end += 1 + digits(end + 1);
    }
    end + bytes.iter().skip(end).take_while(|b| b.is_ascii_alphabetic()).count()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn words(text: &str) -> Vec<&str> {
        tokens(text).map(|t| t.text(text)).collect()
    }

    #[test]
    fn words_are_told_apart() {
        assert_eq!(words("y''=-1.5s//x\n'#': a"), ["y", "''", "=", "-", "1.5s", "//x", "\n", "'#'", ":", "a"]);
        assert_eq!(words("0..9 -> é\u{1f40a}"), ["0", "..", "9", "->", "é", "\u{1f40a}"]);
    }

    #[test]
    fn what_is_not_closed_ends_with_its_line() {
        assert_eq!(words("import \"a\nb"), ["import", "\"a", "\n", "b"]);
        assert_eq!(words("map a \"\n..#\n\" b"), ["map", "a", "\"\n..#\n\"", "b"]);
        assert_eq!(words("'"), ["'"]);
    }
}
