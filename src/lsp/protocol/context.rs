//! What handlers read and change, and how a handler's result becomes a response.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::PathBuf;

use gen_lsp_types as types;
use lsp_server::{ErrorCode, Request, RequestId, Response};
use serde::Serialize;

use super::client::Client;
use super::tokens::SentTokens;
use crate::lsp::verdicts::paint::Painted;
use crate::lsp::verdicts::shown::Shown;
use crate::lsp::view::{Refusal, View};

/// An error response to a request.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Failure {
    pub code: i32,
    message: String,
}

impl Failure {
    pub fn new(code: ErrorCode, message: impl Into<String>) -> Self {
        Failure { code: code as i32, message: message.into() }
    }
}

impl From<Refusal> for Failure {
    fn from(Refusal(why): Refusal) -> Self {
        Failure::new(ErrorCode::RequestFailed, why)
    }
}

/// What was painted of a world.
pub(super) struct PaintedWorld {
    pub root: PathBuf,
    pub world: String,
    pub painted: Painted,
}

/// The documents and programs, and what is known about the client.
pub(super) struct Context {
    pub view: View,
    pub client: Client,
    /// The semantic tokens that were last sent.
    pub tokens: SentTokens,
    /// The live verdicts.
    pub verdicts: Shown,
    /// What was painted of the documents as they are now.
    pub painted: Vec<PaintedWorld>,
}

impl Context {
    /// The response to a request with the result of a handler. A panic in the handler becomes an error response.
    pub fn handle<R: types::Request>(
        &mut self,
        request: Request,
        handler: impl FnOnce(&mut Self, R::Params) -> Result<R::Result, Failure>,
    ) -> Response {
        let Request { id, params, .. } = request;
        let result = match serde_json::from_value::<R::Params>(params) {
            Err(error) => Err(Failure::new(ErrorCode::InvalidParams, error.to_string())),
            Ok(params) => catch_unwind(AssertUnwindSafe(|| handler(self, params)))
                .unwrap_or_else(|_| Err(Failure::new(ErrorCode::InternalError, "internal error in hypedc"))),
        };
        response(id, result)
    }
}

/// The response with a result.
pub(super) fn response<T: Serialize>(id: RequestId, result: Result<T, Failure>) -> Response {
    match result.map(serde_json::to_value) {
        // `Response::new_ok` would build the value again.
        Ok(Ok(value)) => Response { id, response_result: Ok(value) },
        Ok(Err(error)) => Response::new_err(id, ErrorCode::InternalError as i32, error.to_string()),
        Err(Failure { code, message }) => Response::new_err(id, code, message),
    }
}
