//! Signature help: how what is being called is called, and which argument comes.

use gen_lsp_types as types;
use gen_lsp_types::{ParameterInformation, ParameterInformationLabel, SignatureHelp, SignatureInformation};

use crate::lsp::text::place::Place;
use crate::lsp::text::uri::path_of;
use crate::lsp::text::words::SIGNATURES;
use crate::lsp::view::{Failure, Known, View};

impl View {
    pub(in crate::lsp) fn signature_help(
        &self,
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
        match call.before {
            "use" => ways.extend(self.behavior(&path, call.name)),
            "spawn" => ways.extend(self.spawned(&path, call.name)),
            _ => {}
        }
        if ways.is_empty() {
            return Ok(None);
        }
        let fits = |s: &SignatureInformation| s.parameters.as_ref().is_some_and(|p| p.len() > call.argument);
        let active = ways.iter().position(fits).unwrap_or(ways.len() - 1);
        // What is given by name may come in any order.
        let named = ways.get(active).and_then(|way| {
            let label: Vec<u16> = way.label.encode_utf16().collect();
            way.parameters.as_ref()?.iter().position(|p| match &p.label {
                ParameterInformationLabel::Tuple((start, end)) => {
                    let name = label.get(*start as usize..*end as usize).unwrap_or_default();
                    String::from_utf16_lossy(name) == call.given
                }
                ParameterInformationLabel::String(_) => false,
            })
        });
        Ok(Some(SignatureHelp {
            signatures: ways,
            active_signature: Some(active as u32),
            active_parameter: Some((named.unwrap_or(call.argument) as u32).into()),
        }))
    }

    /// How a behaviour is used.
    fn behavior(&self, path: &std::path::Path, name: &str) -> Option<SignatureInformation> {
        let behavior = self.programs(path).find_map(|known| known.now.behavior(name))?;
        let doc = behavior.doc.unwrap_or_default();
        Some(signature(name, behavior.parameters.iter().map(|p| &*p.text), &doc))
    }
}

impl View {
    /// What an entity can be given where it is spawned.
    fn spawned(&self, path: &std::path::Path, name: &str) -> Option<SignatureInformation> {
        let programs: Vec<&Known> = self.programs(path).collect();
        let states = programs.iter().map(|k| &*k.now).chain(programs.iter().filter_map(|k| k.good.as_deref()));
        let mut entities = states.flat_map(|s| s.ide.checked.entities.iter().map(move |e| (s, e)));
        let (snapshot, entity) = entities.find(|(_, e)| e.name.text == name)?;
        let all = entity.params.iter().map(|p| &p.name).chain(entity.refs.iter().map(|r| &r.name));
        let all = all.chain(entity.vars.iter().map(|v| &v.name)).chain(entity.discretes.iter().map(|d| &d.name));
        let doc = snapshot.doc(entity.name.span).unwrap_or_default();
        Some(signature(name, all.map(|name| &*name.text), &doc))
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
