//! Many runs of one world in one block of memory, for learning and for measurements: they are stepped together with
//! numbers as inputs, and observed as numbers.
//!
//! A [`Batch`] has no threads. [`Batch::whole`] is a [`Part`] of it that can be split into parts, each for a thread of the
//! caller with a [`Worker`] of its own. Every row is a run by itself, so that results do not depend on the parts. A step
//! and an observation allocate nothing.

mod condition;
mod planes;
mod view;

use std::sync::Arc;

use crate::ir::{AxisId, ButtonId, ExprId, GoalId, Id, NeverId, World};
use crate::sim::{Control, Fault, Input, PlayerInput, Run, Scratch, Simulator, State};

use condition::{Borders, Condition};
pub use planes::{PlaneChoice, Planes};
pub use view::{Variables, View};

/// A number of an array of inputs or of observations.
pub trait Sample: Copy + Send + Sync {
    /// As a number.
    fn number(self) -> f64;

    /// The nearest number of the type.
    fn of(number: f64) -> Self;
}

macro_rules! samples {
    ($($type:ty),*) => {$(
        impl Sample for $type {
            #[inline]
            fn number(self) -> f64 {
                self.into()
            }

            #[inline]
            fn of(number: f64) -> Self {
                number as $type
            }
        }
    )*};
}

samples!(f64, f32, u8, i8);

impl Sample for bool {
    #[inline]
    fn number(self) -> f64 {
        self.into()
    }

    #[inline]
    fn of(number: f64) -> Self {
        number != 0.0
    }
}

/// How the run of a row stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[repr(u8)]
pub enum Status {
    /// It goes on.
    #[default]
    Running = 0,
    /// A goal holds that ends it.
    Goal = 1,
    /// A `never` holds that ends it.
    Never = 2,
    /// A player has left the bounds of its space.
    Outside = 3,
    /// The program has broken a rule of the language; the state is that before the step.
    Fault = 4,
    /// All steps that it may take are taken.
    TimeUp = 5,
}

/// What ends the runs of a batch, beside leaving the bounds and run-time errors.
#[derive(Debug, Clone, Default)]
pub struct Rules {
    /// The goals that end a run.
    pub goals: Vec<GoalId>,
    /// The `never`s that end a run; they are looked at before goals.
    pub nevers: Vec<NeverId>,
    /// Maximum number of steps of a run.
    pub within: Option<u64>,
}

impl Rules {
    /// All goals and all `never`s of a world, and no limit of steps.
    pub fn of(world: &World) -> Rules {
        Rules { goals: world.goals.ids().collect(), nevers: world.nevers.ids().collect(), within: None }
    }
}

/// A row: what there is of a run beside its state.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Row {
    /// Draws what nature draws.
    pub seed: u64,
    /// Number of steps so far.
    pub steps: u64,
    /// How it stands.
    pub status: Status,
    /// The index of the goal or the `never` that ended it; 0 otherwise.
    pub which: u32,
    /// The broken rule, if that ended it.
    pub fault: Option<Fault>,
}

impl Row {
    /// Ends the run, or lets it go on.
    fn end(&mut self, ending: Option<Ending>) {
        (self.status, self.which, self.fault) =
            ending.map_or((Status::Running, 0, None), |Ending { status, which, fault }| (status, which, fault));
    }
}

/// How a run ended.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Ending {
    status: Status,
    which: u32,
    fault: Option<Fault>,
}

impl Ending {
    fn of(status: Status, which: u32) -> Option<Ending> {
        Some(Ending { status, which, fault: None })
    }

    fn fault(fault: Fault) -> Option<Ending> {
        Some(Ending { status: Status::Fault, which: 0, fault: Some(fault) })
    }
}

/// What the rows have in common.
struct Shared {
    sim: Arc<Simulator>,
    nevers: Vec<(NeverId, Condition)>,
    goals: Vec<(GoalId, Condition)>,
    borders: Borders,
    within: Option<u64>,
    /// The state before the first step.
    first: State,
    /// What comes of the first state.
    begun: Option<Ending>,
    /// Number of numbers that a row takes as its input.
    width: usize,
    /// Where the input of each player is among them.
    players: Vec<Places>,
    rows: u64,
}

/// The places of a player's buttons and axes among the numbers of a row's input.
#[derive(Default)]
struct Places {
    buttons: Vec<(usize, ButtonId)>,
    axes: Vec<(usize, AxisId)>,
}

impl Places {
    fn of(controls: &[Control], from: usize) -> Places {
        let mut places = Places::default();
        for (at, control) in (from..).zip(controls) {
            match *control {
                Control::Button(_, button) => places.buttons.push((at, button)),
                Control::Axis(_, axis) => places.axes.push((at, axis)),
            }
        }
        places
    }

