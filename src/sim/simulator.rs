//! The simulator of one world: prepared data, and the order of the phases.

use std::cell::Cell;
use std::sync::Arc;

use crate::ir::{
    Entity, Expr, ExprId, GoalId, Id, NeverId, Origin, ParamId, Press, Program, Slot, SlotId, SlotLayout, SpaceId,
    SpawnId, VarId, World, WorldId,
};

use crate::watch::{Meter, Unwatched};

use super::actor::{Actor, Flow, actors, moves_independently};
use super::breakable::{Breakables, tile_counts};
use super::chance::{self, Draw, Frames};
use super::collision::Collision;
use super::discrete::{ActingGroup, TakenEdge};
use super::evaluate::Reader;
use super::fault::Fault;
use super::input::{Frame, Input};
use super::life::{Changes, Pool};
use super::members::Members;
use super::probe::Probes;
use super::recall::{Nothing, Recall};
#[cfg(feature = "ask")]
use super::recurring::Memory;
use super::saved::State;
use super::state::{Life, buttons, set_buttons};
use super::still::Still;

/// Simulates one world of a program.
pub struct Simulator {
    program: Arc<Program>,
    world: Arc<World>,
    id: WorldId,
    /// A copy of all expressions, if the program stores them in several blocks.
    code: Option<Box<[Expr]>>,
    pub(super) step: f64,
    pub(super) collision: Collision,
    /// The tiles that can be broken, if there are any.
    pub(super) breakables: Option<Box<Breakables>>,
    /// For each tag, the number of its tiles; empty if no instance asks.
    pub(super) tile_counts: Box<[u32]>,
    /// What probes look at, if there are any.
    pub(super) probes: Option<Box<Probes>>,
    /// Who answers questions to each instance, if there are any.
    pub(super) members: Option<Box<Members>>,
    /// For each entity, what a spawn may take.
    pub(super) pools: Vec<Pool>,
    /// Prepared data of each slot.
    pub(super) actors: Vec<Actor>,
    /// Whether no instance reads another one in the continuous phase.
    pub(super) moves_independently: bool,
    /// Whether anything can be destroyed or spawned.
    lives_change: bool,
    /// The slots that receive signals.
    pub(super) receivers: Vec<SlotId>,
    /// The instances that never move, if there are many.
    pub(super) still: Option<Box<Still>>,
    /// The buttons stored in a state: only for these, a guard reads presses or releases.
    pub(super) remembered: u64,
    /// What nature draws in each step, slot by slot.
    pub(super) draws: Vec<Draw>,
    /// Cost of evaluating all code once, in units of work.
    cost: u64,
}

/// The working memory of a step; allocated once and reused.
#[derive(Debug, Clone)]
pub struct Scratch {
    /// The state at the start of the step, if any edge is taken.
    pub(super) before: Vec<u8>,
    /// What the players do and what nature draws.
    pub(super) frames: Frames,
    /// The edge that each group of each slot takes in this step.
    pub(super) taken: Vec<Option<TakenEdge>>,
    /// The groups with an action in this step.
    pub(super) acting: Vec<ActingGroup>,
    /// The pending changes of this step.
    pub(super) changes: Changes,
    /// The flow of each variable of each slot; constant ones are kept.
    pub(super) flows: Vec<Flow>,
    /// The bounds of each clamp of each slot.
    pub(super) clamps: Vec<(f64, f64)>,
    /// The direction in which each envelope of each slot reached its peak.
    pub(super) peaks: Vec<u16>,
    /// The position of each slot at the start of the continuous phase, px.
    pub(super) start: Vec<(f64, f64)>,
    /// The working memory of the collision phase.
    pub(super) collision: super::collision::Scratch,
    /// What a step looks at of the instances that never move.
    pub(super) still: super::still::Scratch,
    /// What is remembered of earlier steps, if anything is to be.
    #[cfg(feature = "ask")]
    memory: Option<Box<Memory>>,
}

/// The buttons whose presses or releases are read anywhere.
fn remembered(program: &Program) -> u64 {
    let bit = |expr: &Expr| match expr {
        Expr::Button(Press::Pressed | Press::Released, button) => 1 << button.index(),
        _ => 0,
    };
    program.exprs.iter().map(bit).fold(0, |all, bit| all | bit)
}

/// Where an instance begins; one that never moves stays there.
pub(super) fn first_position(slot: &Slot) -> (f64, f64) {
    let along = |axis: usize| slot.vars.get(VarId::XY[axis]).map_or(0.0, |values| values[0] + 0.0);
    (along(0), along(1))
}

