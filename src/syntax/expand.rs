//! Expands behaviours: every `use` is replaced by a copy of the behaviour's members, with arguments in place of
//! parameters.
//!
//! Each copy has a separate file in the source map, which shows the behaviour's text and records the `use`, so that
//! findings point at both. Names inside are resolved where the behaviour is used.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use crate::diagnostic::Diagnostics;
use crate::diagnostic::catalogue::file::TooMany;
use crate::diagnostic::catalogue::lint::Unused;
use crate::diagnostic::catalogue::names::{BehaviorCycle, DuplicateName, UnknownName};
use crate::diagnostic::catalogue::syntax::ExpressionTooLong;
use crate::diagnostic::catalogue::types::MissingArguments;
use crate::source::{MAX_COPIES, SourceMap, Span};

use super::ast::{Behavior, Expr, ExprKind, File, Item, Member, Use, Word};
use super::occurrence::{NameKind, Occurrences};
use super::scan::{MAX_NESTING, MAX_OPERATORS};
use super::substitute::Substitution;

/// Maximum number of expanded members of a program.
pub const MAX_EXPANDED_MEMBERS: usize = 200_000;
/// Maximum nesting depth of modes, groups and behaviours after expansion.
const MAX_DEPTH: usize = 2 * MAX_NESTING;

/// Expands all behaviours, and records occurrences of their names and parameters.
pub fn expand(files: &mut [File], sources: &mut SourceMap, occurrences: &mut Occurrences) -> Diagnostics {
    let mut behaviors: BTreeMap<Word, Arc<Behavior>> = BTreeMap::new();
    let mut diagnostics = Diagnostics::new();
    for behavior in files.iter().flat_map(|f| &f.items).filter_map(|i| match i {
        Item::Behavior(behavior) => Some(behavior),
        _ => None,
    }) {
        occurrences.declare(NameKind::Behavior, behavior.name.span);
        note_parameters(behavior, occurrences);
        note_members(&behavior.members, occurrences);
        match behaviors.get(&behavior.name.text) {
            Some(first) => diagnostics.report(DuplicateName {
                kind: "behavior",
                name: behavior.name.text.to_string(),
                first: first.name.span,
                second: behavior.name.span,
            }),
            None => {
                behaviors.insert(behavior.name.text.clone(), Arc::clone(behavior));
            }
        }
        let mut parameters: BTreeMap<&str, Span> = BTreeMap::new();
        for parameter in &behavior.parameters {
            let first = *parameters.entry(&parameter.text).or_insert(parameter.span);
            if first != parameter.span {
                let (name, second) = (parameter.text.to_string(), parameter.span);
                diagnostics.report(DuplicateName { kind: "parameter", name, first, second });
            }
        }
    }
    let poisoned_names = files.iter().flat_map(|f| f.poisoned_names.iter().map(|name| name.as_str().into())).collect();
    let mut expander = Expander {
        behaviors,
        poisoned_names,
        sources,
        diagnostics,
        occurrences,
        active: Vec::new(),
        expanded: 0,
        depth: 0,
        reads_start: false,
        is_too_deep: false,
        is_full: false,
        used: BTreeSet::new(),
    };
    expander.cycles();
    for item in files.iter_mut().flat_map(|f| &mut f.items) {
        if let Item::Entity(entity) = item
            && has_use(&entity.members)
        {
            let entity = Arc::make_mut(entity);
            expander.reads_start = entity.reads_start;
            expander.members(&mut entity.members);
            entity.reads_start = expander.reads_start;
        }
    }
    expander.unused(files.first());
    expander.diagnostics
}

struct Expander<'a> {
    behaviors: BTreeMap<Word, Arc<Behavior>>,
    /// Names that unreadable parts may have declared.
    poisoned_names: BTreeSet<Word>,
    sources: &'a mut SourceMap,
    diagnostics: Diagnostics,
    occurrences: &'a mut Occurrences,
    /// The behaviours being expanded.
    active: Vec<Word>,
    /// Number of expanded members.
    expanded: usize,
    /// The current nesting depth.
    depth: usize,
    /// Whether the current entity reads where it started.
    reads_start: bool,
    /// Whether the maximum depth was exceeded.
    is_too_deep: bool,
    /// Whether there are more uses than the source map can hold.
    is_full: bool,
    /// The behaviours that were expanded at least once.
    used: BTreeSet<Word>,
}

