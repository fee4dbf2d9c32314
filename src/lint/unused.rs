//! Declarations that nothing reads: parameters, variables, references, inputs, conditions.

use std::collections::{BTreeMap, BTreeSet};

use crate::diagnostic::Diagnostics;
use crate::diagnostic::catalogue::lint::Unused;
use crate::ir::{
    AxisId, ButtonId, ChanceId, DiscreteId, EntityId, ParamId, Place, RefId, SignalId, Subject, VarId, WorldId,
};
use crate::sema::checked::{Action, By, Checked, Condition, Entity, Given, Name, Term, TermKind};
use crate::source::{FileId, Span};

use super::terms;

/// The declarations that are read.
#[derive(Default)]
struct Reads {
    /// Members that are read, by entity; by no entity if it is known only at run time.
    what: BTreeSet<(Option<EntityId>, ReadTarget)>,
    refs: BTreeSet<(EntityId, RefId)>,
}

/// The context of a term: an entity or a world.
#[derive(Clone, Copy)]
enum TermOwner {
    Entity(EntityId),
    World(WorldId),
}

impl Reads {
    fn new(checked: &Checked) -> Self {
        let mut reads = Reads::default();
        for (id, entity) in checked.entities.pairs() {
            let here = TermOwner::Entity(id);
            let defaults = entity.params.iter().map(|p| &p.default);
            let firsts = entity.vars.iter().filter_map(|v| v.initial.as_ref());
            let firsts = firsts.chain(entity.discretes.iter().map(|d| &d.initial));
            let conditions = entity.conditions.iter().map(|c| &c.value);
            for term in terms::of_entity(entity).into_iter().chain(defaults).chain(firsts).chain(conditions) {
                reads.term(checked, here, term);
            }
            for envelope in entity.envelopes.iter() {
                match &envelope.by {
                    By::Button(button) => drop(reads.what.insert((Some(id), ReadTarget::Button(*button)))),
                    By::Axis(axis) => drop(reads.what.insert((Some(id), ReadTarget::Axis(*axis)))),
                    By::Axes(axes, _) => reads.what.extend(axes.iter().map(|axis| (Some(id), ReadTarget::Axis(*axis)))),
                    By::Clock(_) => {}
                }
            }
        }
        for (id, world) in checked.worlds.pairs() {
            let questions = world.goals.iter().chain(world.nevers.iter()).map(|q| &q.predicate);
            let guards = world.spaces.iter().flat_map(|s| &s.links).filter_map(|l| l.guard.as_ref());
            let given = world.instances.iter().flat_map(|i| &i.given).map(|(_, term)| term);
            let conditions = world.conditions.iter().map(|c| &c.value);
            let tests = world.tests.iter().flat_map(|test| &test.predicates);
            for term in questions.chain(guards).chain(given).chain(conditions).chain(tests) {
                reads.term(checked, TermOwner::World(id), term);
            }
        }
        reads
    }

    fn has(&self, entity: EntityId, what: ReadTarget) -> bool {
        self.what.contains(&(Some(entity), what)) || self.what.contains(&(None, what))
    }

    fn term(&mut self, checked: &Checked, here: TermOwner, term: &Term) {
        terms::walk(term, &mut |term| {
            let Some((of, what)) = read(&term.kind) else { return };
            if let (TermOwner::Entity(me), Subject::Ref(id)) = (here, of) {
                self.refs.insert((me, id));
            }
            self.what.insert((owner(checked, here, of), what));
        });
    }
}

/// The member that a term reads of an instance.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum ReadTarget {
    Param(ParamId),
    Var(VarId),
    Discrete(DiscreteId),
    Button(ButtonId),
    Axis(AxisId),
    Signal(SignalId),
    Chance(ChanceId),
    /// Its identity, contacts or mode.
    Itself,
}

fn read(term: &TermKind) -> Option<(Subject, ReadTarget)> {
    Some(match *term {
        TermKind::Param(of, id) => (of, ReadTarget::Param(id)),
        TermKind::Var(of, id, _) => (of, ReadTarget::Var(id)),
        TermKind::Discrete(of, id) => (of, ReadTarget::Discrete(id)),
        TermKind::Button(_, id) => (Subject::Me, ReadTarget::Button(id)),
        TermKind::Axis(id) => (Subject::Me, ReadTarget::Axis(id)),
        TermKind::Received(id) | TermKind::Sum(id) => (Subject::Me, ReadTarget::Signal(id)),
        TermKind::Chance(id) => (Subject::Me, ReadTarget::Chance(id)),
        TermKind::IsNone(of)
        | TermKind::Is(of, _)
        | TermKind::Instance(of)
        | TermKind::InMode(of, _)
        | TermKind::InSpace(of, _) => (of, ReadTarget::Itself),
        TermKind::Touching(ref query) => (query.of, ReadTarget::Itself),
        TermKind::Near(ref query) => (query.0, ReadTarget::Itself),
        TermKind::Distance(ref query) => (query.0, ReadTarget::Itself),
        _ => return None,
    })
}

