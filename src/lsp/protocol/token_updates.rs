//! Semantic tokens as the protocol sends them: whole, or as the difference to what was sent before.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use gen_lsp_types as types;
use gen_lsp_types::{SemanticToken, SemanticTokens, SemanticTokensDelta, SemanticTokensEdit};

use crate::lsp::text::uri::path_of;
use crate::lsp::view::Failure;

use super::server::Server;

/// What was sent last of each document, so that only changes need be sent.
#[derive(Debug, Default)]
pub(super) struct SentTokens {
    last: BTreeMap<PathBuf, (u64, Vec<SemanticToken>)>,
    count: u64,
}

impl SentTokens {
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
    pub(super) fn all_tokens(
        &mut self,
        params: types::SemanticTokensParams,
    ) -> Result<Option<SemanticTokens>, Failure> {
        let path = path_of(&params.text_document.uri);
        let Some(data) = self.view.semantic_tokens(&path, None) else { return Ok(None) };
        Ok(Some(self.tokens.keep(path, data)))
    }

    pub(super) fn tokens_in_range(
        &mut self,
        params: types::SemanticTokensRangeParams,
    ) -> Result<Option<SemanticTokens>, Failure> {
        let path = path_of(&params.text_document.uri);
        let data = self.view.semantic_tokens(&path, Some(params.range));
        Ok(data.map(|data| SemanticTokens { result_id: None, data }))
    }

    pub(super) fn changed_tokens(
        &mut self,
        params: types::SemanticTokensDeltaParams,
    ) -> Result<Option<types::SemanticTokensDeltaResponse>, Failure> {
        let path = path_of(&params.text_document.uri);
        let Some(new) = self.view.semantic_tokens(&path, None) else { return Ok(None) };
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
}
