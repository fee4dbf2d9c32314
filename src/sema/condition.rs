//! Named conditions: `condition on_floor = touching(body, wall, below)`. A condition is checked once, where it is
//! declared, at its first use. A use stands for the checked expression, and is checked for what that needs of its place.

use std::collections::BTreeMap;
use std::rc::Rc;

use crate::diagnostic::Fact;
use crate::diagnostic::catalogue::file::TooMany;
use crate::diagnostic::catalogue::names::{ConditionCycle, DuplicateName};
use crate::diagnostic::catalogue::structure::JointCycle;
use crate::diagnostic::catalogue::syntax::ExpressionTooLong;
use crate::ir::{GroupId, ModeId, RefId, Subject};
use crate::source::Span;
use crate::syntax::ast::{self, Expr, ExprKind, Member, Name, PathRef, Word};
use crate::syntax::occurrence::NameKind;
use crate::syntax::{MAX_NESTING, MAX_OPERATORS};

use super::checked::{Condition, Entity, Term};
use super::entity::{PendingBody, Skeleton};
use super::expression::{ReadLimit, Scope, WorldNames};
use super::reference::lost_by;
use super::{Checker, operators};

/// Maximum number of expressions that the uses of conditions stand for, in the whole program.
const MAX_EXPANDED: usize = 200_000;
/// Maximum number of conditions inside of each other: the check recurses into them.
const MAX_LEVELS: usize = 32;
/// Maximum depth of an expression with those of its conditions put in place, for the same reason. A single expression
/// is never that deep.
const MAX_HEIGHT: usize = MAX_OPERATORS + MAX_NESTING + MAX_LEVELS;

/// The conditions of the entity or the world that is checked.
#[derive(Debug, Default)]
pub(super) struct Conditions {
    declared: Vec<Declared>,
    named: BTreeMap<Word, Vec<usize>>,
    /// Those whose expressions are being checked, from the outside in.
    active: Vec<usize>,
    /// What the innermost one of them needs, as far as it is checked.
    needs: Needs,
    /// Number of expressions that all uses stand for so far, in all entities and worlds.
    expanded: usize,
}

/// A declaration.
#[derive(Debug)]
struct Declared {
    name: Name,
    value: Rc<Expr>,
    /// The mode that holds it.
    mode: Option<ModeId>,
    /// The depth of the expression as written.
    height: usize,
    state: State,
    is_used: bool,
}

#[derive(Debug)]
enum State {
    Unchecked,
    /// Its expression, and what that needs of each place that uses it.
    Checked(Rc<(Term, Needs)>),
    /// It has an error, which is reported: uses report none.
    Broken,
}

/// What an expression needs of the place where it is used.
#[derive(Debug, Clone, Default)]
struct Needs {
    /// The greatest read, in words.
    reads: Option<(ReadLimit, &'static str)>,
    /// The references that it reads without a test, each with a read.
    refs: Vec<(RefId, Span)>,
    /// The groups whose transitions it asks for.
    groups: Vec<GroupId>,
    /// The number of conditions inside of each other, and the depth of the expression with all of them put in place.
    depth: Depth,
}

/// How deep an expression is.
#[derive(Debug, Clone, Copy, Default)]
struct Depth {
    levels: usize,
    height: usize,
}

impl Conditions {
    fn of<'a>(members: impl Iterator<Item = (&'a ast::Condition, Option<ModeId>)>, expanded: usize) -> Self {
        let mut conditions = Conditions { expanded, ..Conditions::default() };
        for (condition, mode) in members {
            let ast::Condition { name, value, .. } = condition;
            conditions.named.entry(name.text.clone()).or_default().push(conditions.declared.len());
            conditions.declared.push(Declared {
                name: name.clone(),
                value: Rc::new(value.clone()),
                mode,
                height: height(value),
                state: State::Unchecked,
                is_used: false,
            });
        }
        conditions
    }

    /// The condition of a name in a mode, or outside of modes.
    fn visible(&self, name: &str, mode: Option<ModeId>, entity: Option<&Entity>) -> Option<usize> {
        let known = self.named.get(name)?;
        known.iter().copied().find(|&index| holds(self.declared[index].mode, mode, entity))
    }

    /// The conditions that a scope can use.
    pub fn names<'a>(&'a self, scope: &'a Scope<'_>) -> impl Iterator<Item = &'a Name> {
        let visible = |known: &&Declared| holds(known.mode, scope.mode, scope.entity);
        self.declared.iter().filter(visible).map(|known| &known.name)
    }

    /// The reference, if the whole guard is `lost(…)` once conditions are put in place.
    pub fn lost_by(&self, guard: &Expr, mode: ModeId, entity: &Entity) -> Option<Name> {
        let (mut guard, mut mode) = (guard, Some(mode));
        for _ in 0..=self.declared.len() {
            let Some(name) = unparenthesized(guard).name() else { break };
            let known = &self.declared[self.visible(&name.text, mode, Some(entity))?];
            (guard, mode) = (&known.value, known.mode);
        }
        lost_by(guard)
    }

    /// Whether the expression of a condition is being checked.
    pub fn are_checked(&self) -> bool {
        !self.active.is_empty()
    }

    /// Notes a read in the expression of a condition.
    pub fn note_read(&mut self, needs: ReadLimit, what: &'static str) {
        if self.are_checked() && self.needs.reads.is_none_or(|(known, _)| known < needs) {
            self.needs.reads = Some((needs, what));
        }
    }

    /// Notes a read of a reference without a test; false if no condition is being checked.
    pub fn note_ref(&mut self, id: RefId, at: Span) -> bool {
        if self.are_checked() && !self.needs.refs.iter().any(|(known, _)| *known == id) {
            self.needs.refs.push((id, at));
        }
        self.are_checked()
    }

    /// Notes that transitions of a group are asked for.
    pub fn note_group(&mut self, group: GroupId) {
        if self.are_checked() && !self.needs.groups.contains(&group) {
            self.needs.groups.push(group);
        }
    }
}

