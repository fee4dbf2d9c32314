//! Modes: their tree, the look-up of a mode by path, edges and updates.

use crate::diagnostic::catalogue::names::{AmbiguousMode, DuplicateName};
use crate::diagnostic::catalogue::structure::{EdgeOutOfGroup, IdleEdge, UpdateConflict};
use crate::diagnostic::catalogue::types::TypeMismatch;
use crate::source::Span;
use crate::syntax::ast::{self, Initial, Member, Path};

use super::checked::{Edge, Entity, Mode, Place, Update};
use super::expression::{Reads, Scope};
use super::ids::{EdgeId, GroupId, Id, ModeId};
use super::names::unknown;
use super::{Checker, MAX_MODES};

/// What a look-up by path needs to know of an entity's modes.
#[derive(Debug, Clone, Default)]
pub(super) struct ModeNames {
    modes: Vec<(Vec<String>, GroupId, Span)>,
}

impl ModeNames {
    pub fn of(entity: &Entity) -> Self {
        ModeNames { modes: entity.modes.iter().map(|m| (m.path.clone(), m.group, m.name.span)).collect() }
    }
}

impl<'a> Checker<'a> {
    /// Adds modes and what they hold to the entity, in preorder; gives the ids of the outermost.
    pub(super) fn mode_skeletons(
        &mut self,
        modes: &[&'a ast::Mode],
        group: GroupId,
        parent: Option<ModeId>,
        path: &[String],
        entity: &mut Entity,
        syntax: &mut Vec<&'a ast::Mode>,
    ) -> Vec<ModeId> {
        let mut ids: Vec<ModeId> = Vec::new();
        for mode in modes {
            if entity.modes.is_full(MAX_MODES) {
                self.too_many("modes", MAX_MODES, mode.name.span);
                return ids;
            }
            if let Some(&first) = ids.iter().find(|&&id| entity.modes[id].name.text == mode.name.text) {
                self.diagnostics.report(DuplicateName {
                    kind: "mode",
                    name: mode.name.text.clone(),
                    first: entity.modes[first].name.span,
                    second: mode.name.span,
                });
                continue;
            }
            let mut full = path.to_vec();
            full.push(mode.name.text.clone());
            let id = entity.modes.push(Mode {
                name: mode.name.clone(),
                doc: mode.doc.clone(),
                path: full.clone(),
                group,
                parent,
                children: Vec::new(),
                marked_initial: mode.initial == Initial::Plain,
                initial_when: None,
                drives: Vec::new(),
                entry: Vec::new(),
                edges: Vec::new(),
                span: mode.span,
            });
            syntax.push(mode);
            let inner: Vec<&ast::Mode> = mode
                .members
                .iter()
                .filter_map(|m| if let Member::Mode(inner) = m { Some(inner) } else { None })
                .collect();
            entity.modes[id].children = self.mode_skeletons(&inner, group, Some(id), &full, entity, syntax);
            ids.push(id);
        }
        ids
    }

    /// The mode that a path names: the whole path, or a suffix that fits only one mode, those of `group` first.
    pub(super) fn mode_named(&mut self, names: &ModeNames, path: &Path, group: Option<GroupId>) -> Option<ModeId> {
        let segments: Vec<&str> = path.segments.iter().map(|s| s.text.as_str()).collect();
        let fits = |mode: &[String]| {
            mode.len() >= segments.len()
                && mode[mode.len() - segments.len()..].iter().zip(&segments).all(|(a, b)| a == b)
        };
        let all: Vec<usize> = (0..names.modes.len()).filter(|&i| path.primes == 0 && fits(&names.modes[i].0)).collect();
        let own: Vec<usize> = all.iter().copied().filter(|&i| Some(names.modes[i].1) == group).collect();
        let whole: Vec<usize> = all.iter().copied().filter(|&i| names.modes[i].0.len() == segments.len()).collect();
        for candidates in [&whole, &own, &all] {
            if let [only] = candidates.as_slice() {
                return Some(ModeId::from_index(*only));
            }
        }
        let written = segments.join(".");
        if all.is_empty() {
            let bare = names.modes.iter().filter_map(|(p, ..)| p.last().map(String::as_str));
            let joined: Vec<String> = names.modes.iter().map(|(p, ..)| p.join(".")).collect();
            let known: Vec<&str> =
                if segments.len() == 1 { bare.collect() } else { joined.iter().map(String::as_str).collect() };
            let mut known_once = known;
            known_once.sort_unstable();
            known_once.dedup();
            let fact = unknown("mode", &written, path.span, known_once);
            self.report_unknown(fact);
            return None;
        }
        let mut fits: Vec<(String, Span)> =
            all.iter().map(|&i| (names.modes[i].0.join("."), names.modes[i].2)).collect();
        fits.truncate(6);
        self.diagnostics.report(AmbiguousMode { name: written, at: path.span, fits });
        None
    }

    /// The body of a mode.
    pub(super) fn mode(&mut self, syntax: &ast::Mode, id: ModeId, scope: &Scope<'_>, entity: &mut Entity) {
        if let Initial::When(guard) = &syntax.initial {
            entity.modes[id].initial_when = self.guard(guard, &scope.reading(Reads::Params));
        }
        for member in &syntax.members {
            match member {
                Member::Flow(flow) => {
                    if let Some(drive) = self.flow(flow, scope) {
                        entity.modes[id].drives.push(drive);
                    }
                }
                Member::Envelope(envelope) => self.envelope(envelope, scope, entity, Some(id)),
                Member::Entry(update) => {
                    if let Some(update) = self.update(update, scope) {
                        self.update_conflict(&entity.modes[id].entry, &update, scope);
                        entity.modes[id].entry.push(update);
                    }
                }
                Member::Edge(edge) => {
                    if let Some(edge) = self.edge(edge, id, scope) {
                        let edge: EdgeId = entity.edges.push(edge);
                        entity.modes[id].edges.push(edge);
                    }
                }
                Member::Mode(_) => {}
                other => self.misplaced(other, "a mode", "in the entity, outside of its modes"),
            }
        }
    }

    fn edge(&mut self, edge: &ast::Edge, source: ModeId, scope: &Scope<'_>) -> Option<Edge> {
        let names = scope.names?;
        let entity = scope.entity?;
        let group = entity.modes[source].group;
        let guard = self.guard(&edge.guard, scope);
        let target = edge.target.as_ref().map(|path| {
            let target = self.mode_named(&names.modes, path, Some(group))?;
            if entity.modes[target].group != group {
                self.diagnostics.report(EdgeOutOfGroup {
                    target: path.span,
                    path: entity.modes[target].path.join("."),
                    declared: entity.modes[target].name.span,
                    own: entity.modes.iter().filter(|m| m.group == group).map(|m| m.path.join(".")).collect(),
                });
                return None;
            }
            Some(target)
        });
        if edge.target.is_none() && edge.is_empty {
            self.diagnostics.report(IdleEdge { at: edge.span });
        }
        let mut updates: Vec<Update> = Vec::new();
        for update in &edge.updates {
            if let Some(update) = self.update(update, scope) {
                self.update_conflict(&updates, &update, scope);
                updates.push(update);
            }
        }
        let target = match target {
            Some(target) => Some(target?),
            None => None,
        };
        Some(Edge { source, target, guard: guard?, updates, span: edge.span })
    }

    /// `y' := e`, `keys := keys + 1`
    fn update(&mut self, update: &ast::Assignment, scope: &Scope<'_>) -> Option<Update> {
        let names = scope.names?;
        let name = &update.variable.name;
        if let Some(&id) = names.discretes.get(&name.text) {
            let v = &update.variable;
            self.unprimed(&Path { segments: vec![v.name.clone()], primes: v.primes, span: v.span })?;
            let discrete = scope.entity?.discretes[id].clone();
            let value = self.typed(&update.value, scope, &discrete.ty)?;
            self.certainly_in_range(&value, &discrete);
            return Some(Update { place: Place::Discrete(id), value, span: update.span });
        }
        if let Some(&var) = names.vars.get(&name.text) {
            let degree = self.primes(&update.variable);
            let value = self.number(&update.value, scope)?;
            return Some(Update { place: Place::Var(var, degree?), value, span: update.span });
        }
        if names.params.get(&name.text).is_some() {
            self.diagnostics.report(TypeMismatch {
                at: update.variable.span,
                found: "a parameter".into(),
                expected: "a variable".into(),
                help: Some(format!(
                    "a parameter never changes; declare `discrete {0}: …` or `continuous {0} = …` for a value that does",
                    name.text
                )),
            });
            return None;
        }
        let fact = unknown("variable", &name.text, name.span, names.vars.names().chain(names.discretes.names()));
        self.report_unknown(fact);
        None
    }

    fn update_conflict(&mut self, before: &[Update], update: &Update, scope: &Scope<'_>) {
        let Some(entity) = scope.entity else { return };
        if let Some(first) = before.iter().find(|u| u.place == update.place) {
            let variable = match update.place {
                Place::Var(var, degree) => {
                    format!("{}{}", entity.vars[var].name.text, "'".repeat(usize::from(degree)))
                }
                Place::Discrete(id) => entity.discretes[id].name.text.clone(),
            };
            self.diagnostics.report(UpdateConflict { variable, first: first.span, second: update.span });
        }
    }
}
