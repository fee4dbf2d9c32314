//! Runs of inputs: the states of a run one by one, what happens in them, and the record of it.

use std::borrow::Cow;
use std::io;
use std::ops::ControlFlow;

use serde::Serialize;

use crate::diagnostic::Diagnostics;
use crate::diagnostic::catalogue::run::{BrokenInvariant, RefusedSpawn};
use crate::ir::{GroupId, Origin, Program, SlotId, SpawnId, WorldId};
use crate::sim::{Fault, Input, Scratch, Script, Simulator};
use crate::watch::{Meter, Watch};

/// The version of the JSON result.
const RESULT_VERSION: u32 = 1;

/// Called with the number of a step, its input and the state after it; breaks to end the run.
pub type OnState<'a> = dyn FnMut(u64, &Input, &[u8], &Scratch) -> io::Result<ControlFlow<()>> + 'a;

/// How a run ended.
pub enum RunEnd {
    /// After all of its steps.
    Done,
    /// A player left the bounds of its space.
    LeftBounds,
    /// The callback ended it.
    Enough,
    /// By a run-time error at a step.
    Fault(Fault, u64),
    /// By the watch, after a step.
    Stopped(u64),
}

/// Runs at most `frames` steps and passes every state to the callback, starting with the initial one. What the script
/// leaves open is drawn from the seed `chance`, 0 by default.
///
/// # Errors
/// Those of the callback.
pub fn drive(
    sim: &Simulator,
    (script, chance): (&Script, Option<u64>),
    frames: u64,
    watch: &dyn Watch,
    on_state: &mut OnState<'_>,
) -> io::Result<RunEnd> {
    let mut scratch = sim.scratch();
    let nothing = Input::nothing(sim.world().players.len());
    let meter = Meter::new(watch);
    let mut state = match sim.metered_initial(&mut scratch, &meter) {
        _ if meter.is_stopped() => return Ok(RunEnd::Stopped(0)),
        Ok(state) => state,
        Err(fault) => return Ok(RunEnd::Fault(fault, 0)),
    };
    let mut inputs = script.inputs().chain(std::iter::repeat(&nothing));
    let mut input = Cow::Borrowed(&nothing);
    for step in 0.. {
        if on_state(step, &input, &state, &scratch)?.is_break() {
            return Ok(RunEnd::Enough);
        }
        if sim.left_bounds(&state).is_some() {
            return Ok(RunEnd::LeftBounds);
        }
        if step == frames {
            break;
        }
        input = sim.draw(chance.unwrap_or_default(), step + 1, inputs.next().unwrap_or(&nothing));
        let stepped = sim.metered_step(&mut state, &input, &mut scratch, &meter);
        if meter.is_stopped() {
            return Ok(RunEnd::Stopped(step));
        }
        if let Err(fault) = stepped {
            return Ok(RunEnd::Fault(fault, step + 1));
        }
        if !sim.draws().is_empty() {
            input = Cow::Owned(sim.drawn(&input, &scratch));
        }
    }
    Ok(RunEnd::Done)
}

/// What happened in a run, for each step that was shown to it.
pub struct Observed<'s> {
    /// The simulator.
    pub sim: &'s Simulator,
    /// For each goal, the first step at which it held.
    pub goals: Vec<Option<u64>>,
    /// For each `never`, the first step at which it held.
    pub nevers: Vec<Option<u64>>,
    /// The first broken invariant: the step, the slot, and its index.
    pub broken: Option<(u64, SlotId, usize)>,
    /// Each spawn that was refused, with the first step at which it was.
    pub refused: Vec<(u64, SlotId, SpawnId)>,
    /// The player who has left the bounds, which ends the run.
    pub left: Option<SlotId>,
    /// Number of steps.
    pub steps: u64,
    /// The last state.
    pub last: Vec<u8>,
}

impl<'s> Observed<'s> {
    /// Nothing was shown yet.
    pub fn new(sim: &'s Simulator) -> Self {
        let world = sim.world();
        Observed {
            sim,
            goals: vec![None; world.goals.len()],
            nevers: vec![None; world.nevers.len()],
            broken: None,
            refused: Vec::new(),
            left: None,
            steps: 0,
            last: Vec::new(),
        }
    }

