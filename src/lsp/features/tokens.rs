//! Semantic tokens: the words of a text from the lexer, names coloured by what they name.

use std::collections::BTreeMap;
use std::path::Path;

use gen_lsp_types as types;
use gen_lsp_types::{SemanticToken, SemanticTokensLegend};

use crate::source::FileId;
use crate::syntax::occurrence::{NameKind, Occurrence, Role};

use crate::lsp::client::Client;
use crate::lsp::snapshot::Snapshot;
use crate::lsp::text::document_text::Text;
use crate::lsp::text::lexer::{Kind, tokens};
use crate::lsp::text::words::{FUNCTIONS, is_keyword};
use crate::lsp::view::View;

/// The kinds of tokens; their places in this list are what is sent.
const TYPES: &[&str] = &[
    "comment",
    "string",
    "number",
    "keyword",
    "operator",
    "function",
    "class",
    "interface",
    "namespace",
    "enumMember",
    "method",
    "parameter",
    "property",
    "variable",
    "event",
    "label",
    "macro",
    "type",
    "enum",
];
/// What else is reported a name, as bits.
const MODIFIERS: &[&str] = &["declaration", "readonly", "modification", "defaultLibrary"];

/// What the numbers of tokens mean.
pub(in crate::lsp) fn legend() -> SemanticTokensLegend {
    let words = |list: &[&str]| list.iter().map(|w| (*w).to_string()).collect();
    SemanticTokensLegend { token_types: words(TYPES), token_modifiers: words(MODIFIERS) }
}

fn type_index(name: &str) -> u32 {
    TYPES.iter().position(|t| *t == name).unwrap_or_default() as u32
}

/// How a name is coloured.
fn of_name(o: &Occurrence) -> (u32, u32) {
    let name = match o.kind {
        NameKind::Entity => "class",
        NameKind::Behavior => "interface",
        NameKind::World | NameKind::Space => "namespace",
        NameKind::Group => "enum",
        NameKind::Mode => "method",
        NameKind::Value => "enumMember",
        NameKind::Argument | NameKind::Parameter => "parameter",
        NameKind::Constant => "macro",
        NameKind::Variable | NameKind::Discrete => "property",
        NameKind::Reference | NameKind::Touched | NameKind::Instance => "variable",
        NameKind::Button | NameKind::Axis => "event",
        NameKind::Tag => "label",
        NameKind::TileSet => "type",
        NameKind::Goal | NameKind::Never => "function",
    };
    let read_only = matches!(o.kind, NameKind::Constant | NameKind::Parameter | NameKind::Argument);
    let role = match o.role {
        Role::Declared => 1,
        Role::Written => 4,
        Role::Read => 0,
    };
    (type_index(name), role | if read_only { 2 } else { 0 })
}

impl View {
    /// The tokens of a document, or of a range of it; none if it is not open.
    pub fn semantic_tokens(&self, path: &Path, range: Option<types::Range>) -> Option<Vec<SemanticToken>> {
        let document = self.documents.get(path)?;
        let known = self.programs(path).next();
        let of = known.and_then(|known| Some((&*known.now, known.now.file(path)?)));
        let encoding = self.client.encoding;
        let bytes = range.map_or(0..usize::MAX, |range| document.text.bytes(range, encoding));
        Some(encoded(&document.text, of, bytes, &self.client))
    }
}

/// The tokens of some bytes of a text; only names for an editor that colours the rest itself, and finer.
fn encoded(
    text: &Text,
    program: Option<(&Snapshot, FileId)>,
    bytes: std::ops::Range<usize>,
    client: &Client,
) -> Vec<SemanticToken> {
    let code = text.code();
    let mut names: BTreeMap<usize, (u32, u32)> = BTreeMap::new();
    if let Some((snapshot, file)) = program {
        for o in snapshot.ide.occurrences.iter().filter(|o| o.at.file() == file) {
            names.entry(o.at.range().start).or_insert_with(|| of_name(o));
        }
    }
    let (mut out, mut line, mut column) = (Vec::new(), 0, 0);
    let mut push = |at: std::ops::Range<usize>, (token_type, modifiers): (u32, u32)| {
        let range = text.range(at, client.encoding);
        let (start, end) = (range.start, range.end);
        if start.line != end.line || end.character <= start.character {
            return;
        }
        let delta_start = if start.line == line { start.character - column } else { start.character };
        out.push(SemanticToken {
            delta_line: start.line - line,
            delta_start,
            length: end.character - start.character,
            token_type,
            token_modifiers_bitset: modifiers,
        });
        (line, column) = (start.line, start.character);
    };
    let all = tokens(code);
    for (index, token) in all.iter().enumerate() {
        if token.at.end <= bytes.start || token.at.start >= bytes.end {
            continue;
        }
        let word = token.text(code);
        if client.has_grammar && !names.contains_key(&token.at.start) {
            continue;
        }
        let of = match token.kind {
            Kind::Comment => (type_index("comment"), 0),
            Kind::Number => (type_index("number"), 0),
            Kind::Tile => (type_index("string"), 0),
            Kind::Text => {
                // A token is in one line: the rows of a map are one each.
                let mut start = token.at.start;
                for row in word.split_inclusive('\n') {
                    let blank = row.len() - row.trim_start().len();
                    push(start + blank..start + row.trim_end().len().max(blank), (type_index("string"), 0));
                    start += row.len();
                }
                continue;
            }
            Kind::Word => match names.get(&token.at.start) {
                Some(name) => *name,
                None if all.get(index + 1).is_some_and(|next| next.text(code) == "(") && FUNCTIONS.contains(&word) => {
                    (type_index("function"), 8)
                }
                None if is_keyword(word) => (type_index("keyword"), 0),
                None => continue,
            },
            Kind::Symbol if !"(){},.;:".contains(word) => (type_index("operator"), 0),
            Kind::Primes => (type_index("operator"), 0),
            Kind::Symbol | Kind::Newline => continue,
        };
        push(token.at.clone(), of);
    }
    out
}
