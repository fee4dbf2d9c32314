//! Signature help: how what is being called is called, and which argument comes.

use gen_lsp_types as types;
use gen_lsp_types::{ParameterInformation, SignatureHelp, SignatureInformation};

use crate::syntax::ast::Item;
use crate::syntax::{self};

use super::place::Place;
use super::server::{Failure, Server};
use super::uri::path_of;
use super::words::SIGNATURES;

impl Server {
    pub(super) fn signature_help(
        &mut self,
        params: types::SignatureHelpParams,
    ) -> Result<Option<SignatureHelp>, Failure> {
        let at = params.text_document_position_params;
        let path = path_of(&at.text_document.uri);
        let Some(document) = self.documents.get(&path) else { return Ok(None) };
        let code = document.text.code();
        let place = Place::of(code, document.text.byte(at.position, self.client.encoding));
        // `near(hero, (x, |` is in a point, which is an argument.
        let Some(call) = place.calls.iter().rev().find(|call| !matches!(call.name, "(" | "," | "")) else {
            return Ok(None);
        };
        let mut ways: Vec<SignatureInformation> = SIGNATURES
            .iter()
            .filter(|s| s.name == call.name)
            .map(|s| signature(s.name, s.parameters.iter().copied(), s.doc))
            .collect();
        if call.before == "use" {
            ways.extend(self.behavior(&path, call.name));
        }
        if ways.is_empty() {
            return Ok(None);
        }
        let fits = |s: &SignatureInformation| s.parameters.as_ref().is_some_and(|p| p.len() > call.argument);
        let active = ways.iter().position(fits).unwrap_or(ways.len() - 1);
        Ok(Some(SignatureHelp {
            signatures: ways,
            active_signature: Some(active as u32),
            active_parameter: Some((call.argument as u32).into()),
        }))
    }

    /// How a behaviour is used.
    fn behavior(&self, path: &std::path::Path, name: &str) -> Option<SignatureInformation> {
        let known = self.programs(path).next()?;
        let sources = &known.now.study.compilation.sources;
        let programs = sources.iter().filter(|(_, file)| file.path.extension().is_some_and(|e| e == "hyped"));
        programs.into_iter().find_map(|(id, file)| {
            let (tree, _) = syntax::parse(id, file.text());
            tree.items.into_iter().find_map(|item| match item {
                Item::Behavior(b) if b.name.text == name => {
                    let doc = b.doc.clone().unwrap_or_default();
                    Some(signature(name, b.parameters.iter().map(|p| p.text.as_str()), &doc))
                }
                _ => None,
            })
        })
    }
}

fn signature<'p>(name: &str, parameters: impl Iterator<Item = &'p str>, doc: &str) -> SignatureInformation {
    let mut label = format!("{name}(");
    let mut places = Vec::new();
    for (index, parameter) in parameters.enumerate() {
        if index > 0 {
            label.push_str(", ");
        }
        // Places in a label count UTF-16 code units.
        let start = label.encode_utf16().count() as u32;
        label.push_str(parameter);
        let end = label.encode_utf16().count() as u32;
        places.push(ParameterInformation { label: (start, end).into(), documentation: None });
    }
    label.push(')');
    SignatureInformation {
        label,
        documentation: (!doc.is_empty()).then(|| doc.to_string().into()),
        parameters: Some(places),
        active_parameter: None,
    }
}
