//! The types of the server's own requests and notifications. `docs/commands/lsp.md` describes them.

use std::path::{Path, PathBuf};

use gen_lsp_types as types;
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

use super::positions;
use super::uri::{path_of, uri_of};
use crate::lsp::text::document_text::Encoding;
use crate::lsp::verdicts::level::{Candidate, ChosenLevel};
use crate::lsp::verdicts::shown::{Shown, ShownProgram, ShownVerdict};
use crate::reach::query::Kind;
use crate::source::normalize;

/// The parameters of `hypedc/levels` and `hypedc/paint`.
#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct WorldParams {
    pub text_document: types::TextDocumentIdentifier,
    pub world: String,
    /// Whether all levels are wanted, and not only the one that was chosen.
    #[serde(default = "yes")]
    pub all: bool,
}

fn yes() -> bool {
    true
}

/// The parameters of `hypedc/wayTo`.
#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct WayToParams {
    pub text_document: types::TextDocumentIdentifier,
    pub world: String,
    pub space: String,
    /// From the left one, from 0.
    pub column: usize,
    /// From the highest one, from 0.
    pub row: usize,
}

/// The parameters of `hypedc/chooseLevel`.
#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct ChooseLevelParams {
    pub text_document: types::TextDocumentIdentifier,
    pub world: String,
    /// Null forgets the choice.
    pub level: Option<LevelParams>,
}

/// A level: the options of the command line. Files are URIs or paths.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct LevelParams {
    pub map: String,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub legend: Option<String>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tile: Option<(f64, f64)>,
}

/// The path of a level that a client names by a URI or by a path.
pub(super) fn level_path(text: &str) -> PathBuf {
    match text.starts_with("file:") {
        // A part of a project of LDtk is no part of the path.
        true => match text.split_once('#') {
            Some((file, part)) => {
                let mut path = path_of(&types::Uri(file.into())).into_os_string();
                path.push("#");
                path.push(percent_encoding::percent_decode_str(part).decode_utf8_lossy().as_ref());
                path.into()
            }
            None => path_of(&types::Uri(text.into())),
        },
        false => normalize(Path::new(text)),
    }
}

/// A level as clients get it: the options of the command line, with paths.
pub(super) fn level_json(level: &ChosenLevel) -> Value {
    let path = |path: &Path| path.to_string_lossy().into_owned();
    json!(LevelParams { map: path(&level.map), legend: level.legend.as_deref().map(path), tile: level.tile })
}

/// The response to `hypedc/levels`.
pub(super) fn levels(shown: &Shown, (root, world): (&Path, &str), is_open: bool, found: Vec<Candidate>) -> Value {
    let level = |candidate: Candidate| {
        json!({
            "map": candidate.map.to_string_lossy(),
            "name": candidate.name,
            "fits": candidate.misfit.is_none(),
            "why": candidate.misfit,
        })
    };
    json!({
        "isOpen": is_open,
        "chosen": shown.level(root, Some(world)).map(level_json),
        "levels": found.into_iter().map(level).collect::<Vec<Value>>(),
    })
}

/// The parameters of the notification `hypedc/verdicts`.
pub(super) fn verdicts(root: &Path, program: &ShownProgram, encoding: Encoding) -> Value {
    let about = program.about.as_ref();
    let document = about.and_then(|about| about.document(&about.root));
    let uri = document.map_or_else(|| uri_of(root).0, |document| document.uri.clone());
    let all: Vec<Value> = program.verdicts.iter().map(|shown| verdict(program, shown, encoding)).collect();
    json!({ "uri": uri, "version": document.map(|document| document.version), "verdicts": all })
}

fn verdict(program: &ShownProgram, shown: &ShownVerdict, encoding: Encoding) -> Value {
    let (question, verdict) = (&shown.asked.question, &shown.asked.verdict);
    let way = verdict.way.as_ref();
    json!({
        "world": question.world,
        "level": program.levels.get(&question.world).map(level_json),
        "kind": question.kind.name(),
        "name": question.name,
        "range": range(program, shown, encoding),
        "isCurrent": shown.is_current,
        "title": shown.title(),
        "verdict": verdict.conclusion.name(),
        "isGood": verdict.is_good(question.kind),
        "details": verdict.details(),
        "steps": way.map(|way| way.steps),
        "seconds": way.map(|way| way.seconds),
        "inputs": way.map(|way| &way.inputs),
    })
}

/// Where the name of a question is in the text that was asked about.
pub(super) fn range(program: &ShownProgram, shown: &ShownVerdict, encoding: Encoding) -> Option<types::Range> {
    let about = program.about.as_ref()?;
    let compiled = about.ide.compilation.program.as_ref()?;
    let question = &shown.asked.question;
    let id = compiled.world_named(&question.world)?;
    let (world, spans) = (&compiled.worlds[id], &compiled.spans.worlds[id]);
    let span = match question.kind {
        Kind::Goal => spans.goals[world.goal_named(&question.name)?],
        Kind::Never => spans.nevers[world.never_named(&question.name)?],
    };
    Some(positions::range(&about.text(span.file()), &span.range(), encoding))
}
