//! Entities in two passes: declarations first (the skeleton, to which other entities and worlds may refer), then
//! bodies.

use std::collections::BTreeSet;
use std::sync::Arc;

use crate::diagnostic::catalogue::file::TooMany;
use crate::diagnostic::catalogue::names::DuplicateName;
use crate::diagnostic::catalogue::syntax::Misplaced;
use crate::diagnostic::catalogue::types::{NotConstant, OutOfRange};
use crate::ir::{
    AxisId, ButtonId, ChanceId, DiscreteId, EntityId, GroupId, IdVec, MAX_AXES, MAX_BUTTONS, MAX_CHANCES, ModeId,
    ParamId, RareVec, RefId, SignalId, VarId,
};
use crate::ordered::Ordered;
use crate::source::Span;
use crate::syntax::ast::{self, ALWAYS, Domain, Expr, Initial, Member, Name, Word};
use crate::syntax::occurrence::NameKind;

use super::checked::SetId;
use super::checked::{
    Annotation, Chance, Discrete, Entity, Group, Param, Reference, Signal, Term, TermKind, Type, Var,
};
use super::condition::Conditions;
use super::constant::{ConstantContext, ConstantError, evaluate};
use super::expression::{ReadLimit, Scope};
use super::facts::Facts;
use super::mode::ModeNames;
use super::names::{Candidate, Table, unknown};
use super::{Checker, Set, start};

/// The names of an entity.
#[derive(Debug)]
pub(super) struct Skeleton {
    pub params: Table<ParamId>,
    pub vars: Table<VarId>,
    pub discretes: Table<DiscreteId>,
    pub refs: Table<RefId>,
    pub signals: Table<SignalId>,
    pub buttons: Table<ButtonId>,
    pub axes: Table<AxisId>,
    pub chances: Table<ChanceId>,
    pub modes: ModeNames,
    /// For each mode: the references for which it has an edge on `lost`.
    pub lost: Vec<Vec<Word>>,
}

/// The unchecked part of an entity whose names are known.
#[derive(Debug, Default)]
pub(super) struct PendingBody<'t> {
    /// The members outside of modes.
    pub members: Vec<&'t Member>,
    /// Modes in preorder of their ids.
    pub modes: Vec<PendingMode<'t>>,
}

/// A mode whose name is known.
#[derive(Debug)]
pub(super) struct PendingMode<'t> {
    pub syntax: &'t ast::Mode,
    /// Its members but for its child modes; those of several `always` are together.
    pub members: Vec<&'t Member>,
}

impl<'t> From<&'t ast::Mode> for PendingMode<'t> {
    fn from(syntax: &'t ast::Mode) -> Self {
        PendingMode { syntax, members: syntax.members.iter().collect() }
    }
}

impl Skeleton {
    /// The names of a completely declared entity.
    fn of(entity: &Entity, modes: &[PendingMode<'_>], conditions: &Conditions) -> Self {
        let lost = |index: usize, mode: &PendingMode<'_>| {
            let edges = mode.members.iter().filter_map(|m| match m {
                Member::Edge(edge) if edge.target.is_some() => {
                    conditions.lost_by(&edge.guard, ModeId(index as u32), entity)
                }
                _ => None,
            });
            let once: BTreeSet<Word> = edges.map(|name| name.text).collect();
            once.into_iter().collect()
        };
        Skeleton {
            params: Table::of("parameter", entity.params.iter().map(|param| &param.name)),
            vars: Table::of("variable", entity.vars.iter().map(|var| &var.name)),
            discretes: Table::of("variable", entity.discretes.iter().map(|discrete| &discrete.name)),
            refs: Table::of("reference", entity.refs.iter().map(|reference| &reference.name)),
            signals: Table::of("signal", entity.signals.iter().map(|signal| &signal.name)),
            buttons: Table::of("button", entity.buttons.iter()),
            axes: Table::of("axis", entity.axes.iter()),
            chances: Table::of("chance", entity.chances.iter().map(|chance| &chance.name)),
            modes: ModeNames::of(entity),
            lost: modes.iter().enumerate().map(|(index, mode)| lost(index, mode)).collect(),
        }
    }

