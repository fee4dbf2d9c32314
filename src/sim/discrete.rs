//! The discrete phase: edges, updates, entering and leaving modes. Everything is read from the state at the start of
//! the step and written to the new one, so the order of instances does not matter. Destroyed and spawned instances and
//! moves through links are recorded, and applied after all edges.

use std::cell::Cell;

use crate::ir::{
    Actions, EdgeId, Entity, Follow, GroupId, Id, Leaf, LeafId, Place, Send, SendId, SlotId, Transition, Update,
};

use super::actor::{Actor, Filter, Guard, Plan};
use super::chance::Frames;
use super::evaluate::Reader;
use super::fault::{Fault, FaultKind};
use super::input::Frame;
use super::life::Changes;
use super::recall::Recall;
use super::simulator::{Scratch, Simulator};
use super::state::leaf_at;

/// An edge that a group takes in this step.
#[derive(Debug, Clone, Copy)]
pub(super) struct TakenEdge {
    pub edge: EdgeId,
    pub transition: Transition,
}

/// A group with an action in this step.
#[derive(Debug, Clone, Copy)]
pub(super) struct ActingGroup {
    slot: SlotId,
    group: GroupId,
    choice: Option<TakenEdge>,
}

impl Simulator {
    /// Takes the edges of every live slot; `STILL` as in [`Simulator::step_of`]. What is recalled takes none.
    #[inline(always)]
    pub(super) fn transitions<const STILL: bool, R: Recall>(
        &self,
        state: &mut [u8],
        scratch: &mut Scratch,
        recall: &mut R,
    ) -> Result<(), Fault> {
        let Scratch { before, frames, taken, acting, changes, still: awake, .. } = scratch;
        let fault = Cell::new(None);
        changes.clear();
        acting.clear();
        if STILL {
            self.decide_awake(awake, state, frames, taken, acting, &fault);
        } else if R::IS_ANY {
            let all = recall.awake().iter().map(|slot| &self.actors[*slot as usize]);
            self.decide(all, state, frames, taken, acting, &fault);
        } else {
            self.decide(self.actors.iter(), state, frames, taken, acting, &fault);
        }
        Self::check_fault(&fault)?;
        // In most steps no edge is taken, and no copy of the state is needed.
        if acting.is_empty() {
            self.clear_signals(state);
            return Ok(());
        }
        if R::IS_ANY {
            acting.iter().for_each(|acting| recall.acts(acting.slot.index()));
        }
        // Nor of more than what is read: a large copy is a good part of a step.
        if acting.iter().all(|acting| self.actors[acting.slot.index()].code.is_apart) {
            for acting in acting.iter() {
                let (from, to) = self.actors[acting.slot.index()].layout.block;
                before[from..to].copy_from_slice(&state[from..to]);
            }
        } else {
            before.copy_from_slice(state);
        }
        self.clear_signals(state);
        for &ActingGroup { slot, group, choice } in acting.iter() {
            let actor = &self.actors[slot.index()];
            let reader = self.reader(actor, before, frames, &taken[actor.groups.clone()], &fault);
            self.run(state, &reader, &actor.entity, group, choice, changes);
        }
        Self::check_fault(&fault)?;
        if changes.is_none() { Ok(()) } else { self.apply_changes(state, scratch) }
    }