    /// Sets a player's input. Without branches on the numbers: those of a batch are as good as random.
    #[inline]
    fn read<T: Sample>(&self, numbers: &[T], input: &mut PlayerInput) {
        let bit = |&(at, button): &(usize, ButtonId)| u64::from(numbers[at].number() != 0.0) << button.index();
        input.buttons = self.buttons.iter().map(bit).fold(0, |all, bit| all | bit);
        for &(at, axis) in &self.axes {
            let number = numbers[at].number();
            // NaN is no direction.
            input.axes[axis.index()] = if number.is_nan() { 0.0 } else { number.clamp(-1.0, 1.0) };
        }
    }
}

/// Many runs of one world.
pub struct Batch {
    shared: Shared,
    states: Vec<u8>,
    rows: Vec<Row>,
}

/// The working memory of a thread.
pub struct Worker {
    scratch: Scratch,
    input: Input,
    drawn: Input,
    before: Vec<u8>,
}

/// Consecutive rows of a batch.
pub struct Part<'b> {
    shared: &'b Shared,
    states: &'b mut [u8],
    rows: &'b mut [Row],
}

impl Batch {
    /// A number of runs from the start of a world. The run in row `i` draws from the seed `seed + i`; when it is reset, from
    /// a seed that is greater by the number of rows.
    ///
    /// # Errors
    /// A [`Fault`] if the initial state breaks a rule.
    pub fn new(sim: Arc<Simulator>, rows: usize, seed: u64, rules: Rules) -> Result<Batch, Fault> {
        let first = Run::of(Arc::clone(&sim))?.state().clone();
        let players: Vec<Vec<Control>> =
            sim.world().players.ids().map(|player| sim.controls(player).collect()).collect();
        let per_player = players.iter().map(Vec::len).max().unwrap_or(0);
        let program = Arc::clone(sim.program());
        let world = sim.world_id();
        let condition = |holds: ExprId| Condition::new(&program, &program.worlds[world], holds);
        let mut shared = Shared {
            width: players.len() * per_player,
            players: players.iter().enumerate().map(|(at, of)| Places::of(of, at * per_player)).collect(),
            nevers: rules.nevers.iter().map(|&id| (id, condition(sim.world().nevers[id].holds))).collect(),
            goals: rules.goals.iter().map(|&id| (id, condition(sim.world().goals[id].holds))).collect(),
            borders: Borders::new(&program.worlds[world]),
            within: rules.within,
            begun: None,
            rows: rows as u64,
            first,
            sim,
        };
        shared.begun = shared.judge(&shared.first, 0);
        let states = shared.first.repeat(rows);
        let row = |at: u64| shared.begin(seed.wrapping_add(at));
        let rows = (0..rows as u64).map(row).collect();
        Ok(Batch { states, rows, shared })
    }

    /// The simulator.
    pub fn simulator(&self) -> &Arc<Simulator> {
        &self.shared.sim
    }

    /// The rows.
    pub fn rows(&self) -> &[Row] {
        &self.rows
    }

    /// The bytes of all states, one after the other.
    pub fn states(&self) -> &[u8] {
        &self.states
    }

    /// Number of players, and of numbers that each takes as its input: of the player with the most buttons and axes. Buttons
    /// come first, then axes, each in the order in which the entity has them.
    pub fn shape(&self) -> (usize, usize) {
        let players = self.shared.sim.world().players.len();
        (players, self.shared.width.checked_div(players).unwrap_or(0))
    }

    /// The working memory of a thread.
    pub fn worker(&self) -> Worker {
        let sim = &self.shared.sim;
        let nothing = Input::nothing(sim.world().players.len());
        let mut drawn = Input::default();
        // Makes room once.
        sim.draw_into(0, 1, &nothing, &mut drawn);
        Worker { scratch: sim.scratch(), input: nothing, drawn, before: self.shared.first.to_vec() }
    }

    /// All rows.
    pub fn whole(&mut self) -> Part<'_> {
        Part { shared: &self.shared, states: &mut self.states, rows: &mut self.rows }
    }

    /// The state of a row.
    pub fn state(&self, row: usize) -> Option<&[u8]> {
        let size = self.shared.first.len();
        self.states.get(row.checked_mul(size)?..)?.get(..size)
    }

    /// Writes what an observation sees of each row, one after the other, as far as there is room.
    pub fn observe<T: Sample>(&self, view: &View, out: &mut [T]) {
        self.shared.observe(&self.states, view, out);
    }

    /// Replaces the state of a row, with the number of steps that led to it.
    pub fn set_state(&mut self, row: usize, state: &State, steps: u64) {
        let size = self.shared.first.len();
        let (Some(of), true) = (self.rows.get_mut(row), state.len() == size) else { return };
        self.states[row * size..(row + 1) * size].copy_from_slice(state);
        *of = Row { steps, ..*of };
        of.end(self.shared.judge(state, steps));
    }
}

impl Shared {
    /// A row at the start of a run.
    fn begin(&self, seed: u64) -> Row {
        let mut row = Row { seed, steps: 0, status: Status::Running, which: 0, fault: None };
        row.end(self.begun);
        row
    }

