//! Code lenses: the commands of worlds and questions, the levels of open maps, and the live verdicts.

use gen_lsp_types as types;
use serde_json::{Value, json};

use super::context::Context;
use super::extensions::level_json;
use super::positions;
use crate::lsp::documents::Document;
use crate::lsp::features::hints::{CodeLens, LensCommand, code_lenses};
use crate::lsp::verdicts::verdict::Verdict;
use crate::reach::query::Kind;

/// The lenses of a document.
pub(super) fn lenses(context: &Context, path: &std::path::Path, document: &Document) -> Vec<types::CodeLens> {
    let mut out = Vec::new();
    for CodeLens { bytes, command } in code_lenses(&document.text) {
        let range = positions::range(&document.text, &bytes, context.client.encoding);
        let mut add = |title: String, command: &str, arguments: Vec<Value>| {
            let command = types::Command { title, tooltip: None, command: command.into(), arguments: Some(arguments) };
            out.push(types::CodeLens { range, command: Some(command), data: None });
        };
        let uri = &document.uri;
        match command {
            LensCommand::Simulate { world, is_open: false } => {
                add("▶ simulate".into(), "hypedc.sim", vec![json!(uri), json!(world)]);
            }
            LensCommand::Simulate { world, is_open: true } => {
                let level = context.verdicts.level(path, Some(&world));
                let name = level.map(|level| level.name(path));
                add(
                    "▶ simulate".into(),
                    "hypedc.sim",
                    vec![json!(uri), json!(world), level_argument(context, path, &world)],
                );
                let title = name.map_or("choose a level".into(), |name| format!("level: {name}"));
                add(title, "hypedc.level", vec![json!(uri), json!(world)]);
            }
            LensCommand::Reach { world, kind, name, is_open } => {
                let level = if is_open { level_argument(context, path, &world) } else { Value::Null };
                let search = || {
                    let mut arguments = vec![json!(uri), json!(world), json!(name)];
                    if is_open || kind == Kind::Never {
                        arguments.push(level.clone());
                    }
                    if kind == Kind::Never {
                        arguments.push(json!(kind.name()));
                    }
                    arguments
                };
                if let Some(shown) = context.verdicts.verdict(path, (&world, kind, &name)) {
                    match &shown.asked.verdict {
                        Verdict { way: Some(way), .. } if shown.is_current => {
                            let arguments = [json!(uri), json!(world), json!(name), level.clone(), json!(way.inputs)];
                            add(shown.title(), "hypedc.play", arguments.into());
                        }
                        _ => add(shown.title(), "hypedc.reach", search()),
                    }
                }
                let title = match kind {
                    Kind::Goal => "▶ search for this goal",
                    Kind::Never => "▶ search for a way to break this",
                };
                add(title.into(), "hypedc.reach", search());
            }
        }
    }
    out
}

/// The level of a command about a world with an open map: as it was chosen, or `"ask"`.
fn level_argument(context: &Context, path: &std::path::Path, world: &str) -> Value {
    context.verdicts.level(path, Some(world)).map_or(json!("ask"), level_json)
}