    /// Shows the state after a step.
    pub fn observe(&mut self, step: u64, state: &[u8]) {
        let world = self.sim.world();
        self.left = self.sim.left_bounds(state);
        // Out of bounds, a `never` still counts, a goal does not.
        let goals = self.goals.iter_mut().zip(world.goals.iter()).filter(|_| self.left.is_none());
        for (first, predicate) in goals.chain(self.nevers.iter_mut().zip(world.nevers.iter())) {
            if first.is_none() && self.sim.holds(state, predicate.holds) == Ok(true) {
                *first = Some(step);
            }
        }
        self.steps = step;
        self.last.clear();
        self.last.extend_from_slice(state);
    }

    /// Records refused spawns and broken invariants.
    pub fn record_events(&mut self, step: u64, scratch: &Scratch, state: &[u8]) {
        if let Some((slot, spawn)) = self.sim.refused(scratch) {
            let entity = |s: SlotId| self.sim.world().slots[s].entity;
            let known = self.refused.iter().any(|(_, s, x)| (entity(*s), *x) == (entity(slot), spawn));
            if !known {
                self.refused.push((step, slot, spawn));
            }
        }
        if self.broken.is_none()
            && let Ok(Some((slot, invariant))) = self.sim.broken_invariant(state)
        {
            self.broken = Some((step, slot, invariant));
        }
    }

    /// The findings about the run.
    pub fn findings(&self, program: &Program, world: WorldId) -> Diagnostics {
        let slots = &program.worlds[world].slots;
        let mut out = Diagnostics::new();
        for &(step, slot, spawn) in &self.refused {
            let of = slots[slot].entity;
            let entity = program.entities[program.entities[of].spawns[spawn].entity].name.to_string();
            let at = program.spans.entities[of].spawns[spawn];
            out.report(RefusedSpawn { at, instance: slots[slot].name.clone(), entity, step });
        }
        if let Some((step, slot, invariant)) = self.broken {
            let at = program.spans.entities[slots[slot].entity].invariants[invariant];
            out.report(BrokenInvariant { at, instance: slots[slot].name.clone(), step });
        }
        out
    }

    /// Whether a `never` or an invariant was violated.
    pub fn violated(&self) -> bool {
        self.nevers.iter().any(Option::is_some) || self.broken.is_some()
    }

    /// The run as a record.
    pub fn result(&self, file: String, inputs: String, ended: &RunEnd) -> SimResult {
        let world = self.sim.world();
        let seconds = |step: u64| step as f64 * world.step.seconds();
        let first = |name: &str, step: &Option<u64>| FirstStep {
            name: name.to_string(),
            step: *step,
            seconds: step.map(seconds),
        };
        let end = match ended {
            RunEnd::Done | RunEnd::Enough => None,
            RunEnd::LeftBounds => self.left.map(|slot| format!("`{}` has left the bounds", world.slots[slot].name)),
            RunEnd::Fault(fault, step) => {
                let fact = fault.fact(self.sim.program(), self.sim.world_id(), *step);
                Some(format!("{} in `{}` in step {step}", fact.what, fact.instance))
            }
            RunEnd::Stopped(step) => Some(format!("stopped after step {step}")),
        };
        SimResult {
            version: RESULT_VERSION,
            hypedc: env!("CARGO_PKG_VERSION").to_string(),
            file,
            world: world.name.clone(),
            inputs,
            steps: self.steps,
            seconds_of_play: seconds(self.steps),
            end,
            instances: self.instances(),
            goals: world.goals.iter().zip(&self.goals).map(|(goal, step)| first(&goal.name, step)).collect(),
            nevers: world.nevers.iter().zip(&self.nevers).map(|(never, step)| first(&never.name, step)).collect(),
            broken: self.broken.map(|(step, slot, _)| BrokenResult { instance: world.slots[slot].name.clone(), step }),
        }
    }

