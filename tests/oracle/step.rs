//! One step: inputs, edges and their effects, then flows and collisions (in separate files), and the checks at the end.

use hypedc::ir::{DiscreteId, EdgeId, EntityId, GroupId, Id, ModeId, Origin, Place, RefId, SlotId, Subject};

use std::collections::{BTreeMap, BTreeSet};

use hypedc::sema::checked::{Action, Given, Link, Spawn, Term, Update};

use super::evaluate::Code;
use super::model::{Fault, Keys, Moves, Oracle, State, Thing};

/// The input of a player, and the buttons that were down before.
pub type Frame = (Keys, BTreeSet<u32>);

/// The transient data of a step.
#[derive(Default)]
pub struct Passing {
    /// What was destroyed in this step.
    pub dying: BTreeSet<usize>,
    /// What was spawned in this step.
    pub newborn: BTreeSet<usize>,
    /// Whether a spawn found no free slot.
    pub refused: bool,
    /// Of each instance the modes that it entered, and those that it left.
    pub joint: BTreeMap<usize, (BTreeSet<ModeId>, BTreeSet<ModeId>)>,
}

impl Passing {
    /// Whether an instance moves and collides in this step.
    pub fn acts(&self, slot: usize) -> bool {
        !self.dying.contains(&slot) && !self.newborn.contains(&slot)
    }
}

/// A pending spawn.
struct Birth<'a> {
    by: usize,
    spawn: &'a Spawn,
    /// The spawner's reference that keeps it.
    into: Option<RefId>,
}

/// The effects of an instance's edges.
#[derive(Default)]
struct Doing<'p> {
    actions: Vec<&'p Action>,
    /// The new active modes of each group that changes.
    modes: BTreeMap<usize, Vec<ModeId>>,
    entered: BTreeSet<ModeId>,
    left: BTreeSet<ModeId>,
    /// The link that it goes through.
    link: Option<&'p Link>,
}

impl<'p> Oracle<'p> {
    /// The state before the first step.
    pub fn initial(&self) -> Result<State, Fault> {
        let held = self.world.players.iter().map(|_| BTreeSet::new()).collect();
        let things = self.world.instances.iter().map(|instance| {
            (instance.origin != Origin::Free).then(|| Thing {
                params: instance.params.iter().map(|value| value + 0.0).collect(),
                vars: instance.vars.iter().map(|values| values.map(|value| value + 0.0)).collect(),
                discretes: instance.discretes.iter().copied().collect(),
                refs: instance.refs.iter().map(|r| r.map(|slot| slot.index())).collect(),
                space: instance.space.index(),
                modes: Vec::new(),
                timers: BTreeMap::new(),
                peaks: BTreeMap::new(),
                signals: BTreeMap::new(),
                contacts: BTreeSet::new(),
                carrier: None,
            })
        });
        let mut state = State { things: things.collect(), held, broken: BTreeMap::new(), drawn: Vec::new() };
        for slot in 0..state.things.len() {
            if state.things[slot].is_some() {
                self.begin(&mut state, slot)?;
            }
        }
        self.find_contacts(&mut state, &Passing::default())?;
        Ok(state)
    }

    /// The modes of an instance that has just been made.
    fn begin(&self, state: &mut State, slot: usize) -> Result<(), Fault> {
        let entity = self.entity(slot);
        let mut modes = Vec::new();
        for group in entity.groups.iter() {
            modes.push(self.initial_modes(state, slot, &group.modes)?);
        }
        let thing = state.things[slot].as_mut().unwrap();
        thing.timers = modes.iter().flatten().map(|m| (*m, 0)).collect();
        thing.modes = modes;
        Ok(())
    }

