//! Builds the syntax tree from pest's pairs: files, entities, modes, edges, envelopes. Worlds are in `build_world`,
//! expressions in `expression`.

use std::cell::{Cell, RefCell};
use std::collections::BTreeSet;

use hashbrown::HashSet;
use pest::Parser;
use pest::iterators::Pair;

use crate::diagnostic::Diagnostics;
use crate::diagnostic::catalogue::syntax::{TooManyErrors, Unexpected};
use crate::source::{FileId, Span};

use super::ast::{
    ALWAYS, Appearance, Assignment, Behavior, BinaryOp, Chance, Clamp, Collider, Constant, Continuous, Destroy,
    Dimension, Discrete, Domain, Edge, Entity, Expr, ExprKind, File, Follow, Group, Import, Initial, Invariant, Item,
    Look, Member, Mode, Name, Path, Receivers, Reference, Send, Signal, Spawn, Update, Use, Variable, Word, World,
    is_start,
};
use super::part::{MEMBERS, Part, UPDATES, WORLD_ITEMS, each, note_declared, note_tile, parts};
use super::reparse::{Earlier, Kept};
use super::scan::Scan;
use super::{Grammar, Rule, message};

/// Maximum number of reported syntax errors per file.
const MAX_SYNTAX_ERRORS: usize = 100;

/// The shared state of the builders.
pub(super) struct Builder<'a> {
    pub(super) file: FileId,
    pub(super) source: &'a str,
    scan: &'a Scan,
    pub(super) text: &'a str,
    /// The offset of the current pairs in the text: a text is parsed part by part.
    pub(super) base: usize,
    /// The furthest position reached in the last part that matched no rule at all.
    pub(super) stuck: usize,
    /// Number of parts that matched no rule.
    pub(super) broken: usize,
    poisoned_names: BTreeSet<String>,
    /// The interned words.
    words: RefCell<HashSet<Word>>,
    /// Whether `start.x` or `start.y` occurred since it was last asked.
    reads_start: Cell<bool>,
    pub(super) errors: usize,
    pub(super) diagnostics: &'a mut Diagnostics,
}

/// Parses the scanned text and builds the tree; `text` is what the parser sees. Returns the items that a later parse can
/// take, too.
pub(super) fn file(
    id: FileId,
    source: &str,
    (scan, text): (&Scan, Option<&str>),
    earlier: Option<&Earlier<'_>>,
    diagnostics: &mut Diagnostics,
) -> (File, Vec<Kept>) {
    let mut out = File { id, items: Vec::new(), is_broken: false, poisoned_names: BTreeSet::new(), texts: Vec::new() };
    let Some(text) = text else {
        // Nothing of the file was read: later stages must not report uses of its declarations.
        out.is_broken = true;
        out.poisoned_names.insert("*".into());
        return (out, Vec::new());
    };
    let mut kept = Vec::new();
    let mut b = Builder::new(id, source, scan, text, diagnostics);
    match b.items(earlier, &mut kept) {
        Some(items) => out.items = items,
        None => {
            b.base = 0;
            let at = b.span(b.stuck, b.stuck + 1);
            b.diagnostics.report(Unexpected { at, found: None, expected: Vec::new(), help: None, meant: None });
            b.broken += 1;
            b.poisoned_names.insert("*".into());
            kept.clear();
        }
    }
    out.is_broken = b.broken > 0;
    out.poisoned_names = b.poisoned_names;
    (out, kept)
}

/// Parses a scanned text that is a single predicate.
pub(super) fn predicate(id: FileId, source: &str, mut scan: Scan, diagnostics: &mut Diagnostics) -> Option<Expr> {
    let text = scan.text.take()?;
    let b = Builder::new(id, source, &scan, &text, diagnostics);
    match Grammar::parse(Rule::only_predicate, &text) {
        Ok(mut pairs) => b.expression(parts(&pairs.next()?).first()?),
        Err(_) => {
            let fact = message::explain(Rule::only_predicate, &text, 0, text.len(), &|from, to| b.span(from, to));
            b.diagnostics.report(fact);
            None
        }
    }
}