    /// The instances that are named or there after the last step.
    fn instances(&self) -> Vec<InstanceResult> {
        let (program, world): (&Program, _) = (self.sim.program(), self.sim.world());
        if self.last.is_empty() {
            return Vec::new();
        }
        let instance = |(id, slot): (SlotId, &crate::ir::Slot)| {
            let (entity, layout) = (&program.entities[slot.entity], &world.layout.slots[id]);
            let is_alive = layout.alive(&self.last);
            if !is_alive && slot.origin != Origin::Named {
                return None;
            }
            let groups = entity.groups.ids().filter(|_| is_alive);
            let mode = |group: GroupId| entity.modes[entity.leaves[layout.leaf(&self.last, group)].mode].path.clone();
            let vars = entity.vars.pairs().filter(|_| is_alive);
            let rates = vars.map(|(var, name)| {
                let at = |degree| layout.var(&self.last, var, degree);
                RateResult { name: name.to_string(), value: at(0), rate: at(1) }
            });
            let discretes = entity.discretes.pairs().filter(|_| is_alive);
            let discretes = discretes.map(|(discrete, of)| TextResult {
                name: of.name.to_string(),
                value: of.domain.text(layout.discrete(&self.last, discrete)).to_string(),
            });
            let refs = entity.refs.pairs().filter(|_| is_alive).map(|(reference, of)| {
                let target = layout.reference(&self.last, reference);
                let value = target.map_or_else(|| "none".to_string(), |target| world.slots[target].name.clone());
                TextResult { name: of.name.to_string(), value }
            });
            Some(InstanceResult {
                name: slot.name.clone(),
                entity: entity.name.to_string(),
                is_alive,
                space: world.spaces[self.sim.space(&self.last, id)].name.clone(),
                modes: groups.map(mode).collect(),
                variables: rates.collect(),
                others: discretes.chain(refs).collect(),
            })
        };
        world.slots.pairs().filter_map(instance).collect()
    }
}

/// What came of a run.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct SimResult {
    /// The version of this format.
    pub version: u32,
    /// The version of the command.
    pub hypedc: String,
    /// The path of the program.
    pub file: String,
    /// The world.
    pub world: String,
    /// The inputs, as a script.
    pub inputs: String,
    /// Number of steps.
    pub steps: u64,
    /// The time that they last, s.
    pub seconds_of_play: f64,
    /// Why it ended before its last step; null if it did not.
    pub end: Option<String>,
    /// The instances after the last step: those that are there, and named ones that are not.
    pub instances: Vec<InstanceResult>,
    /// The goals.
    pub goals: Vec<FirstStep>,
    /// The `never`s.
    pub nevers: Vec<FirstStep>,
    /// The first broken invariant; null if there is none.
    pub broken: Option<BrokenResult>,
}

/// A goal or a `never`.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct FirstStep {
    /// Its name.
    pub name: String,
    /// The first step at which it held; null if there is none.
    pub step: Option<u64>,
    /// The time of that step, s.
    pub seconds: Option<f64>,
}

/// An invariant that does not hold.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct BrokenResult {
    /// The instance.
    pub instance: String,
    /// The step.
    pub step: u64,
}

/// An instance after the last step.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct InstanceResult {
    /// Its name.
    pub name: String,
    /// Its entity.
    pub entity: String,
    /// Whether it is there; otherwise it has no modes and values.
    pub is_alive: bool,
    /// The space that it is in.
    pub space: String,
    /// The innermost active mode of each group.
    pub modes: Vec<String>,
    /// Its variables.
    pub variables: Vec<RateResult>,
    /// Its discrete variables and references, as the language writes them.
    pub others: Vec<TextResult>,
}

/// A variable.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct RateResult {
    /// Its name.
    pub name: String,
    /// Its value.
    pub value: f64,
    /// Its rate of change, per second.
    pub rate: f64,
}

/// A value as text.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct TextResult {
    /// The name.
    pub name: String,
    /// The value.
    pub value: String,
}

/// The schema of the result.
#[cfg(feature = "testing")]
pub fn sim_schema() -> schemars::Schema {
    schemars::schema_for!(SimResult)
}
