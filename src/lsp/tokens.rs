//! Semantic tokens: the words of a text from the lexer, names coloured by what they name.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use gen_lsp_types as types;
use gen_lsp_types::{SemanticToken, SemanticTokens, SemanticTokensDelta, SemanticTokensEdit, SemanticTokensLegend};

use crate::source::FileId;
use crate::syntax::occurrence::{NameKind, Occurrence, Role};

use super::capabilities::Client;
use super::lexer::{Kind, tokens};
use super::server::{Failure, Server};
use super::snapshot::Snapshot;
use super::text::Text;
use super::uri::path_of;
use super::words::{FUNCTIONS, is_keyword};

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
/// What else is told of a name, as bits.
const MODIFIERS: &[&str] = &["declaration", "readonly", "modification", "defaultLibrary"];

/// What the numbers of tokens mean.
pub(super) fn legend() -> SemanticTokensLegend {
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

/// What was sent last of each document, so that only changes need be sent.
#[derive(Debug, Default)]
pub(super) struct Shown {
    last: BTreeMap<PathBuf, (u64, Vec<SemanticToken>)>,
    count: u64,
}

impl Shown {
    /// A document is closed.
    pub fn forget(&mut self, path: &Path) {
        self.last.remove(path);
    }

    fn keep(&mut self, path: PathBuf, data: Vec<SemanticToken>) -> SemanticTokens {
        self.count += 1;
        self.last.insert(path, (self.count, data.clone()));
        SemanticTokens { result_id: Some(self.count.to_string()), data }
    }
}

impl Server {
    pub(super) fn semantic_tokens(
        &mut self,
        params: types::SemanticTokensParams,
    ) -> Result<Option<SemanticTokens>, Failure> {
        let path = path_of(&params.text_document.uri);
        let Some(data) = self.tokens_of(&path, None) else { return Ok(None) };
        Ok(Some(self.tokens.keep(path, data)))
    }

    pub(super) fn semantic_tokens_in_range(
        &mut self,
        params: types::SemanticTokensRangeParams,
    ) -> Result<Option<SemanticTokens>, Failure> {
        let path = path_of(&params.text_document.uri);
        let data = self.tokens_of(&path, Some(params.range));
        Ok(data.map(|data| SemanticTokens { result_id: None, data }))
    }

    pub(super) fn semantic_tokens_delta(
        &mut self,
        params: types::SemanticTokensDeltaParams,
    ) -> Result<Option<types::SemanticTokensDeltaResponse>, Failure> {
        let path = path_of(&params.text_document.uri);
        let Some(new) = self.tokens_of(&path, None) else { return Ok(None) };
        let before = self.tokens.last.get(&path).filter(|(id, _)| id.to_string() == params.previous_result_id);
        let Some(old) = before.map(|(_, old)| old.clone()) else {
            return Ok(Some(self.tokens.keep(path, new).into()));
        };
        let same = old.iter().zip(&new).take_while(|(a, b)| a == b).count();
        let left = old.len().min(new.len()) - same;
        let same_end = old.iter().rev().zip(new.iter().rev()).take(left).take_while(|(a, b)| a == b).count();
        let put = new.get(same..new.len() - same_end).unwrap_or_default();
        let data =
            put.iter().flat_map(|t| [t.delta_line, t.delta_start, t.length, t.token_type, t.token_modifiers_bitset]);
        let edit = SemanticTokensEdit {
            start: 5 * same as u32,
            delete_count: 5 * (old.len() - same - same_end) as u32,
            data: Some(data.collect()),
        };
        let edits = if edit.delete_count == 0 && put.is_empty() { Vec::new() } else { vec![edit] };
        let result_id = self.tokens.keep(path, new).result_id;
        Ok(Some(SemanticTokensDelta { result_id, edits }.into()))
    }

    fn tokens_of(&self, path: &Path, range: Option<types::Range>) -> Option<Vec<SemanticToken>> {
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
        for o in snapshot.study.occurrences.iter().filter(|o| o.at.file() == file) {
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
                // A token stands in one line: the rows of a map are one each.
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