impl<'a> Builder<'a> {
    fn new(file: FileId, source: &'a str, scan: &'a Scan, text: &'a str, diagnostics: &'a mut Diagnostics) -> Self {
        Builder {
            file,
            source,
            scan,
            text,
            base: 0,
            stuck: 0,
            broken: 0,
            poisoned_names: BTreeSet::new(),
            words: RefCell::default(),
            reads_start: Cell::new(false),
            errors: 0,
            diagnostics,
        }
    }

    /// The start of a pair in the repaired text.
    pub fn start_of(&self, pair: &Pair<'_, Rule>) -> usize {
        self.base + pair.as_span().start()
    }

    /// The byte of the source of a byte of the repaired text.
    pub fn position(&self, at: usize) -> usize {
        self.scan.position(at)
    }

    /// The source span of bytes of the repaired text.
    pub fn span(&self, start: usize, end: usize) -> Span {
        Span::new(self.file, self.scan.position(start), self.scan.position(end))
    }

    /// The source span of a pair, without white space at its end.
    pub fn span_of(&self, pair: &Pair<'_, Rule>) -> Span {
        let (start, text) = (self.start_of(pair), pair.as_str());
        self.span(start, start + text.trim_end().len())
    }

    /// Interns a word of the text.
    fn word(&self, text: &str) -> Word {
        let mut words = self.words.borrow_mut();
        if let Some(word) = words.get(text) {
            return word.clone();
        }
        let word = Word::from(text);
        words.insert(word.clone());
        word
    }

    pub fn name(&self, pair: &Pair<'_, Rule>) -> Name {
        let text = match pair.as_rule() {
            // The name of a string is its contents.
            Rule::text => pair.as_str().trim_matches('"'),
            Rule::tag => match pair.clone().into_inner().next() {
                Some(inner) => return self.name(&inner),
                None => pair.as_str(),
            },
            _ => pair.as_str().trim_end(),
        };
        Name { text: self.word(text), span: self.span_of(pair) }
    }

    pub fn names(&self, pair: &Pair<'_, Rule>) -> Vec<Name> {
        let mut names = Vec::with_capacity(each(pair).count());
        names.extend(each(pair).map(|p| self.name(&p)));
        names
    }

    fn is_explained(&self, span: Span) -> bool {
        self.scan.is_explained(span)
    }

    /// Reports a part that matched no rule. `rule` is the expected rule.
    pub fn bad(&mut self, rule: Rule, pair: &Pair<'_, Rule>) {
        let (from, to) = (self.start_of(pair), self.base + pair.as_span().end());
        let span = self.span_of(pair);
        self.broken += 1;
        note_declared(pair.as_str(), &mut self.poisoned_names);
        if self.is_explained(span) {
            return;
        }
        self.errors += 1;
        if self.errors > MAX_SYNTAX_ERRORS {
            if self.errors == MAX_SYNTAX_ERRORS + 1 {
                self.diagnostics.report(TooManyErrors { at: span });
            }
            return;
        }
        let fact = message::explain(rule, self.text, from, to, &|a, b| self.span(a, b));
        self.diagnostics.report(fact);
    }

    /// Reports a tile that matched no rule. What its map has of it is not reported, too.
    pub fn bad_tile(&mut self, rule: Rule, pair: &Pair<'_, Rule>) {
        note_tile(pair.as_str(), &mut self.poisoned_names);
        self.bad(rule, pair);
    }

