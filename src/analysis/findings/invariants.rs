//! Invariants: proven, or where they may break. They are looked at after each step and before the first one, which is
//! what a configuration holds.

use crate::diagnostic::Diagnostics;
use crate::diagnostic::catalogue::values::{Broken, Unknown, Unproven};
use crate::ir::{
    Actions, Drive, Entity, EntityId, ExprId, Group, IdVec, LeafId, ModeId, Origin, ParamId, Place, Program, SlotId,
    VarId, World, WorldId,
};

use super::super::configuration::Configuration;
use super::super::values::Values;
use super::super::{ConfigurationSpace, GivenUp};
use super::judge::Reads;
use super::{Subject, words};

/// What is known of an invariant in a world.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum InvariantVerdict {
    /// It holds in every state.
    Proven,
    /// It may not hold.
    NotProven,
    /// It does not hold in the first state.
    Broken,
}

/// The verdict of each invariant of each entity that has an instance in a world, all its instances together; in the
/// order of the entities, then of the text.
pub fn invariants(
    program: &Program,
    world: WorldId,
    space: &ConfigurationSpace,
) -> Vec<(EntityId, usize, InvariantVerdict)> {
    let w = &program.worlds[world];
    let mut out = Vec::new();
    for (id, entity) in program.entities.pairs() {
        let slots: Vec<SlotId> = w.slots.ids().filter(|s| w.slots[*s].entity == id).collect();
        for (index, &holds) in entity.invariants.iter().enumerate().filter(|_| !slots.is_empty()) {
            let verdicts = slots.iter().map(|&slot| verdict(program, w, space, slot, holds).0);
            out.push((id, index, verdicts.max_by_key(|v| *v as u8).unwrap_or(InvariantVerdict::Proven)));
        }
    }
    out
}

/// The verdict in a slot, and the first configuration in which it may break, cut to that.
fn verdict(
    program: &Program,
    world: &World,
    space: &ConfigurationSpace,
    slot: SlotId,
    holds: ExprId,
) -> (InvariantVerdict, Option<Configuration>) {
    if let Some(first) = beginning(program, world, slot)
        && !space.reader(program, world, Some((slot, &first))).truth(holds).can_hold
    {
        return (InvariantVerdict::Broken, Some(first));
    }
    if space.slots[slot].is_given_up {
        return (InvariantVerdict::NotProven, None);
    }
    for at in &space.slots[slot].configurations {
        if let Some(broken) = space.reader(program, world, Some((slot, at))).refined(at, holds, false) {
            return (InvariantVerdict::NotProven, Some(broken));
        }
    }
    (InvariantVerdict::Proven, None)
}

/// The state in which an instance that is there from the start begins, as far as it is known.
fn beginning(program: &Program, world: &World, slot: SlotId) -> Option<Configuration> {
    let s = &world.slots[slot];
    let entity = &program.entities[s.entity];
    if s.origin == Origin::Free {
        return None;
    }
    let none = IdVec::<ParamId, f64>::new();
    let params = if s.is_fixed { &s.params } else { &none };
    let mut leaves: Vec<LeafId> = Vec::new();
    for group in entity.groups.iter() {
        let mut choices = &group.choices;
        let mut mode = group.first;
        loop {
            for choice in choices {
                if program.constant(choice.guard, params, world.step)? != 0.0 {
                    mode = choice.mode;
                    break;
                }
            }
            let m = &entity.modes[mode];
            match m.inner.filter(|_| m.chooses) {
                Some(inner) => {
                    choices = &m.choices;
                    mode = inner;
                }
                None => break,
            }
        }
        leaves.push(entity.modes[mode].initial);
    }
    let vars = s.vars.iter().map(|v| v.map(Values::point)).collect();
    let discretes = s.discretes.iter().map(|d| Values::point(f64::from(*d))).collect();
    let first = Configuration::new(vars, discretes, s.timer_limits.len(), [s.space].into());
    Some(Configuration { leaves, ..first })
}

