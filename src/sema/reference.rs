//! References: their targets, where they may be read, `spawn` and `destroy`.

use std::collections::BTreeMap;
use std::rc::Rc;
use std::sync::Arc;

use crate::diagnostic::catalogue::names::DuplicateName;
use crate::diagnostic::catalogue::structure::{LostEntry, LostRead};
use crate::diagnostic::catalogue::syntax::Misplaced;
use crate::diagnostic::catalogue::types::TypeMismatch;
use crate::ir::{EntityId, ModeId, Place, RefId, Subject};
use crate::source::Span;
use crate::syntax::ast::{self, Expr, ExprKind, Name};
use crate::syntax::occurrence::Role;

use super::checked::{Action, BoundProbe, Edge, Entity, Given, Spawn, Term, TermKind, Type};
use super::entity::Skeleton;
use super::expression::Scope;
use super::foreign;
use super::names::{Table, unknown};
use super::{Checker, start};

/// The reference, if the whole guard is `lost(…)`.
pub(super) fn lost_by(guard: &Expr) -> Option<Name> {
    match &guard.kind {
        ExprKind::Paren(inner) => lost_by(inner),
        ExprKind::Call(call) if call.function.text == "lost" && call.binding.is_none() => match &*call.arguments {
            [reference] => reference.name(),
            _ => None,
        },
        _ => None,
    }
}

