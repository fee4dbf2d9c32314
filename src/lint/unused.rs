//! Declarations that nothing reads: parameters, variables, references, inputs.

use std::collections::BTreeSet;

use crate::diagnostic::Diagnostics;
use crate::diagnostic::catalogue::lint::Unused;
use crate::sema::checked::{Action, By, Checked, Entity, Given, Name, Place, Subject, Term, TermKind};
use crate::sema::ids::{AxisId, ButtonId, DiscreteId, EntityId, ParamId, RefId, SlotId, VarId, WorldId};
use crate::source::{FileId, Span};

use super::terms;

/// Who reads what.
#[derive(Default)]
struct Reads {
    params: BTreeSet<(EntityId, ParamId)>,
    vars: BTreeSet<(EntityId, VarId)>,
    discretes: BTreeSet<(EntityId, DiscreteId)>,
    refs: BTreeSet<(EntityId, RefId)>,
    buttons: BTreeSet<(EntityId, ButtonId)>,
    axes: BTreeSet<(EntityId, AxisId)>,
}

/// Where a term stands: in an entity, or in a world.
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
                    By::Button(button) => drop(reads.buttons.insert((id, *button))),
                    By::Axis(axis) => drop(reads.axes.insert((id, *axis))),
                    By::Axes(axes, _) => reads.axes.extend(axes.iter().map(|axis| (id, *axis))),
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

    fn term(&mut self, checked: &Checked, here: Here, term: &Term) {
        terms::walk(term, &mut |term| {
            let Some((of, what)) = read(&term.kind) else { return };
            if let (Here::Entity(me), Subject::Ref(id)) = (here, of) {
                self.refs.insert((me, id));
            }
            for entity in owners(checked, here, of) {
                match what {
                    What::Param(id) => drop(self.params.insert((entity, id))),
                    What::Var(id) => drop(self.vars.insert((entity, id))),
                    What::Discrete(id) => drop(self.discretes.insert((entity, id))),
                    What::Button(id) => drop(self.buttons.insert((entity, id))),
                    What::Axis(id) => drop(self.axes.insert((entity, id))),
                    What::Itself => {}
                }
            }
        });
    }
}

/// What a term reads of an instance.
#[derive(Clone, Copy)]
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
        | TermKind::InSpace(of, _)
        | TermKind::Touching { of, .. }
        | TermKind::Near { of, .. } => (of, What::Itself),
        _ => return None,
    })
}

/// The entities that a subject can be of: all of them where only the run tells.
fn owners(checked: &Checked, here: Here, of: Subject) -> Vec<EntityId> {
    let of_slot = |world: WorldId, slot: SlotId| checked.worlds[world].instances[slot].entity;
    match (here, of) {
        (Here::Entity(me), Subject::Me) => vec![me],
        (Here::World(world), Subject::Slot(slot)) => vec![of_slot(world, slot)],
        (Here::Entity(me), Subject::Ref(id)) if checked.entities[me].refs[id].entity.is_some() => {
            checked.entities[me].refs[id].entity.into_iter().collect()
        }
        _ => checked.entities.ids().collect(),
    }
}

/// Reports what nothing reads. In the file `root` of a program with worlds, what is written but never read counts, too.
pub(super) fn unused(checked: &Checked, root: FileId, found: &mut Diagnostics) {
    let reads = Reads::new(checked);
    for (id, entity) in checked.entities.pairs() {
        let is_final = !checked.worlds.is_empty() && entity.name.span.file == root;
        let mut judge = |kind: &'static str, name: &Name, is_read: bool, written: Option<Span>| {
            if is_read || name.text.starts_with('_') || (written.is_some() && !is_final) {
                return;
            }
            found.report(Unused { kind, name: name.text.clone(), at: name.span, written });
        };
        for (param, p) in entity.params.pairs() {
            judge("parameter", &p.name, reads.params.contains(&(id, param)), None);
        }
        // Where an instance is, everybody sees.
        for (var, v) in entity.vars.pairs().skip(2) {
            let written = written(checked, id, |p| matches!(p, Place::Var(v, _) if v == var));
            let drives = entity.drives.iter().chain(entity.modes.iter().flat_map(|m| &m.drives));
            let driven = drives.clone().find(|d| d.var == var).map(|d| d.span);
            judge("variable", &v.name, reads.vars.contains(&(id, var)), driven.or(written));
        }
        for (discrete, d) in entity.discretes.pairs() {
            let written = written(checked, id, |p| p == Place::Discrete(discrete));
            judge("variable", &d.name, reads.discretes.contains(&(id, discrete)), written);
        }
        for (reference, r) in entity.refs.pairs() {
            let written = written(checked, id, |p| p == Place::Ref(reference));
            judge("reference", &r.name, reads.refs.contains(&(id, reference)), written);
        }
        for (button, name) in entity.buttons.pairs() {
            judge("button", name, reads.buttons.contains(&(id, button)), None);
        }
        for (axis, name) in entity.axes.pairs() {
            judge("axis", name, reads.axes.contains(&(id, axis)), None);
        }
    }
}

/// Where an entity's own code, or whoever makes an instance of it, first writes something.
fn written(checked: &Checked, id: EntityId, is_it: impl Fn(Place) -> bool) -> Option<Span> {
    let given = |given: &Given| match *given {
        Given::Var(var, degree) => is_it(Place::Var(var, degree)),
        Given::Discrete(id) => is_it(Place::Discrete(id)),
        Given::Ref(id) => is_it(Place::Ref(id)),
        Given::Param(_) => false,
    };
    for (other, entity) in checked.entities.pairs() {
        for action in actions(entity) {
            match action {
                Action::Update(update) if other == id && is_it(update.place) => return Some(update.span),
                Action::Spawn(spawn) => {
                    if other == id && spawn.into.is_some_and(|r| is_it(Place::Ref(r))) {
                        return Some(spawn.span);
                    }
                    if let Some((_, term)) = spawn.given.iter().find(|(g, _)| spawn.entity == id && given(g)) {
                        return Some(term.span);
                    }
                }
                _ => {}
            }
        }
    }
    let instances = checked.worlds.iter().flat_map(|w| w.instances.iter()).filter(|i| i.entity == id);
    instances.flat_map(|i| &i.given).find(|(g, _)| given(g)).map(|(_, term)| term.span)
}

fn actions(entity: &Entity) -> impl Iterator<Item = &Action> {
    let entries = entity.modes.iter().flat_map(|m| &m.entry);
    let follows = entity.modes.iter().flat_map(|m| &m.follows).flat_map(|f| &f.actions);
    entries.chain(follows).chain(entity.edges.iter().flat_map(|e| &e.actions))
}
