//! Invariants: proven, or where they may break. They are examined after each step and before the first one, which is
//! what a configuration holds.

use std::collections::BTreeMap;

use crate::diagnostic::Diagnostics;
use crate::diagnostic::catalogue::values::{Broken, Unknown, Unproven};
use crate::ir::{
    Actions, Drive, Entity, EntityId, ExprId, Group, IdVec, LeafId, ModeId, Origin, ParamId, Place, Program, SlotId,
    VarId, World, WorldId,
};
use crate::source::Span;

use super::super::{ConfigurationSpace, GivenUp};
use super::account::{Account, Occurrence};
use super::judge::Reads;
use super::words::Seen;
use super::{Scene, words};
use crate::analysis::domain::configuration::Configuration;
use crate::analysis::domain::values::Values;

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

/// Where an invariant may break.
struct Breach {
    /// What it reads can be there, if there is anything to say.
    values: Option<String>,
    /// The instance, and where it is placed.
    instance: (String, Span),
    leaves: Vec<LeafId>,
}

/// Where an invariant breaks at the start, and where it may break.
#[derive(Default)]
struct Breaches {
    broken: Option<Breach>,
    /// The same, of an instance of which nothing is known else: another one says more.
    broken_given_up: Option<Breach>,
    unproven: Option<Breach>,
}

/// The invariants of an entity that are not proven, as far as worlds have been looked at.
#[derive(Default)]
pub(super) struct Invariants(BTreeMap<usize, Breaches>);

impl Invariants {
    /// Adds what is known of them in a slot.
    pub fn add(&mut self, program: &Program, entity: &Entity, o: &Occurrence<'_>) {
        for (index, &holds) in entity.invariants.iter().enumerate() {
            let (verdict, Some(at)) = verdict(program, o.world, o.space, o.slot, holds) else { continue };
            let breaches = self.0.entry(index).or_default();
            let first = match verdict {
                InvariantVerdict::Proven => continue,
                InvariantVerdict::NotProven => &mut breaches.unproven,
                InvariantVerdict::Broken if o.found.is_given_up => &mut breaches.broken_given_up,
                InvariantVerdict::Broken => &mut breaches.broken,
            };
            first.get_or_insert_with(|| {
                let reads = Reads::of(program, holds);
                let values = words::read(entity, &reads, &[(&at.leaves, &Seen::of(&reads, o, &at))]);
                let values = (!values.is_empty()).then(|| words::listed(&values));
                let placed = program.spans.worlds[o.world_id].slots[o.slot];
                Breach { values, instance: (o.world.slots[o.slot].name.clone(), placed), leaves: at.leaves }
            });
        }
    }
}

/// Reports the invariants of an entity that break at the start, or that are not proven. Without an account no world has it.
pub(super) fn report(scene: &Scene<'_>, id: EntityId, account: Option<&Account<'_>>, found: &mut Diagnostics) {
    let (entity, spans) = (&scene.program.entities[id], &scene.program.spans.entities[id]);
    for (index, &holds) in entity.invariants.iter().enumerate() {
        let at = spans.invariants[index];
        let breaches = account.and_then(|a| a.invariants.0.get(&index));
        if let Some(b) = breaches.and_then(|b| b.broken.as_ref().or(b.broken_given_up.as_ref())) {
            found.report(Broken { at, values: b.values.clone(), instance: b.instance.clone() });
        } else if let Some(b) = breaches.and_then(|b| b.unproven.as_ref()) {
            let concerned = concerned(entity, &Reads::of(scene.program, holds));
            let leaves = b.leaves.iter().enumerate().filter(|(group, _)| concerned[*group]);
            let modes = leaves.map(|(_, l)| entity.leaves[*l].mode);
            let modes: Vec<_> = modes.map(|m| (entity.modes[m].path.clone(), spans.modes[m])).collect();
            found.report(Unproven { at, values: b.values.clone(), modes, instance: b.instance.0.clone() });
        } else if let Some((instance, why, help)) = unknown(&entity.name, account) {
            found.report(Unknown { at, instance, why, help });
        }
    }
}

/// An instance of which nothing is known.
pub(super) struct Nothing {
    instance: String,
    world: String,
    /// Whether the world's map is not given.
    is_open: bool,
    why: Option<GivenUp>,
}

impl Nothing {
    pub fn of(o: &Occurrence<'_>) -> Self {
        let (instance, world) = (o.world.slots[o.slot].name.clone(), o.world.name.clone());
        Nothing { instance, world, is_open: o.world.open.is_some(), why: o.found.why }
    }
}

/// Why nothing is known of some instance of an entity, if so: the instance, the reason, and a way out.
fn unknown(name: &str, account: Option<&Account<'_>>) -> Option<(Option<String>, String, String)> {
    let Some(account) = account else {
        let help = format!("place a `{name}` in a world to see whether it holds there");
        return Some((None, format!("no world has a `{name}`"), help));
    };
    let nothing = account.given_up.as_ref()?;
    let (why, help) = match nothing.why {
        _ if nothing.is_open => {
            (format!("the map of `{}` is not given", nothing.world), "give one with `--map PATH`".to_string())
        }
        Some(why @ GivenUp::Combinations) => {
            (why.reason(), "split the entity, or let one group stand for several".to_string())
        }
        why => {
            let why = why.unwrap_or(GivenUp::Effort).reason();
            (why, format!("check a smaller world with a `{name}`"))
        }
    };
    Some((Some(nothing.instance.clone()), why, help))
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
        let inside = group.modes;
        let is_own = |mode: ModeId| inside.contains(mode);
        entity.groups.len() == 1
            || reads.modes
            || entity.leaves.iter().any(|l| is_own(l.mode) && l.drives.iter().any(drives))
            || entity.edges.iter().any(|e| is_own(e.source) && updates(&e.actions))
            || entity.modes.pairs().any(|(mode, m)| is_own(mode) && updates(&m.entry))
    };
    entity.groups.iter().map(of).collect()
}
