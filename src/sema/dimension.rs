//! Dimension inference: every number has a dimension `px^i · s^j`, inferred from its uses; annotations are optional.
//!
//! Exponents are unknowns of linear equations, solved one by one as uses are found (unification in an Abelian group;
//! Kennedy, *Programming Languages and Dimensions*, 1996). A literal takes the dimension that its context needs; as a
//! factor beside another term it is dimensionless.

mod ratio;
mod report;

use crate::ir::{Arithmetic, EntityId, Function, ParamId, Place, SignalId, SlotId, Subject, VarId};

use std::collections::BTreeMap;

use crate::diagnostic::Diagnostics;
use crate::source::{SourceMap, Span};

use ratio::Ratio;

use super::checked::{Action, By, Checked, DriveBy, Entity, Given, Rate, Release, Term, TermKind, World};

type Unknown = usize;

/// A dimension: known exponents plus multiples of unknown dimensions.
#[derive(Debug, Clone, PartialEq)]
struct Dim {
    px: Ratio,
    s: Ratio,
    unknowns: BTreeMap<Unknown, Ratio>,
    /// Whether an exponent overflowed, so that the dimension is unknown.
    is_unknown: bool,
}

impl Dim {
    fn known(px: i64, s: i64) -> Dim {
        Dim { px: Ratio(px, 1), s: Ratio(s, 1), unknowns: BTreeMap::new(), is_unknown: false }
    }
    fn unknown(u: Unknown) -> Dim {
        Dim { unknowns: BTreeMap::from([(u, Ratio::ONE)]), ..Dim::known(0, 0) }
    }
    fn plus(mut self, other: &Dim, factor: Ratio) -> Dim {
        self.add(other, factor);
        self
    }
    fn add(&mut self, other: &Dim, factor: Ratio) {
        if self.try_add(other, factor).is_none() {
            *self = Dim { is_unknown: true, ..Dim::known(0, 0) };
        }
    }
    /// `None` if an exponent cannot be represented exactly; `self` is then invalid.
    fn try_add(&mut self, other: &Dim, factor: Ratio) -> Option<()> {
        if self.is_unknown || other.is_unknown {
            return None;
        }
        self.px = self.px.plus(other.px.times(factor)?)?;
        self.s = self.s.plus(other.s.times(factor)?)?;
        for (u, r) in &other.unknowns {
            let sum = self.unknowns.get(u).copied().unwrap_or(Ratio::ZERO).plus(r.times(factor)?)?;
            if sum == Ratio::ZERO {
                self.unknowns.remove(u);
            } else {
                self.unknowns.insert(*u, sum);
            }
        }
        Some(())
    }
    fn words(&self) -> String {
        let part = |unit: &str, r: Ratio| match (r.0, r.1) {
            (1, 1) => unit.to_string(),
            (n, 1) => format!("{unit}^{n}"),
            (n, d) => format!("{unit}^({n}/{d})"),
        };
        let negative = |r: Ratio| Ratio(-r.0, r.1);
        let mut top: Vec<String> = Vec::new();
        let mut bottom: Vec<String> = Vec::new();
        for (unit, r) in [("px", self.px), ("s", self.s)] {
            match r.0.signum() {
                1 => top.push(part(unit, r)),
                -1 => bottom.push(part(unit, negative(r))),
                _ => {}
            }
        }
        let top = if top.is_empty() { "1".to_string() } else { top.join("*") };
        if bottom.is_empty() { top } else { format!("{top}/{}", bottom.join("/")) }
    }
}

const TIME: (i64, i64) = (0, 1);
const LENGTH: (i64, i64) = (1, 0);

