//! Findings of the verdicts: an edit has broken what was so before. A warning only if that is a fact: proven, or shown
//! by inputs that were replayed. Beside them, levels that were chosen and do not fit.

use std::path::Path;

use gen_lsp_types::{Code, Diagnostic, DiagnosticSeverity, Range};
use serde_json::{Value, json};

use super::extensions::range;
use super::findings::ByDocument;
use super::positions;
use super::uri::uri_of;
use crate::lsp::snapshot::Snapshot;
use crate::lsp::text::document_text::Encoding;
use crate::lsp::verdicts::level::ChosenLevel;
use crate::lsp::verdicts::shown::{ShownProgram, ShownVerdict};
use crate::reach::Conclusion;
use crate::reach::query::Kind;

/// The findings of the verdicts on a program.
pub(super) fn findings(root: &Path, program: &ShownProgram, encoding: Encoding) -> ByDocument {
    let mut out = ByDocument::new();
    let Some(about) = &program.about else { return out };
    let uri = about.document(root).map_or_else(|| uri_of(root).0, |document| document.uri.clone());
    let found = program.verdicts.iter().filter(|shown| shown.is_current);
    let mut found: Vec<Diagnostic> = found.filter_map(|shown| finding(program, shown, encoding)).collect();
    let misfit =
        |(world, why): (&String, &String)| misfit((root, about), program.levels.get(world)?, world, why, encoding);
    found.extend(program.misfits.iter().filter_map(misfit));
    if !found.is_empty() {
        out.insert(uri, found);
    }
    out
}

/// The level that was chosen for a world cannot be its map.
fn misfit(
    (root, about): (&Path, &Snapshot),
    level: &ChosenLevel,
    world: &str,
    why: &str,
    encoding: Encoding,
) -> Option<Diagnostic> {
    let program = about.ide.compilation.program.as_ref()?;
    let span = program.spans.worlds[program.world_named(world)?].name;
    let range = positions::range(&about.text(span.file()), &span.range(), encoding);
    let message = format!("the chosen level `{}` does not fit `{world}`: {why}", level.name(root));
    Some(diagnostic(range, ("level-misfit", DiagnosticSeverity::Warning), message, json!({ "world": world })))
}

fn diagnostic(range: Range, (code, severity): (&str, DiagnosticSeverity), message: String, data: Value) -> Diagnostic {
    Diagnostic {
        range,
        severity: Some(severity),
        code: Some(Code::String(code.into())),
        code_description: None,
        source: Some("hypedc".into()),
        message: message.into(),
        tags: None,
        related_information: None,
        data: Some(data),
    }
}

fn finding(program: &ShownProgram, shown: &ShownVerdict, encoding: Encoding) -> Option<Diagnostic> {
    let (question, verdict) = (&shown.asked.question, &shown.asked.verdict);
    let broken = shown.asked.broken.as_ref()?;
    let name = &question.name;
    let (code, severity, message) = match (question.kind, verdict.conclusion) {
        (Kind::Never, _) => {
            let seconds = verdict.way.as_ref()?.seconds;
            let message = format!(
                "this edit broke `never {name}`: it was proven before, and inputs break it in {seconds:.2} s now"
            );
            ("broken-never", DiagnosticSeverity::Warning, message)
        }
        (Kind::Goal, Conclusion::ProvenUnreachable) => {
            let why = verdict.reasons.first().map_or(String::new(), |why| format!(": {why}"));
            let message = format!(
                "this edit broke `goal {name}`: it was reached in {:.2} s before, and is proven unreachable now{why}",
                broken.seconds
            );
            ("broken-goal", DiagnosticSeverity::Warning, message)
        }
        (Kind::Goal, _) => {
            let open = match verdict.conclusion {
                Conclusion::Exhausted => "no inputs with axes at -1, 0 and 1 do, which is no proof".to_string(),
                Conclusion::Error => verdict.reasons.first().cloned().unwrap_or_default(),
                _ => format!("{} nodes of a search found no others, which proves nothing", verdict.nodes),
            };
            let message =
                format!("the inputs that reached `goal {name}` in {:.2} s no longer do; {open}", broken.seconds);
            ("lost-way", DiagnosticSeverity::Information, message)
        }
    };
    let message = match &broken.fails {
        Some((_, how)) => format!("{message}\nThe inputs from before: {how}"),
        None => message,
    };
    let inputs = broken.inputs.as_ref().or(verdict.way.as_ref().map(|way| &way.inputs));
    let data = json!({
        "world": question.world,
        "name": name,
        "inputs": inputs,
        "failsAtStep": broken.fails.as_ref().map(|(step, _)| step),
    });
    Some(diagnostic(range(program, shown, encoding)?, (code, severity), message, data))
}
