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
pub(in crate::lsp) fn tokens(text: &str) -> Vec<Token> {
    let mut out: Vec<Token> = Vec::new();
    let mut at = 0;
    while let Some(rest) = text.get(at..).filter(|rest| !rest.is_empty()) {
        let Some(first) = rest.chars().next() else { break };
        let while_all = |test: &dyn Fn(char) -> bool| rest.find(|c| !test(c)).unwrap_or(rest.len());
        let line = rest.find(['\n', '\r']).unwrap_or(rest.len());
        let follows_word = out.last().is_some_and(|t| t.kind == Kind::Word && t.at.end == at);
        let (kind, length) = match first {
            '\n' => (Kind::Newline, 1),
            c if c.is_whitespace() => {
                at += c.len_utf8();
                continue;
            }
            '/' if rest.starts_with("//") => (Kind::Comment, line),
            '"' => (Kind::Text, quoted(rest, line)),
            '\'' if follows_word => (Kind::Primes, while_all(&|c| c == '\'')),
            '\'' => match rest.char_indices().nth(2) {
                Some((second, '\'')) if second <= line => (Kind::Tile, second + 1),
                _ => (Kind::Symbol, 1),
            },
            c if starts_name(c) => (Kind::Word, while_all(&continues_name)),
            c if c.is_ascii_digit() => (Kind::Number, number(rest)),
            _ => {
                let two =
                    [":=", "+=", "-=", "->", "==", "!=", "<=", ">=", ".."].iter().find(|op| rest.starts_with(**op));
                (Kind::Symbol, two.map_or(first.len_utf8(), |op| op.len()))
            }
        };
        out.push(Token { kind, at: at..at + length });
        at += length;
    }
    out
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
        tokens(text).iter().map(|t| t.text(text)).collect()
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