/// Checks all entities and worlds of a program without other errors. Returns the dimensions of parameters and
/// variables.
pub(super) fn check(program: &Checked, sources: &SourceMap, diagnostics: &mut Diagnostics) -> Dimensions {
    let mut solver = Solver {
        program,
        solved: Vec::new(),
        named: BTreeMap::new(),
        conflicts: Vec::new(),
        envelope: None,
        roots: Vec::new(),
    };
    for (id, entity) in program.entities.pairs() {
        solver.entity(id, entity);
    }
    for world in program.worlds.iter() {
        solver.world(world);
        for condition in &world.conditions {
            let entity_of = |slot: SlotId| world.instances[slot].entity;
            solver.dimension(&condition.value, &TermContext { me: None, entity_of: &entity_of });
        }
        let questions = world.goals.iter().chain(world.nevers.iter()).map(|question| &question.predicate);
        for predicate in questions.chain(world.tests.iter().flat_map(|test| &test.predicates)) {
            let entity_of = |slot: SlotId| world.instances[slot].entity;
            solver.dimension(predicate, &TermContext { me: None, entity_of: &entity_of });
        }
        for guard in world.spaces.iter().flat_map(|s| &s.links).filter_map(|l| l.guard.as_ref()) {
            let entity_of = |slot: SlotId| world.instances[slot].entity;
            solver.dimension(guard, &TermContext { me: None, entity_of: &entity_of });
        }
    }
    let found = solver.found();
    solver.report(sources, diagnostics);
    found
}

/// The dimensions of parameters and variables, in source syntax: `px/s^2`.
#[derive(Debug, Clone, Default)]
pub struct Dimensions {
    /// Dimensions of parameters that follow from their uses.
    pub params: BTreeMap<(EntityId, ParamId), String>,
    /// Dimensions of continuous variables.
    pub vars: BTreeMap<(EntityId, VarId), String>,
}

/// The context of a term: how its subjects resolve.
struct TermContext<'a> {
    me: Option<EntityId>,
    entity_of: &'a dyn Fn(SlotId) -> EntityId,
}

/// A name with an unknown dimension.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Named {
    Param(EntityId, ParamId),
    Var(EntityId, VarId),
}

/// The site of a term whose dimension does not fit.
#[derive(Debug, Clone)]
enum ConflictSite {
    /// A context with a required dimension.
    Place,
    /// Beside another term, related by an operation.
    Term(Term, Relation),
    /// It is driven by an envelope together with the first variable.
    Driven { first: VarId, other: VarId, degree: u8 },
}

/// An operation that requires equal dimensions.
#[derive(Debug, Clone, Copy)]
enum Relation {
    Added,
    Subtracted,
    Compared,
    Given(Function),
}

struct Conflict {
    entity: Option<EntityId>,
    term: Term,
    needed: Dim,
    found: Dim,
    beside: ConflictSite,
    /// The enclosing envelope.
    envelope: Option<Span>,
}

struct Solver<'p> {
    program: &'p Checked,
    /// For each unknown: its solution, and the use that determined it.
    solved: Vec<Option<(Dim, Span)>>,
    named: BTreeMap<Named, Unknown>,
    conflicts: Vec<Conflict>,
    /// The envelope whose terms are being checked.
    envelope: Option<Span>,
    /// For each square root: its dimension and its argument.
    roots: Vec<(Dim, Term)>,
}

