//! Edges between modes as a call hierarchy: the source modes and the target modes of a mode.

use std::ops::Range;
use std::path::PathBuf;

use crate::ir::ModeId;
use crate::sema::checked::Entity;
use crate::source::Span;
use crate::syntax::occurrence::NameKind;

use super::hover::owners;
use super::navigate::positions;
use crate::lsp::location::{FileOffset, Location};
use crate::lsp::snapshot::Snapshot;
use crate::lsp::view::View;

/// A mode identified by names, so that it is valid across snapshots.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(in crate::lsp) struct ModeName {
    /// The path of the program.
    pub root: PathBuf,
    pub entity: String,
    /// The path of the mode, with dots.
    pub mode: String,
}

/// A mode, as an item of the hierarchy.
#[derive(Debug)]
pub(in crate::lsp) struct CallItem {
    pub name: ModeName,
    /// The whole mode.
    pub at: Location,
    /// Its name, in the same text.
    pub name_at: Range<usize>,
}

/// The edges between the requested mode and another one.
#[derive(Debug)]
pub(in crate::lsp) struct Call {
    pub other: CallItem,
    pub edges: Vec<Location>,
}

/// The modes whose names are at a position.
pub(in crate::lsp) fn prepare_calls(view: &View, at: &FileOffset) -> Vec<CallItem> {
    let mut out: Vec<CallItem> = Vec::new();
    for position in positions(view, at) {
        let snapshot = position.snapshot;
        for o in position.names.iter().filter(|o| o.kind == NameKind::Mode) {
            for (_, entity) in owners(&snapshot.ide.checked, snapshot, o, snapshot.name(o)) {
                let Some(mode) = entity.modes.find(|m| source_span(snapshot, m.name.span) == o.declared) else {
                    continue;
                };
                let item = item(snapshot, entity, mode);
                if !out.iter().any(|known| known.name == item.name) {
                    out.push(item);
                }
            }
        }
    }
    out
}

/// The modes with edges to a mode; `None` if it no longer exists.
pub(in crate::lsp) fn incoming_calls(view: &View, name: &ModeName) -> Option<Vec<Call>> {
    let (snapshot, entity, mode) = mode_of(view, name)?;
    let into = |id: &ModeId| entity.edges.iter().any(|e| e.source == *id && e.target == Some(mode));
    let calls = entity
        .modes
        .ids()
        .filter(into)
        .map(|source| Call { other: item(snapshot, entity, source), edges: edges(snapshot, entity, source, mode) });
    Some(calls.collect())
}

/// The modes to which a mode has edges; `None` if it no longer exists.
pub(in crate::lsp) fn outgoing_calls(view: &View, name: &ModeName) -> Option<Vec<Call>> {
    let (snapshot, entity, mode) = mode_of(view, name)?;
    let from = |id: &ModeId| entity.edges.iter().any(|e| e.source == mode && e.target == Some(*id));
    let calls = entity
        .modes
        .ids()
        .filter(from)
        .map(|target| Call { other: item(snapshot, entity, target), edges: edges(snapshot, entity, mode, target) });
    Some(calls.collect())
}

fn item(snapshot: &Snapshot, entity: &Entity, mode: ModeId) -> CallItem {
    let mode = &entity.modes[mode];
    let (name, whole) = (source_span(snapshot, mode.name.span), source_span(snapshot, mode.span));
    let whole = if whole.contains(name) { whole } else { name };
    let (root, path) = (snapshot.root.clone(), mode.path.join("."));
    CallItem {
        name: ModeName { root, entity: entity.name.text.to_string(), mode: path },
        at: snapshot.location(whole),
        name_at: name.range(),
    }
}

/// Looks up a mode in the current snapshot.
fn mode_of<'v>(view: &'v View, name: &ModeName) -> Option<(&'v Snapshot, &'v Entity, ModeId)> {
    let snapshot = &*view.programs.get(&name.root)?.current;
    let entity = snapshot.ide.checked.entities.iter().find(|e| e.name.text == name.entity)?;
    let mode = entity.modes.find(|m| m.path.join(".") == name.mode)?;
    Some((snapshot, entity, mode))
}

/// The locations of the edges from a mode to another.
fn edges(snapshot: &Snapshot, entity: &Entity, source: ModeId, target: ModeId) -> Vec<Location> {
    let edges = entity.edges.iter().filter(|e| e.source == source && e.target == Some(target));
    edges.map(|e| snapshot.location(source_span(snapshot, e.span))).collect()
}

/// The span in the source file, for code that was expanded from a behaviour.
fn source_span(snapshot: &Snapshot, at: Span) -> Span {
    snapshot.ide.compilation.sources.trace(at).0
}
