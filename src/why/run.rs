//! A run up to a step, and why the step went as it did: modes, edges in the order in which they were tried, contacts, what
//! was written, and since when each of these is so.

use serde::Serialize;

use crate::ir::{EdgeId, ExprId, Id, SlotId};
use crate::sim::{Fault, Input, Inspection, Script, Simulator};
use crate::source::SourceMap;

use super::record::{Atom, Contact, Place, Value};
use super::step::{Guards, Moment, Moved, contacts, edges, inspect};
use super::whom::whom;
use super::writes::writes;

/// Inputs of a run, and what nature draws where they leave it open.
#[derive(Clone, Copy)]
pub(super) struct Inputs<'r> {
    pub script: &'r Script,
    pub seed: u64,
}

/// Why a run has no such step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum RunError {
    /// A run-time error at a step.
    Fault(Fault, u64),
    /// A player left the bounds, which ended the run after a step.
    Over(SlotId, u64),
}

/// Why an instance did what it did in a step.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct Why {
    /// The step: the state before it is that after one step less.
    pub step: u64,
    /// The time after it, s.
    pub seconds: f64,
    /// The instance.
    pub instance: String,
    /// Its entity.
    pub entity: String,
    /// Whether it is there after the step.
    pub is_alive: bool,
    /// The space that it is in.
    pub space: String,
    /// The innermost active mode of each group.
    pub modes: Vec<ModeSince>,
    /// Its values after the step.
    pub values: Vec<Value>,
    /// The contact queries that hold after the step.
    pub contacts: Vec<Touched>,
    /// The edges of the modes that were active before the step, in the order in which they are tried.
    pub edges: Vec<EdgeWhy>,
    /// What edges and entries did in the step, in order.
    pub writes: Vec<Write>,
}

/// An active mode.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct ModeSince {
    /// Its path.
    pub mode: String,
    /// The step in which its group last changed to it; 0: from the start.
    pub since: u64,
}

/// A contact query that holds.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct Touched {
    /// The query.
    #[serde(flatten)]
    pub contact: Contact,
    /// With whom, as far as it is still there.
    pub whom: Vec<String>,
    /// The step since which it holds.
    pub since: u64,
}

/// An edge.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct EdgeWhy {
    /// Its index in the entity.
    pub edge: usize,
    /// The mode whose edge it is.
    pub from: String,
    /// The target; null if it stays.
    pub to: Option<String>,
    /// Its line in the text.
    pub place: Option<Place>,
    /// Whether its guard held.
    pub held: bool,
    /// Whether it was taken.
    pub taken: bool,
    /// Whether it was tried: not if an edge before it was taken.
    pub tried: bool,
    /// The parts of its guard.
    pub atoms: Vec<AtomSince>,
}

/// A part of a guard.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct AtomSince {
    /// The part.
    #[serde(flatten)]
    pub atom: Atom,
    /// The step since which it is so.
    pub since: u64,
}

/// Something that an edge or an entry did.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct Write {
    /// What was written, such as `y'`; none of a spawn, a signal and a destruction.
    pub what: Option<String>,
    /// The expression as it is written in the program, or what was done instead.
    pub text: String,
    /// The value that was written; of a signal, who received it.
    pub value: Option<String>,
    /// The edge or the mode whose update it is.
    pub by: String,
}

/// A step: the state before, the input as it was drawn, the edges that were taken.
pub(super) type Step<'s> = (&'s [u8], &'s Input, &'s [(SlotId, EdgeId)]);
/// Called for each state with its number, and with the step that led to it.
pub(super) type OnState<'f> = dyn FnMut(u64, Option<Step<'_>>, &[u8]) + 'f;

/// Plays a run.
pub(super) fn play(
    sim: &Simulator,
    inputs: Inputs<'_>,
    steps: u64,
    on_state: &mut OnState<'_>,
) -> Result<(), RunError> {
    let mut scratch = sim.scratch();
    let mut state = sim.initial(&mut scratch).map_err(|fault| RunError::Fault(fault, 0))?;
    on_state(0, None, &state);
    let nothing = Input::nothing(sim.world().players.len());
    let mut given = inputs.script.inputs().chain(std::iter::repeat(&nothing));
    let mut before = state.clone();
    for step in 1..=steps {
        if let Some(slot) = sim.left_bounds(&state) {
            return Err(RunError::Over(slot, step - 1));
        }
        before.clone_from(&state);
        let input = sim.draw(inputs.seed, step, given.next().unwrap_or(&nothing)).into_owned();
        sim.step(&mut state, &input, &mut scratch).map_err(|fault| RunError::Fault(fault, step))?;
        on_state(step, Some((&before, &input, sim.taken_edges(&scratch))), &state);
    }
    Ok(())
}