    pub(super) fn item(&mut self, pair: &Pair<'_, Rule>, end: usize) -> Part<Item> {
        let (start, inner) = (self.start_of(pair), parts(pair));
        let whole = |item| Some((item, end));
        match pair.as_rule() {
            Rule::import => {
                let path = inner.first().map(|path| self.name(path));
                whole(path.map(|path| Item::Import(Import { path })))
            }
            Rule::constant => whole(self.constant(pair).map(|constant| Item::Constant(constant.into()))),
            Rule::entity_head => {
                let name = self.name(inner.first()?);
                let (members, end) = self.block(&MEMBERS, end)?;
                let span = self.span(start, end);
                let reads_start = self.reads_start.take();
                let entity = Entity { name, members, reads_start, doc: self.doc(span), span };
                Some((Some(Item::Entity(entity.into())), end))
            }
            Rule::world_head => {
                let name = self.name(inner.first()?);
                let (items, end) = self.block(&WORLD_ITEMS, end)?;
                let span = self.span(start, end);
                Some((Some(Item::World(World { name, items, doc: self.doc(span), span }.into())), end))
            }
            Rule::behavior_head => {
                let name = self.name(inner.first()?);
                let formals = inner.iter().find(|p| p.as_rule() == Rule::formals);
                let parameters = formals.map_or(Vec::new(), |f| self.names(f));
                let (members, end) = self.block(&MEMBERS, end)?;
                let span = self.span(start, end);
                let reads_start = self.reads_start.take();
                let behavior = Behavior { name, parameters, members, reads_start, doc: self.doc(span), span };
                Some((Some(Item::Behavior(behavior.into())), end))
            }
            _ => {
                self.bad(Rule::only_item, pair);
                whole(None)
            }
        }
    }

    /// The `///` lines directly above something.
    pub(super) fn doc(&self, of: Span) -> Option<String> {
        let mut start = of.range().start;
        let mut lines = Vec::new();
        let before = self.scan.docs.partition_point(|c| (c.start as usize) < start);
        for comment in self.scan.docs.get(..before)?.iter().rev() {
            let gap = self.source.get(comment.end as usize..start)?;
            if !gap.trim().is_empty() || gap.matches('\n').count() != 1 {
                break;
            }
            let body = self.source.get(comment.start as usize..comment.end as usize)?.trim_start_matches('/');
            lines.push(body.strip_prefix(' ').unwrap_or(body).trim_end());
            start = comment.start as usize;
        }
        lines.reverse();
        (!lines.is_empty()).then(|| lines.join("\n"))
    }

    fn constant(&mut self, pair: &Pair<'_, Rule>) -> Option<Constant> {
        let inner = parts(pair);
        let name = self.name(inner.first()?);
        let dimension = inner.iter().find(|p| p.as_rule() == Rule::annotation).and_then(|p| self.dimension(p));
        let value = self.expression(inner.iter().find(|p| p.as_rule() == Rule::expression)?)?;
        Some(Constant { name, dimension, value, doc: self.doc(self.span_of(pair)) })
    }

    fn dimension(&self, annotation: &Pair<'_, Rule>) -> Option<Dimension> {
        let dimension = parts(annotation).into_iter().next()?;
        let mut factors = Vec::new();
        let mut sign = 1;
        for part in parts(&dimension) {
            if part.as_rule() == Rule::dimension_operator {
                sign = if part.as_str().starts_with('/') { -1 } else { 1 };
                continue;
            }
            let inner = parts(&part);
            let exponent = inner.get(1).map_or(Some(1), |e| e.as_str().parse::<i32>().ok())?;
            factors.push((self.name(inner.first()?), sign * exponent));
        }
        Some(Dimension { factors, span: self.span_of(&dimension) })
    }