impl Checker<'_> {
    /// A reference of the entity, or an instance bound by a guard, with its entity if known.
    pub(super) fn referred(&self, name: &str, scope: &Scope<'_>) -> Option<(Subject, Option<EntityId>)> {
        if let Some(subject) = self.facts.named(name) {
            return Some((subject, self.facts.entity(subject)));
        }
        let id = *scope.names?.refs.get(name)?;
        let subject = Subject::Ref(id);
        let declared = scope.entity?.refs[id].entity;
        Some((subject, self.facts.entity(subject).or(declared)))
    }

    /// The reference that an expression names.
    pub(super) fn reference(&mut self, e: &Expr, scope: &Scope<'_>) -> Option<(Subject, Option<EntityId>)> {
        if let Some(name) = &e.name() {
            if let Some(found) = self.referred(&name.text, scope) {
                self.record_subject_use(found.0, name, scope);
                return Some(found);
            }
            let known = scope.names.into_iter().flat_map(|n| n.refs.names()).chain(self.facts.names());
            let fact = unknown("reference", &name.text, name.span, known);
            let meant = self.unreferenced(&name.text, scope);
            self.report_unknown(fact.suggestion(meant));
            return None;
        }
        self.diagnostics.report(TypeMismatch {
            at: e.span,
            found: "an expression".into(),
            expected: "the name of a reference".into(),
            help: None,
        });
        None
    }

    /// Whether a name stands for the nearest instance of an entity.
    fn is_nearest(&self, of: Subject) -> bool {
        matches!(of, Subject::Probed(id) if matches!(self.facts.probes.get(id), Some(BoundProbe::Nearest(..))))
    }

    /// Reports an `is` that never holds.
    pub(super) fn never_is(&mut self, of: Subject, subject: &Expr, name: &Name, known: EntityId, scope: &Scope<'_>) {
        let subject = subject.name().map(|name| name.text.to_string()).unwrap_or_default();
        let known = &self.checked.entities[known].name.text;
        let is_declared = match (of, scope.entity) {
            (Subject::Ref(id), Some(me)) => me.refs[id].entity.is_some(),
            _ => false,
        };
        let help = match is_declared {
            true => {
                format!("`{subject}` is declared to refer to `{known}`; `ref {subject}: any` may refer to any entity")
            }
            false if self.is_nearest(of) => format!("`nearest` names a `{known}`"),
            false => format!("here `{subject}` is known to refer to `{known}`: another `is` around this one says so"),
        };
        self.diagnostics.report(TypeMismatch {
            at: name.span,
            found: format!("`{}`", name.text),
            expected: format!("`{known}`"),
            help: Some(help),
        });
    }

    /// Reports a read of a reference that may be none here.
    pub(super) fn readable(&mut self, subject: Subject, name: &Name, span: Span, scope: &Scope<'_>) {
        if self.facts.is_set(subject) {
            return;
        }
        let Subject::Ref(id) = subject else { return };
        let me = scope.entity.map_or("", |entity| &*entity.name.text);
        let Some(reason) = self.lost.reason(me, &name.text) else { return };
        if self.conditions.note_ref(id, span) {
            return;
        }
        if let (true, Some(mode), Some(entity), Some(names)) = (scope.covered, scope.mode, scope.entity, scope.names) {
            let mut around = Some(mode);
            while let Some(at) = around {
                if names.lost[at.0 as usize].contains(&name.text) {
                    self.facts.covered.push((at, id, span));
                    if !self.facts.needs.contains(&id) {
                        self.facts.needs.push(id);
                    }
                    return;
                }
                around = entity.modes[at].parent;
            }
        }
        let covered = scope.covered && scope.mode.is_some();
        let entity = self.entity_name(scope.entity.and_then(|entity| entity.refs[id].entity));
        let name = name.text.to_string();
        self.diagnostics.report(LostRead {
            at: span,
            name,
            entity,
            in_mode: covered,
            why: reason.told(),
            is_unset: reason.is_unset(),
        });
    }

    /// Edges into a mode that reads a reference must ensure that it is not none.
    pub(super) fn lost_entries(&mut self, entity: &Entity, guards: &[Vec<RefId>]) {
        let mut requested: BTreeMap<(ModeId, RefId), Span> = BTreeMap::new();
        for &(mode, reference, at) in &self.facts.covered {
            requested.entry((mode, reference)).or_insert(at);
        }
        for ((mode, reference), read) in requested {
            for (index, edge) in entity.edges.iter().enumerate() {
                if !may_enter(entity, edge, mode) || guards[index].contains(&reference) || sets(edge, reference) {
                    continue;
                }
                self.diagnostics.report(LostEntry {
                    at: edge.span,
                    name: entity.refs[reference].name.text.to_string(),
                    entity: self.entity_name(entity.refs[reference].entity),
                    mode: entity.modes[mode].path.join("."),
                    read,
                });
            }
        }
    }

    /// `into := spawn Entity(…)`
    pub(super) fn spawn(&mut self, spawn: &ast::Spawn, scope: &Scope<'_>) -> Option<Spawn> {
        let into = match &spawn.into {
            Some(variable) => Some(self.reference_place(variable, scope)?),
            None => None,
        };
        let Some(entity) = self.entity_named(&spawn.entity) else {
            let fact = unknown("entity", &spawn.entity.text, spawn.entity.span, self.entities.names());
            self.report_unknown(fact);
            return None;
        };
        if let (Some(into), Some(own)) = (into, scope.entity)
            && let Some(wanted) = own.refs[into].entity.filter(|w| *w != entity)
        {
            let wanted = self.checked.entities[wanted].name.text.to_string();
            self.diagnostics.report(TypeMismatch {
                at: spawn.entity.span,
                found: format!("an instance of `{}`", spawn.entity.text),
                expected: format!("an instance of `{wanted}`"),
                help: None,
            });
        }
        let mut set: Table<()> = Table::new("setting");
        let mut given = Vec::new();
        let mut fits = true;
        for setting in &spawn.settings {
            let written = format!("{}{}", setting.variable.text, "'".repeat(setting.variable.primes as usize));
            if !set.declare(&Name { text: written.into(), span: setting.variable.span }, (), &mut self.diagnostics) {
                continue;
            }
            let value = self.setting(entity, &setting.variable).and_then(|(what, ty)| {
                let term = self.typed(&setting.value, scope, &ty)?;
                Some((what, term))
            });
            fits &= value.is_some();
            given.extend(value);
        }
        start::spawn(&self.checked.entities[entity], &mut given, spawn.span);
        fits.then_some(Spawn { into, entity, given, span: spawn.span })
    }

    /// The meaning of a value name in an entity.
    pub(super) fn value_named(&mut self, id: EntityId, name: &str) -> Option<Given> {
        let entity = &self.checked.entities[id];
        let values = self.values.entry(id).or_insert_with(|| {
            let vars = entity.vars.pairs().map(|(id, v)| (&v.name, Given::Var(id, 0)));
            let refs = entity.refs.pairs().map(|(id, r)| (&r.name, Given::Ref(id)));
            let discretes = entity.discretes.pairs().map(|(id, d)| (&d.name, Given::Discrete(id)));
            let params = entity.params.pairs().map(|(id, p)| (&p.name, Given::Param(id)));
            // They share one name space, in which the first of two equal names wins.
            let all = vars.chain(refs).chain(discretes).chain(params);
            Rc::new(all.map(|(name, what)| (name.text.to_string(), what)).collect())
        });
        values.get(name).copied()
    }

    /// The target of a setting in a `place` or a `spawn`, and the type of its value.
    pub(super) fn setting(&mut self, id: EntityId, variable: &ast::Variable) -> Option<(Given, Type)> {
        let name = &variable.name();
        let of = Arc::clone(&self.checked.entities[id]);
        let named = self.value_named(id, &name.text);
        if let Some(what) = named {
            self.record_value_use(&of, what, name.span, Role::Written);
        }
        match named.filter(|what| variable.primes == 0 || matches!(what, Given::Var(..))) {
            Some(Given::Param(id)) => {
                let ty = match &of.params[id].default.ty {
                    Type::Int => Type::Real,
                    ty => *ty,
                };
                return Some((Given::Param(id), ty));
            }
            Some(Given::Discrete(id)) => return Some((Given::Discrete(id), of.discretes[id].ty)),
            Some(Given::Ref(id)) => return Some((Given::Ref(id), Type::reference(of.refs[id].entity))),
            Some(Given::Var(id, _)) => {
                let degree = self.primes(variable)?;
                return Some((Given::Var(id, degree), Type::Real));
            }
            None => {}
        }
        let known = of.declared_params().map(|(_, p)| &p.name);
        let known = known.chain(of.discretes.iter().map(|d| &d.name)).chain(of.refs.iter().map(|r| &r.name));
        let known = known.chain(of.vars.iter().map(|v| &v.name));
        let meant = foreign::drawn(&of, &name.text);
        let fact = unknown("parameter or variable", &name.text, name.span, known).suggestion(meant);
        self.report_unknown(fact);
        None
    }

    /// Reports a position that a setting sets a second time; `position` is where it comes from.
    pub(super) fn position_is_placed(&mut self, position: Span, setting: &ast::Assignment, what: Given) -> bool {
        let Given::Var(var, 0) = what else { return false };
        if !var.is_position() {
            return false;
        }
        self.diagnostics.report(DuplicateName {
            kind: "the position",
            name: setting.variable.text.to_string(),
            first: position,
            second: setting.span(),
        });
        true
    }

    /// The reference on a left side.
    pub(super) fn reference_place(&mut self, variable: &ast::Variable, scope: &Scope<'_>) -> Option<RefId> {
        let names: &Skeleton = scope.names?;
        let name = &variable.name();
        if variable.primes == 0
            && let Some(&id) = names.refs.get(&name.text)
        {
            if let Some(entity) = scope.entity {
                self.record_value_use(entity, Given::Ref(id), name.span, Role::Written);
            }
            return Some(id);
        }
        if names.vars.get(&name.text).is_some() || names.discretes.get(&name.text).is_some() {
            self.diagnostics.report(TypeMismatch {
                at: variable.span,
                found: "a variable".into(),
                expected: "a reference".into(),
                help: Some(format!("declare `ref {}: ENTITY`", name.text)),
            });
            return None;
        }
        let fact = unknown("reference", &name.text, name.span, names.refs.names());
        self.report_unknown(fact);
        None
    }

    /// `none`, `self`, a reference, or an instance bound by the guard.
    pub(super) fn reference_value(&mut self, e: &Expr, scope: &Scope<'_>) -> Option<Term> {
        match &e.kind {
            ExprKind::NoneRef => Some(Term { kind: TermKind::NoneRef, ty: Type::AnyRef, span: e.span }),
            ExprKind::SelfRef => match scope.me {
                Some(me) => {
                    let kind = TermKind::Instance(Subject::Me);
                    Some(Term { kind, ty: Type::Ref(me), span: e.span })
                }
                None => {
                    self.diagnostics.report(Misplaced {
                        at: e.span,
                        what: "`self`",
                        inside: "a world",
                        belongs: "in an entity; a world names its instances",
                    });
                    None
                }
            },
            _ => {
                let (subject, entity) = self.reference(e, scope)?;
                Some(Term { kind: TermKind::Instance(subject), ty: Type::reference(entity), span: e.span })
            }
        }
    }
}

/// Whether an edge sets a reference to something.
fn sets(edge: &Edge, reference: RefId) -> bool {
    edge.actions.iter().any(|action| match action {
        Action::Update(u) => u.place == Place::Ref(reference) && u.value.kind != TermKind::NoneRef,
        Action::Spawn(s) => s.into == Some(reference),
        Action::Destroy(_) | Action::Send(_) => false,
    })
}

/// Whether taking an edge can enter a mode.
fn may_enter(entity: &Entity, edge: &Edge, mode: ModeId) -> bool {
    let Some(target) = edge.target else { return false };
    let inside = |inner: ModeId, outer: ModeId| {
        let mut at = Some(inner);
        while let Some(m) = at {
            if m == outer {
                return true;
            }
            at = entity.modes[m].parent;
        }
        false
    };
    if inside(target, mode) {
        // An active proper ancestor of the target stays active.
        return target == mode || !inside(edge.source, mode);
    }
    inside(mode, target) && {
        let mut at = mode;
        while at != target {
            let Some(parent) = entity.modes[at].parent else { return false };
            let default = entity.default_mode(&entity.modes[parent].children);
            if default != Some(at) && entity.modes[at].initial_when.is_none() {
                return false;
            }
            at = parent;
        }
        true
    }
}