/// The last step at which a value changed.
struct Since<T>(Option<(T, u64)>);

impl<T: PartialEq> Since<T> {
    fn see(&mut self, value: T, step: u64) {
        if self.0.as_ref().is_none_or(|(known, _)| *known != value) {
            self.0 = Some((value, step));
        }
    }

    fn step(&self) -> u64 {
        self.0.as_ref().map_or(0, |(_, step)| *step)
    }
}

/// Why an instance did what it did in a step. What nature draws comes from a seed where the script leaves it open.
///
/// # Errors
/// [`RunError`] if the run has no such step.
pub fn why(
    sim: &Simulator,
    sources: &SourceMap,
    (script, seed): (&Script, u64),
    step: u64,
    slot: SlotId,
) -> Result<Why, RunError> {
    let inputs = Inputs { script, seed };
    let (mut last, mut taken, mut after) = (None, Vec::new(), Vec::new());
    play(sim, inputs, step, &mut |at, led, state| {
        if at == step {
            last = led.map(|(before, input, _)| (before.to_vec(), input.clone()));
            taken = led.map_or(Vec::new(), |(_, _, edges)| edges.to_vec());
            after = state.to_vec();
        }
    })?;
    let before = last.as_ref().map(|(state, input)| (state.as_slice(), input));
    let moment = Moment { sim, sources, before, after: &after, taken: Some(&taken) };
    let (considered, touched) = (edges(&moment, slot), contacts(&moment, slot));
    let parts: Vec<ExprId> = considered.iter().flat_map(|edge| &edge.parts).copied().collect();
    let program = sim.program();
    let entity = &program.entities[sim.world().slots[slot].entity];
    let mut leaves: Vec<Since<_>> = entity.groups.iter().map(|_| Since(None)).collect();
    let mut atoms: Vec<Since<_>> = parts.iter().map(|_| Since(None)).collect();
    let mut touches: Vec<Since<_>> = touched.iter().map(|_| Since(None)).collect();
    play(sim, inputs, step, &mut |at, led, state| {
        let instance = sim.instance(state, slot);
        for (since, group) in leaves.iter_mut().zip(entity.groups.ids()) {
            since.see((instance.is_alive(), instance.leaf(group)), at);
        }
        for (since, (touch, _)) in touches.iter_mut().zip(&touched) {
            since.see(instance.is_alive() && instance.touches(*touch), at);
        }
        let Some((before, input, taken)) = led.filter(|(before, ..)| sim.instance(before, slot).is_alive()) else {
            return;
        };
        let inspection = Inspection::new(sim, before, input);
        let moved = Some(Moved { sim, before, after: state, taken });
        let guards = Guards { program, sources, step: &inspection, slot, moved };
        for (since, part) in atoms.iter_mut().zip(&parts) {
            since.see(guards.truth(*part), at);
        }
    })?;
    let inspected = inspect(&moment, slot);
    let instance = sim.instance(&after, slot);
    let mode = |(since, group)| ModeSince {
        mode: entity.modes[entity.leaves[instance.leaf(group)].mode].path.clone(),
        since: Since::step(since),
    };
    let is_alive = instance.is_alive();
    let modes = leaves.iter().zip(entity.groups.ids()).filter(|_| is_alive).map(mode).collect();
    let contact = |((touch, contact), since): (_, &Since<bool>)| Touched {
        contact,
        whom: whom(&moment, slot, touch),
        since: since.step(),
    };
    let writes = writes(&moment, slot);
    let mut since = atoms.iter().map(Since::step);
    let mut is_over = vec![false; entity.groups.len()];
    let edge_why = considered.into_iter().map(|edge| {
        let state = edge.state;
        let group = entity.modes[entity.edges[edge.id].source].group.index();
        let tried = state.to.is_none() || !is_over[group];
        is_over[group] |= state.taken && state.to.is_some();
        let path = |mode: usize| entity.modes.iter().nth(mode).map(|mode| mode.path.clone()).unwrap_or_default();
        EdgeWhy {
            edge: state.edge,
            from: path(state.from),
            to: state.to.map(path),
            place: state.place,
            held: state.held,
            taken: state.taken,
            tried,
            atoms: state
                .atoms
                .into_iter()
                .map(|atom| AtomSince { atom, since: since.next().unwrap_or_default() })
                .collect(),
        }
    });
    Ok(Why {
        step,
        seconds: sim.world().step.times(u32::try_from(step).unwrap_or(u32::MAX)),
        instance: instance.name().to_string(),
        entity: entity.name.to_string(),
        is_alive,
        space: sim.world().spaces[instance.space()].name.clone(),
        modes,
        values: inspected.values,
        contacts: touched.into_iter().zip(&touches).map(contact).collect(),
        edges: edge_why.collect(),
        writes,
    })
}