    /// A part of an entity, a behaviour, a group or a mode.
    pub(super) fn part(&mut self, pair: &Pair<'_, Rule>, end: usize) -> Part<Member> {
        let start = self.start_of(pair);
        match pair.as_rule() {
            Rule::group_head => {
                let name = self.name(parts(pair).first()?);
                let (members, end) = self.block(&MEMBERS, end)?;
                let group = Group { name, members, span: self.span(start, end) };
                Some((Some(Member::Group(group.into())), end))
            }
            Rule::mode_head => {
                let mut inner = parts(pair).into_iter().peekable();
                let initial = match inner.next_if(|first| first.as_rule() == Rule::initial) {
                    None => Some(Initial::No),
                    Some(first) => match parts(&first).first() {
                        Some(guard) => self.expression(guard).map(|guard| Initial::When(guard.into())),
                        None => Some(Initial::Plain),
                    },
                };
                let name = self.name(&inner.next()?);
                let (members, end) = self.block(&MEMBERS, end)?;
                let span = self.span(start, end);
                let doc = self.doc(span).map(String::into_boxed_str);
                let mode = initial.map(|initial| Mode { initial, name, members, doc, span });
                Some((mode.map(|mode| Member::Mode(mode.into())), end))
            }
            Rule::always_head => {
                let name = Name { text: ALWAYS.into(), span: self.span(start, start + ALWAYS.len()) };
                let (members, end) = self.block(&MEMBERS, end)?;
                let span = self.span(start, end);
                let doc = self.doc(span).map(String::into_boxed_str);
                Some((Some(Member::Mode(Mode { initial: Initial::Always, name, members, doc, span }.into())), end))
            }
            Rule::edge_head => {
                let inner = parts(pair);
                let guard = inner.first().and_then(|guard| match guard.as_rule() {
                    Rule::kw_else => Some(Expr { kind: ExprKind::Else, span: self.span_of(guard) }),
                    _ => self.expression(guard),
                });
                let mut target = None;
                let mut is_read = guard.is_some();
                if let Some(leads) = inner.iter().find(|p| p.as_rule() == Rule::target) {
                    target = parts(leads).first().and_then(|path| self.path(path));
                    is_read &= target.is_some();
                }
                let is_open = inner.iter().any(|p| p.as_rule() == Rule::opening);
                let (mut updates, mut is_empty) = (Vec::new(), true);
                let (mut span, mut end) = (self.span_of(pair), end);
                if is_open {
                    let broken = self.broken;
                    (updates, end) = self.block(&UPDATES, end)?;
                    is_empty = updates.is_empty() && self.broken == broken;
                    span = self.span(start, end);
                }
                let guard = guard.filter(|_| is_read);
                let edge = guard.map(|guard| Edge { guard, target, updates: updates.into(), is_empty, span });
                Some((edge.map(|edge| Member::Edge(edge.into())), end))
            }
            Rule::bad_member => {
                self.bad(Rule::only_member, pair);
                Some((None, end))
            }
            _ => Some((self.member(pair), end)),
        }
    }