impl Scratch {
    /// Amount of work done with it so far: about one for each compared pair of boxes, examined tile and moved part of
    /// an instance; it may wrap around.
    pub fn work(&self) -> u64 {
        self.collision.work
    }

    /// Bytes of what it remembers.
    pub fn bytes(&self) -> usize {
        #[cfg(feature = "ask")]
        return self.memory.as_ref().map_or(0, |memory| memory.bytes());
        #[cfg(not(feature = "ask"))]
        0
    }
}

impl Simulator {
    /// Prepares a world.
    pub fn new(program: &Arc<Program>, id: WorldId) -> Self {
        let world = &program.worlds[id];
        let still = world.layout.slots.iter().map(|layout| layout.rest.is_some()).collect();
        let mut collision = Collision::new(program, world, &still);
        let lives_change = world.slots.iter().any(|s| {
            let e = &program.entities[s.entity];
            e.action_lists().any(|a| !a.spawns.is_empty() || !a.destroys.is_empty())
        });
        let actors = actors(program, world);
        let nevers = program.with_operands(world.nevers.iter().map(|n| n.holds).collect());
        let still = Still::new(world, &still, &mut collision, &actors);
        let code = |actor: &Actor| actor.code.exprs.len();
        let visited = match &still {
            None => actors.iter().map(code).sum::<usize>(),
            Some(still) => still.visits().map(|slot| code(&actors[slot])).sum(),
        };
        let cost = visited + nevers.len();
        let probes = Probes::new(program, world, &collision, &actors);
        let members = Members::new(world, &actors);
        let exprs = || actors.iter().flat_map(|actor| &actor.code.exprs);
        let asked: u64 = members.as_ref().map_or(0, |members| exprs().map(|expr| members.cost(expr)).sum());
        let probed = probes.as_ref().map_or(0, |probes| exprs().map(|expr| probes.cost(expr)).sum());
        Simulator {
            program: Arc::clone(program),
            world: Arc::clone(world),
            id,
            code: program.exprs.in_one_piece().is_none().then(|| program.exprs.iter().copied().collect()),
            moves_independently: moves_independently(&actors),
            step: world.step.seconds(),
            collision,
            breakables: Breakables::new(world),
            tile_counts: tile_counts(world, &actors),
            pools: program.entities.ids().map(|entity| Pool::new(world, entity)).collect(),
            actors,
            lives_change,
            receivers: world
                .slots
                .ids()
                .filter(|slot| !program.entities[world.slots[*slot].entity].signals.is_empty())
                .collect(),
            remembered: remembered(program),
            draws: chance::draws(program, world),
            still,
            cost: probed + asked + cost as u64,
            probes,
            members,
        }
    }

    /// The program.
    pub fn program(&self) -> &Arc<Program> {
        &self.program
    }

    /// The world.
    pub fn world(&self) -> &World {
        &self.world
    }

    /// The world's id.
    pub fn world_id(&self) -> WorldId {
        self.id
    }

    #[inline]
    pub(super) fn entity(&self, slot: SlotId) -> &Entity {
        &self.actors[slot.index()].entity
    }

    #[inline]
    pub(super) fn layout(&self, slot: SlotId) -> &SlotLayout {
        &self.actors[slot.index()].layout
    }