impl Checker<'_> {
    /// Declares the conditions in the body of an entity.
    pub(super) fn declare_conditions(&mut self, body: &PendingBody<'_>) {
        let modes = body.modes.iter().enumerate();
        let modes = modes.map(|(index, mode)| (&mode.members, Some(ModeId(index as u32))));
        let all = std::iter::once((&body.members, None)).chain(modes).flat_map(|(members, mode)| {
            members.iter().filter_map(move |member| match *member {
                Member::Condition(condition) => Some((&**condition, mode)),
                _ => None,
            })
        });
        self.conditions = Conditions::of(all, self.conditions.expanded);
    }

    /// Reports conditions of an entity whose names are taken.
    pub(super) fn entity_conditions(&mut self, names: &Skeleton, scope: &Scope<'_>) {
        for index in 0..self.conditions.declared.len() {
            let name = self.conditions.declared[index].name.clone();
            self.record_declaration(NameKind::Condition, &name);
            if self.is_of_every_entity(&name) {
                self.conditions.declared[index].state = State::Broken;
                continue;
            }
            let values = names.value_place(&name.text);
            self.report_duplicate(index, values, scope);
        }
    }

    /// Declares the conditions of a world.
    pub(super) fn world_conditions(&mut self, syntax: &ast::World, names: &WorldNames, scope: &Scope<'_>) {
        let items = syntax.items.iter().filter_map(|item| match item {
            ast::WorldItem::Condition(condition) => Some((&**condition, None)),
            _ => None,
        });
        self.conditions = Conditions::of(items, self.conditions.expanded);
        for index in 0..self.conditions.declared.len() {
            let name = self.conditions.declared[index].name.clone();
            self.record_declaration(NameKind::Condition, &name);
            let is_it = |known: &&Name| known.text == name.text;
            let known = names.instance(&name.text).and_then(|(slot, _)| names.instances.get(slot.0 as usize));
            let known = known.map(|(known, _)| known);
            let known = known.or_else(|| names.spaces.iter().map(|(known, _)| known).find(is_it));
            self.report_duplicate(index, known.map(|known| known.span), scope);
        }
    }

    /// Reports a condition whose name means something else where it can be used.
    fn report_duplicate(&mut self, index: usize, known: Option<Span>, scope: &Scope<'_>) {
        let conditions = &self.conditions;
        let Declared { name, mode, .. } = &conditions.declared[index];
        let others = conditions.named.get(&name.text).into_iter().flatten().filter(|&&other| other != index);
        // Of two conditions, the inner one is reported; of two in one block, the later one.
        let other = others.copied().find(|&other| {
            let outer = conditions.declared[other].mode;
            holds(outer, *mode, scope.entity) && (outer != *mode || other < index)
        });
        let other = other.map(|other| conditions.declared[other].name.span);
        let Some(first) = known.or(other) else { return };
        let second = name.span;
        let (first, second) = if first.file() == second.file() && second.start() < first.start() && known.is_some() {
            (second, first)
        } else {
            (first, second)
        };
        self.diagnostics.report(DuplicateName { kind: "condition", name: name.text.to_string(), first, second });
    }

    /// The checked conditions, which are no longer known afterwards; those that nothing uses are checked now.
    pub(super) fn take_conditions(&mut self, scope: &Scope<'_>) -> Vec<Condition> {
        for index in 0..self.conditions.declared.len() {
            self.check_condition(index, scope);
        }
        let declared = std::mem::take(&mut self.conditions.declared);
        self.conditions.named.clear();
        let checked = declared.into_iter().filter_map(|Declared { name, mode, state, is_used, .. }| match state {
            State::Checked(checked) => {
                let value = Rc::try_unwrap(checked).map_or_else(|shared| shared.0.clone(), |(term, _)| term);
                Some(Condition { name, mode, value, is_used })
            }
            State::Unchecked | State::Broken => None,
        });
        checked.collect()
    }

    /// Checks the expression of a condition, unless that was done before.
    fn check_condition(&mut self, index: usize, scope: &Scope<'_>) {
        let conditions = &mut self.conditions;
        if !matches!(conditions.declared[index].state, State::Unchecked) {
            return;
        }
        let outermost = conditions.active.first().copied().unwrap_or(index);
        let heights = conditions.active.iter().chain([&index]).map(|&at| conditions.declared[at].height);
        let depth = Depth { levels: conditions.active.len() + 1, height: heights.sum() };
        if self.is_too_deep(outermost, depth) {
            return;
        }
        let conditions = &mut self.conditions;
        let Declared { value, mode, height, .. } = &conditions.declared[index];
        let (value, mode, height) = (Rc::clone(value), *mode, *height);
        conditions.active.push(index);
        let outer_needs = std::mem::take(&mut conditions.needs);
        // What is known at the first use is not known at the others.
        let outer_facts = std::mem::take(&mut self.facts);
        let scope = Scope { mode, covered: false, reads: ReadLimit::Edges, ..*scope };
        let term = self.guard(&value, &scope);
        self.facts = outer_facts;
        let mut needs = std::mem::replace(&mut self.conditions.needs, outer_needs);
        self.conditions.active.pop();
        needs.depth = Depth { levels: needs.depth.levels + 1, height: needs.depth.height + height };
        if self.is_too_deep(index, needs.depth) {
            return;
        }
        if term.as_ref().is_some_and(|term| operators(term) > MAX_OPERATORS) {
            self.report_once(index, ExpressionTooLong { at: value.span, limit: MAX_OPERATORS, unread: false });
        }
        let state = &mut self.conditions.declared[index].state;
        if matches!(state, State::Unchecked) {
            *state = term.map_or(State::Broken, |term| State::Checked(Rc::new((term, needs))));
        }
    }

    /// Reports a condition whose expression is deeper than what is supported.
    fn is_too_deep(&mut self, index: usize, Depth { levels, height }: Depth) -> bool {
        let (what, count, limit) = if levels > MAX_LEVELS {
            ("conditions inside of each other", levels, MAX_LEVELS)
        } else if height > MAX_HEIGHT {
            ("brackets and operators inside of each other, those of conditions included", height, MAX_HEIGHT)
        } else {
            return false;
        };
        let at = self.conditions.declared[index].name.span;
        self.report_once(index, TooMany { what: what.into(), count: count as u64, limit: limit as u64, at });
        true
    }

    /// Reports an error of a condition, unless it has one.
    fn report_once(&mut self, index: usize, fact: impl Fact) {
        let state = &mut self.conditions.declared[index].state;
        if !matches!(std::mem::replace(state, State::Broken), State::Broken) {
            self.diagnostics.report(fact);
        }
    }

    /// The index of a condition that a scope can use.
    pub(super) fn visible_condition(&self, name: &str, scope: &Scope<'_>) -> Option<usize> {
        self.conditions.visible(name, scope.mode, scope.entity)
    }

    /// The mode that has a condition of a name that is not visible in a scope.
    pub(super) fn condition_elsewhere(&self, name: &str, scope: &Scope<'_>) -> Option<String> {
        let entity = scope.entity?;
        let known = *self.conditions.named.get(name)?.first()?;
        let mode = entity.modes.get(self.conditions.declared[known].mode?)?.path.join(".");
        Some(format!("`{name}` is a condition of the mode `{mode}`: declare it in the entity to use it elsewhere"))
    }

    /// The expression that a use of a condition stands for, with the span of the use.
    pub(super) fn used_condition(
        &mut self,
        index: usize,
        path: &PathRef<'_>,
        span: Span,
        scope: &Scope<'_>,
    ) -> Option<Term> {
        let declared = self.conditions.declared[index].name.span;
        let name = path.segments.first()?;
        self.record_use(NameKind::Condition, name.span, declared);
        self.unprimed(path)?;
        if let Some(first) = self.conditions.active.iter().position(|active| *active == index) {
            self.report_condition_cycle(first, span);
            return None;
        }
        self.conditions.declared[index].is_used = true;
        self.check_condition(index, scope);
        let State::Checked(checked) = &self.conditions.declared[index].state else { return None };
        let checked = Rc::clone(checked);
        let (term, needs) = &*checked;
        let before = self.conditions.expanded;
        self.conditions.expanded = before.saturating_add(size(term));
        if self.conditions.expanded > MAX_EXPANDED {
            if before <= MAX_EXPANDED {
                let (count, limit) = (self.conditions.expanded as u64, MAX_EXPANDED as u64);
                let what = "expressions by uses of conditions".into();
                self.diagnostics.report(TooMany { what, count, limit, at: span });
            }
            return None;
        }
        let (depth, inner) = (&mut self.conditions.needs.depth, needs.depth);
        *depth = Depth { levels: depth.levels.max(inner.levels), height: depth.height.max(inner.height) };
        self.provide(needs, declared, span, scope)?;
        Some(Term { span, ..term.clone() })
    }

    /// Checks that the place of a use gives what a condition needs.
    fn provide(&mut self, needs: &Needs, declared: Span, span: Span, scope: &Scope<'_>) -> Option<()> {
        let known = self.diagnostics.iter().len();
        if let Some((reads, what)) = needs.reads
            && self.allow(Some(()), span, scope, reads, what).is_none()
        {
            self.diagnostics.add_label(known, declared, format!("reads {what}"));
            return None;
        }
        for (id, at) in &needs.refs {
            let (Some(entity), known) = (scope.entity, self.diagnostics.iter().len()) else { continue };
            let name = entity.refs[*id].name.clone();
            self.readable(Subject::Ref(*id), &name, span, scope);
            self.diagnostics.add_label(known, *at, format!("`{}` is read here", name.text));
        }
        for group in &needs.groups {
            let Some(entity) = scope.entity else { continue };
            if scope.mode.is_some_and(|mode| entity.modes[mode].group == *group) {
                let known = self.diagnostics.iter().len();
                let name = entity.groups[*group].name.as_ref();
                let name = name.map_or("the modes".into(), |name| format!("`{}`", name.text));
                self.diagnostics.report(JointCycle { steps: vec![(name, span)] });
                self.diagnostics.add_label(known, declared, "asks for transitions of the same group".into());
                return None;
            }
            self.conditions.note_group(*group);
        }
        Some(())
    }

    /// Reports conditions that use each other: those being checked, from an index on.
    fn report_condition_cycle(&mut self, first: usize, at: Span) {
        let conditions = &mut self.conditions;
        let cycle = conditions.active.get(first..).unwrap_or_default();
        let mut names: Vec<String> = cycle.iter().map(|&i| conditions.declared[i].name.text.to_string()).collect();
        names.extend(names.first().cloned());
        for &index in cycle {
            conditions.declared[index].state = State::Broken;
        }
        self.diagnostics.report(ConditionCycle { at, names });
    }
}