    fn member(&mut self, pair: &Pair<'_, Rule>) -> Option<Member> {
        let span = self.span_of(pair);
        let inner = parts(pair);
        Some(match pair.as_rule() {
            Rule::parameter => Member::Parameter(self.constant(pair)?.into()),
            Rule::continuous => {
                let name = self.name(inner.first()?);
                let dimension = inner.iter().find(|p| p.as_rule() == Rule::annotation).and_then(|p| self.dimension(p));
                let initial = inner.iter().find(|p| p.as_rule() == Rule::expression);
                let initial = initial.and_then(|p| self.expression(p));
                Member::Continuous(Continuous { name, dimension, initial }.into())
            }
            Rule::discrete => {
                let name = self.name(inner.first()?);
                let domain = self.domain(inner.get(1)?)?;
                let initial = self.expression(inner.iter().rfind(|p| p.as_rule() == Rule::expression)?)?;
                Member::Discrete(Discrete { name, domain, initial }.into())
            }
            Rule::buttons => Member::Buttons((self.names(pair), span).into()),
            Rule::axes => Member::Axes((self.names(pair), span).into()),
            Rule::chance => {
                let name = self.name(inner.iter().find(|p| p.as_rule() == Rule::name)?);
                let ends: Vec<_> = inner.into_iter().filter(|p| p.as_rule() == Rule::expression).collect();
                let [low, high]: [Expr; 2] = self.expressions(&ends)?.try_into().ok()?;
                Member::Chance(Chance { name, low, high, span }.into())
            }
            Rule::collider => {
                let kinematic = inner.first()?.as_rule() == Rule::kw_kinematic;
                let tags = self.names(inner.iter().find(|p| p.as_rule() == Rule::tags)?);
                let shape_pair = inner.iter().find(|p| p.as_rule() == Rule::shape)?;
                let shape_parts = parts(shape_pair);
                let shape = self.name(shape_parts.first()?);
                let arguments = self.expressions(shape_parts.get(1..)?)?;
                let guard = match inner.iter().find(|p| p.as_rule() == Rule::expression) {
                    Some(guard) => Some(self.expression(guard)?),
                    None => None,
                };
                Member::Collider(Collider { kinematic, tags, shape, arguments, guard, span }.into())
            }
            Rule::assignment => {
                let is_flow = inner.get(1)?.as_rule() == Rule::assign;
                let assignment = self.assignment(pair)?;
                if is_flow {
                    Member::Flow(assignment.into())
                } else {
                    Member::Entry(Update::Assign(assignment.into()).into())
                }
            }
            Rule::spawn | Rule::destroy | Rule::send => Member::Entry(self.update(pair)?.into()),
            Rule::reference => {
                let (name, entity) = (self.name(inner.first()?), self.name(inner.get(1)?));
                Member::Reference(Reference { name, entity }.into())
            }
            Rule::clamp => {
                let variable = self.variable(inner.first()?)?;
                let bounds = inner.get(1)?;
                let (low, high) = match bounds.as_rule() {
                    Rule::within => {
                        let both = self.expressions(&parts(bounds).into_iter().skip(1).collect::<Vec<_>>())?;
                        let [low, high]: [Expr; 2] = both.try_into().ok()?;
                        (Some(low), Some(high))
                    }
                    Rule::at_most => (None, Some(self.expression(inner.get(2)?)?)),
                    _ => (Some(self.expression(inner.get(2)?)?), None),
                };
                Member::Clamp(Clamp { variable, low, high, span }.into())
            }
            Rule::invariant => {
                Member::Invariant(Invariant { predicate: self.expression(inner.first()?)?, span }.into())
            }
            Rule::condition => Member::Condition(self.condition(pair)?.into()),
            Rule::signals => {
                let signals = inner.iter().filter(|p| p.as_rule() == Rule::signal);
                Member::Signals((signals.map(|p| self.signal(p)).collect::<Option<_>>()?, span).into())
            }
            Rule::look => Member::Look(Look { appearance: self.appearance(inner.first()?)?, span }.into()),
            Rule::put => {
                let arguments = match inner.get(1) {
                    Some(actuals) => self.actuals(actuals)?,
                    None => Vec::new(),
                };
                Member::Use(Use { behavior: self.name(inner.first()?), arguments, span }.into())
            }
            Rule::follow => {
                let guard = match inner.iter().find(|p| p.as_rule() == Rule::expression) {
                    Some(guard) => Some(self.expression(guard)?),
                    None => None,
                };
                let updates = inner.iter().find(|p| p.as_rule() == Rule::updates);
                let updates = updates.map_or(Vec::new(), |u| self.updates(u));
                Member::Follow(Follow { guard, updates, span }.into())
            }
            Rule::envelope => Member::Envelope(self.envelope(pair)?.into()),
            _ => return None,
        })
    }

    /// A colour or the path of a picture.
    pub(super) fn appearance(&self, pair: &Pair<'_, Rule>) -> Option<Appearance> {
        let inner = parts(pair);
        let written = inner.first()?;
        Some(match written.as_rule() {
            Rule::color => Appearance::Color(self.name(written)),
            _ => Appearance::Picture(self.name(written)),
        })
    }

    fn signal(&mut self, pair: &Pair<'_, Rule>) -> Option<Signal> {
        let inner = parts(pair);
        let number = inner.iter().find(|p| p.as_rule() == Rule::signal_number).and_then(|number| {
            let of = parts(number);
            let annotation = of.iter().find(|p| p.as_rule() == Rule::annotation);
            Some((self.name(of.first()?), annotation.and_then(|p| self.dimension(p))))
        });
        Some(Signal { name: self.name(inner.first()?), number, span: self.span_of(pair) })
    }

    fn domain(&mut self, pair: &Pair<'_, Rule>) -> Option<Domain> {
        let domain = parts(pair).into_iter().next()?;
        Some(match domain.as_rule() {
            Rule::int_domain => {
                let inner = parts(&domain);
                Domain::Int(Box::new(self.expression(inner.first()?)?), Box::new(self.expression(inner.get(1)?)?))
            }
            Rule::bool_domain => Domain::Bool,
            _ => Domain::Set(self.names(&domain)),
        })
    }

    pub fn variable(&self, pair: &Pair<'_, Rule>) -> Option<Variable> {
        let inner = parts(pair);
        let primes = inner.get(1).map_or(0, |p| p.as_str().len() as u32);
        Some(Variable { text: self.name(inner.first()?).text, primes, span: self.span_of(pair) })
    }

