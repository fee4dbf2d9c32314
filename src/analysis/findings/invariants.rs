//! Invariants: proven, or where they may break. An invariant is evaluated after each step and before the first one, on
//! the configurations themselves.

use std::collections::BTreeMap;

use crate::diagnostic::Diagnostics;
use crate::diagnostic::catalogue::values::{Broken, Unknown, Unproven};
use crate::ir::{
    Actions, Drive, Entity, EntityId, ExprId, Group, IdVec, LeafId, ModeId, Origin, ParamId, Place, Program, SlotId,
    VarId, World, WorldId,
};
use crate::source::Span;

use super::super::{ConfigurationSpace, GivenUp};
use super::atoms::Reads;
use super::summary::{EntitySummary, Occurrence};
use super::value_text::Observed;
use super::{Context, value_text};
use crate::analysis::domain::configuration::Configuration;
use crate::analysis::domain::values::Values;

/// The verdict on an invariant in a world.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum InvariantVerdict {
    /// It holds in every state.
    Proven,
    /// It may not hold.
    NotProven,
    /// It does not hold in the first state.
    Broken,
}

/// The verdict on each invariant of each entity with an instance in a world, joined over its instances; in the order of
/// the entities, then of the text.
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

/// The verdict in a slot, and the first configuration that may break the invariant, refined by its negation.
fn verdict(
    program: &Program,
    world: &World,
    space: &ConfigurationSpace,
    slot: SlotId,
    holds: ExprId,
) -> (InvariantVerdict, Option<Configuration>) {
    if let Some(first) = initial_state(program, world, slot)
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

/// The initial state of an instance that exists from the start, if it is known.
fn initial_state(program: &Program, world: &World, slot: SlotId) -> Option<Configuration> {
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
    Some(Configuration { leaves: leaves.into(), ..first })
}

/// Where an invariant may break.
struct Breach {
    /// Text of the values that it reads, if there are any.
    values: Option<String>,
    /// The instance, and the span of its placement.
    instance: (String, Span),
    leaves: Vec<LeafId>,
}

/// Where an invariant breaks at the start, and where it may break.
#[derive(Default)]
struct Breaches {
    broken: Option<Breach>,
    /// The same for an instance whose analysis was given up: others take precedence.
    broken_given_up: Option<Breach>,
    unproven: Option<Breach>,
}

/// The invariants of an entity that are not proven so far.
#[derive(Default)]
pub(super) struct Invariants(BTreeMap<usize, Breaches>);

impl Invariants {
    /// Adds the verdicts in a slot.
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
                let values = value_text::read(entity, &reads, &[(&at.leaves, &Observed::of(&reads, o, &at))]);
                let values = (!values.is_empty()).then(|| value_text::listed(&values));
                let placed = program.spans.worlds[o.world_id].slots[o.slot];
                Breach { values, instance: (o.world.slots[o.slot].name.clone(), placed), leaves: at.leaves.to_vec() }
            });
        }
    }
}

/// Reports the invariants of an entity that break at the start or are not proven. `summary` is `None` if no world
/// contains the entity.
pub(super) fn report(
    context: &Context<'_>,
    id: EntityId,
    summary: Option<&EntitySummary<'_>>,
    found: &mut Diagnostics,
) {
    let (entity, spans) = (&context.program.entities[id], &context.program.spans.entities[id]);
    for (index, &holds) in entity.invariants.iter().enumerate() {
        let at = spans.invariants[index];
        let breaches = summary.and_then(|a| a.invariants.0.get(&index));
        if let Some(b) = breaches.and_then(|b| b.broken.as_ref().or(b.broken_given_up.as_ref())) {
            found.report(Broken { at, values: b.values.clone(), instance: b.instance.clone() });
        } else if let Some(b) = breaches.and_then(|b| b.unproven.as_ref()) {
            let concerned = concerned(entity, &Reads::of(context.program, holds));
            let leaves = b.leaves.iter().enumerate().filter(|(group, _)| concerned[*group]);
            let modes = leaves.map(|(_, l)| entity.leaves[*l].mode);
            let modes: Vec<_> = modes.map(|m| (entity.modes[m].path.clone(), spans.modes[m])).collect();
            found.report(Unproven { at, values: b.values.clone(), modes, instance: b.instance.0.clone() });
        } else if let Some((instance, why, help)) = unknown(&entity.name, summary) {
            found.report(Unknown { at, instance, why, help });
        }
    }
}

/// An instance whose analysis was given up.
pub(super) struct UnknownInstance {
    instance: String,
    world: String,
    /// Whether the world's map is missing.
    is_open: bool,
    why: Option<GivenUp>,
}

impl UnknownInstance {
    pub fn of(o: &Occurrence<'_>) -> Self {
        let (instance, world) = (o.world.slots[o.slot].name.clone(), o.world.name.clone());
        UnknownInstance { instance, world, is_open: o.world.open.is_some(), why: o.found.why }
    }
}

/// Why an invariant is undecided: the instance, the reason, and a suggestion.
fn unknown(name: &str, summary: Option<&EntitySummary<'_>>) -> Option<(Option<String>, String, String)> {
    let Some(summary) = summary else {
        let help = format!("place a `{name}` in a world to see whether it holds there");
        return Some((None, format!("no world has a `{name}`"), help));
    };
    let nothing = summary.given_up.as_ref()?;
    let (why, help) = match nothing.why {
        _ if nothing.is_open => {
            (format!("the map of `{}` is not given", nothing.world), "give one with `--map PATH`".to_string())
        }
        Some(why @ GivenUp::Combinations) => {
            (why.reason(), "split the entity, or let one group stand for several".to_string())
        }
        why => {
            let why = why.unwrap_or(GivenUp::Budget).reason();
            (why, format!("check a smaller world with a `{name}`"))
        }
    };
    Some((Some(nothing.instance.clone()), why, help))
}

/// For each group, whether it drives or updates anything that is read; a single group always counts.
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