    /// How a run ends in a state, if it does: as a search judges it, `never`s first, then bounds, then goals.
    #[inline(always)]
    fn judge(&self, state: &[u8], steps: u64) -> Option<Ending> {
        let sim = &*self.sim;
        for (never, condition) in &self.nevers {
            match condition.holds(sim, state) {
                Ok(false) => {}
                Ok(true) => return Ending::of(Status::Never, never.0),
                Err(fault) => return Ending::fault(fault),
            }
        }
        if self.borders.are_left(sim, state) {
            return Ending::of(Status::Outside, 0);
        }
        for (goal, condition) in &self.goals {
            match condition.holds(sim, state) {
                Ok(false) => {}
                Ok(true) => return Ending::of(Status::Goal, goal.0),
                Err(fault) => return Ending::fault(fault),
            }
        }
        if self.within.is_some_and(|within| steps >= within) { Ending::of(Status::TimeUp, 0) } else { None }
    }
}

impl<'b> Part<'b> {
    /// Number of rows.
    pub fn len(&self) -> usize {
        self.rows.len()
    }

    /// Whether it has no rows.
    pub fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }

    /// Number of numbers that each row takes as its input.
    pub fn width(&self) -> usize {
        self.shared.width
    }

    /// The first rows, at most a number of them, and the others.
    pub fn split_at(self, rows: usize) -> (Part<'b>, Part<'b>) {
        let rows = rows.min(self.rows.len());
        let (states, other_states) = self.states.split_at_mut(rows * self.shared.first.len());
        let (rows, other_rows) = self.rows.split_at_mut(rows);
        let shared = self.shared;
        (Part { shared, states, rows }, Part { shared, states: other_states, rows: other_rows })
    }

    /// One step of each row that goes on; one whose run has ended stays as it is, or with `resets` begins anew in place of
    /// the step. `inputs` has [`Part::width`] numbers for each row: a button is down unless its number is 0, an axis is
    /// from -1 to 1. Rows without numbers are not stepped.
    pub fn step<T: Sample>(&mut self, inputs: &[T], resets: bool, worker: &mut Worker) {
        let shared = self.shared;
        let size = shared.first.len();
        let mut inputs = inputs.chunks_exact(shared.width.max(1));
        for (state, row) in self.states.chunks_exact_mut(size).zip(self.rows.iter_mut()) {
            let numbers = match inputs.next() {
                Some(numbers) => numbers,
                None if shared.width == 0 => &[],
                None => return,
            };
            if row.status != Status::Running {
                if resets {
                    shared.reset(state, row);
                }
                continue;
            }
            for (places, input) in shared.players.iter().zip(&mut worker.input.0) {
                places.read(numbers, input);
            }
            shared.step(state, row, worker);
        }
    }

    /// Begins anew where `is_reset` says so.
    pub fn reset(&mut self, is_reset: impl Fn(usize) -> bool) {
        let size = self.shared.first.len();
        for (at, (state, row)) in self.states.chunks_exact_mut(size).zip(self.rows.iter_mut()).enumerate() {
            if is_reset(at) {
                self.shared.reset(state, row);
            }
        }
    }

    /// Begins all anew; row `i` draws from the seed `seed + i`.
    pub fn restart(&mut self, seed: u64) {
        let size = self.shared.first.len();
        let rows = self.states.chunks_exact_mut(size).zip(self.rows.iter_mut());
        for (at, (state, row)) in (0u64..).zip(rows) {
            state.copy_from_slice(&self.shared.first);
            *row = self.shared.begin(seed.wrapping_add(at));
        }
    }

    /// As [`Batch::observe`].
    pub fn observe<T: Sample>(&self, view: &View, out: &mut [T]) {
        self.shared.observe(self.states, view, out);
    }

    /// How the run of each row stands, as its number.
    pub fn write_status(&self, out: &mut [u8]) {
        for (out, row) in out.iter_mut().zip(self.rows.iter()) {
            *out = row.status as u8;
        }
    }
}

impl Shared {
    fn observe<T: Sample>(&self, states: &[u8], view: &View, out: &mut [T]) {
        let states = states.chunks_exact(self.first.len());
        for (state, out) in states.zip(out.chunks_exact_mut(view.len().max(1))) {
            view.write(&self.sim, state, out);
        }
    }

    fn reset(&self, state: &mut [u8], row: &mut Row) {
        state.copy_from_slice(&self.first);
        *row = self.begin(row.seed.wrapping_add(self.rows));
    }

    #[inline(always)]
    fn step(&self, state: &mut [u8], row: &mut Row, worker: &mut Worker) {
        let Worker { scratch, input, drawn, before } = worker;
        before.copy_from_slice(state);
        let input = match self.sim.draws() {
            [] => &*input,
            _ => {
                self.sim.draw_into(row.seed, row.steps + 1, input, drawn);
                &*drawn
            }
        };
        if let Err(fault) = self.sim.step(state, input, scratch) {
            state.copy_from_slice(before);
            row.end(Ending::fault(fault));
            return;
        }
        row.steps += 1;
        if let ending @ Some(_) = self.judge(state, row.steps) {
            row.end(ending);
        }
    }
}