    /// The initial mode of siblings, and the initial modes inside it.
    fn initial_modes(&self, state: &State, slot: usize, of: &[ModeId]) -> Result<Vec<ModeId>, Fault> {
        let Some(mut chosen) = of.first().copied() else { return Ok(Vec::new()) };
        let modes = &self.entity(slot).modes;
        // From the weakest reason to the strongest: written first, first without a condition, marked, first that holds.
        if let Some(mode) = of.iter().find(|m| modes[**m].initial_when.is_none()) {
            chosen = *mode;
        }
        if let Some(mode) = of.iter().find(|m| modes[**m].marked_initial) {
            chosen = *mode;
        }
        for mode in of {
            if let Some(guard) = &modes[*mode].initial_when
                && self.code(state, slot).holds(guard)?
            {
                chosen = *mode;
                break;
            }
        }
        let mut path = vec![chosen];
        path.extend(self.initial_modes(state, slot, &modes[chosen].children)?);
        Ok(path)
    }

    /// Code of an instance that reads no inputs.
    pub fn code<'a>(&'a self, state: &'a State, slot: usize) -> Code<'a> {
        Code { oracle: self, state, me: Some(slot), member: None, keys: None, joint: None, passing: None }
    }

    /// Code of an instance, with the input of its player.
    pub fn played<'a>(&'a self, state: &'a State, slot: usize, frames: &'a [Frame]) -> Code<'a> {
        let keys = self.player(slot).map(|player| (&frames[player].0, &frames[player].1));
        Code { keys, ..self.code(state, slot) }
    }

    /// One step.
    pub fn step(&self, before: &State, moves: &Moves) -> Result<(State, Passing), Fault> {
        let frames: Vec<Frame> = moves.keys.iter().cloned().zip(before.held.iter().cloned()).collect();
        let before = State { drawn: moves.drawn.clone(), ..before.clone() };
        let mut state = before.clone();
        state.held = moves.keys.iter().map(|keys| keys.held.clone()).collect();
        let mut passing = Passing::default();
        self.edges(&before, &mut state, &frames, &mut passing)?;
        let start = state.clone();
        self.flows(&start, &mut state, &frames, &passing)?;
        self.collide(&start, &mut state, &passing)?;
        for slot in &passing.dying {
            state.things[*slot] = None;
        }
        for thing in state.things.iter_mut().flatten() {
            for reference in &mut thing.refs {
                *reference = reference.filter(|slot| !passing.dying.contains(slot));
            }
            thing.carrier = thing.carrier.filter(|slot| !passing.dying.contains(slot));
        }
        state.drawn.clear();
        for left in state.broken.values_mut() {
            *left = left.map(|left| left - 1);
        }
        state.broken.retain(|_, left| *left != Some(0));
        Ok((state, passing))
    }

    fn edges(&self, before: &State, state: &mut State, frames: &[Frame], passing: &mut Passing) -> Result<(), Fault> {
        let mut spawns: Vec<Birth<'_>> = Vec::new();
        let mut moves: Vec<(usize, &Link)> = Vec::new();
        state.things.iter_mut().flatten().for_each(|thing| thing.signals.clear());
        for slot in 0..before.things.len() {
            if before.things[slot].is_none() {
                continue;
            }
            let doing = self.decide(before, slot, frames)?;
            passing.joint.insert(slot, (doing.entered.clone(), doing.left.clone()));
            self.act(before, state, slot, frames, &doing.actions, &mut spawns, passing)?;
            let thing = state.things[slot].as_mut().unwrap();
            for (group, modes) in doing.modes {
                thing.modes[group] = modes;
            }
            thing.timers.retain(|mode, _| !doing.left.contains(mode));
            thing.timers.extend(doing.entered.iter().map(|mode| (*mode, 0)));
            moves.extend(doing.link.map(|link| (slot, link)));
        }
        for birth in spawns {
            self.spawn(before, state, birth, frames, passing)?;
        }
        for (slot, link) in moves {
            let thing = state.things[slot].as_mut().unwrap();
            thing.space = link.space.index();
            thing.carrier = None;
            for axis in 0..2 {
                let (from, to) = ((link.from[axis], link.from[axis + 2]), (link.to[axis], link.to[axis + 2]));
                let (from, to) = ((from.0, from.0 + from.1), (to.0, to.0 + to.1));
                let way = thing.vars[axis][0] - from.0;
                thing.vars[axis][0] = to.0 + (to.1 - to.0) * way / (from.1 - from.0) + 0.0;
            }
        }
        Ok(())
    }

    /// The decisions of all groups of an instance.
    fn decide(&self, before: &State, slot: usize, frames: &[Frame]) -> Result<Doing<'p>, Fault> {
        let entity = self.entity(slot);
        let thing = before.things[slot].as_ref().unwrap();
        let mut doing = Doing::default();
        let mut taken: BTreeMap<GroupId, EdgeId> = BTreeMap::new();
        for group in &entity.order {
            let active = &thing.modes[group.index()];
            let edges = || active.iter().flat_map(|m| &entity.modes[*m].edges).copied();
            let leading = || edges().filter(|e| entity.edges[*e].target.is_some());
            let lost = leading().filter(|e| entity.edges[*e].lost.is_some());
            let others = leading().filter(|e| entity.edges[*e].lost.is_none());
            let mut chosen = None;
            for edge in lost.chain(others) {
                let joint = Some((&doing.entered, &doing.left));
                if (Code { joint, ..self.played(before, slot, frames) }).holds(&entity.edges[edge].guard)? {
                    chosen = Some(edge);
                    break;
                }
            }
            let Some(edge) = chosen else { continue };
            let target = entity.edges[edge].target.unwrap();
            let mut around = Vec::new();
            let mut at = entity.modes[target].parent;
            while let Some(mode) = at {
                around.insert(0, mode);
                at = entity.modes[mode].parent;
            }
            let stays = |mode: &ModeId| around.contains(mode) && active.contains(mode);
            doing.left.extend(active.iter().filter(|m| !stays(m)));
            let mut modes = around.clone();
            modes.extend(self.initial_modes(before, slot, &[target])?);
            doing.entered.extend(modes.iter().filter(|m| !stays(m)));
            doing.modes.insert(group.index(), modes);
            taken.insert(*group, edge);
        }
        for (group, _) in entity.groups.pairs() {
            let active = &thing.modes[group.index()];
            for edge in active.iter().flat_map(|m| &entity.modes[*m].edges) {
                let edge = &entity.edges[*edge];
                let code = Code { joint: Some((&doing.entered, &doing.left)), ..self.played(before, slot, frames) };
                let is_lost = edge.needs.iter().any(|r| code.slot(Subject::Ref(*r)).is_none());
                if edge.target.is_none() && !is_lost && code.holds(&edge.guard)? {
                    doing.actions.extend(&edge.actions);
                }
            }
            if let Some(modes) = doing.modes.get(&group.index()) {
                let entered = modes.iter().filter(|m| doing.entered.contains(m));
                doing.actions.extend(entered.flat_map(|m| &entity.modes[*m].entry));
            }
            if let Some(edge) = taken.get(&group) {
                doing.actions.extend(&entity.edges[*edge].actions);
            }
            for follow in active.iter().flat_map(|m| &entity.modes[*m].follows) {
                let code = self.played(before, slot, frames);
                let code = Code { joint: Some((&doing.entered, &doing.left)), ..code };
                let is_lost = follow.needs.iter().any(|r| code.slot(Subject::Ref(*r)).is_none());
                let holds = match &follow.guard {
                    _ if is_lost || doing.link.is_some() => false,
                    Some(guard) => code.holds(guard)?,
                    None => true,
                };
                if holds && let Some(link) = self.link_at(before, slot)? {
                    doing.link = Some(link);
                    doing.actions.extend(&follow.actions);
                }
            }
        }
        Ok(doing)
    }

    /// The first link of its space in whose rectangle an instance is and that is open.
    fn link_at(&self, before: &State, slot: usize) -> Result<Option<&'p Link>, Fault> {
        let thing = before.things[slot].as_ref().unwrap();
        let (x, y) = thing.position();
        for link in &self.world.spaces.iter().nth(thing.space).unwrap().links {
            let [left, bottom, width, height] = link.from;
            let is_inside = left <= x && x <= left + width && bottom <= y && y <= bottom + height;
            let is_open = match &link.guard {
                _ if !is_inside => false,
                Some(guard) => self.predicate(before, guard)?,
                None => true,
            };
            if is_open {
                return Ok(Some(link));
            }
        }
        Ok(None)
    }

    /// Applies the actions of an instance, and records spawns and destroys.
    #[allow(clippy::too_many_arguments, reason = "all of a step")]
    fn act<'a>(
        &self,
        before: &State,
        state: &mut State,
        slot: usize,
        frames: &[Frame],
        actions: &[&'a Action],
        spawns: &mut Vec<Birth<'a>>,
        passing: &mut Passing,
    ) -> Result<(), Fault> {
        let joint = passing.joint.get(&slot).cloned();
        let code = Code { joint: joint.as_ref().map(|j| (&j.0, &j.1)), ..self.played(before, slot, frames) };
        // The last assignment of a reference wins.
        let forget = |spawns: &mut Vec<Birth<'_>>, id: RefId| {
            for birth in spawns.iter_mut().filter(|birth| (birth.by, birth.into) == (slot, Some(id))) {
                birth.into = None;
            }
        };
        for action in actions {
            let thing = state.things[slot].as_mut().unwrap();
            match action {
                Action::Update(Update { place, value, .. }) => match place {
                    Place::Var(var, degree) => {
                        thing.vars[var.index()][usize::from(*degree)] = code.value(value)? + 0.0;
                    }
                    Place::Discrete(id) => {
                        thing.discretes[id.index()] = self.whole(self.entity_id(slot), *id, code.value(value)?)?;
                    }
                    Place::Ref(id) => {
                        forget(spawns, *id);
                        thing.refs[id.index()] = code.instance(value);
                    }
                },
                Action::Spawn(spawn) => {
                    if let Some(into) = spawn.into {
                        forget(spawns, into);
                    }
                    spawns.push(Birth { by: slot, spawn, into: spawn.into });
                }
                Action::Destroy(what) => match code.instance(what) {
                    Some(slot) => drop(passing.dying.insert(slot)),
                    None => {
                        if let Some((space, cell)) = code.tile(what) {
                            let restore = self.breakable(space, cell).unwrap().restore;
                            state.broken.entry((space, cell)).or_insert(restore);
                        }
                    }
                },
                Action::Send(send) => {
                    let number = send.number.as_ref().map(|number| code.value(number)).transpose()?;
                    let of = &self.program.entities[send.entity];
                    let sum = of.signals[send.signal].number.as_ref();
                    let number = match (number, sum) {
                        (Some(number), Some(sum)) if sum.dimension.is_none() => number.round(),
                        (number, _) => number.unwrap_or(0.0),
                    };
                    let one = send.to.as_ref().map(|to| code.instance(to));
                    for (to, thing) in state.things.iter_mut().enumerate() {
                        let is_one = one.is_none_or(|one| one == Some(to));
                        let is_there = before.things[to].is_some() && self.entity_id(to) == send.entity;
                        if let (Some(thing), true) = (thing, is_one && is_there) {
                            let sum = thing.signals.entry(send.signal.0).or_default();
                            *sum += number;
                            if !sum.is_finite() {
                                return Err(Fault::NotFinite);
                            }
                        }
                    }
                }
            }
        }
        Ok(())
    }

    /// A value that a discrete variable can take.
    fn whole(&self, entity: EntityId, id: DiscreteId, value: f64) -> Result<i32, Fault> {
        let (low, high) = self.program.entities[entity].discretes[id].range;
        let fits = value.fract() == 0.0 && f64::from(low) <= value && value <= f64::from(high);
        if fits { Ok(value as i32) } else { Err(Fault::OutOfRange) }
    }

    fn spawn(
        &self,
        before: &State,
        state: &mut State,
        Birth { by: spawner, spawn, into }: Birth<'_>,
        frames: &[Frame],
        passing: &mut Passing,
    ) -> Result<(), Fault> {
        let instances = &self.world.instances;
        // What a placed instance leaves is room for another one, but its name stays its own.
        let living = instances
            .ids()
            .filter(|slot| instances[*slot].entity == spawn.entity && state.things[slot.index()].is_some());
        let most = self.world.limits.iter().find(|(entity, _)| *entity == spawn.entity).map(|(_, most)| *most as usize);
        let is_full = most.is_some_and(|most| living.count() >= most);
        let free = instances.ids().filter(|_| !is_full).find(|slot| {
            let instance = &instances[*slot];
            instance.entity == spawn.entity && instance.origin != Origin::Named && state.things[slot.index()].is_none()
        });
        if let Some(into) = into {
            state.things[spawner].as_mut().unwrap().refs[into.index()] = free.map(SlotId::index);
        }
        let Some(slot) = free.map(SlotId::index) else {
            passing.refused = true;
            return Ok(());
        };
        let entity = &self.program.entities[spawn.entity];
        let joint = passing.joint.get(&spawner).map(|j| (&j.0, &j.1));
        let code = Code { joint, ..self.played(before, spawner, frames) };
        let given = |wanted: Given| spawn.given.iter().find(|(what, _)| *what == wanted).map(|(_, term)| term);
        let by = before.things[spawner].as_ref().unwrap();
        let mut thing = Thing {
            params: Vec::new(),
            vars: Vec::new(),
            discretes: Vec::new(),
            refs: Vec::new(),
            space: by.space,
            modes: Vec::new(),
            timers: BTreeMap::new(),
            peaks: BTreeMap::new(),
            contacts: BTreeSet::new(),
            signals: BTreeMap::new(),
            carrier: None,
        };
        // It reads its own parameters from itself.
        let mut made = before.clone();
        let mut own = |thing: &Thing, term: &Term| {
            made.things[slot] = Some(thing.clone());
            self.code(&made, slot).value(term)
        };
        for (id, param) in entity.params.pairs() {
            let value = match given(Given::Param(id)) {
                Some(term) => code.value(term)?,
                None => own(&thing, &param.default)?,
            };
            thing.params.push(value + 0.0);
        }
        for (id, var) in entity.vars.pairs() {
            let mut value = [0.0; 3];
            for (degree, value) in (0u8..).zip(&mut value) {
                *value = match (given(Given::Var(id, degree)), &var.initial) {
                    (Some(term), _) => code.value(term)?,
                    (None, Some(initial)) if degree == 0 => own(&thing, initial)?,
                    (None, None) if degree == 0 => by.vars[id.index()][0],
                    _ => 0.0,
                };
            }
            // There is one zero.
            thing.vars.push(value.map(|value| value + 0.0));
        }
        for (id, discrete) in entity.discretes.pairs() {
            let value = match given(Given::Discrete(id)) {
                Some(term) => code.value(term)?,
                None => own(&thing, &discrete.initial)?,
            };
            thing.discretes.push(self.whole(spawn.entity, id, value)?);
        }
        for id in entity.refs.ids() {
            thing.refs.push(given(Given::Ref(id)).and_then(|term| code.instance(term)));
        }
        state.things[slot] = Some(thing);
        passing.newborn.insert(slot);
        self.begin(state, slot)
    }

    /// Whether a predicate of the world holds.
    pub fn predicate(&self, state: &State, term: &Term) -> Result<bool, Fault> {
        Code { oracle: self, state, me: None, member: None, keys: None, joint: None, passing: None }.holds(term)
    }

    /// Whether every player is inside its space's bounds: with `bounds`, neither below nor beside them.
    pub fn in_bounds(&self, state: &State) -> bool {
        self.world.players.iter().all(|player| {
            let Some(thing) = &state.things[player.slot.index()] else { return true };
            let space = self.world.spaces.iter().nth(thing.space).unwrap();
            let (x, y) = thing.position();
            space.bounds.is_none_or(|[left, bottom, width, _]| left <= x && x <= left + width && y >= bottom)
        })
    }

    /// The first invariant that does not hold, with its instance.
    pub fn broken(&self, state: &State) -> Result<Option<(usize, usize)>, Fault> {
        for (slot, _) in state.things.iter().enumerate().filter(|(_, t)| t.is_some()) {
            for (index, invariant) in self.entity(slot).invariants.iter().enumerate() {
                if !self.code(state, slot).holds(invariant)? {
                    return Ok(Some((slot, index)));
                }
            }
        }
        Ok(None)
    }
}
