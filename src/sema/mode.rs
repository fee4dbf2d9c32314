//! Modes: their tree, the look-up of a mode by path, edges and updates.

use crate::ir::{DiscreteId, EdgeId, Function, GroupId, Id, MAX_MODES, ModeId, Place, RefId, Subject};

use std::cell::OnceCell;
use std::collections::BTreeMap;

use crate::diagnostic::catalogue::names::{AmbiguousMode, DuplicateName};
use crate::diagnostic::catalogue::structure::{EdgeOutOfGroup, IdleEdge, UpdateConflict};
use crate::diagnostic::catalogue::syntax::Misplaced;
use crate::diagnostic::catalogue::types::TypeMismatch;
use crate::source::Span;
use crate::syntax::ast::{self, BinaryOp, ExprKind, Initial, Member, PathRef, Word};
use crate::syntax::occurrence::{NameKind, Role};

use super::Checker;
use super::checked::{Action, Discrete, Edge, Entity, Follow, Given, Mode, Term, TermKind, Type, Update};
use super::entity::PendingMode;
use super::expression::{ReadLimit, Scope};
use super::facts::Mark;
use super::foreign;
use super::names::{Candidate, unknown};
use super::operator::arithmetic;

/// What an `else` negates.
enum Otherwise {
    /// There is no `when` before it.
    None,
    /// The guard of the `when`, with the references that it reads and that only an edge on `lost` covers.
    Of(Term, Vec<RefId>),
    /// A guard with an error.
    Unreadable,
}

/// The mode names of an entity, for look-up by path.
#[derive(Debug, Clone, Default)]
pub(super) struct ModeNames {
    pub modes: Vec<(Vec<String>, GroupId, Span)>,
    /// The groups that have names.
    pub groups: Vec<(String, Span)>,
    /// The modes with each last name.
    named: BTreeMap<String, Vec<usize>>,
    /// All names once, in order, each with its first span; computed on demand.
    last: OnceCell<BTreeMap<String, Span>>,
    /// The same for full paths.
    whole: OnceCell<BTreeMap<String, Span>>,
}

impl ModeNames {
    pub fn of(entity: &Entity) -> Self {
        let mut names = ModeNames::default();
        names.groups.extend(entity.groups.iter().filter_map(|g| g.name.as_ref()).map(|n| (n.text.to_string(), n.span)));
        for (index, mode) in entity.modes.iter().enumerate() {
            names.modes.push((mode.path.clone(), mode.group, mode.name.span));
            names.named.entry(mode.name.text.to_string()).or_default().push(index);
        }
        names
    }

    /// The names, or full paths, as candidates for a suggestion.
    fn known(&self, whole: bool) -> impl Iterator<Item = Candidate<'_>> {
        let made = if whole { &self.whole } else { &self.last };
        let known = made.get_or_init(|| {
            let mut known = BTreeMap::new();
            // What holds in all modes is not entered.
            for (path, _, at) in self.modes.iter().filter(|(path, ..)| path.last().is_none_or(|last| last != "always"))
            {
                let text = if whole { path.join(".") } else { path.last().cloned().unwrap_or_default() };
                known.entry(text).or_insert(*at);
            }
            known
        });
        known.iter().map(|(text, at)| Candidate { text, at: Some(*at) })
    }
}

