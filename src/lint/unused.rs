//! Declarations that nothing reads: parameters, variables, references, inputs.

use std::collections::{BTreeMap, BTreeSet};

use crate::diagnostic::Diagnostics;
use crate::diagnostic::catalogue::lint::Unused;
use crate::ir::{AxisId, ButtonId, DiscreteId, EntityId, ParamId, Place, RefId, Subject, VarId, WorldId};
use crate::sema::checked::{Action, By, Checked, Entity, Given, Name, Term, TermKind};
use crate::source::{FileId, Span};

use super::terms;

/// Who reads what.
#[derive(Default)]
struct Reads {
    /// What is read of an entity; of all of them where only the run tells.
    what: BTreeSet<(Option<EntityId>, What)>,
    refs: BTreeSet<(EntityId, RefId)>,
}

/// Where a term is: in an entity, or in a world.
#[derive(Clone, Copy)]
enum Here {
    Entity(EntityId),
    World(WorldId),
}

impl Reads {
    fn new(checked: &Checked) -> Self {
        let mut reads = Reads::default();
        for (id, entity) in checked.entities.pairs() {
            let here = Here::Entity(id);
            let defaults = entity.params.iter().map(|p| &p.default);
            let firsts = entity.vars.iter().filter_map(|v| v.initial.as_ref());
            let firsts = firsts.chain(entity.discretes.iter().map(|d| &d.initial));
            for term in terms::of_entity(entity).into_iter().chain(defaults).chain(firsts) {
                reads.term(checked, here, term);
            }
            for envelope in entity.envelopes.iter() {
                match &envelope.by {
                    By::Button(button) => drop(reads.what.insert((Some(id), What::Button(*button)))),
                    By::Axis(axis) => drop(reads.what.insert((Some(id), What::Axis(*axis)))),
                    By::Axes(axes, _) => reads.what.extend(axes.iter().map(|axis| (Some(id), What::Axis(*axis)))),
                    By::Clock(_) => {}
                }
            }
        }
        for (id, world) in checked.worlds.pairs() {
            let questions = world.goals.iter().chain(world.nevers.iter()).map(|q| &q.predicate);
            let guards = world.spaces.iter().flat_map(|s| &s.links).filter_map(|l| l.guard.as_ref());
            let given = world.instances.iter().flat_map(|i| &i.given).map(|(_, term)| term);
            for term in questions.chain(guards).chain(given) {
                reads.term(checked, Here::World(id), term);
            }
        }
        reads
    }

    fn has(&self, entity: EntityId, what: What) -> bool {
        self.what.contains(&(Some(entity), what)) || self.what.contains(&(None, what))
    }

    fn term(&mut self, checked: &Checked, here: Here, term: &Term) {
        terms::walk(term, &mut |term| {
            let Some((of, what)) = read(&term.kind) else { return };
            if let (Here::Entity(me), Subject::Ref(id)) = (here, of) {
                self.refs.insert((me, id));
            }
            self.what.insert((owner(checked, here, of), what));
        });
    }
}

/// What a term reads of an instance.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum What {
    Param(ParamId),
    Var(VarId),
    Discrete(DiscreteId),
    Button(ButtonId),
    Axis(AxisId),
    /// Which instance it is, or what it does.
    Itself,
}

fn read(term: &TermKind) -> Option<(Subject, What)> {
    Some(match *term {
        TermKind::Param(of, id) => (of, What::Param(id)),
        TermKind::Var(of, id, _) => (of, What::Var(id)),
        TermKind::Discrete(of, id) => (of, What::Discrete(id)),
        TermKind::Button(_, id) => (Subject::Me, What::Button(id)),
        TermKind::Axis(id) => (Subject::Me, What::Axis(id)),
        TermKind::IsNone(of)
        | TermKind::Is(of, _)
        | TermKind::Instance(of)
        | TermKind::InMode(of, _)
        | TermKind::InSpace(of, _) => (of, What::Itself),
        TermKind::Touching(ref asked) => (asked.of, What::Itself),
        TermKind::Near(ref asked) => (asked.0, What::Itself),
        _ => return None,
    })
}

/// The entity that a subject is of; none where only the run tells.
fn owner(checked: &Checked, here: Here, of: Subject) -> Option<EntityId> {
    match (here, of) {
        (Here::Entity(me), Subject::Me) => Some(me),
        (Here::World(world), Subject::Slot(slot)) => Some(checked.worlds[world].instances[slot].entity),
        (Here::Entity(me), Subject::Ref(id)) => checked.entities[me].refs[id].entity,
        _ => None,
    }
}

/// Reports what nothing reads. In the file `root` of a program with worlds, what is written but never read counts, too.
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
        for (param, p) in entity.params.pairs() {
            judge("parameter", &p.name, reads.has(id, What::Param(param)), None);
        }
        let drives = entity.drives.iter().chain(entity.modes.iter().flat_map(|m| &m.drives));
        let mut driven: BTreeMap<VarId, Span> = BTreeMap::new();
        for drive in drives {
            driven.entry(drive.var).or_insert(drive.span);
        }
        // Where an instance is, everybody sees.
        for (var, v) in entity.vars.pairs().skip(2) {
            let written = writes.get(&(id, Target::Var(var))).copied();
            let driven = driven.get(&var).copied();
            judge("variable", &v.name, reads.has(id, What::Var(var)), driven.or(written));
        }
        for (discrete, d) in entity.discretes.pairs() {
            let written = writes.get(&(id, Target::Discrete(discrete))).copied();
            judge("variable", &d.name, reads.has(id, What::Discrete(discrete)), written);
        }
        for (reference, r) in entity.refs.pairs() {
            let written = writes.get(&(id, Target::Ref(reference))).copied();
            judge("reference", &r.name, reads.refs.contains(&(id, reference)), written);
        }
        for (button, name) in entity.buttons.pairs() {
            judge("button", name, reads.has(id, What::Button(button)), None);
        }
        for (axis, name) in entity.axes.pairs() {
            judge("axis", name, reads.has(id, What::Axis(axis)), None);
        }
    }
}

/// What can be written: a variable in whatever degree.
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

/// Where an entity's own code, or code that spawns or places it, first writes something.
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
                Action::Destroy(_) => {}
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
