//! Semantic tokens: the tokens of the lexer, with names classified by the symbols that they refer to.

use std::collections::BTreeMap;
use std::ops::Range;
use std::path::Path;

use crate::source::FileId;
use crate::syntax::occurrence::{NameKind, Role};

use crate::diagnostic::words::SIGNATURES;
use crate::lsp::snapshot::Snapshot;
use crate::lsp::text::lexer::{self, Kind};
use crate::lsp::text::words::is_keyword;
use crate::lsp::view::View;

/// The kind of a token.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::lsp) enum TokenKind {
    Comment,
    /// A quoted string, or a character of a tile set.
    Text,
    Number,
    Keyword,
    Operator,
    /// A function of the language.
    Function,
    Name(NameKind, Role),
    /// A tag, with the number of its colour.
    Tag(usize, Role),
}

/// The colours that the tags of a program get in turn, so that one is recognized in colliders, tile sets and `collide`.
pub(in crate::lsp) const TAG_COLORS: [&str; 6] = ["tag1", "tag2", "tag3", "tag4", "tag5", "tag6"];

impl TokenKind {
    /// What its colour depends on: its name, or the colour of a tag.
    pub fn color(self) -> &'static str {
        match self {
            TokenKind::Tag(number, _) => TAG_COLORS[number],
            kind => kind.name(),
        }
    }

    /// Its name: one of the token types of the protocol.
    pub fn name(self) -> &'static str {
        match self {
            TokenKind::Comment => "comment",
            TokenKind::Text => "string",
            TokenKind::Number => "number",
            TokenKind::Keyword => "keyword",
            TokenKind::Operator => "operator",
            TokenKind::Function => "function",
            TokenKind::Name(kind, _) => type_of_name(kind),
            TokenKind::Tag(..) => type_of_name(NameKind::Tag),
        }
    }
}

/// The token type of a name.
fn type_of_name(kind: NameKind) -> &'static str {
    match kind {
        NameKind::Entity => "class",
        NameKind::Behavior => "interface",
        NameKind::World | NameKind::Space => "namespace",
        NameKind::Group => "enum",
        NameKind::Mode => "method",
        NameKind::Value => "enumMember",
        NameKind::Argument | NameKind::Parameter => "parameter",
        NameKind::Constant => "macro",
        NameKind::Variable | NameKind::Discrete | NameKind::SignalNumber => "property",
        NameKind::Reference | NameKind::Touched | NameKind::Instance => "variable",
        NameKind::Button | NameKind::Axis | NameKind::Chance | NameKind::Signal => "event",
        NameKind::Tag => "label",
        NameKind::TileSet => "type",
        NameKind::Condition | NameKind::Goal | NameKind::Never => "function",
    }
}

/// A token, within one line.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(in crate::lsp) struct Token {
    pub bytes: Range<usize>,
    pub kind: TokenKind,
}

/// The tokens in a range of an open document, in order. `names_only` is for editors whose own grammar highlights the
/// rest in more detail.
pub(in crate::lsp) fn semantic_tokens(
    view: &View,
    path: &Path,
    bytes: &Range<usize>,
    names_only: bool,
) -> Option<Vec<Token>> {
    let document = view.documents.get(path)?;
    let known = view.programs_with(path).next();
    let program = known.and_then(|state| Some((&*state.current, state.current.file(path)?)));
    Some(of_code(document.text.code(), program, bytes, names_only))
}

fn of_code(code: &str, program: Option<(&Snapshot, FileId)>, bytes: &Range<usize>, names_only: bool) -> Vec<Token> {
    let mut names: BTreeMap<usize, TokenKind> = BTreeMap::new();
    if let Some((snapshot, file)) = program {
        let tags = snapshot.ide.checked.tags.iter().enumerate();
        let numbers: BTreeMap<&str, usize> =
            tags.map(|(number, tag)| (&*tag.text, number % TAG_COLORS.len())).collect();
        for o in snapshot.ide.occurrences.iter().filter(|o| o.at.file() == file) {
            let range = o.at.range();
            let tag = code.get(range.clone()).filter(|_| o.kind == NameKind::Tag).and_then(|name| numbers.get(name));
            let kind = tag.map_or(TokenKind::Name(o.kind, o.role), |number| TokenKind::Tag(*number, o.role));
            names.entry(range.start).or_insert(kind);
        }
    }
    let mut out = Vec::new();
    let all: Vec<lexer::Token> = lexer::tokens(code).collect();
    for (index, token) in all.iter().enumerate() {
        if token.at.end <= bytes.start || token.at.start >= bytes.end {
            continue;
        }
        let word = token.text(code);
        // The occurrence of a tag that is not a name is within its quotes.
        let named = names.get(&(token.at.start + usize::from(token.kind == Kind::Text)));
        if names_only && named.is_none() {
            continue;
        }
        let kind = match token.kind {
            Kind::Comment => TokenKind::Comment,
            Kind::Number => TokenKind::Number,
            Kind::Tile => TokenKind::Text,
            Kind::Text => {
                if let Some(tag @ TokenKind::Tag(..)) = named {
                    out.push(Token { bytes: token.at.clone(), kind: *tag });
                    continue;
                }
                // Tokens do not span lines: one per row of a map.
                let mut start = token.at.start;
                for row in word.split_inclusive('\n') {
                    let blank = row.len() - row.trim_start().len();
                    let bytes = start + blank..start + row.trim_end().len().max(blank);
                    out.push(Token { bytes, kind: TokenKind::Text });
                    start += row.len();
                }
                continue;
            }
            Kind::Word => match named {
                Some(name) => *name,
                None if all.get(index + 1).is_some_and(|next| next.text(code) == "(")
                    && SIGNATURES.iter().any(|function| function.name == word) =>
                {
                    TokenKind::Function
                }
                None if is_keyword(word) => TokenKind::Keyword,
                None => continue,
            },
            Kind::Symbol if !"(){},.;:".contains(word) => TokenKind::Operator,
            Kind::Primes => TokenKind::Operator,
            Kind::Symbol | Kind::Newline => continue,
        };
        out.push(Token { bytes: token.at.clone(), kind });
    }
    out
}