impl Checker<'_> {
    /// Adds modes and their contents to the entity, and their syntax to its body, in preorder; returns the ids of the
    /// outermost modes.
    pub(super) fn mode_skeletons<'t>(
        &mut self,
        modes: Vec<PendingMode<'t>>,
        group: GroupId,
        parent: Option<ModeId>,
        path: &[String],
        entity: &mut Entity,
        body: &mut Vec<PendingMode<'t>>,
    ) -> Vec<ModeId> {
        let mut ids: Vec<ModeId> = Vec::new();
        let mut named: BTreeMap<Word, Span> = BTreeMap::new();
        for mut pending in modes {
            let mode = pending.syntax;
            if entity.modes.is_full(MAX_MODES) {
                self.too_many("modes", MAX_MODES, mode.name.span);
                return ids;
            }
            self.record_declaration(NameKind::Mode, &mode.name);
            let first = *named.entry(mode.name.text.clone()).or_insert(mode.name.span);
            if first != mode.name.span {
                let (name, second) = (mode.name.text.to_string(), mode.name.span);
                self.diagnostics.report(DuplicateName { kind: "mode", name, first, second });
                continue;
            }
            let mut full = path.to_vec();
            full.push(mode.name.text.to_string());
            let id = entity.modes.push(Mode {
                name: mode.name.clone(),
                doc: mode.doc.as_deref().map(String::from),
                path: full.clone(),
                group,
                parent,
                children: Vec::new(),
                marked_initial: mode.initial == Initial::Plain,
                is_always: mode.initial == Initial::Always,
                initial_when: None,
                drives: Vec::new(),
                entry: Vec::new(),
                edges: Vec::new(),
                follows: Vec::new(),
                span: mode.span,
            });
            let is_inner = |member: &Member| matches!(member, Member::Mode(m) if m.initial != Initial::Always);
            let is_always = mode.initial == Initial::Always;
            let inner = pending.members.extract_if(.., |member| !is_always && is_inner(member));
            let inner = inner
                .filter_map(|member| if let Member::Mode(inner) = member { Some((&**inner).into()) } else { None });
            let inner: Vec<PendingMode<'_>> = inner.collect();
            body.push(pending);
            entity.modes[id].children = self.mode_skeletons(inner, group, Some(id), &full, entity, body);
            ids.push(id);
        }
        ids
    }

    /// The mode of a path: a full path, or a suffix that fits only one mode, preferring those of `group`.
    pub(super) fn mode_named(
        &mut self,
        names: &ModeNames,
        path: &PathRef<'_>,
        group: Option<GroupId>,
    ) -> Option<ModeId> {
        let segments: Vec<&str> = path.segments.iter().map(|s| &*s.text).collect();
        let fits = |mode: &[String]| {
            mode.len() >= segments.len()
                && mode[mode.len() - segments.len()..].iter().zip(&segments).all(|(a, b)| a == b)
        };
        let named = segments.last().filter(|_| path.primes == 0).and_then(|last| names.named.get(*last));
        let all: Vec<usize> = named.into_iter().flatten().copied().filter(|&i| fits(&names.modes[i].0)).collect();
        let own: Vec<usize> = all.iter().copied().filter(|&i| Some(names.modes[i].1) == group).collect();
        let whole: Vec<usize> = all.iter().copied().filter(|&i| names.modes[i].0.len() == segments.len()).collect();
        // Names in a behaviour refer to modes of the same `use`.
        let same_use = |i: &usize| path.span.is_copy() && names.modes[*i].2.file() == path.span.file();
        let used: Vec<usize> = all.iter().copied().filter(same_use).collect();
        for candidates in [&used, &whole, &own, &all] {
            if let [only] = candidates.as_slice() {
                self.record_mode_use(names, *only, path);
                return Some(ModeId::from_index(*only));
            }
        }
        let written = segments.join(".");
        if all.is_empty() {
            let mut fact = unknown("mode", &written, path.span, names.known(segments.len() > 1));
            let is_removal = ["destroyed", "removed", "deleted", "gone"].contains(&written.as_str());
            if is_removal && group.is_some() {
                fact = fact.declared_by("an edge that removes its instance has no target: `{ destroy self }`".into());
            }
            self.report_unknown(fact);
            return None;
        }
        let mut fits: Vec<(String, Span)> =
            all.iter().map(|&i| (names.modes[i].0.join("."), names.modes[i].2)).collect();
        fits.truncate(6);
        self.diagnostics.report(AmbiguousMode { name: written, at: path.span, fits });
        None
    }

    /// Checks the body of a mode. Adds to `tested`, for each edge of the entity, the references that its guard tests.
    pub(super) fn mode(
        &mut self,
        PendingMode { syntax, members }: PendingMode<'_>,
        id: ModeId,
        scope: &Scope<'_>,
        entity: &mut Entity,
        tested: &mut Vec<Vec<RefId>>,
    ) {
        let edges = &scope.reading(ReadLimit::Edges);
        if let Initial::When(guard) = &syntax.initial {
            entity.modes[id].initial_when = self.guard(guard, &scope.reading(ReadLimit::Params));
        }
        let is_always = syntax.initial == Initial::Always;
        let mut otherwise = Otherwise::None;
        let mut members = members.into_iter().peekable();
        while let Some(member) = members.next() {
            let is_else = |next: &&Member| matches!(next, Member::Edge(edge) if edge.guard.kind == ExprKind::Else);
            let before = std::mem::replace(&mut otherwise, Otherwise::None);
            match member {
                Member::Flow(_) | Member::Envelope(_) if is_always => {
                    self.misplaced(member, "`always`", "in the entity, where it holds in all modes");
                }
                Member::Entry(_) if is_always => {
                    self.misplaced(member, "`always`, which is never entered", "on an edge: `when GUARD { … }`");
                }
                Member::Flow(flow) => {
                    if let Some(drive) = self.flow(flow, scope) {
                        entity.modes[id].drives.push(drive);
                    }
                }
                Member::Envelope(envelope) => self.envelope(envelope, scope, entity, Some(id)),
                Member::Entry(update) => {
                    // Entry actions read the state before the edge, when the mode was not active.
                    let scope = Scope { covered: false, ..*edges };
                    self.action(update, &scope, &mut entity.modes[id].entry);
                }
                Member::Edge(edge) => {
                    let has_else = edge.guard.kind != ExprKind::Else && members.peek().is_some_and(is_else);
                    let mark = self.facts.mark();
                    let guard = self.edge_guard(&edge.guard, before, edges);
                    if has_else {
                        let negation = guard.clone().map(|when| (when, self.facts.needs.clone()));
                        otherwise = negation.map_or(Otherwise::Unreadable, |(when, needs)| Otherwise::Of(when, needs));
                    }
                    if let Some((edge, tests)) = self.edge(edge, (guard, mark), id, edges) {
                        let edge: EdgeId = entity.edges.push(edge);
                        entity.modes[id].edges.push(edge);
                        tested.push(tests);
                    }
                }
                Member::Follow(follow) => {
                    if let Some(follow) = self.follow(follow, edges) {
                        entity.modes[id].follows.push(follow);
                    }
                }
                Member::Use(_) | Member::Condition(_) => {}
                Member::Mode(_) if is_always => self.misplaced(member, "`always`", "beside it, in the entity"),
                other => self.misplaced(other, "a mode", "in the entity, outside of its modes"),
            }
        }
        self.update_conflicts(&entity.modes[id].entry, entity);
    }

    /// The guard of an edge: that of its `when`, or for `else` the negation of `before`, with the references that it
    /// reads and that only an edge on `lost` covers.
    fn edge_guard(&mut self, guard: &ast::Expr, before: Otherwise, scope: &Scope<'_>) -> Option<Term> {
        self.facts.needs.clear();
        if guard.kind != ExprKind::Else {
            self.facts.bindable = true;
            let checked = self.guard(guard, scope);
            self.facts.bindable = false;
            return checked;
        }
        match before {
            Otherwise::Of(when, needs) => {
                self.facts.needs = needs;
                Some(Term { kind: TermKind::Not(Box::new(when)), ty: Type::Bool, span: guard.span })
            }
            Otherwise::Unreadable => None,
            Otherwise::None => {
                self.diagnostics.report(Misplaced {
                    at: guard.span,
                    what: "`else`",
                    inside: "a mode without a `when` before it",
                    belongs: "directly after the `when` that it is the other case of",
                });
                None
            }
        }
    }

    /// An edge with its guard, and the references that the guard tests. What was learned since the mark is forgotten.
    fn edge(
        &mut self,
        edge: &ast::Edge,
        (guard, mark): (Option<Term>, Mark),
        source: ModeId,
        scope: &Scope<'_>,
    ) -> Option<(Edge, Vec<RefId>)> {
        let names = scope.names?;
        let entity = scope.entity?;
        let group = entity.modes[source].group;
        if let Some(guard) = &guard {
            self.facts.learn(guard, true);
        }
        let tests = self.facts.set_refs();
        let target = edge.target.as_ref().map(|path| {
            let target = self.mode_named(&names.modes, &path.view(), Some(group))?;
            if entity.modes[target].group != group {
                self.diagnostics.report(EdgeOutOfGroup {
                    target: path.span(),
                    path: entity.modes[target].path.join("."),
                    declared: entity.modes[target].name.span,
                    is_always: entity.modes[source].is_always,
                    own: entity.modes.iter().filter(|m| m.group == group).map(|m| m.path.join(".")).collect(),
                });
                return None;
            }
            Some(target)
        });
        if edge.target.is_none() && edge.is_empty {
            self.diagnostics.report(IdleEdge { at: edge.span });
        }
        let lost = self.conditions.lost_by(&edge.guard, source, entity);
        let lost = lost.and_then(|name| names.refs.get(&name.text).copied());
        let written = edge.updates.len();
        let mut actions: Vec<Action> = Vec::with_capacity(written);
        for update in &edge.updates {
            self.action(update, scope, &mut actions);
        }
        self.update_conflicts(&actions, entity);
        self.facts.forget(mark);
        let needs = std::mem::take(&mut self.facts.needs);
        let target = match target {
            Some(target) => Some(target?),
            None => None,
        };
        // References covered by an edge on `lost` of an enclosing mode are not none when this edge is taken.
        let mut tests: Vec<RefId> = tests;
        let mut around = Some(source);
        while let Some(at) = around {
            tests.extend(names.lost[at.index()].iter().filter_map(|name| names.refs.get(name).copied()));
            around = entity.modes[at].parent;
        }
        if let Some(lost) = lost {
            tests.retain(|r| *r != lost);
        }
        if actions.len() < written {
            // Unreadable updates may set any of them.
            tests.extend(entity.refs.ids());
        }
        Some((Edge { source, target, guard: guard?, actions, lost, needs, span: edge.span }, tests))
    }

    /// `follow links when guard { … }`
    fn follow(&mut self, follow: &ast::Follow, scope: &Scope<'_>) -> Option<Follow> {
        let mark = self.facts.mark();
        self.facts.needs.clear();
        self.facts.bindable = true;
        let guard = follow.guard.as_ref().map(|g| self.guard(g, scope));
        self.facts.bindable = false;
        if let Some(Some(guard)) = &guard {
            self.facts.learn(guard, true);
        }
        let mut actions = Vec::new();
        for update in &follow.updates {
            self.action(update, scope, &mut actions);
        }
        if let Some(entity) = scope.entity {
            self.update_conflicts(&actions, entity);
        }
        self.facts.forget(mark);
        let needs = std::mem::take(&mut self.facts.needs);
        let guard = match guard {
            Some(guard) => Some(guard?),
            None => None,
        };
        Some(Follow { guard, actions, needs, span: follow.span })
    }

    /// Adds an update, a `spawn`, a `destroy` or a `send` to the actions of an edge or entry.
    fn action(&mut self, update: &ast::Update, scope: &Scope<'_>, before: &mut Vec<Action>) {
        let action = match update {
            ast::Update::Assign(assignment) => self.update(assignment, scope).map(Action::Update),
            ast::Update::Spawn(spawn) => self.spawn(spawn, scope).map(Action::Spawn),
            ast::Update::Destroy(destroy) => self.destroyed(&destroy.what, scope).map(Action::Destroy),
            ast::Update::Send(send) => self.send(send, scope).map(Action::Send),
        };
        before.extend(action);
    }

    /// The value of `keys += e`: it stops at the ends of the range.
    fn adjusted_count(
        &mut self,
        update: &ast::Assignment,
        operator: BinaryOp,
        (id, discrete): (DiscreteId, &Discrete),
        scope: &Scope<'_>,
    ) -> Option<Term> {
        if discrete.ty != Type::Int {
            self.not_adjustable(update, "a value that is no number");
            return None;
        }
        let ((low, high), span) = (discrete.range, update.span());
        let by = self.typed(&update.value, scope, &Type::Int)?;
        let now = Term { kind: TermKind::Discrete(Subject::Me, id), ty: Type::Int, span };
        let sum = arithmetic(operator, [now, by], span)?;
        let end = |at: i32| Term { kind: TermKind::Number(f64::from(at)), ty: Type::Int, span };
        let kind = TermKind::Call(Box::new((Function::Clamp, [sum, end(low), end(high)].into())));
        Some(Term { kind, ty: Type::Int, span })
    }

    fn not_adjustable(&mut self, update: &ast::Assignment, found: &str) {
        self.diagnostics.report(TypeMismatch {
            at: update.variable.span,
            found: found.into(),
            expected: "a number".into(),
            help: Some("`+=` and `-=` change numbers; `:=` sets any value".into()),
        });
    }

    /// `y' := e`, `keys += 1`
    fn update(&mut self, update: &ast::Assignment, scope: &Scope<'_>) -> Option<Update> {
        let names = scope.names?;
        let name = &update.variable.name();
        if let Some(&id) = names.discretes.get(&name.text) {
            if let Some(entity) = scope.entity {
                self.record_value_use(entity, Given::Discrete(id), name.span, Role::Written);
            }
            self.unprimed(&update.variable.path())?;
            let discrete = scope.entity?.discretes[id].clone();
            let value = match update.operator {
                Some(operator) => self.adjusted_count(update, operator, (id, &discrete), scope)?,
                None => self.typed(&update.value, scope, &discrete.ty)?,
            };
            self.certainly_in_range(&value, &discrete);
            return Some(Update { place: Place::Discrete(id), value, span: update.span() });
        }
        if let Some(&id) = names.refs.get(&name.text) {
            self.reference_place(&update.variable, scope)?;
            if update.operator.is_some() {
                self.not_adjustable(update, "a reference");
                return None;
            }
            let ty = Type::reference(scope.entity?.refs[id].entity);
            let value: Term = self.typed(&update.value, scope, &ty)?;
            return Some(Update { place: Place::Ref(id), value, span: update.span() });
        }
        if let Some(&var) = names.vars.get(&name.text) {
            if let Some(entity) = scope.entity {
                self.record_value_use(entity, Given::Var(var, 0), name.span, Role::Written);
            }
            let degree = self.primes(&update.variable);
            let mut value = self.number(&update.value, scope)?;
            if let Some(operator) = update.operator {
                let span = update.span();
                let now = Term { kind: TermKind::Var(Subject::Me, var, degree?), ty: Type::Real, span };
                value = arithmetic(operator, [now, value], span)?;
            }
            return Some(Update { place: Place::Var(var, degree?), value, span: update.span() });
        }
        if self.visible_condition(&name.text, scope).is_some() {
            self.diagnostics.report(TypeMismatch {
                at: update.variable.span,
                found: "a condition".into(),
                expected: "a variable".into(),
                help: Some("a condition follows from what it reads; a `discrete … : bool` keeps a value".into()),
            });
            return None;
        }
        if names.signals.get(&name.text).is_some() {
            self.diagnostics.report(TypeMismatch {
                at: update.variable.span,
                found: "a signal".into(),
                expected: "a variable".into(),
                help: Some(format!("`send self.{}` sends it to this instance", name.text)),
            });
            return None;
        }
        if let Some(help) = scope.entity.and_then(|entity| foreign::drawn(entity, &name.text)) {
            self.diagnostics.report(TypeMismatch {
                at: update.variable.span,
                found: "a chance".into(),
                expected: "a variable".into(),
                help: Some(help),
            });
            return None;
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
        let fact = unknown(
            "variable",
            &name.text,
            name.span,
            names.vars.names().chain(names.discretes.names()).chain(names.refs.names()),
        );
        self.report_unknown(fact);
        None
    }

    /// Variables that the updates of one edge or entry set twice.
    fn update_conflicts(&mut self, actions: &[Action], entity: &Entity) {
        let mut first: BTreeMap<Place, Span> = BTreeMap::new();
        for (place, second) in actions.iter().filter_map(written) {
            let Some(&first) = first.get(&place) else {
                first.insert(place, second);
                continue;
            };
            let variable = match place {
                Place::Var(var, degree) => {
                    format!("{}{}", entity.vars[var].name.text, "'".repeat(usize::from(degree)))
                }
                Place::Discrete(id) => entity.discretes[id].name.text.to_string(),
                Place::Ref(id) => entity.refs[id].name.text.to_string(),
            };
            self.diagnostics.report(UpdateConflict { variable, first, second });
        }
    }
}

/// The target and the span of an action.
fn written(action: &Action) -> Option<(Place, Span)> {
    match action {
        Action::Update(update) => Some((update.place, update.span)),
        Action::Spawn(spawn) => spawn.into.map(|into| (Place::Ref(into), spawn.span)),
        Action::Destroy(_) | Action::Send(_) => None,
    }
}
