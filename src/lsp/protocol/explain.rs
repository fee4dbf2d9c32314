//! `hypedc/explain`: the page of a code, which `hypedc explain` prints, for clients that show it themselves.

use gen_lsp_types as types;
use lsp_server::ErrorCode;
use serde::{Deserialize, Serialize};

use super::context::{Context, Failure};
use super::handlers::Answer;
use crate::diagnostic::Code;

/// The request.
pub(super) enum ExplainRequest {}

/// Its parameters.
#[derive(Debug, Serialize, Deserialize)]
pub(super) struct ExplainParams {
    /// Such as `E0201`.
    pub code: String,
}

/// The page of a code.
#[derive(Debug, Serialize, Deserialize)]
pub(super) struct Explanation {
    pub code: String,
    pub title: String,
    /// The whole, with its heading.
    pub markdown: String,
}

impl types::Request for ExplainRequest {
    const METHOD: types::LspRequestMethod<'static> = types::LspRequestMethod::new("hypedc/explain");
    const MESSAGE_DIRECTION: types::MessageDirection = types::MessageDirection::ClientToServer;
    type Params = ExplainParams;
    type Result = Explanation;
}

pub(super) fn explain(_: &Context, params: ExplainParams) -> Answer<ExplainRequest> {
    let code = Code::from_text(&params.code).ok_or_else(|| {
        Failure::new(ErrorCode::InvalidParams, format!("no code `{}`; `hypedc explain` lists all", params.code))
    })?;
    Ok(Explanation { code: code.text().into(), title: code.title().into(), markdown: code.page().into() })
}
