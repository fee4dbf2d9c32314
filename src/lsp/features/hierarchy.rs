//! Edges as calls: which modes lead into a mode, and where a mode leads.

use crate::ir::ModeId;
use gen_lsp_types as types;
use gen_lsp_types::{CallHierarchyIncomingCall, CallHierarchyItem, CallHierarchyOutgoingCall, SymbolKind};
use serde_json::{Value, json};

use crate::sema::checked::Entity;
use crate::syntax::occurrence::NameKind;

use super::hover::owners;
use crate::lsp::snapshot::Snapshot;
use crate::lsp::view::{Failure, View};

impl View {
    pub(in crate::lsp) fn prepare_calls(
        &self,
        params: types::CallHierarchyPrepareParams,
    ) -> Result<Option<Vec<CallHierarchyItem>>, Failure> {
        let mut out: Vec<CallHierarchyItem> = Vec::new();
        for position in self.positions(&params.text_document_position_params) {
            let snapshot = position.snapshot;
            for o in position.names.iter().filter(|o| o.kind == NameKind::Mode) {
                for (_, entity) in owners(&snapshot.ide.checked, snapshot, o, snapshot.name(o)) {
                    let trace = |span| snapshot.ide.compilation.sources.trace(span).0;
                    let Some(mode) = entity.modes.find(|m| trace(m.name.span) == o.declared) else { continue };
                    let item = self.item(snapshot, entity, mode);
                    if !out.iter().any(|known| known.data == item.data) {
                        out.push(item);
                    }
                }
            }
        }
        Ok((!out.is_empty()).then_some(out))
    }

    pub(in crate::lsp) fn incoming_calls(
        &self,
        params: types::CallHierarchyIncomingCallsParams,
    ) -> Result<Option<Vec<CallHierarchyIncomingCall>>, Failure> {
        let Some((snapshot, entity, mode)) = self.mode_of(&params.item) else { return Ok(None) };
        let into = |id: &ModeId| entity.edges.iter().any(|e| e.source == *id && e.target == Some(mode));
        let calls = entity.modes.ids().filter(into).map(|source| CallHierarchyIncomingCall {
            from: self.item(snapshot, entity, source),
            from_ranges: self.edges(snapshot, entity, source, mode),
        });
        Ok(Some(calls.collect()))
    }

    pub(in crate::lsp) fn outgoing_calls(
        &self,
        params: types::CallHierarchyOutgoingCallsParams,
    ) -> Result<Option<Vec<CallHierarchyOutgoingCall>>, Failure> {
        let Some((snapshot, entity, mode)) = self.mode_of(&params.item) else { return Ok(None) };
        let from = |id: &ModeId| entity.edges.iter().any(|e| e.source == mode && e.target == Some(*id));
        let calls = entity.modes.ids().filter(from).map(|target| CallHierarchyOutgoingCall {
            to: self.item(snapshot, entity, target),
            from_ranges: self.edges(snapshot, entity, mode, target),
        });
        Ok(Some(calls.collect()))
    }

    fn item(&self, snapshot: &Snapshot, entity: &Entity, mode: ModeId) -> CallHierarchyItem {
        let mode = &entity.modes[mode];
        let trace = |span| snapshot.ide.compilation.sources.trace(span).0;
        let (name, whole) = (trace(mode.name.span), trace(mode.span));
        let whole = if whole.contains(name) { whole } else { name };
        CallHierarchyItem {
            name: mode.path.join("."),
            kind: SymbolKind::Method,
            tags: None,
            detail: Some(entity.name.text.to_string()),
            uri: snapshot.uri(name.file()),
            range: snapshot.range(whole, self.client.encoding),
            selection_range: snapshot.range(name, self.client.encoding),
            data: Some(json!({
                "root": snapshot.root, "entity": entity.name.text, "mode": mode.path.join("."),
            })),
        }
    }

    /// The mode of an item that was given out before, if it is still there.
    fn mode_of(&self, item: &CallHierarchyItem) -> Option<(&Snapshot, &Entity, ModeId)> {
        let data = item.data.as_ref()?;
        let text = |key: &str| data.get(key).and_then(Value::as_str);
        let snapshot = &*self.known.get(std::path::Path::new(text("root")?))?.now;
        let entity = snapshot.ide.checked.entities.iter().find(|e| Some(&*e.name.text) == text("entity"))?;
        let mode = entity.modes.find(|m| Some(m.path.join(".").as_str()) == text("mode"))?;
        Some((snapshot, entity, mode))
    }

    /// The edges from a mode to another.
    fn edges(&self, snapshot: &Snapshot, entity: &Entity, source: ModeId, target: ModeId) -> Vec<types::Range> {
        let edges = entity.edges.iter().filter(|e| e.source == source && e.target == Some(target));
        let trace = |span| snapshot.ide.compilation.sources.trace(span).0;
        edges.map(|e| snapshot.range(trace(e.span), self.client.encoding)).collect()
    }
}
