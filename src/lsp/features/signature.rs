//! Signature help: the signatures of the call at the cursor, and the current argument.

use std::path::Path;

use crate::diagnostic::words::SIGNATURES;
use crate::lsp::location::FileOffset;
use crate::lsp::text::cursor::CursorContext;
use crate::lsp::view::{ProgramState, View};

/// The signatures of a call.
#[derive(Debug)]
pub(in crate::lsp) struct SignatureHelp {
    /// At least one.
    pub signatures: Vec<CallSignature>,
    /// The index of the first signature with enough parameters.
    pub active: usize,
    /// The index of the current argument in that signature.
    pub argument: usize,
}

/// A signature.
#[derive(Debug)]
pub(in crate::lsp) struct CallSignature {
    pub name: String,
    pub parameters: Vec<String>,
    /// May be empty.
    pub doc: String,
}

/// The signatures of the innermost call around a position in an open document.
pub(in crate::lsp) fn signature_help(view: &View, at: &FileOffset) -> Option<SignatureHelp> {
    let document = view.documents.get(&at.path)?;
    let cursor = CursorContext::at(document.text.code(), at.byte);
    // Skip parentheses without a name: `near(hero, (x, |` is in a point.
    let call = cursor.calls.iter().rev().find(|call| !matches!(call.name, "(" | "," | ""))?;
    let mut signatures: Vec<CallSignature> = SIGNATURES
        .iter()
        .filter(|s| s.name == call.name)
        .map(|s| signature(s.name, s.parameters.iter().copied(), s.doc))
        .collect();
    match call.before {
        "use" => signatures.extend(behavior(view, &at.path, call.name)),
        "spawn" => signatures.extend(spawned(view, &at.path, call.name)),
        _ => {}
    }
    let fits = |s: &CallSignature| s.parameters.len() > call.argument;
    let active = signatures.iter().position(fits).or(signatures.len().checked_sub(1))?;
    // Named arguments may be in any order.
    let named = signatures.get(active)?.parameters.iter().position(|parameter| parameter == call.argument_name);
    Some(SignatureHelp { signatures, active, argument: named.unwrap_or(call.argument) })
}

/// The signature of a behaviour, for `use`.
fn behavior(view: &View, path: &Path, name: &str) -> Option<CallSignature> {
    let behavior = view.programs_with(path).find_map(|state| state.current.behavior(name))?;
    let doc = behavior.doc.clone().unwrap_or_default();
    Some(signature(name, behavior.parameters.iter().map(|p| &*p.text), &doc))
}

/// The signature of an entity, for `spawn`: its parameters, references and variables.
fn spawned(view: &View, path: &Path, name: &str) -> Option<CallSignature> {
    let programs: Vec<&ProgramState> = view.programs_with(path).collect();
    let states = programs.iter().map(|k| &*k.current).chain(programs.iter().filter_map(|k| k.last_good.as_deref()));
    let mut entities = states.flat_map(|s| s.ide.checked.entities.iter().map(move |e| (s, e)));
    let (snapshot, entity) = entities.find(|(_, e)| e.name.text == name)?;
    let all = entity.declared_params().map(|(_, p)| &p.name).chain(entity.refs.iter().map(|r| &r.name));
    let all = all.chain(entity.vars.iter().map(|v| &v.name)).chain(entity.discretes.iter().map(|d| &d.name));
    let doc = snapshot.doc(entity.name.span).unwrap_or_default();
    Some(signature(name, all.map(|name| &*name.text), &doc))
}

fn signature<'p>(name: &str, parameters: impl Iterator<Item = &'p str>, doc: &str) -> CallSignature {
    CallSignature { name: name.into(), parameters: parameters.map(str::to_string).collect(), doc: doc.into() }
}
