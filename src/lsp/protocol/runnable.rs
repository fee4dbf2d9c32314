//! `hypedc/tests`: what can be run in the programs of the workspace, for the lists of editors.

use std::path::Path;

use gen_lsp_types as types;
use serde::{Deserialize, Serialize};

use super::context::Context;
use super::handlers::Answer;
use super::uri::path_of;
use crate::lsp::features::tests::{Named, RunnableWorld, runnable_worlds};
use crate::lsp::text::document_text::Text;

/// The request.
pub(super) enum TestsRequest {}

/// Its parameters.
#[derive(Debug, Default, Serialize, Deserialize)]
#[serde(rename_all = "camelCase", default)]
pub(super) struct TestsParams {
    /// One document; all programs of the workspace without it.
    pub text_document: Option<types::TextDocumentIdentifier>,
}

/// The worlds of a document.
#[derive(Debug, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct DocumentTests {
    pub uri: types::Uri,
    pub worlds: Vec<WorldTests>,
}

/// What can be run of a world.
#[derive(Debug, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct WorldTests {
    #[serde(flatten)]
    pub world: NamedRange,
    /// Whether a map is left open: it needs a level.
    pub is_open: bool,
    pub goals: Vec<NamedRange>,
    pub nevers: Vec<NamedRange>,
    pub tests: Vec<NamedRange>,
}

/// A name with its ranges.
#[derive(Debug, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct NamedRange {
    pub name: String,
    /// From the name to the end of the declaration.
    pub range: types::Range,
    /// The name.
    pub selection_range: types::Range,
}

impl types::Request for TestsRequest {
    const METHOD: types::LspRequestMethod<'static> = types::LspRequestMethod::new("hypedc/tests");
    const MESSAGE_DIRECTION: types::MessageDirection = types::MessageDirection::ClientToServer;
    type Params = TestsParams;
    type Result = Vec<DocumentTests>;
}

/// The worlds of a document, or of all programs of the workspace that have some.
pub(super) fn tests(context: &Context, params: TestsParams) -> Answer<TestsRequest> {
    let of = |path: &Path| {
        let text = context.view.text(path)?;
        let worlds = runnable_worlds(&text).into_iter().map(|world| of_world(context, &text, world)).collect();
        Some(DocumentTests { uri: context.to_protocol().uri(path), worlds })
    };
    Ok(match params.text_document {
        Some(document) => of(&path_of(&document.uri)).into_iter().collect(),
        None => {
            let all = context.view.programs.keys().filter_map(|path| of(path));
            all.filter(|document| !document.worlds.is_empty()).collect()
        }
    })
}

fn of_world(context: &Context, text: &Text, of: RunnableWorld) -> WorldTests {
    let to = context.to_protocol();
    let named = |of: Named| NamedRange {
        range: to.range(text, &of.whole),
        selection_range: to.range(text, &of.bytes),
        name: of.name,
    };
    let all = |of: Vec<Named>| of.into_iter().map(named).collect();
    WorldTests {
        world: named(of.world),
        is_open: of.is_open,
        goals: all(of.goals),
        nevers: all(of.nevers),
        tests: all(of.tests),
    }
}