    /// Where a parameter, a variable, a chance, a signal or a reference of a name is declared.
    pub fn value_place(&self, name: &str) -> Option<Span> {
        let param = self.params.entry(name).map(|(known, _)| known);
        let known = param.or_else(|| self.vars.entry(name).map(|(known, _)| known));
        let known = known.or_else(|| self.discretes.entry(name).map(|(known, _)| known));
        let known = known.or_else(|| self.refs.entry(name).map(|(known, _)| known));
        let known = known.or_else(|| self.chances.entry(name).map(|(known, _)| known));
        known.or_else(|| self.signals.entry(name).map(|(known, _)| known)).map(|known| known.span)
    }
}

impl Checker<'_> {
    /// Declares the names, types and modes of an entity; returns the rest for later.
    pub(super) fn skeleton<'t>(&mut self, syntax: &'t ast::Entity) -> (Entity, PendingBody<'t>) {
        let mut entity = Entity {
            name: syntax.name.clone(),
            doc: syntax.doc.as_deref().map(Box::from),
            params: RareVec::new(),
            reads_start: false,
            vars: IdVec::new(),
            discretes: RareVec::new(),
            refs: RareVec::new(),
            signals: RareVec::new(),
            bound: RareVec::new(),
            probes: RareVec::new(),
            buttons: RareVec::new(),
            axes: RareVec::new(),
            chances: RareVec::new(),
            colliders: RareVec::new(),
            groups: RareVec::new(),
            modes: RareVec::new(),
            edges: RareVec::new(),
            envelopes: RareVec::new(),
            drives: Vec::new(),
            clamps: Box::default(),
            invariants: Box::default(),
            conditions: Box::default(),
            order: Box::default(),
        };
        let mut body = PendingBody::default();
        for text in ["x", "y"] {
            let name = Name { text: text.into(), span: entity.name.span };
            entity.vars.push(Var { name, initial: None, dimension: None });
        }
        if syntax.reads_start {
            start::declare(&mut entity);
        }
        // The scope of parameter defaults.
        let mut names = Skeleton::of(&entity, &[], &self.conditions);
        let (mut modes, mut signals): (Vec<&Member>, Vec<Signal>) = (Vec::new(), Vec::new());
        // Parameters, variables and chances share one name space; buttons and axes another.
        let mut values: Table<()> = Table::new("parameter or variable");
        let mut inputs: Table<()> = Table::new("input");
        for member in &syntax.members {
            match member {
                Member::Parameter(p) => self.parameter(p, &mut entity, &mut names, &mut values),
                Member::Continuous(c) => {
                    self.record_declaration(NameKind::Variable, &c.name);
                    if self.is_new_value(&c.name, &mut values) {
                        let dimension = c.dimension.as_ref().and_then(|d| self.annotation(d));
                        let id = entity.vars.push(Var { name: c.name.clone(), initial: None, dimension });
                        names.vars.declare(&c.name, id, &mut self.diagnostics);
                    }
                    if c.initial.is_some() {
                        body.members.push(member);
                    }
                }
                Member::Discrete(d) => {
                    self.record_declaration(NameKind::Discrete, &d.name);
                    if !self.is_new_value(&d.name, &mut values) {
                        continue;
                    }
                    let (ty, range) = self.domain(&d.domain);
                    let initial = Term { kind: TermKind::Number(f64::from(range.0)), ty, span: d.name.span };
                    let values = match ty {
                        Type::Set(set) => Arc::clone(&self.sets[set].names),
                        _ => Arc::default(),
                    };
                    let id = entity.discretes.push(Discrete { name: d.name.clone(), ty, values, range, initial });
                    names.discretes.declare(&d.name, id, &mut self.diagnostics);
                    body.members.push(member);
                }
                Member::Reference(r) => {
                    self.record_declaration(NameKind::Reference, &r.name);
                    if !self.is_new_value(&r.name, &mut values) {
                        continue;
                    }
                    let entity_id = match self.entity_named(&r.entity) {
                        Some(id) => Some(id),
                        None if r.entity.text == "any" => None,
                        None => {
                            let known = self.entities.names().chain([Candidate::from("any")]);
                            let fact = unknown("entity", &r.entity.text, r.entity.span, known);
                            self.report_unknown(fact);
                            self.poisoned_names.insert(r.name.text.to_string());
                            continue;
                        }
                    };
                    let id = entity.refs.push(Reference { name: r.name.clone(), entity: entity_id });
                    names.refs.declare(&r.name, id, &mut self.diagnostics);
                }
                Member::Signals(list) => {
                    for signal in &list.0 {
                        if self.is_new_value(&signal.name, &mut values) {
                            signals.push(self.signal(signal));
                        }
                    }
                }
                Member::Buttons(list) => {
                    for name in &list.0 {
                        self.record_declaration(NameKind::Button, name);
                        if !inputs.declare(name, (), &mut self.diagnostics) {
                            continue;
                        }
                        if entity.buttons.is_full(MAX_BUTTONS) {
                            self.too_many("buttons", MAX_BUTTONS, name.span);
                            break;
                        }
                        let id = entity.buttons.push(name.clone());
                        names.buttons.declare(name, id, &mut self.diagnostics);
                    }
                }
                Member::Axes(list) => {
                    for name in &list.0 {
                        self.record_declaration(NameKind::Axis, name);
                        if !inputs.declare(name, (), &mut self.diagnostics) {
                            continue;
                        }
                        if entity.axes.is_full(MAX_AXES) {
                            self.too_many("axes", MAX_AXES, name.span);
                            break;
                        }
                        let id = entity.axes.push(name.clone());
                        names.axes.declare(name, id, &mut self.diagnostics);
                    }
                }
                Member::Chance(c) => self.chance(c, &mut entity, &mut names, &mut values),
                Member::Group(_) | Member::Mode(_) => modes.push(member),
                Member::Use(_) => {}
                other => body.members.push(other),
            }
        }
        // Those with a number come first.
        signals.order_by_key(|signal| signal.number.is_none());
        entity.signals = signals.into_iter().collect();
        self.groups(modes, &mut entity, &mut body.modes);
        (entity, body)
    }

    pub(super) fn too_many(&mut self, what: &str, limit: usize, at: Span) {
        self.diagnostics.report(TooMany { what: what.into(), count: limit as u64 + 1, limit: limit as u64, at });
    }

    fn is_new_value(&mut self, name: &Name, values: &mut Table<()>) -> bool {
        !self.is_of_every_entity(name) && values.declare(name, (), &mut self.diagnostics)
    }

    /// Reports a declaration of `x` or `y`.
    pub(super) fn is_of_every_entity(&mut self, name: &Name) -> bool {
        let is_position = name.text == "x" || name.text == "y";
        if is_position {
            self.diagnostics.report(Misplaced {
                at: name.span,
                what: "a declaration of `x` or `y`",
                inside: "an entity",
                belongs: "nowhere: every entity has `x` and `y`",
            });
        }
        is_position
    }

    fn parameter(&mut self, p: &ast::Constant, entity: &mut Entity, names: &mut Skeleton, values: &mut Table<()>) {
        self.record_declaration(NameKind::Parameter, &p.name);
        if !self.is_new_value(&p.name, values) {
            return;
        }
        let scope = Scope { entity: Some(entity), names: Some(names), ..Scope::constant() }.reading(ReadLimit::Params);
        let default = self.value(&p.value, &scope);
        let dimension = p.dimension.as_ref().and_then(|d| self.annotation(d));
        // A parameter with an invalid default still declares its name.
        let default = default.unwrap_or(Term { kind: TermKind::Number(0.0), ty: Type::Int, span: p.value.span });
        let id = entity.params.push(Param { name: p.name.clone(), default, dimension });
        names.params.declare(&p.name, id, &mut self.diagnostics);
    }

    fn chance(&mut self, c: &ast::Chance, entity: &mut Entity, names: &mut Skeleton, values: &mut Table<()>) {
        self.record_declaration(NameKind::Chance, &c.name);
        if !self.is_new_value(&c.name, values) {
            return;
        }
        if entity.chances.is_full(MAX_CHANCES) {
            self.too_many("chances", MAX_CHANCES, c.name.span);
            return;
        }
        // A chance with an invalid range still declares its name.
        let range = self.int_range(&c.low, &c.high).unwrap_or((0, 1));
        let id = entity.chances.push(Chance { name: c.name.clone(), range });
        names.chances.declare(&c.name, id, &mut self.diagnostics);
    }

    pub(super) fn annotation(&mut self, d: &ast::Dimension) -> Option<Annotation> {
        match Annotation::read(d) {
            Ok(annotation) => Some(annotation),
            Err(name) => {
                let fact = unknown("unit", &name.text, name.span, ["px", "s", "1"]);
                self.report_unknown(fact);
                None
            }
        }
    }

    /// The id of a set of names, created on first use.
    fn set(&mut self, names: Vec<String>) -> SetId {
        if let Some(&id) = self.set_ids.get(&names) {
            return id;
        }
        let names = Arc::new(names);
        let id = self.sets.push(Set { names: Arc::clone(&names), places: Vec::new() });
        self.set_ids.insert(names, id);
        id
    }

    fn domain(&mut self, domain: &Domain) -> (Type, (i32, i32)) {
        match domain {
            Domain::Bool => (Type::Bool, (0, 1)),
            Domain::Set(names) => {
                let mut table: Table<()> = Table::new("value");
                names.iter().for_each(|n| self.record_declaration(NameKind::Value, n));
                let fresh: Vec<String> = names
                    .iter()
                    .filter(|n| table.declare(n, (), &mut self.diagnostics))
                    .map(|n| n.text.to_string())
                    .collect();
                let last = fresh.len().saturating_sub(1) as i32;
                let set = self.set(fresh);
                self.sets[set].places.extend(names.iter().cloned());
                (Type::Set(set), (0, last))
            }
            Domain::Int(low, high) => (Type::Int, self.int_range(low, high).unwrap_or((i32::MIN, i32::MAX))),
        }
    }

    /// A constant range of whole numbers; `None` if it is reported.
    fn int_range(&mut self, low: &Expr, high: &Expr) -> Option<(i32, i32)> {
        let (a, b) = (self.whole(low), self.whole(high));
        let (a, b) = (a?, b?);
        if a <= b {
            return Some((a, b));
        }
        self.diagnostics.report(OutOfRange {
            at: high.span,
            what: format!("the greatest value {b}"),
            range: format!("{a} and above"),
        });
        None
    }

    /// A constant whole number.
    fn whole(&mut self, e: &Expr) -> Option<i32> {
        let term = self.typed(e, &Scope::constant(), &Type::Int)?;
        let value = self.evaluated(&term, ConstantContext::LITERALS)?;
        if value.abs() <= 1e9 {
            return Some(value as i32);
        }
        self.diagnostics.report(OutOfRange {
            at: e.span,
            what: value.to_string(),
            range: "-1000000000..1000000000".into(),
        });
        None
    }

    /// The value of a term that must be constant.
    pub(super) fn evaluated(&mut self, term: &Term, context: ConstantContext<'_>) -> Option<f64> {
        match evaluate(term, context) {
            Ok(value) => Some(value),
            Err(ConstantError::NotConstant(at)) => {
                self.diagnostics.report(NotConstant {
                    at,
                    what: "this value",
                    may_read: "literals and constants, and `frames` only inside of a world",
                });
                None
            }
            Err(ConstantError::NotFinite(at)) => {
                self.diagnostics.report(OutOfRange {
                    at,
                    what: "this value".into(),
                    range: "the finite numbers".into(),
                });
                None
            }
        }
    }

    /// Groups and modes, numbered in preorder. Modes outside of groups are one group, so is what `always` holds; both
    /// stand where the first of them is written.
    fn groups<'t>(&mut self, members: Vec<&'t Member>, entity: &mut Entity, body: &mut Vec<PendingMode<'t>>) {
        let mut group_names: Table<Span> = Table::new("group");
        let mut groups: Vec<(Option<&Name>, Vec<PendingMode<'t>>)> = Vec::new();
        let (mut anonymous, mut always) = (None, None);
        for member in members {
            match member {
                Member::Group(group) => {
                    self.record_declaration(NameKind::Group, &group.name);
                    group_names.declare(&group.name, group.name.span, &mut self.diagnostics);
                    let mut modes = Vec::new();
                    for inner in &group.members {
                        match inner {
                            Member::Mode(mode) if mode.initial != Initial::Always => modes.push((&**mode).into()),
                            Member::Mode(_) => self.misplaced(inner, "a group", "in the entity, outside of its groups"),
                            other => self.misplaced(other, "a group", "in the entity or in a mode"),
                        }
                    }
                    groups.push((Some(&group.name), modes));
                }
                Member::Mode(mode) => {
                    let place = if mode.initial == Initial::Always { &mut always } else { &mut anonymous };
                    let at = *place.get_or_insert(groups.len());
                    match groups.get_mut(at) {
                        // Several `always` are one mode, which may come from several behaviours.
                        Some((_, modes)) if mode.initial == Initial::Always => {
                            modes.iter_mut().take(1).for_each(|first| first.members.extend(&mode.members));
                        }
                        Some((_, modes)) => modes.push((&**mode).into()),
                        None => groups.push((None, vec![(&**mode).into()])),
                    }
                }
                _ => {}
            }
        }
        let outermost = anonymous.and_then(|at| groups.get(at)).into_iter().flat_map(|(_, modes)| modes);
        for PendingMode { syntax: mode, .. } in outermost {
            let other = always.filter(|_| mode.name.text == ALWAYS).and_then(|at| groups.get(at));
            let other = other.and_then(|(_, modes)| modes.first()).map(|always| always.syntax.name.span);
            // A path would name both.
            if let Some(first) = group_names.get(&mode.name.text).copied().or(other) {
                let (name, second) = (mode.name.text.to_string(), mode.name.span);
                self.diagnostics.report(DuplicateName { kind: "group or mode", name, first, second });
            }
        }
        for (name, modes) in groups {
            self.add_group(name, modes, entity, body);
        }
    }

    fn add_group<'t>(
        &mut self,
        name: Option<&Name>,
        modes: Vec<PendingMode<'t>>,
        entity: &mut Entity,
        body: &mut Vec<PendingMode<'t>>,
    ) {
        if modes.is_empty() {
            return;
        }
        let group: GroupId = entity.groups.push(Group { name: name.cloned(), modes: Vec::new() });
        let path: Vec<String> = name.iter().map(|n| n.text.to_string()).collect();
        let roots = self.mode_skeletons(modes, group, None, &path, entity, body);
        entity.groups[group].modes = roots;
    }

    pub(super) fn misplaced(&mut self, member: &Member, inside: &'static str, belongs: &'static str) {
        let (at, what) = match member {
            Member::Parameter(p) => (p.name.span, "a `param`"),
            Member::Continuous(c) => (c.name.span, "a `continuous`"),
            Member::Discrete(d) => (d.name.span, "a `discrete`"),
            Member::Buttons(list) => (list.1, "a `button`"),
            Member::Axes(list) => (list.1, "an `axis`"),
            Member::Chance(c) => (c.span, "a `chance`"),
            Member::Collider(c) => (c.span, "a `collider`"),
            Member::Group(g) => (g.name.span, "a `group`"),
            Member::Mode(m) if m.initial == Initial::Always => (m.name.span, "`always`"),
            Member::Mode(m) => (m.name.span, "a `mode`"),
            Member::Flow(a) => (a.span(), "a flow"),
            Member::Entry(update) => match &**update {
                ast::Update::Assign(a) => (a.span(), "an update"),
                ast::Update::Spawn(s) => (s.span, "a `spawn`"),
                ast::Update::Destroy(d) => (d.span, "a `destroy`"),
                ast::Update::Send(s) => (s.span, "a `send`"),
            },
            Member::Reference(r) => (r.name.span, "a `ref`"),
            Member::Clamp(c) => (c.span, "a `clamp`"),
            Member::Invariant(i) => (i.span, "an `invariant`"),
            Member::Condition(c) => (c.name.span, "a `condition`"),
            Member::Signals(list) => (list.1, "a `signal`"),
            Member::Look(l) => (l.span, "a `look`"),
            Member::Follow(f) => (f.span, "`follow links`"),
            Member::Use(u) => (u.span, "a `use`"),
            Member::Edge(e) => (e.span, "an edge"),
            Member::Envelope(e) => (e.span, "an `envelope`"),
        };
        self.diagnostics.report(Misplaced { at, what, inside, belongs });
    }

    /// Checks the body of an entity whose names are known.
    pub(super) fn entity(&mut self, body: PendingBody<'_>, id: EntityId) -> Entity {
        let frozen = self.checked.entities[id].clone();
        let mut entity = (*frozen).clone();
        self.declare_conditions(&body);
        let names = &Skeleton::of(&frozen, &body.modes, &self.conditions);
        let scope = Scope { entity: Some(&*frozen), names: Some(names), me: Some(id), ..Scope::constant() };
        let scope = scope.reading(ReadLimit::All);
        self.facts = Facts::default();
        self.entity_conditions(names, &scope);
        self.initial_values(&body.members, names, &mut entity, &scope);
        let (mut clamps, mut invariants) = (Vec::new(), Vec::new());
        let mut looks: Table<()> = Table::new("the look of");
        for member in body.members {
            match member {
                Member::Collider(c) => {
                    if let Some(collider) = self.collider(c, &scope) {
                        entity.colliders.push(collider);
                    }
                }
                Member::Flow(flow) => {
                    if let Some(drive) = self.flow(flow, &scope) {
                        entity.drives.push(drive);
                    }
                }
                Member::Envelope(envelope) => self.envelope(envelope, &scope, &mut entity, None),
                Member::Clamp(clamp) => clamps.extend(self.clamp(clamp, &scope)),
                Member::Look(look) => self.entity_look(look, (id, &frozen.name), &mut looks),
                Member::Invariant(invariant) => {
                    let scope = scope.reading(ReadLimit::State);
                    invariants.extend(self.guard(&invariant.predicate, &scope));
                }
                Member::Entry(_) | Member::Edge(_) | Member::Follow(_) => {
                    self.misplaced(member, "an entity outside of its modes", "inside a mode, or in `always { … }`");
                }
                _ => {}
            }
        }
        let members = body.modes.iter().flat_map(|mode| &mode.members);
        let edges = members.filter(|member| matches!(member, Member::Edge(_))).count();
        entity.edges.reserve(edges);
        let mut tested = Vec::with_capacity(edges);
        for (mode, syntax) in body.modes.into_iter().enumerate() {
            let scope = Scope { mode: Some(ModeId(mode as u32)), covered: true, ..scope };
            self.mode(syntax, ModeId(mode as u32), &scope, &mut entity, &mut tested);
        }
        self.flow_conflicts(&entity);
        self.lost_entries(&entity, &tested);
        (entity.clamps, entity.invariants) = (clamps.into(), invariants.into());
        entity.order = self.group_order(&entity).into();
        entity.conditions = self.take_conditions(&scope).into();
        entity.bound = std::mem::take(&mut self.facts.bound).into();
        entity.probes = std::mem::take(&mut self.facts.probes).into();
        entity
    }

    fn initial_values(&mut self, members: &[&Member], names: &Skeleton, entity: &mut Entity, scope: &Scope<'_>) {
        let scope = scope.reading(ReadLimit::Params);
        let mut record_use = BTreeSet::new();
        for member in members {
            let Member::Continuous(c) = *member else {
                continue;
            };
            let (Some(&var), Some(initial)) = (names.vars.get(&c.name.text), &c.initial) else {
                continue;
            };
            if record_use.insert(var) && !var.is_position() {
                entity.vars[var].initial = self.number(initial, &scope);
            }
        }
        let discretes = members.iter().filter_map(|m| if let Member::Discrete(d) = *m { Some(d) } else { None });
        for (index, discrete) in discretes.enumerate() {
            let id = DiscreteId(index as u32);
            let ty = entity.discretes[id].ty;
            if let Some(term) = self.typed(&discrete.initial, &scope, &ty) {
                self.certainly_in_range(&term, &entity.discretes[id]);
                entity.discretes[id].initial = term;
            }
        }
    }

    /// Reports a constant value outside of a discrete variable's range.
    pub(super) fn certainly_in_range(&mut self, value: &Term, discrete: &Discrete) {
        let (low, high) = discrete.range;
        if let Ok(known) = evaluate(value, ConstantContext::LITERALS)
            && !(f64::from(low)..=f64::from(high)).contains(&known)
        {
            self.diagnostics.report(OutOfRange {
                at: value.span,
                what: format!("`{}` = {known}", discrete.name.text),
                range: format!("{low}..{high}"),
            });
        }
    }
}