/// Reports the invariants of an entity that break at the start, or that are not proven.
pub(super) fn report(subject: &Subject<'_>, found: &mut Diagnostics) {
    let scene = subject.scene;
    let spans = &scene.program.spans.entities[subject.id];
    for (index, &holds) in subject.entity.invariants.iter().enumerate() {
        let mut unproven = None;
        let mut broken = None;
        for o in subject.slots.iter().chain(&subject.given_up) {
            match verdict(scene.program, o.world, o.space, o.slot, holds) {
                (InvariantVerdict::Broken, Some(at)) if broken.is_none() => broken = Some((o, at)),
                (InvariantVerdict::NotProven, Some(at)) if unproven.is_none() => unproven = Some((o, at)),
                _ => {}
            }
        }
        let Some((o, at)) = broken.as_ref().or(unproven.as_ref()) else {
            if let Some((instance, why, help)) = unknown(subject) {
                found.report(Unknown { at: spans.invariants[index], instance, why, help });
            }
            continue;
        };
        let values = words::read(subject, &Reads::of(scene.program, holds), &[(o, at)]);
        let values = (!values.is_empty()).then(|| words::listed(&values));
        let name = o.world.slots[o.slot].name.clone();
        let placed = scene.program.spans.worlds[o.world_id].slots[o.slot];
        if broken.is_some() {
            found.report(Broken { at: spans.invariants[index], values, instance: (name, placed) });
            continue;
        }
        let concerned = concerned(subject.entity, &Reads::of(scene.program, holds));
        let leaves = at.leaves.iter().enumerate().filter(|(group, _)| concerned[*group]);
        let modes = leaves.map(|(_, l)| subject.entity.leaves[*l].mode);
        let modes: Vec<_> = modes.map(|m| (subject.entity.modes[m].path.clone(), spans.modes[m])).collect();
        found.report(Unproven { at: spans.invariants[index], values, modes, instance: name });
    }
}

/// Why nothing is known of some instance of an entity, if so: the instance, the reason, and a way out.
fn unknown(subject: &Subject<'_>) -> Option<(Option<String>, String, String)> {
    let name = &subject.entity.name;
    let Some(o) = subject.given_up.first() else {
        let help = || format!("place a `{name}` in a world to see whether it holds there");
        return (!subject.is_anywhere).then(|| (None, format!("no world has a `{name}`"), help()));
    };
    let (instance, world) = (o.world.slots[o.slot].name.clone(), &o.world.name);
    let (why, help) = match o.found.why {
        _ if o.world.open.is_some() => {
            (format!("the map of `{world}` is not given"), "give one with `--map PATH`".to_string())
        }
        Some(why @ GivenUp::Combinations) => {
            (why.reason(), "split the entity, or let one group stand for several".to_string())
        }
        why => {
            let why = why.unwrap_or(GivenUp::Effort).reason();
            (why, format!("check a smaller world with a `{name}`"))
        }
    };
    Some((Some(instance), why, help))
}

/// Of each group, whether it drives or updates any of what is read; a group alone always counts.
fn concerned(entity: &Entity, reads: &Reads) -> Vec<bool> {
    let is_read = |var: VarId| reads.vars.iter().any(|(v, _)| *v == var);
    let updates = |a: &Actions| {
        a.updates.iter().any(|u| match u.place {
            Place::Var(var, _) => is_read(var),
            Place::Discrete(id) => reads.discretes.contains(&id),
            Place::Ref(_) => false,
        })
    };
    let drives = |drive: &Drive| match *drive {
        Drive::Coast(var) | Drive::Flow { var, .. } => is_read(var),
        Drive::Envelope(id, _) => entity.envelopes[id].vars.iter().any(|v| is_read(*v)),
    };
    let of = |group: &Group| {
        let (first, after) = group.modes;
        let is_own = |mode: ModeId| first <= mode && mode < after;
        entity.groups.len() == 1
            || reads.modes
            || entity.leaves.iter().any(|l| is_own(l.mode) && l.drives.iter().any(drives))
            || entity.edges.iter().any(|e| is_own(e.source) && updates(&e.actions))
            || entity.modes.pairs().any(|(mode, m)| is_own(mode) && updates(&m.entry))
    };
    entity.groups.iter().map(of).collect()
}