/// The entity of a subject; none if it is known only at run time.
fn owner(checked: &Checked, here: TermOwner, of: Subject) -> Option<EntityId> {
    match (here, of) {
        (_, Subject::Member(entity)) => Some(entity),
        (TermOwner::Entity(me), Subject::Probed(probe)) => checked.entities[me].probed(probe),
        (TermOwner::Entity(me), Subject::Me) => Some(me),
        (TermOwner::World(world), Subject::Slot(slot)) => Some(checked.worlds[world].instances[slot].entity),
        (TermOwner::Entity(me), Subject::Ref(id)) => checked.entities[me].refs[id].entity,
        _ => None,
    }
}

/// Reports unread declarations. In the file `root` of a program with worlds, declarations that are written but never
/// read are reported too.
pub(super) fn unused(checked: &Checked, root: FileId, found: &mut Diagnostics) {
    let reads = Reads::new(checked);
    let writes = writes(checked);
    for (id, entity) in checked.entities.pairs() {
        let is_final = !checked.worlds.is_empty() && entity.name.span.file() == root;
        let mut judge = |kind: &'static str, name: &Name, is_read: bool, written: Option<Span>| {
            if is_read || name.text.starts_with('_') || (written.is_some() && !is_final) {
                return;
            }
            found.report(Unused { kind, name: name.text.to_string(), at: name.span, written });
        };
        for (param, p) in entity.declared_params() {
            judge("parameter", &p.name, reads.has(id, ReadTarget::Param(param)), None);
        }
        let drives = entity.drives.iter().chain(entity.modes.iter().flat_map(|m| &m.drives));
        let mut driven: BTreeMap<VarId, Span> = BTreeMap::new();
        for drive in drives {
            driven.entry(drive.var).or_insert(drive.span);
        }
        // The position of an instance is always observable.
        for (var, v) in entity.vars.pairs().skip(2) {
            let written = writes.get(&(id, Target::Var(var))).copied();
            let driven = driven.get(&var).copied();
            judge("variable", &v.name, reads.has(id, ReadTarget::Var(var)), driven.or(written));
        }
        for (discrete, d) in entity.discretes.pairs() {
            let written = writes.get(&(id, Target::Discrete(discrete))).copied();
            judge("variable", &d.name, reads.has(id, ReadTarget::Discrete(discrete)), written);
        }
        for (reference, r) in entity.refs.pairs() {
            let written = writes.get(&(id, Target::Ref(reference))).copied();
            judge("reference", &r.name, reads.refs.contains(&(id, reference)), written);
        }
        for (signal, s) in entity.signals.pairs() {
            judge("signal", &s.name, reads.has(id, ReadTarget::Signal(signal)), None);
        }
        for condition in &entity.conditions {
            judge("condition", &condition.name, condition.is_used, None);
        }
        for (button, name) in entity.buttons.pairs() {
            judge("button", name, reads.has(id, ReadTarget::Button(button)), None);
        }
        for (axis, name) in entity.axes.pairs() {
            judge("axis", name, reads.has(id, ReadTarget::Axis(axis)), None);
        }
        for (chance, c) in entity.chances.pairs() {
            judge("chance", &c.name, reads.has(id, ReadTarget::Chance(chance)), None);
        }
    }
    for condition in checked.worlds.iter().flat_map(|w| &w.conditions) {
        let Condition { name, is_used, .. } = condition;
        if !is_used && !name.text.starts_with('_') {
            let (kind, name, at) = ("condition", name.text.to_string(), name.span);
            found.report(Unused { kind, name, at, written: None });
        }
    }
}

/// A write target: a variable in any degree.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Target {
    Var(VarId),
    Discrete(DiscreteId),
    Ref(RefId),
}

impl From<Place> for Target {
    fn from(place: Place) -> Self {
        match place {
            Place::Var(id, _) => Target::Var(id),
            Place::Discrete(id) => Target::Discrete(id),
            Place::Ref(id) => Target::Ref(id),
        }
    }
}

/// The first write of each target, by the entity's own code or by code that spawns or places it.
fn writes(checked: &Checked) -> BTreeMap<(EntityId, Target), Span> {
    let mut first = BTreeMap::new();
    let give = |first: &mut BTreeMap<_, _>, entity: EntityId, given: &[(Given, Term)]| {
        for (what, term) in given {
            let target = match *what {
                Given::Var(id, _) => Target::Var(id),
                Given::Discrete(id) => Target::Discrete(id),
                Given::Ref(id) => Target::Ref(id),
                Given::Param(_) => continue,
            };
            first.entry((entity, target)).or_insert(term.span);
        }
    };
    for (id, entity) in checked.entities.pairs() {
        for action in actions(entity) {
            match action {
                Action::Update(update) => drop(first.entry((id, update.place.into())).or_insert(update.span)),
                Action::Spawn(spawn) => {
                    if let Some(into) = spawn.into {
                        first.entry((id, Target::Ref(into))).or_insert(spawn.span);
                    }
                    give(&mut first, spawn.entity, &spawn.given);
                }
                Action::Destroy(_) | Action::Send(_) => {}
            }
        }
    }
    for instance in checked.worlds.iter().flat_map(|w| w.instances.iter()) {
        give(&mut first, instance.entity, &instance.given);
    }
    first
}

fn actions(entity: &Entity) -> impl Iterator<Item = &Action> {
    let entries = entity.modes.iter().flat_map(|m| &m.entry);
    let follows = entity.modes.iter().flat_map(|m| &m.follows).flat_map(|f| &f.actions);
    entries.chain(follows).chain(entity.edges.iter().flat_map(|e| &e.actions))
}