    /// Determines the groups with an action in this step: those that take an edge, and those with other actions.
    #[inline(always)]
    pub(super) fn decide<'a>(
        &'a self,
        actors: impl Iterator<Item = &'a Actor>,
        state: &'a [u8],
        frames: &'a Frames,
        taken: &mut [Option<TakenEdge>],
        acting: &mut Vec<ActingGroup>,
        fault: &'a Cell<Option<Fault>>,
    ) {
        for actor in actors {
            if !actor.layout.acts(state) {
                continue;
            }
            if !actor.code.is_joint {
                if actor.code.has_one_group {
                    let from = leaf_at(state, actor.leaf_at);
                    self.decide_alone(actor, (GroupId(0), from), state, frames, acting, fault);
                    continue;
                }
                for group in actor.group_ids() {
                    let from = actor.layout.leaf(state, group);
                    self.decide_alone(actor, (group, from), state, frames, acting, fault);
                }
                continue;
            }
            let (entity, slot) = (&*actor.entity, actor.id);
            let own = actor.groups.clone();
            taken[own.clone()].fill(None);
            for &group in &entity.order {
                let reader = self.reader(actor, state, frames, &taken[own.clone()], fault);
                let from = actor.layout.leaf(state, group);
                let edge = first_edge(actor, state, frames, &actor.code.plans[from], || reader);
                let choice = edge.and_then(|edge| taken_edge(&reader, entity, group, from, edge));
                taken[own.start + group.index()] = choice;
            }
            for (group, &choice) in actor.group_ids().zip(&taken[own.clone()]) {
                let plan = &actor.code.plans[actor.layout.leaf(state, group)];
                let reader = || self.reader(actor, state, frames, &taken[own.clone()], fault);
                if choice.is_some() || is_busy(actor, state, frames, plan, reader) {
                    acting.push(ActingGroup { slot, group, choice });
                }
            }
        }
    }

    /// Whether a group that depends on no other has an action in this step.
    #[inline(always)]
    fn decide_alone<'a>(
        &'a self,
        actor: &'a Actor,
        (group, from): (GroupId, LeafId),
        state: &'a [u8],
        frames: &'a Frames,
        acting: &mut Vec<ActingGroup>,
        fault: &'a Cell<Option<Fault>>,
    ) {
        let plan = &actor.code.plans[from];
        if plan.is_busy || any_passes(actor, state, frames, &plan.filter) {
            return self.act_alone(actor, (group, from), state, frames, acting, fault);
        }
        debug_assert!(
            {
                let fault = Cell::new(None);
                let alone = || self.reader(actor, state, frames, &[], &fault);
                let is_busy = is_busy(actor, state, frames, plan, alone);
                !is_busy && first_edge(actor, state, frames, plan, alone).is_none() && fault.get().is_none()
            },
            "a guard holds that no condition of the filter lets through"
        );
    }

    /// The action of a group that depends on no other, if it has one.
    #[inline(never)]
    fn act_alone<'a>(
        &'a self,
        actor: &'a Actor,
        (group, from): (GroupId, LeafId),
        state: &'a [u8],
        frames: &'a Frames,
        acting: &mut Vec<ActingGroup>,
        fault: &'a Cell<Option<Fault>>,
    ) {
        let plan = &actor.code.plans[from];
        let alone = || self.reader(actor, state, frames, &[], fault);
        let edge = first_edge(actor, state, frames, plan, alone);
        if edge.is_some() || is_busy(actor, state, frames, plan, alone) {
            let choice = edge.and_then(|edge| taken_edge(&alone(), &actor.entity, group, from, edge));
            acting.push(ActingGroup { slot: actor.id, group, choice });
        }
    }

    /// Runs the actions of a group: internal edges, the edge taken, links.
    #[inline(never)]
    fn run(
        &self,
        state: &mut [u8],
        reader: &Reader<'_>,
        entity: &Entity,
        group: GroupId,
        taken: Option<TakenEdge>,
        changes: &mut Changes,
    ) {
        let from = self.layout(reader.me).leaf(reader.state, group);
        let leaf: &Leaf = &entity.leaves[from];
        let set = |needs: &[crate::ir::RefId]| {
            needs.iter().all(|&r| self.layout(reader.me).reference(reader.state, r).is_some())
        };
        for &id in &leaf.internal {
            let edge = &entity.edges[id];
            if set(&edge.needs) && reader.truth(edge.guard) {
                changes.record_edge(reader.me, id);
                self.act(state, reader, &edge.actions, changes);
            }
        }
        if let Some(taken) = taken {
            changes.record_edge(reader.me, taken.edge);
            self.take(state, reader, entity, taken, changes);
        }
        for &follow in &leaf.follows {
            let follow: &Follow = &entity.follows[follow];
            if changes.is_moving(reader.me) || !set(&follow.needs) || !follow.guard.is_none_or(|g| reader.truth(g)) {
                continue;
            }
            if let Some(link) = self.link_at(reader) {
                changes.move_through(reader.me, link);
                self.act(state, reader, &follow.actions, changes);
            }
        }
    }

    /// Takes a transition: runs the entry actions from the outermost mode inwards, then the actions of the edge.
    fn take(&self, state: &mut [u8], reader: &Reader<'_>, entity: &Entity, taken: TakenEdge, changes: &mut Changes) {
        let TakenEdge { edge, transition } = taken;
        let layout = self.layout(reader.me);
        layout.set_leaf(state, transition.group, transition.to);
        for timer in transition.resets(entity) {
            layout.set_timer(state, timer, 0);
        }
        for mode in transition.entered(entity) {
            self.act(state, reader, &entity.modes[mode].entry, changes);
        }
        self.act(state, reader, &entity.edges[edge].actions, changes);
    }

    fn act(&self, state: &mut [u8], reader: &Reader<'_>, actions: &Actions, changes: &mut Changes) {
        for update in &actions.updates {
            self.update(state, reader.me, reader, update);
        }
        for update in &actions.refs {
            changes.clear_spawn_target(reader.me, update.reference);
            let target = reader.reference(update.value);
            self.layout(reader.me).set_reference(state, update.reference, target);
        }
        for &spawn in &actions.spawns {
            let into = self.entity(reader.me).spawns[spawn].into;
            if let Some(into) = into {
                changes.clear_spawn_target(reader.me, into);
            }
            changes.spawn(reader.me, spawn, into);
        }
        for &send in &actions.sends {
            self.send(state, reader, send);
        }
        for &what in &actions.destroys {
            match reader.reference(what) {
                Some(target) => changes.destroy(target),
                None => reader.tile(what).into_iter().for_each(|tile| changes.break_tile(tile)),
            }
        }
    }

    /// Forgets the signals of the step before.
    #[inline]
    fn clear_signals(&self, state: &mut [u8]) {
        for &slot in &self.receivers {
            let Actor { layout, signals, numbered, .. } = &self.actors[slot.index()];
            layout.clear_signals(state, *signals, *numbered);
        }
    }

    /// Sends a signal to those that are alive at the start of the step.
    #[inline(never)]
    fn send(&self, state: &mut [u8], reader: &Reader<'_>, send: SendId) {
        let Send { to, entity, signal, value } = self.entity(reader.me).sends[send];
        let value = value.map(|value| (value, reader.number(value)));
        let mut receive = |slot: SlotId| {
            let layout = self.layout(slot);
            if self.world().slots[slot].entity != entity || !layout.acts(reader.state) {
                return;
            }
            layout.set_signal(state, signal);
            if let (Some((at, value)), Some(number)) = (value, &self.entity(slot).signals[signal].number) {
                let value = if number.is_whole { value.round() } else { value };
                let sum = layout.sum(state, signal);
                let total = reader.checked(at, sum + value, [sum, value]);
                layout.set_sum(state, signal, total);
            }
        };
        match to {
            Some(to) => reader.instance(to).into_iter().for_each(receive),
            None => self.receivers.iter().for_each(|slot| receive(*slot)),
        }
    }

    /// Writes a variable of a slot; `reader` evaluates the value.
    pub(super) fn update(&self, state: &mut [u8], slot: SlotId, reader: &Reader<'_>, update: &Update) {
        let value = reader.number(update.value);
        match update.place {
            Place::Var(var, degree) => self.layout(slot).set_moving_var(state, var, degree, value),
            Place::Discrete(id) => {
                let (low, high) = self.entity(slot).discretes[id].range;
                let fits = value >= f64::from(low) && value <= f64::from(high) && value.fract() == 0.0;
                if fits {
                    self.layout(slot).set_discrete(state, id, value as i32);
                } else {
                    let entity = self.world().slots[slot].entity;
                    reader.note(FaultKind::OutOfRange(update.value, entity, id, value));
                }
            }
            Place::Ref(_) => {}
        }
    }

    /// Advances the timers of active modes in the new state.
    #[inline(always)]
    pub(super) fn count_timers(&self, state: &mut [u8], actor: &Actor) {
        let Actor { layout, timer_limits, code, .. } = actor;
        if timer_limits.is_empty() {
            return;
        }
        for group in actor.group_ids() {
            for &id in &code.plans[layout.leaf(state, group)].timers {
                let count = layout.timer(state, id);
                layout.set_timer(state, id, count.saturating_add(1).min(timer_limits[id]));
            }
        }
    }
}