/// Whether a block can use what another one declares: `None` is the entity or the world itself.
fn holds(outer: Option<ModeId>, inner: Option<ModeId>, entity: Option<&Entity>) -> bool {
    let (Some(_), Some(entity)) = (outer, entity) else { return outer.is_none() };
    let mut around = inner;
    while let Some(mode) = around {
        if around == outer {
            return true;
        }
        around = entity.modes[mode].parent;
    }
    false
}

fn unparenthesized(mut e: &Expr) -> &Expr {
    while let ExprKind::Paren(inner) = &e.kind {
        e = inner;
    }
    e
}

/// Number of terms of a term.
fn size(term: &Term) -> usize {
    1 + term.operands().iter().map(size).sum::<usize>()
}

/// Number of expressions on the longest path into an expression.
fn height(e: &Expr) -> usize {
    let highest = |inner: &[Expr]| inner.iter().map(height).max().unwrap_or(0);
    1 + match &e.kind {
        ExprKind::Call(call) => highest(&call.arguments),
        ExprKind::Point(both) | ExprKind::Moved(both) | ExprKind::Binary(_, both) | ExprKind::Compare(_, both) => {
            highest(&**both)
        }
        ExprKind::Paren(a) | ExprKind::Negate(a) | ExprKind::Not(a) => height(a),
        ExprKind::Chain(chain) => chain.1.iter().map(|(_, e)| height(e)).fold(height(&chain.0), usize::max),
        _ => 0,
    }
}