impl Expander<'_> {
    /// Reports unused behaviours of the root file, if it has a world: a file without one is a library.
    fn unused(&mut self, root: Option<&File>) {
        let Some(root) = root.filter(|f| f.items.iter().any(|i| matches!(i, Item::World(_)))) else { return };
        let own = root.items.iter().filter_map(|i| if let Item::Behavior(b) = i { Some(&b.name) } else { None });
        let unused = own.filter(|name| !self.used.contains(&name.text) && !name.text.starts_with('_'));
        if !root.is_broken && !self.diagnostics.has_errors() {
            for name in unused {
                let (kind, name, at) = ("behavior", name.text.to_string(), name.span);
                self.diagnostics.report(Unused { kind, name, at, written: None });
            }
        }
    }

    /// Reports every cycle of behaviours that use each other, once.
    fn cycles(&mut self) {
        let mut uses: BTreeMap<&str, Vec<(&str, Span)>> = BTreeMap::new();
        for (name, behavior) in &self.behaviors {
            let mut inner = Vec::new();
            collect(&behavior.members, &mut inner);
            uses.insert(name, inner);
        }
        let mut done: BTreeSet<&str> = BTreeSet::new();
        let mut found = Vec::new();
        for &start in uses.keys() {
            // A depth-first search with an explicit stack of behaviours and their next uses.
            let mut way: Vec<(&str, usize)> = vec![(start, 0)];
            let mut on_way: BTreeSet<&str> = BTreeSet::from([start]);
            while let Some((name, next)) = way.last_mut() {
                let Some(&(inner, span)) = uses.get(name).and_then(|u| u.get(*next)) else {
                    done.insert(name);
                    on_way.remove(name);
                    way.pop();
                    continue;
                };
                *next += 1;
                if on_way.contains(inner)
                    && let Some(first) = way.iter().position(|(n, _)| *n == inner)
                {
                    let mut names: Vec<String> = way[first..].iter().map(|(n, _)| (*n).to_string()).collect();
                    names.push(inner.to_string());
                    found.push(BehaviorCycle { at: span, names });
                } else if !done.contains(&inner) && uses.contains_key(inner) {
                    way.push((inner, 0));
                    on_way.insert(inner);
                }
            }
        }
        for cycle in found {
            self.diagnostics.report(cycle);
        }
    }

    /// Replaces every `use` among some members, and in the modes and groups among them.
    fn members(&mut self, members: &mut Vec<Member>) {
        if !has_use(members) {
            return;
        }
        self.depth += 1;
        for member in std::mem::take(members) {
            match member {
                Member::Use(used) => members.extend(self.expand_use(&used)),
                Member::Mode(mut mode) => {
                    self.members(&mut mode.members);
                    members.push(Member::Mode(mode));
                }
                Member::Group(mut group) => {
                    self.members(&mut group.members);
                    members.push(Member::Group(group));
                }
                other => members.push(other),
            }
        }
        self.depth -= 1;
    }

    /// The members of a `use`.
    fn expand_use(&mut self, used: &Use) -> Vec<Member> {
        let name = &used.behavior.text;
        let Some(behavior) = self.behaviors.get(name).cloned() else {
            if !self.poisoned_names.contains(name) && !self.poisoned_names.contains("*") {
                let known = self.behaviors.values().map(|b| (&*b.name.text, Some(b.name.span)));
                self.diagnostics.report(UnknownName::new("behavior", name, used.behavior.span, known));
            }
            return Vec::new();
        };
        self.used.insert(name.clone());
        self.occurrences.read(NameKind::Behavior, used.behavior.span, behavior.name.span);
        if self.active.contains(name) {
            return Vec::new(); // a cycle, which is reported
        }
        if self.depth > MAX_DEPTH {
            if !std::mem::replace(&mut self.is_too_deep, true) {
                let (count, limit) = (self.depth as u64, MAX_DEPTH as u64);
                let what = "modes, groups and behaviors inside of each other".into();
                self.diagnostics.report(TooMany { what, count, limit, at: used.span });
            }
            return Vec::new();
        }
        let before = self.expanded;
        self.expanded += 1 + size(&behavior.members);
        if self.expanded > MAX_EXPANDED_MEMBERS {
            if before <= MAX_EXPANDED_MEMBERS {
                let (count, limit) = (self.expanded as u64, MAX_EXPANDED_MEMBERS as u64);
                self.diagnostics.report(TooMany { what: "members by `use`".into(), count, limit, at: used.span });
            }
            return Vec::new();
        }
        let Some(arguments) = self.arguments(used, &behavior) else { return Vec::new() };
        if self.sources.is_full_of_copies() {
            if !std::mem::replace(&mut self.is_full, true) {
                let (count, limit) = (MAX_COPIES as u64 + 1, MAX_COPIES as u64);
                let what = "behaviors put in place by `use`".into();
                self.diagnostics.report(TooMany { what, count, limit, at: used.span });
            }
            return Vec::new();
        }
        let copy = self.sources.copy(behavior.name.span.file(), used.span);
        let from = behavior.name.span.file();
        let mut substitution = Substitution { from, to: copy, arguments, too_long: None, replaced: Vec::new() };
        self.reads_start |= behavior.reads_start;
        let mut members = behavior.members.clone();
        members.iter_mut().for_each(|m| substitution.member(m));
        if let Some(at) = substitution.too_long {
            self.diagnostics.report(ExpressionTooLong { at, limit: MAX_OPERATORS, unread: false });
            return Vec::new();
        }
        self.active.push(behavior.name.text.clone());
        self.members(&mut members);
        self.active.pop();
        members
    }

    /// The argument of each parameter.
    fn arguments(&mut self, used: &Use, behavior: &Behavior) -> Option<Vec<(String, Expr)>> {
        let mut arguments: Vec<(String, Expr)> = Vec::new();
        let mut places: BTreeMap<&str, Span> = BTreeMap::new();
        let parameters: BTreeSet<&str> = behavior.parameters.iter().map(|p| &*p.text).collect();
        let mut fits = true;
        for argument in &used.arguments {
            let (name, at) = (&argument.variable.text, argument.variable.span);
            let known = parameters.contains(&**name) && argument.variable.primes == 0;
            if let Some(parameter) = behavior.parameters.iter().find(|p| known && p.text == *name) {
                self.occurrences.read(NameKind::Argument, argument.variable.name().span, parameter.span);
            }
            if !known {
                fits = false;
                let known = behavior.parameters.iter().map(|p| (&*p.text, Some(p.span)));
                self.diagnostics.report(UnknownName::new("parameter", name, at, known));
                continue;
            }
            if let Some(&first) = places.get(&**name) {
                let name = name.to_string();
                self.diagnostics.report(DuplicateName { kind: "argument", name, first, second: at });
                continue;
            }
            places.insert(name, at);
            arguments.push((name.to_string(), argument.value.clone()));
        }
        let missing: Vec<String> =
            behavior.parameters.iter().filter(|p| !places.contains_key(&*p.text)).map(|p| p.text.to_string()).collect();
        if !missing.is_empty() && fits {
            fits = false;
            let name = behavior.name.text.to_string();
            self.diagnostics.report(MissingArguments { at: used.span, name, missing, declared: behavior.name.span });
        }
        fits.then_some(arguments)
    }
}