    /// A reader for an instance's own code.
    #[inline]
    pub(super) fn reader<'a>(
        &'a self,
        actor: &'a Actor,
        state: &'a [u8],
        frames: &'a Frames,
        taken: &'a [Option<TakenEdge>],
        fault: &'a Cell<Option<Fault>>,
    ) -> Reader<'a> {
        let (code, base) = (&*actor.code.exprs, actor.base);
        Reader {
            sim: self,
            state,
            frames,
            taken,
            fault,
            actor: Some(actor),
            me: actor.id,
            member: actor.id,
            code,
            base,
        }
    }

    /// A reader for expressions of the world.
    #[inline]
    pub(super) fn world_reader<'a>(&'a self, state: &'a [u8], fault: &'a Cell<Option<Fault>>) -> Reader<'a> {
        let code = self.code.as_deref().or(self.program.exprs.in_one_piece()).unwrap_or_default();
        let (frames, me) = (Frames::NONE, SlotId(0));
        Reader { sim: self, state, frames, taken: &[], fault, actor: None, me, member: me, code, base: 0 }
    }

    /// The reader of an instance, outside of a step.
    pub(super) fn own_reader<'a>(
        &'a self,
        state: &'a [u8],
        slot: SlotId,
        frames: &'a Frames,
        fault: &'a Cell<Option<Fault>>,
    ) -> Reader<'a> {
        self.reader(&self.actors[slot.index()], state, frames, &[], fault)
    }

    /// Working memory for this world.
    pub fn scratch(&self) -> Scratch {
        let sum = |count: &dyn Fn(&Entity) -> usize| -> usize {
            self.world.slots.iter().map(|s| count(&self.program.entities[s.entity])).sum()
        };
        let destroys = sum(&|e| e.action_lists().map(|a| a.destroys.len()).sum());
        let slots = self.world.slots.len();
        Scratch {
            taken: vec![None; sum(&|e| e.groups.len())],
            acting: Vec::with_capacity(sum(&|e| e.groups.len())),
            changes: Changes::with_capacity(destroys, sum(&|e| e.spawns.len()), slots, sum(&|e| e.edges.len())),
            clamps: vec![(0.0, 0.0); sum(&|e| e.clamps.len())],
            peaks: vec![0; sum(&|e| e.envelopes.len())],
            start: self.world.slots.iter().map(first_position).collect(),
            still: self.still.as_ref().map_or_else(super::still::Scratch::default, |still| still.scratch()),
            before: vec![0; self.world.layout.size],
            frames: Frames::new(self.world.players.len(), self.draws.len()),
            flows: self.actors.iter().flat_map(|a| a.code.steady.iter().copied()).collect(),
            collision: self.collision.scratch(&self.world, self.actors.last().map_or(0, |actor| actor.kept.end)),
            #[cfg(feature = "ask")]
            memory: None,
        }
    }

    /// Working memory for many runs that are much alike, as in a search: what instances do that nothing touches is
    /// remembered, where that pays. Steps give the same bits as with any other.
    pub fn remembering_scratch(&self) -> Scratch {
        // The engine of the page has no room for it.
        #[cfg(feature = "ask")]
        return Scratch { memory: Memory::of(self), ..self.scratch() };
        #[cfg(not(feature = "ask"))]
        self.scratch()
    }

    /// Whether contacts of instances far from each other have nothing to do with each other, nor with what changes besides.
    #[cfg(feature = "ask")]
    pub(super) fn is_local(&self) -> bool {
        self.still.is_none() && self.breakables.is_none() && self.collision.is_common
    }

    /// The state before the first step, contacts included.
    ///
    /// # Errors
    /// A [`Fault`] if a collider's size or guard breaks a rule.
    pub fn initial(&self, scratch: &mut Scratch) -> Result<State, Fault> {
        self.metered_initial(scratch, &Meter::new(&Unwatched))
    }

    /// As [`Simulator::initial`]; if the meter stops it, the result must not be used.
    ///
    /// # Errors
    /// As there.
    pub fn metered_initial(&self, scratch: &mut Scratch, meter: &Meter<'_>) -> Result<State, Fault> {
        let mut state = State::new(vec![0; self.world.layout.size]);
        for (id, _) in self.world.slots.pairs().filter(|(_, s)| s.origin != Origin::Free) {
            self.place(id, &mut state)?;
        }
        self.first_contacts(&mut state, scratch, meter)?;
        Ok(state)
    }

    /// Places the instance of a slot as the world's table says.
    ///
    /// # Errors
    /// A [`Fault`] if a guard of an initial mode breaks a rule.
    pub(super) fn place(&self, id: SlotId, state: &mut State) -> Result<(), Fault> {
        let (slot, layout) = (&self.world.slots[id], self.layout(id));
        for (param, value) in slot.params.pairs() {
            layout.set_param(state, param, *value);
        }
        for (reference, target) in slot.refs.pairs() {
            layout.set_reference(state, reference, *target);
        }
        for (var, values) in slot.vars.pairs() {
            for (degree, value) in (0u8..).zip(values) {
                layout.set_var(state, var, degree, *value);
            }
        }
        for (discrete, value) in slot.discretes.pairs() {
            layout.set_discrete(state, discrete, *value);
        }
        let fault = Cell::new(None);
        for (group, g) in self.entity(id).groups.pairs() {
            let reader = self.reader(&self.actors[id.index()], state, Frames::NONE, &[], &fault);
            let leaf = reader.entered(reader.chosen(&g.choices, g.first));
            layout.set_leaf(state, group, leaf);
        }
        Self::check_fault(&fault)?;
        layout.set_space(state, slot.space);
        layout.set_life(state, Life::Alive);
        Ok(())
    }

    /// Computes the contacts at the start of a run: nothing moves.
    ///
    /// # Errors
    /// A [`Fault`] if a shape or a guard breaks a rule.
    pub(super) fn first_contacts(
        &self,
        state: &mut State,
        scratch: &mut Scratch,
        meter: &Meter<'_>,
    ) -> Result<(), Fault> {
        scratch.frames.players.fill(Frame::default());
        self.lay(&Input::default().1, &mut scratch.frames);
        scratch.changes.clear();
        self.note_start(state, scratch);
        #[cfg(feature = "ask")]
        scratch.memory.iter_mut().for_each(|memory| memory.forget_boxes());
        self.collide(state, scratch, (false, &mut Nothing), meter)
    }

    /// One step of time: `state` becomes the next state.
    ///
    /// A [`Fault`] if the program breaks a rule; `state` must then not be used.
    pub fn step(&self, state: &mut [u8], input: &Input, scratch: &mut Scratch) -> Result<(), Fault> {
        self.metered_step(state, input, scratch, &Meter::new(&Unwatched))
    }

    /// As [`Simulator::step`], which can take long with many neighbours; if the meter stops it, `state` must not be
    /// used.
    ///
    /// # Errors
    /// As there.
    pub fn metered_step(
        &self,
        state: &mut [u8],
        input: &Input,
        scratch: &mut Scratch,
        meter: &Meter<'_>,
    ) -> Result<(), Fault> {
        if self.still.is_some() {
            return self.step_among_still(state, input, scratch, meter);
        }
        #[cfg(feature = "ask")]
        if scratch.memory.is_some() {
            return self.step_remembering(state, input, scratch, meter);
        }
        self.step_of::<false, _>(state, input, scratch, &mut Nothing, meter)
    }

    #[cfg(feature = "ask")]
    #[inline(never)]
    fn step_remembering(
        &self,
        state: &mut [u8],
        input: &Input,
        scratch: &mut Scratch,
        meter: &Meter<'_>,
    ) -> Result<(), Fault> {
        let Some(mut memory) = scratch.memory.take() else { return Ok(()) };
        memory.recall(state);
        let result = self.step_of::<false, _>(state, input, scratch, &mut *memory, meter);
        match result {
            Ok(()) if !meter.is_stopped() => memory.keep(state, scratch.changes.has_spawned()),
            _ => memory.forget_boxes(),
        }
        scratch.memory = Some(memory);
        result
    }

    #[inline(never)]
    fn step_among_still(
        &self,
        state: &mut [u8],
        input: &Input,
        scratch: &mut Scratch,
        meter: &Meter<'_>,
    ) -> Result<(), Fault> {
        self.step_of::<true, _>(state, input, scratch, &mut Nothing, meter)
    }

    /// A step; `STILL` if there are many instances that never move. Apart, so that the others cost nothing.
    #[inline(always)]
    fn step_of<const STILL: bool, R: Recall>(
        &self,
        state: &mut [u8],
        input: &Input,
        scratch: &mut Scratch,
        recall: &mut R,
        meter: &Meter<'_>,
    ) -> Result<(), Fault> {
        let before = scratch.work();
        for (player, &at) in self.world.layout.players.pairs() {
            let now = input.of(player);
            scratch.frames.players[player.index()] = Frame::new(now, buttons(state, at));
            set_buttons(state, at, now.buttons & self.remembered);
        }
        if !self.draws.is_empty() {
            self.lay(&input.1, &mut scratch.frames);
        }
        self.transitions::<STILL, R>(state, scratch, recall)?;
        if R::IS_ANY {
            scratch.changes.destroyed().iter().for_each(|slot| recall.lose(slot.index()));
        }
        recall.note(state);
        self.flow::<STILL, R>(state, scratch, recall)?;
        recall.move_known(state, &mut scratch.start);
        if STILL {
            self.collide_apart(state, scratch, true, meter)?;
        } else {
            self.collide(state, scratch, (true, recall), meter)?;
        }
        if !meter.is_stopped() {
            meter.spend(recall.end(state));
        }
        if self.lives_change {
            self.remove_destroyed(state, scratch);
        }
        if let Some(breakables) = &self.breakables {
            breakables.restore(state);
        }
        meter.spend(1 + self.cost + scratch.work().wrapping_sub(before));
        Ok(())
    }

    /// Stores the positions before anything moves.
    fn note_start(&self, state: &[u8], scratch: &mut Scratch) {
        for (start, slot) in scratch.start.iter_mut().zip(self.world.slots.ids()) {
            *start = self.position(state, slot);
        }
    }

    /// The first spawn of the last step without a free slot, with its spawner.
    pub fn refused(&self, scratch: &Scratch) -> Option<(SlotId, SpawnId)> {
        scratch.changes.refused()
    }

    /// The first invariant that does not hold in a state: the slot, and its index in the entity.
    ///
    /// # Errors
    /// A [`Fault`] if the invariant breaks a rule.
    pub fn broken_invariant(&self, state: &[u8]) -> Result<Option<(SlotId, usize)>, Fault> {
        for slot in self.world.slots.ids().filter(|&s| self.layout(s).alive(state)) {
            for (index, &invariant) in self.entity(slot).invariants.iter().enumerate() {
                let fault = Cell::new(None);
                let holds = self.reader(&self.actors[slot.index()], state, Frames::NONE, &[], &fault).truth(invariant);
                Self::check_fault(&fault)?;
                if !holds {
                    return Ok(Some((slot, index)));
                }
            }
        }
        Ok(None)
    }

    /// Whether a predicate of the world holds in a state.
    ///
    /// # Errors
    /// A [`Fault`] if the predicate breaks a rule.
    pub fn holds(&self, state: &[u8], predicate: ExprId) -> Result<bool, Fault> {
        let fault = Cell::new(None);
        let reader = self.world_reader(state, &fault);
        let holds = reader.truth(predicate);
        match fault.get() {
            Some(fault) => Err(fault),
            None => Ok(holds),
        }
    }

    /// An expression of the world as a number; truth is 1.
    ///
    /// # Errors
    /// As [`Simulator::holds`].
    pub fn number(&self, state: &[u8], expression: ExprId) -> Result<f64, Fault> {
        let fault = Cell::new(None);
        let value = self.world_reader(state, &fault).number(expression);
        match fault.get() {
            Some(fault) => Err(fault),
            None => Ok(value),
        }
    }

    /// Whether a goal holds in a state.
    ///
    /// # Errors
    /// As [`Simulator::holds`].
    pub fn goal(&self, state: &[u8], goal: GoalId) -> Result<bool, Fault> {
        self.holds(state, self.world.goals[goal].holds)
    }

    /// The first `never` that holds in a state.
    ///
    /// # Errors
    /// As [`Simulator::holds`].
    pub fn violated(&self, state: &[u8]) -> Result<Option<NeverId>, Fault> {
        for (id, never) in self.world.nevers.pairs() {
            if self.holds(state, never.holds)? {
                return Ok(Some(id));
            }
        }
        Ok(None)
    }

    /// The first player whose position lies below or beside the bounds written for its space. The run ends in such a
    /// state: a `never` that holds in it counts, a goal does not. Without `bounds` a run ends at no border.
    pub fn left_bounds(&self, state: &[u8]) -> Option<SlotId> {
        self.world.players.iter().map(|player| player.slot).find(|&slot| {
            self.layout(slot).alive(state)
                && self.world.spaces[self.space(state, slot)]
                    .bounds
                    .is_some_and(|bounds| bounds.is_left_at(self.position(state, slot)))
        })
    }

    /// A slot's position, px.
    #[inline]
    pub fn position(&self, state: &[u8], slot: SlotId) -> (f64, f64) {
        let layout = self.layout(slot);
        (layout.var(state, VarId::X, 0), layout.var(state, VarId::Y, 0))
    }

    /// A parameter of a slot's instance: from the state if it can differ between lives of the slot, else from the
    /// world.
    #[inline]
    pub(super) fn param(&self, state: &[u8], slot: SlotId, param: ParamId) -> f64 {
        match self.layout(slot).param(state, param) {
            Some(value) => value,
            None => self.world.slots[slot].params[param],
        }
    }

    /// The space that a slot is in.
    #[inline]
    pub fn space(&self, state: &[u8], slot: SlotId) -> SpaceId {
        self.layout(slot).space(state)
    }

    /// Fails with the recorded fault, if any.
    #[inline]
    pub(super) fn check_fault(fault: &Cell<Option<Fault>>) -> Result<(), Fault> {
        match fault.get() {
            Some(fault) => Err(fault),
            None => Ok(()),
        }
    }
}