impl Solver<'_> {
    /// The inferred dimensions.
    fn found(&mut self) -> Dimensions {
        let mut out = Dimensions::default();
        for (name, unknown) in self.named.clone() {
            let dim = self.reduce(&Dim::unknown(unknown));
            if dim.is_unknown || !dim.unknowns.is_empty() {
                continue;
            }
            match name {
                Named::Param(entity, id) => out.params.insert((entity, id), dim.words()),
                Named::Var(entity, id) => out.vars.insert((entity, id), dim.words()),
            };
        }
        out
    }

    fn new_unknown(&mut self) -> Unknown {
        self.solved.push(None);
        self.solved.len() - 1
    }

    fn name(&mut self, name: Named) -> Dim {
        if let Named::Var(_, var) = name
            && var <= VarId::Y
        {
            return Dim::known(1, 0);
        }
        if let Some(&u) = self.named.get(&name) {
            return Dim::unknown(u);
        }
        let u = self.new_unknown();
        self.named.insert(name, u);
        let annotation = match name {
            Named::Param(e, p) => self.program.entities[e].params[p].dimension,
            Named::Var(e, v) => self.program.entities[e].vars[v].dimension,
        };
        if let Some(a) = annotation {
            self.solved[u] = Some((Dim::known(i64::from(a.px), i64::from(a.s)), a.span));
        }
        Dim::unknown(u)
    }

    /// Replaces all solved unknowns in a dimension.
    fn reduce(&mut self, dim: &Dim) -> Dim {
        self.reduce_solutions(dim);
        self.substitute(dim)
    }

    /// Replaces solved unknowns in a dimension once, not recursively.
    fn substitute(&self, dim: &Dim) -> Dim {
        let mut out = Dim { unknowns: BTreeMap::new(), ..dim.clone() };
        for (u, r) in &dim.unknowns {
            match &self.solved[*u] {
                Some((solution, _)) => out.add(solution, *r),
                None => out.add(&Dim::unknown(*u), *r),
            }
        }
        out
    }

    /// Reduces the solutions that a dimension needs, innermost first, without recursion: chains may be long.
    fn reduce_solutions(&mut self, dim: &Dim) {
        let mut open: Vec<(Unknown, bool)> = dim.unknowns.keys().map(|u| (*u, false)).collect();
        while let Some((u, inner_done)) = open.pop() {
            let Some((solution, at)) = &self.solved[u] else { continue };
            if solution.unknowns.keys().all(|v| self.solved[*v].is_none()) {
                continue;
            }
            if inner_done {
                self.solved[u] = Some((self.substitute(solution), *at));
            } else {
                open.push((u, true));
                open.extend(solution.unknowns.keys().map(|v| (*v, false)));
            }
        }
    }

    /// Unifies `found`, the dimension of `term`, with the dimension that its context needs.
    fn unify(&mut self, term: &Term, found: &Dim, needed: &Dim, beside: ConflictSite, context: &TermContext<'_>) {
        let difference = self.reduce(found).plus(&self.reduce(needed), Ratio(-1, 1));
        // A single unknown is determined by this use.
        let pick =
            difference.unknowns.iter().max_by_key(|(u, _)| found.unknowns.contains_key(*u)).map(|(u, r)| (*u, *r));
        match pick {
            Some((u, r)) => {
                let rest = difference.plus(&Dim::unknown(u), Ratio(-r.0, r.1));
                let solution = Dim::known(0, 0).plus(&rest, Ratio::new(-r.1, r.0));
                if !solution.is_unknown {
                    self.solved[u] = Some((solution, term.span));
                }
            }
            None if difference.px != Ratio::ZERO || difference.s != Ratio::ZERO => {
                let (needed, found) = (self.reduce(needed), self.reduce(found));
                self.conflicts.push(Conflict {
                    entity: context.me,
                    term: term.clone(),
                    needed,
                    found,
                    beside,
                    envelope: self.envelope,
                });
            }
            None => {}
        }
    }

    /// The default of a parameter, the first information about its dimension. It solves at most one unknown: otherwise
    /// products of products would grow.
    fn is_given(&mut self, term: &Term, found: &Dim, needed: &Dim, context: &TermContext<'_>) {
        let own = needed.unknowns.keys().next().copied().filter(|u| self.solved[*u].is_none());
        let found = self.reduce(found);
        match own {
            Some(own) if found.unknowns.len() > 1 && !found.unknowns.contains_key(&own) => {
                self.solved[own] = Some((found, term.span))
            }
            _ => self.unify(term, &found, needed, ConflictSite::Place, context),
        }
    }

    /// A term in a context with a known dimension.
    fn place(&mut self, term: &Term, needed: &Dim, context: &TermContext<'_>) {
        if let Some(found) = self.dimension(term, context) {
            self.unify(term, &found, needed, ConflictSite::Place, context);
        }
    }

    /// Terms that must agree; returns their common dimension, `None` if all are literals.
    fn agree(&mut self, terms: &[&Term], joint: Relation, context: &TermContext<'_>) -> Option<Dim> {
        let mut common: Option<(Dim, &Term)> = None;
        for term in terms {
            let Some(found) = self.dimension(term, context) else {
                continue;
            };
            match &common {
                Some((needed, first)) => {
                    self.unify(term, &found, needed, ConflictSite::Term((*first).clone(), joint), context);
                }
                None => common = Some((found, term)),
            }
        }
        common.map(|(dim, _)| dim)
    }

    /// The dimension of a term; `None` for literals, which fit everywhere.
    fn dimension(&mut self, term: &Term, context: &TermContext<'_>) -> Option<Dim> {
        let entity = |of: Subject| match of {
            Subject::Me => context.me,
            Subject::Slot(slot) => Some((context.entity_of)(slot)),
            Subject::Ref(id) => context.me.and_then(|me| self.program.entities[me].refs[id].entity),
            Subject::Member(entity) => Some(entity),
            Subject::Probed(id) => context.me.and_then(|me| self.program.entities[me].probed(id)),
            Subject::Touched(_) => None,
        };
        match &term.kind {
            TermKind::Number(_) | TermKind::Bool(_) => None,
            TermKind::Quantity(quantity) => Some(Dim::known(i64::from(quantity.1), i64::from(quantity.2))),
            TermKind::Frames(_) | TermKind::Timer(_) => Some(Dim::known(TIME.0, TIME.1)),
            TermKind::Param(of, p) => Some(self.name(Named::Param(entity(*of)?, *p))),
            TermKind::Var(of, var, degree) => {
                let base = match entity(*of) {
                    Some(entity) => self.name(Named::Var(entity, *var)),
                    None if *var <= VarId::Y => Dim::known(LENGTH.0, LENGTH.1),
                    None => return None,
                };
                Some(base.plus(&Dim::known(0, -i64::from(*degree)), Ratio::ONE))
            }
            TermKind::Discrete(..) | TermKind::Axis(_) | TermKind::Chance(_) => Some(Dim::known(0, 0)),
            TermKind::Sum(sum) => Some(self.of_sum(context.me?, *sum)),
            TermKind::Negate(a) => self.dimension(a, context),
            TermKind::Arithmetic(Arithmetic::Add, sides) => {
                let [a, b] = sides.as_ref();
                self.agree(&[a, b], Relation::Added, context)
            }
            TermKind::Arithmetic(Arithmetic::Subtract, sides) => {
                let [a, b] = sides.as_ref();
                self.agree(&[a, b], Relation::Subtracted, context)
            }
            TermKind::Arithmetic(op, sides) => {
                let [a, b] = sides.as_ref();
                let sign = if *op == Arithmetic::Divide { Ratio(-1, 1) } else { Ratio::ONE };
                let (a, b) = (self.dimension(a, context), self.dimension(b, context));
                if a.is_none() && b.is_none() {
                    return None;
                }
                let pure = Dim::known(0, 0);
                Some(a.unwrap_or(pure.clone()).plus(&b.unwrap_or(pure), sign))
            }
            TermKind::Call(call) => {
                let (function, args) = call.as_ref();
                let args: Vec<&Term> = args.iter().collect();
                match (function, args.as_slice()) {
                    (Function::If, [condition, values @ ..]) => {
                        self.dimension(condition, context);
                        self.agree(values, Relation::Given(*function), context)
                    }
                    (Function::Sign | Function::Atan2, _) => {
                        self.agree(&args, Relation::Given(*function), context);
                        Some(Dim::known(0, 0))
                    }
                    (Function::Sin | Function::Cos, [angle]) => {
                        self.place(angle, &Dim::known(0, 0), context);
                        Some(Dim::known(0, 0))
                    }
                    (Function::Sqrt, [a]) => {
                        let square = self.dimension(a, context)?;
                        let root = Dim::unknown(self.new_unknown());
                        let twice = Dim::known(0, 0).plus(&root, Ratio(2, 1));
                        self.unify(a, &twice, &square, ConflictSite::Place, context);
                        self.roots.push((root.clone(), (*a).clone()));
                        Some(root)
                    }
                    _ => self.agree(&args, Relation::Given(*function), context),
                }
            }
            TermKind::Compare(_, sides) => {
                let [a, b] = sides.as_ref();
                self.agree(&[a, b], Relation::Compared, context);
                None
            }
            TermKind::And(sides) | TermKind::Or(sides) => {
                for side in sides.iter() {
                    self.dimension(side, context);
                }
                None
            }
            TermKind::Not(a) => {
                self.dimension(a, context);
                None
            }
            TermKind::Count(of) => {
                for term in of.iter() {
                    self.dimension(term, context);
                }
                Some(Dim::known(0, 0))
            }
            TermKind::Tiles(_) => Some(Dim::known(0, 0)),
            TermKind::Near(_) | TermKind::Probe(_) | TermKind::Distance(_) => {
                let length = Dim::known(LENGTH.0, LENGTH.1);
                term.operands().iter().for_each(|term| self.place(term, &length, context));
                matches!(term.kind, TermKind::Distance(_)).then_some(length)
            }
            TermKind::Members(_) | TermKind::Nearest(_) => {
                term.operands().iter().for_each(|term| drop(self.dimension(term, context)));
                matches!(term.kind, TermKind::Members(_)).then(|| Dim::known(0, 0))
            }
            TermKind::Button(..)
            | TermKind::Touching(_)
            | TermKind::Joint { .. }
            | TermKind::Received(_)
            | TermKind::IsNone(_)
            | TermKind::Is(..)
            | TermKind::Alive(_)
            | TermKind::NoneRef
            | TermKind::Instance(_)
            | TermKind::InMode(..)
            | TermKind::InSpace(..) => None,
        }
    }

    fn world(&mut self, world: &World) {
        let length = Dim::known(LENGTH.0, LENGTH.1);
        let nobody = TermContext { me: None, entity_of: &|_| EntityId(0) };
        for side in &world.lengths {
            self.place(side, &length, &nobody);
        }
        let time = Dim::known(TIME.0, TIME.1);
        for term in &world.times {
            self.place(term, &time, &nobody);
        }
        for instance in world.instances.iter() {
            let id = instance.entity;
            let context = TermContext { me: Some(id), entity_of: &|_| id };
            self.given(id, &instance.given, &context);
        }
    }

    /// Checks the values given to an instance of an entity; the terms belong to `context`.
    fn given(&mut self, id: EntityId, given: &[(Given, Term)], context: &TermContext<'_>) {
        for (what, term) in given {
            let needed = match *what {
                Given::Param(param) => self.name(Named::Param(id, param)),
                Given::Var(var, degree) => self.derivative(id, var, degree),
                Given::Discrete(_) => Dim::known(0, 0),
                Given::Ref(_) => continue,
            };
            self.place(term, &needed, context);
        }
    }

    /// The dimension of the number of a signal: as declared, else that of a whole number.
    fn of_sum(&self, entity: EntityId, signal: SignalId) -> Dim {
        let number = self.program.entities[entity].signals[signal].number.as_ref();
        let declared = number.and_then(|number| number.dimension);
        declared.map_or(Dim::known(0, 0), |a| Dim::known(i64::from(a.px), i64::from(a.s)))
    }

    /// The dimension of a variable or one of its derivatives.
    fn derivative(&mut self, id: EntityId, var: VarId, degree: u8) -> Dim {
        self.name(Named::Var(id, var)).plus(&Dim::known(0, -i64::from(degree)), Ratio::ONE)
    }

    fn entity(&mut self, id: EntityId, entity: &Entity) {
        let context = TermContext { me: Some(id), entity_of: &|_| id };
        let of_var = |this: &mut Self, var: VarId, degree: u8| this.derivative(id, var, degree);
        let length = Dim::known(LENGTH.0, LENGTH.1);
        let time = Dim::known(TIME.0, TIME.1);
        let updates = |this: &mut Self, actions: &[Action]| {
            for action in actions {
                match action {
                    Action::Update(update) => match update.place {
                        Place::Var(var, degree) => {
                            let needed = of_var(this, var, degree);
                            this.place(&update.value, &needed, &context);
                        }
                        Place::Discrete(_) => this.place(&update.value, &Dim::known(0, 0), &context),
                        Place::Ref(_) => {}
                    },
                    Action::Spawn(spawn) => this.given(spawn.entity, &spawn.given, &context),
                    Action::Destroy(_) => {}
                    Action::Send(send) => {
                        if let Some(number) = &send.number {
                            let needed = this.of_sum(send.entity, send.signal);
                            this.place(number, &needed, &context);
                        }
                    }
                }
            }
        };
        // The given value is the first information about a parameter.
        for (param, declared) in entity.params.pairs() {
            if let Some(found) = self.dimension(&declared.default, &context) {
                let needed = self.name(Named::Param(id, param));
                self.is_given(&declared.default, &found, &needed, &context);
            }
        }
        for drive in entity.drives.iter().chain(entity.modes.iter().flat_map(|m| &m.drives)) {
            if let DriveBy::Flow(value) = &drive.by {
                let needed = of_var(self, drive.var, drive.degree);
                self.place(value, &needed, &context);
            }
        }
        for envelope in entity.envelopes.iter() {
            let Some(&var) = envelope.vars.first() else { continue };
            // Its keyword is its span.
            let (start, end) = (envelope.span.start(), envelope.span.end());
            self.envelope = Some(envelope.span.ending(end.min(start + "envelope".len() as u32)));
            let level = of_var(self, var, envelope.degree);
            let rate_of = of_var(self, var, envelope.degree + 1);
            // All components of a vector have one dimension.
            for &other in envelope.vars.iter().skip(1) {
                let found = of_var(self, other, envelope.degree);
                let (first, degree) = (var, envelope.degree);
                self.unify(&envelope.sustain, &found, &level, ConflictSite::Driven { first, other, degree }, &context);
            }
            let rate = |this: &mut Self, rate: &Rate| match rate {
                Rate::Instant => {}
                Rate::Accel(a) => this.place(a, &rate_of, &context),
                Rate::Over(t) => this.place(t, &time, &context),
            };
            rate(self, &envelope.attack);
            self.place(&envelope.sustain, &level, &context);
            if let Some(peak) = &envelope.peak {
                self.place(peak, &level, &context);
                rate(self, &envelope.decay);
            }
            if let (By::Clock(_), Some(held)) = (&envelope.by, &envelope.sustain_for) {
                self.place(held, &time, &context);
            }
            if let Release::To(release, to) = &envelope.release {
                rate(self, release);
                if let Some(to) = to {
                    self.place(to, &level, &context);
                }
            }
            if let Some(guard) = &envelope.driven_while {
                self.dimension(guard, &context);
            }
        }
        self.envelope = None;
        for mode in entity.modes.iter() {
            updates(self, &mode.entry);
            if let Some(guard) = &mode.initial_when {
                self.dimension(guard, &context);
            }
            for follow in &mode.follows {
                updates(self, &follow.actions);
                if let Some(guard) = &follow.guard {
                    self.dimension(guard, &context);
                }
            }
        }
        for edge in entity.edges.iter() {
            self.dimension(&edge.guard, &context);
            updates(self, &edge.actions);
        }
        for collider in entity.colliders.iter() {
            for side in collider.shape.numbers() {
                self.place(side, &length, &context);
            }
            if let Some(guard) = &collider.guard {
                self.dimension(guard, &context);
            }
        }
        for clamp in &entity.clamps {
            let needed = of_var(self, clamp.var, clamp.degree);
            for bound in clamp.low.iter().chain(&clamp.high) {
                self.place(bound, &needed, &context);
            }
        }
        for invariant in &entity.invariants {
            self.dimension(invariant, &context);
        }
        for (var, declared) in entity.vars.pairs() {
            if let Some(initial) = &declared.initial {
                let needed = of_var(self, var, 0);
                self.place(initial, &needed, &context);
            }
        }
        for condition in &entity.conditions {
            self.dimension(&condition.value, &context);
        }
    }
}
