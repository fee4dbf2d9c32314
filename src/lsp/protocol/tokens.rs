//! Encodes semantic tokens for the protocol: complete, by range, or as the delta to the tokens sent before.

use std::collections::BTreeMap;
use std::ops::Range;
use std::path::{Path, PathBuf};

use gen_lsp_types as types;
use gen_lsp_types::{SemanticToken, SemanticTokens, SemanticTokensDelta, SemanticTokensEdit, SemanticTokensLegend};

use super::context::Context;
use super::handlers::Answer;
use super::positions::range;
use super::uri::path_of;
use crate::lsp::features::tokens::{TAG_COLORS, Token, TokenKind, semantic_tokens};
use crate::lsp::text::document_text::{Encoding, Text};
use crate::syntax::occurrence::{NameKind, Role};

/// The token types of the legend; tokens are sent as indices into this list.
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
/// The token modifiers of the legend, before the colours of tags; sent as a bit set.
const MODIFIERS: &[&str] = &["declaration", "readonly", "modification", "defaultLibrary"];
const DECLARATION: u32 = 1;
const READ_ONLY: u32 = 2;
const MODIFICATION: u32 = 4;
const LIBRARY: u32 = 8;

/// The legend: the names of types and modifiers.
pub(super) fn legend() -> SemanticTokensLegend {
    let words = |list: &[&str]| list.iter().map(|w| (*w).to_string()).collect();
    SemanticTokensLegend { token_types: words(TYPES), token_modifiers: words(&[MODIFIERS, &TAG_COLORS].concat()) }
}

/// The index of the type of a token in the legend, and its modifiers.
fn encode_kind(kind: TokenKind) -> (u32, u32) {
    let name = kind.name();
    let type_index = TYPES.iter().position(|t| *t == name).unwrap_or_default() as u32;
    let modifiers = match kind {
        TokenKind::Function => LIBRARY,
        TokenKind::Name(kind, role) => {
            let is_fixed = matches!(kind, NameKind::Constant | NameKind::Parameter | NameKind::Argument);
            of_role(role) | if is_fixed { READ_ONLY } else { 0 }
        }
        TokenKind::Tag(number, role) => of_role(role) | 1 << (MODIFIERS.len() + number),
        _ => 0,
    };
    (type_index, modifiers)
}

fn of_role(role: Role) -> u32 {
    match role {
        Role::Declared => DECLARATION,
        Role::Written => MODIFICATION,
        Role::Read => 0,
    }
}

/// Encodes tokens, each position relative to the preceding token.
fn encoded(text: &Text, tokens: &[Token], encoding: Encoding) -> Vec<SemanticToken> {
    let (mut out, mut line, mut column) = (Vec::new(), 0, 0);
    for token in tokens {
        let types::Range { start, end } = range(text, &token.bytes, encoding);
        if start.line != end.line || end.character <= start.character {
            continue;
        }
        let (token_type, modifiers) = encode_kind(token.kind);
        out.push(SemanticToken {
            delta_line: start.line - line,
            delta_start: if start.line == line { start.character - column } else { start.character },
            length: end.character - start.character,
            token_type,
            token_modifiers_bitset: modifiers,
        });
        (line, column) = (start.line, start.character);
    }
    out
}

/// The tokens last sent for each document, to compute deltas.
#[derive(Debug, Default)]
pub(super) struct SentTokens {
    last: BTreeMap<PathBuf, (u64, Vec<SemanticToken>)>,
    count: u64,
}

impl SentTokens {
    /// Removes a document that was closed.
    pub fn forget(&mut self, path: &Path) {
        self.last.remove(path);
    }

    /// Stores the tokens of a document under a new result id.
    fn store(&mut self, path: PathBuf, data: Vec<SemanticToken>) -> SemanticTokens {
        self.count += 1;
        self.last.insert(path, (self.count, data.clone()));
        SemanticTokens { result_id: Some(self.count.to_string()), data }
    }
}

impl Context {
    /// The encoded tokens in a range of a document; `None` if it is not open.
    fn tokens_of(&self, path: &Path, bytes: &Range<usize>) -> Option<Vec<SemanticToken>> {
        let tokens = semantic_tokens(&self.view, path, bytes, self.client.has_grammar)?;
        Some(encoded(&self.view.documents.get(path)?.text, &tokens, self.client.encoding))
    }
}

pub(super) fn all_tokens(
    context: &mut Context,
    params: types::SemanticTokensParams,
) -> Answer<types::SemanticTokensRequest> {
    let path = path_of(&params.text_document.uri);
    let Some(data) = context.tokens_of(&path, &(0..usize::MAX)) else { return Ok(None) };
    Ok(Some(context.tokens.store(path, data)))
}

pub(super) fn tokens_in_range(
    context: &Context,
    params: types::SemanticTokensRangeParams,
) -> Answer<types::SemanticTokensRangeRequest> {
    let (path, bytes) = context.file_bytes(&params.text_document, params.range);
    let data = context.tokens_of(&path, &bytes);
    Ok(data.map(|data| SemanticTokens { result_id: None, data }))
}

pub(super) fn changed_tokens(
    context: &mut Context,
    params: types::SemanticTokensDeltaParams,
) -> Answer<types::SemanticTokensDeltaRequest> {
    let path = path_of(&params.text_document.uri);
    let Some(new) = context.tokens_of(&path, &(0..usize::MAX)) else { return Ok(None) };
    let before = context.tokens.last.get(&path).filter(|(id, _)| id.to_string() == params.previous_result_id);
    let Some(old) = before.map(|(_, old)| old.clone()) else {
        return Ok(Some(context.tokens.store(path, new).into()));
    };
    let same = old.iter().zip(&new).take_while(|(a, b)| a == b).count();
    let remaining = old.len().min(new.len()) - same;
    let same_end = old.iter().rev().zip(new.iter().rev()).take(remaining).take_while(|(a, b)| a == b).count();
    let inserted = new.get(same..new.len() - same_end).unwrap_or_default();
    let data =
        inserted.iter().flat_map(|t| [t.delta_line, t.delta_start, t.length, t.token_type, t.token_modifiers_bitset]);
    let edit = SemanticTokensEdit {
        start: 5 * same as u32,
        delete_count: 5 * (old.len() - same - same_end) as u32,
        data: Some(data.collect()),
    };
    let edits = if edit.delete_count == 0 && inserted.is_empty() { Vec::new() } else { vec![edit] };
    let result_id = context.tokens.store(path, new).result_id;
    Ok(Some(SemanticTokensDelta { result_id, edits }.into()))
}