    pub fn path(&self, pair: &Pair<'_, Rule>) -> Option<Path> {
        // Most paths are a single name.
        let mut segments = Vec::with_capacity(1);
        let mut primes = 0;
        for part in parts(pair) {
            if part.as_rule() == Rule::primes {
                primes = part.as_str().len() as u32;
            } else {
                segments.push(self.name(&part));
            }
        }
        if let [first, second] = &*segments
            && is_start(first, second)
        {
            self.reads_start.set(true);
        }
        (!segments.is_empty()).then(|| Path::new(segments, primes, self.span_of(pair)))
    }

    fn updates(&mut self, pair: &Pair<'_, Rule>) -> Vec<Update> {
        let mut updates = Vec::new();
        for part in parts(pair) {
            match part.as_rule() {
                Rule::bad_update => self.bad(Rule::only_update, &part),
                _ => updates.extend(self.update(&part)),
            }
        }
        updates
    }

    pub(super) fn update(&mut self, pair: &Pair<'_, Rule>) -> Option<Update> {
        let span = self.span_of(pair);
        let inner = parts(pair);
        Some(match pair.as_rule() {
            Rule::spawn => {
                let into = inner.first().filter(|p| p.as_rule() == Rule::variable);
                let into = match into {
                    Some(variable) => Some(self.variable(variable)?),
                    None => None,
                };
                let entity = self.name(inner.iter().find(|p| p.as_rule() == Rule::name)?);
                let settings = match inner.iter().find(|p| p.as_rule() == Rule::actuals) {
                    Some(actuals) => self.actuals(actuals)?,
                    None => Vec::new(),
                };
                Update::Spawn(Spawn { into, entity, settings, span }.into())
            }
            Rule::destroy => {
                let what = inner.first()?;
                let at = self.span_of(what);
                let kind = match what.as_rule() {
                    Rule::kw_self => ExprKind::SelfRef,
                    _ => ExprKind::Name(self.name(what).text, 0),
                };
                Update::Destroy(Destroy { what: Expr { kind, span: at }, span }.into())
            }
            Rule::send => {
                let to = inner.first()?;
                let all = (to.as_rule() == Rule::all_of).then(|| parts(to).into_iter().next()).flatten();
                let address: Vec<_> = parts(all.as_ref().unwrap_or(to));
                let [of, signal] = address.as_slice() else { return None };
                let (at, name) = (self.span_of(of), self.name(of));
                let to = match of.as_rule() {
                    _ if all.is_some() => Receivers::All(name),
                    Rule::kw_self => Receivers::One(Expr { kind: ExprKind::SelfRef, span: at }),
                    _ => Receivers::One(Expr { kind: ExprKind::Name(name.text, 0), span: at }),
                };
                let signal = self.name(signal);
                let number = match inner.iter().find(|p| p.as_rule() == Rule::sent) {
                    Some(sent) => Some(self.expression(parts(sent).iter().find(|p| p.as_rule() == Rule::expression)?)?),
                    None => None,
                };
                Update::Send(Send { to, signal, number, span }.into())
            }
            _ => Update::Assign(self.assignment(pair)?.into()),
        })
    }

    fn actuals(&mut self, pair: &Pair<'_, Rule>) -> Option<Vec<Assignment>> {
        parts(pair).iter().map(|actual| self.assignment(actual)).collect()
    }

    /// `variable = value`, `variable := value`, `variable += value` or `variable -= value`.
    pub fn assignment(&mut self, pair: &Pair<'_, Rule>) -> Option<Assignment> {
        let inner = parts(pair);
        let variable = self.variable(inner.first()?)?;
        let operator = match inner.get(1)?.as_rule() {
            Rule::increase => Some(BinaryOp::Add),
            Rule::decrease => Some(BinaryOp::Subtract),
            _ => None,
        };
        let mut assignment = Assignment::new(variable, self.expression(inner.get(2)?)?, self.span_of(pair));
        assignment.operator = operator;
        Some(assignment)
    }
}