/// The edge that a group takes: the first whose guard holds. Most guards need no reader.
#[inline(always)]
fn first_edge<'a>(
    actor: &Actor,
    state: &[u8],
    frames: &Frames,
    plan: &Plan,
    reader: impl Fn() -> Reader<'a>,
) -> Option<EdgeId> {
    plan.edges.iter().find(|(guard, _)| holds(actor, state, frames, *guard, &reader)).map(|(_, edge)| *edge)
}

/// Whether a group has anything to run in the discrete phase although it takes no edge.
#[inline(always)]
fn is_busy<'a>(actor: &Actor, state: &[u8], frames: &Frames, plan: &Plan, reader: impl Fn() -> Reader<'a>) -> bool {
    plan.is_busy || plan.internal.iter().any(|guard| holds(actor, state, frames, *guard, &reader))
}

/// Whether any condition of a filter holds; if not, no guard does.
#[inline(always)]
fn any_passes(actor: &Actor, state: &[u8], frames: &Frames, filter: &Filter) -> bool {
    if filter.is_open {
        return true;
    }
    let [touching, apart] = filter.touches;
    if touching | apart != 0 {
        let touches = actor.layout.first_touches(state);
        if touches & touching | !touches & apart != 0 {
            return true;
        }
    }
    if filter.reads_buttons {
        // Without a player no button is down.
        let any = frames.of(actor).map(|frame| frame.any(&filter.buttons));
        if any.unwrap_or_else(|| Frame::default().any(&filter.buttons)) {
            return true;
        }
    }
    filter.ranges.iter().any(|&(var, degree, (low, high), wanted)| {
        let value = actor.layout.moving_var(state, var, degree);
        (low <= value && value <= high) == wanted
    })
}

/// Whether a guard holds.
#[inline(always)]
fn holds<'a>(actor: &Actor, state: &[u8], frames: &Frames, guard: Guard, reader: &impl Fn() -> Reader<'a>) -> bool {
    match guard {
        Guard::Touching(touch, wanted) => actor.layout.touch(state, touch) == wanted,
        Guard::Button(press, button, wanted) => {
            frames.of(actor).is_some_and(|frame| frame.button(press, button)) == wanted
        }
        Guard::Within(var, degree, (low, high), wanted) => {
            let value = actor.layout.moving_var(state, var, degree);
            (low <= value && value <= high) == wanted
        }
        Guard::Expr(id) => reader().truth(id),
    }
}

/// The transition of an edge, if it has a target.
fn taken_edge(reader: &Reader<'_>, entity: &Entity, group: GroupId, from: LeafId, edge: EdgeId) -> Option<TakenEdge> {
    let target = entity.edges[edge].target?;
    Some(TakenEdge { edge, transition: Transition { group, from, target, to: reader.entered(target) } })
}