/// Records occurrences of a behaviour's own parameters: where they are replaced, here by themselves.
fn note_parameters(behavior: &Behavior, occurrences: &mut Occurrences) {
    for parameter in &behavior.parameters {
        occurrences.declare(NameKind::Argument, parameter.span);
    }
    if behavior.parameters.is_empty() {
        return;
    }
    let itself =
        |p: &super::ast::Name| (p.text.to_string(), Expr { kind: ExprKind::Name(p.text.clone(), 0), span: p.span });
    let (file, arguments) = (behavior.name.span.file(), behavior.parameters.iter().map(itself).collect());
    let mut substitution = Substitution { from: file, to: file, arguments, too_long: None, replaced: Vec::new() };
    behavior.members.clone().iter_mut().for_each(|m| substitution.member(m));
    for (at, parameter) in substitution.replaced {
        if let Some(parameter) = behavior.parameters.get(parameter) {
            occurrences.read(NameKind::Argument, at, parameter.span);
        }
    }
}

/// Records the declarations of a behaviour, which matters if it is unused.
fn note_members(members: &[Member], occurrences: &mut Occurrences) {
    for member in members {
        match member {
            Member::Parameter(p) => occurrences.declare(NameKind::Parameter, p.name.span),
            Member::Continuous(c) => occurrences.declare(NameKind::Variable, c.name.span),
            Member::Discrete(d) => occurrences.declare(NameKind::Discrete, d.name.span),
            Member::Reference(r) => occurrences.declare(NameKind::Reference, r.name.span),
            Member::Buttons(list) => list.0.iter().for_each(|n| occurrences.declare(NameKind::Button, n.span)),
            Member::Axes(list) => list.0.iter().for_each(|n| occurrences.declare(NameKind::Axis, n.span)),
            Member::Chance(c) => occurrences.declare(NameKind::Chance, c.name.span),
            Member::Condition(c) => occurrences.declare(NameKind::Condition, c.name.span),
            Member::Signals(list) => list.0.iter().for_each(|s| occurrences.declare(NameKind::Signal, s.name.span)),
            Member::Group(group) => {
                occurrences.declare(NameKind::Group, group.name.span);
                note_members(&group.members, occurrences);
            }
            Member::Mode(mode) => {
                occurrences.declare(NameKind::Mode, mode.name.span);
                note_members(&mode.members, occurrences);
            }
            _ => {}
        }
    }
}

fn has_use(members: &[Member]) -> bool {
    members.iter().any(|m| match m {
        Member::Use(_) => true,
        Member::Mode(mode) => has_use(&mode.members),
        Member::Group(group) => has_use(&group.members),
        _ => false,
    })
}

/// Number of members, including nested ones.
fn size(members: &[Member]) -> usize {
    let inside = members.iter().map(|m| match m {
        Member::Mode(mode) => size(&mode.members),
        Member::Group(group) => size(&group.members),
        _ => 0,
    });
    members.len() + inside.sum::<usize>()
}

/// The names and spans of all uses among some members.
fn collect<'a>(members: &'a [Member], out: &mut Vec<(&'a str, Span)>) {
    for member in members {
        match member {
            Member::Use(used) => out.push((&used.behavior.text, used.span)),
            Member::Mode(mode) => collect(&mode.members, out),
            Member::Group(group) => collect(&group.members, out),
            _ => {}
        }
    }
}
