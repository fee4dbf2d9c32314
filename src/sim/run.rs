//! A running world for a game loop: its state, and the working memory of a step.

use std::sync::Arc;

use crate::ir::{Program, SlotId, World, WorldId};

use super::chance::Draws;
use super::event::Event;
use super::fault::Fault;
use super::input::{Input, PlayerInput};
use super::instance::Instance;
use super::saved::State;
use super::simulator::{Scratch, Simulator};

/// A running world.
///
/// ```
/// use std::path::Path;
/// use std::sync::Arc;
///
/// use hypedc::compile::compile;
/// use hypedc::ir::WorldId;
/// use hypedc::sim::{Event, Run};
/// use hypedc::source::{Files, ReadError};
///
/// /// Where the game keeps its text.
/// struct Assets;
///
/// impl Files for Assets {
///     fn read(&self, _: &Path) -> Result<String, ReadError> {
///         Ok("entity Ball {
///                 button up
///                 mode fall { y'' = -100; when held(up) -> rise }
///                 mode rise { y' = 50 }
///             }
///             world Sky {
///                 space main { place ball: Ball at (0, 80) }
///                 player 1: ball
///                 goal high: ball.y > 90
///             }"
///         .to_string())
///     }
/// }
///
/// let program = compile(Path::new("ball.hyped"), &Assets).program.ok_or("it has errors")?;
/// let mut run = Run::new(&program, WorldId(0)).map_err(|fault| format!("{fault:?}"))?;
/// let ball = run.world().slot_named("ball").ok_or("no ball")?;
/// let up = run.simulator().control(1, "up").ok_or("no button")?;
/// let mut input = run.nothing();
/// let mut reached = None;
/// for frame in 1..=120 {
///     input.set(up, if frame > 20 { 1.0 } else { 0.0 });
///     let mut heard = Vec::new();
///     run.step_with_events(&input, &mut |event| heard.push(event)).map_err(|fault| format!("{fault:?}"))?;
///     if heard.iter().any(|event| matches!(event, Event::Goal(_))) {
///         reached = Some((frame, run.instance(ball).position().1));
///     }
/// }
/// assert!(reached.is_some_and(|(frame, y)| frame > 20 && y > 90.0));
/// # Ok::<(), String>(())
/// ```
#[derive(Clone)]
pub struct Run {
    sim: Arc<Simulator>,
    state: State,
    scratch: Scratch,
    /// The state at the start of the last step: restored if a step fails, and compared to derive events.
    before: State,
    /// The input of the last step with all that nature drew; unused in a world without chances.
    drawn: Input,
    /// Draws what an input leaves open.
    seed: u64,
    /// Number of steps so far.
    steps: u64,
}

impl Run {
    /// Starts a run of a world.
    ///
    /// # Errors
    /// A [`Fault`] if the initial state breaks a rule of the language.
    pub fn new(program: &Arc<Program>, world: WorldId) -> Result<Run, Fault> {
        Run::of(Arc::new(Simulator::new(program, world)))
    }

    /// Starts a run with a simulator that several runs share.
    ///
    /// # Errors
    /// As [`Run::new`].
    pub fn of(sim: Arc<Simulator>) -> Result<Run, Fault> {
        let mut scratch = sim.scratch();
        let state = sim.initial(&mut scratch)?;
        let players = vec![PlayerInput::default(); sim.world().players.len()];
        let drawn = Input(players, Draws::with_capacity(sim.draws().len()));
        Ok(Run { before: state.clone(), state, scratch, sim, drawn, seed: 0, steps: 0 })
    }

    /// Draws what inputs leave open from another seed; that of a new run is 0. The same seed and inputs give the same
    /// run.
    pub fn set_seed(&mut self, seed: u64) {
        self.seed = seed;
    }

    /// Number of steps so far: what a seed draws depends on it.
    pub fn steps(&self) -> u64 {
        self.steps
    }

    /// Continues the count of steps at another number, for instance that of a [state](Run::set_state) that was stored.
    pub fn set_steps(&mut self, steps: u64) {
        self.steps = steps;
    }

    /// The input of the last step, with what nature drew and the step has read.
    pub fn drawn(&self, input: &Input) -> Input {
        self.sim.drawn(input, &self.scratch)
    }

    /// One step of time. What the input leaves open is drawn.
    ///
    /// A [`Fault`] if the program breaks a rule of the language; the state is then unchanged.
    pub fn step(&mut self, input: &Input) -> Result<(), Fault> {
        self.before.clone_from(&self.state);
        let input = match self.sim.draws() {
            [] => input,
            _ => {
                self.sim.draw_into(self.seed, self.steps + 1, input, &mut self.drawn);
                &self.drawn
            }
        };
        let stepped = self.sim.step(&mut self.state, input, &mut self.scratch);
        match stepped {
            Ok(()) => self.steps += 1,
            Err(_) => self.state.clone_from(&self.before),
        }
        stepped
    }

    /// One step of time; reports its events.
    ///
    /// # Errors
    /// As [`Run::step`].
    pub fn step_with_events(&mut self, input: &Input, on_event: &mut dyn FnMut(Event)) -> Result<(), Fault> {
        self.step(input)?;
        self.sim.events(&self.before, &self.state, &self.scratch, on_event)
    }

    /// The state.
    pub fn state(&self) -> &State {
        &self.state
    }

    /// Continues from another state of the same world: one of this run, or one that was [loaded](Simulator::load). In a
    /// world with chances store [`Run::steps`] beside a state, and restore it with [`Run::set_steps`]: the same draws
    /// follow then.
    pub fn set_state(&mut self, state: &State) {
        self.state.clone_from(state);
    }

    /// The simulator.
    pub fn simulator(&self) -> &Arc<Simulator> {
        &self.sim
    }

    /// The world.
    pub fn world(&self) -> &World {
        self.sim.world()
    }

    /// The instance of a slot.
    pub fn instance(&self, slot: SlotId) -> Instance<'_> {
        self.sim.instance(&self.state, slot)
    }

    /// No input from any player.
    pub fn nothing(&self) -> Input {
        Input::nothing(self.world().players.len())
    }
}
