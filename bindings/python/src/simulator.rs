//! A running world.

use std::sync::Arc;

use hypedc::ask::Loaded;
use hypedc::ir::WorldId;
use hypedc::sim;
use hypedc::sim::{Input, Named, Run, State, TraceFormat, TraceLines};
use hypedc::view::{Film, FilmOptions, Images, PlayerArea};
use numpy::{PyArray1, PyArray3, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict, PyTuple};

use crate::error::{argument, question, step, unknown_name};
use crate::event::Event;
use crate::inputs::{input, script};
use crate::named::{object, value};
use crate::program::Program;
use crate::world::World;

/// Number of steps between two looks for signals.
const STEPS: u64 = 1 << 14;
/// Maximum number of steps of one call, as of a script.
const MAX_STEPS: u64 = 100_000_000;
/// The largest side of a picture, in pixels.
const MAX_SIDE: u32 = 8192;

/// A running world of a program.
#[pyclass(module = "hyped", weakref)]
pub struct Simulator {
    program: Py<Program>,
    loaded: Arc<Loaded>,
    world: WorldId,
    run: Run,
    seed: u64,
    /// What the last input was made of, as most are repeated.
    last: Option<(String, Input)>,
}

impl Simulator {
    /// Runs a world in a simulator that is shared.
    pub(crate) fn of(
        program: Py<Program>,
        loaded: &Arc<Loaded>,
        sim: &Arc<sim::Simulator>,
        seed: u64,
    ) -> PyResult<Self> {
        let world = sim.world_id();
        let fault = |fault: sim::Fault| step(&loaded.sources, fault.fact(&loaded.program, world, 0));
        let mut run = Run::of(Arc::clone(sim)).map_err(fault)?;
        run.set_seed(seed);
        Ok(Simulator { program, loaded: Arc::clone(loaded), world, run, seed, last: None })
    }

    /// Puts a state in place.
    pub(crate) fn put(&mut self, state: &State, steps: u64) {
        self.run.set_state(state);
        self.run.set_steps(steps);
    }

    /// As [`Simulator::put`], of the bytes of a state of the same simulator.
    pub(crate) fn put_bytes(&mut self, bytes: &[u8], steps: u64) {
        let mut state = self.run.state().clone();
        if state.len() == bytes.len() {
            state.copy_from_slice(bytes);
            self.put(&state, steps);
        }
    }

    fn input(&mut self, given: Option<&Bound<'_, PyAny>>) -> PyResult<Input> {
        let text = given.and_then(|given| given.extract::<String>().ok());
        if let (Some(text), Some((last, input))) = (&text, &self.last)
            && text == last
        {
            return Ok(input.clone());
        }
        let input = input((&self.loaded, self.world), self.run.simulator(), given)?;
        if let Some(text) = text {
            self.last = Some((text, input.clone()));
        }
        Ok(input)
    }

    fn fault(&self, fault: sim::Fault) -> PyErr {
        step(&self.loaded.sources, fault.fact(&self.loaded.program, self.world, self.run.steps() + 1))
    }

    fn repeat(&mut self, py: Python<'_>, input: &Input, mut count: u64) -> PyResult<()> {
        if count == 1 {
            return self.run.step(input).map_err(|fault| self.fault(fault));
        }
        while count > 0 {
            let steps = count.min(STEPS);
            let run = &mut self.run;
            let done = py.detach(|| (0..steps).try_for_each(|_| run.step(input)));
            done.map_err(|fault| self.fault(fault))?;
            py.check_signals()?;
            count -= steps;
        }
        Ok(())
    }
}

#[pymethods]
impl Simulator {
    #[new]
    #[pyo3(signature = (program, world = None, *, seed = 0))]
    fn new(program: &Bound<'_, Program>, world: Option<&str>, seed: u64) -> PyResult<Self> {
        let of = program.get();
        let id = of.world_id(world)?;
        let sim = Arc::new(sim::Simulator::new(&of.loaded.program, id));
        Simulator::of(program.clone().unbind(), &of.loaded, &sim, seed)
    }

    /// The program.
    #[getter]
    fn program(&self, py: Python<'_>) -> Py<Program> {
        self.program.clone_ref(py)
    }

    /// The world.
    #[getter]
    fn world(&self, py: Python<'_>) -> World {
        World::new(self.program.clone_ref(py), &self.loaded, self.world)
    }

    /// Number of steps so far.
    #[getter]
    fn steps(&self) -> u64 {
        self.run.steps()
    }

    /// The time so far, s.
    #[getter]
    fn time(&self) -> f64 {
        self.run.steps() as f64 * self.run.world().step.seconds()
    }

    /// The seed of what nature draws.
    #[getter]
    fn seed(&self) -> u64 {
        self.seed
    }

    #[setter]
    fn set_seed(&mut self, seed: u64) {
        self.seed = seed;
        self.run.set_seed(seed);
    }

    /// A number of steps with the same input.
    #[pyo3(signature = (inputs = None, count = 1))]
    fn step(&mut self, py: Python<'_>, inputs: Option<&Bound<'_, PyAny>>, count: u64) -> PyResult<()> {
        if count > MAX_STEPS {
            return Err(argument(format!("`count` is at most {MAX_STEPS}, not {count}")));
        }
        let input = self.input(inputs)?;
        self.repeat(py, &input, count)
    }

    /// One step; returns its events.
    #[pyo3(signature = (inputs = None))]
    fn step_with_events(&mut self, inputs: Option<&Bound<'_, PyAny>>) -> PyResult<Vec<Event>> {
        let input = self.input(inputs)?;
        let mut events = Vec::new();
        let stepped = self.run.step_with_events(&input, &mut |event| events.push(event));
        stepped.map_err(|fault| self.fault(fault))?;
        let sim = self.run.simulator();
        Ok(events.into_iter().map(|event| Event::new(sim, event)).collect())
    }

    /// Runs an input script to its end.
    fn run(&mut self, py: Python<'_>, inputs: &str) -> PyResult<()> {
        let script = script(&self.loaded, self.world, inputs)?;
        script.steps.iter().try_for_each(|of| self.repeat(py, &of.input, u64::from(of.count)))
    }

    /// Begins anew.
    #[pyo3(signature = (seed = None))]
    fn reset(&mut self, seed: Option<u64>) -> PyResult<()> {
        let first = Run::of(Arc::clone(self.run.simulator())).map_err(|fault| self.fault(fault))?;
        self.put(first.state(), 0);
        self.set_seed(seed.unwrap_or(self.seed));
        Ok(())
    }

    /// A part of the state by name.
    fn __getitem__<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyAny>> {
        let sim = self.run.simulator();
        let part = sim.named(name).map_err(unknown_name)?;
        object(py, &sim.named_value(self.run.state(), part))
    }

    /// Writes a part of the state by name.
    fn __setitem__(&mut self, name: &str, new: &Bound<'_, PyAny>) -> PyResult<()> {
        let sim = Arc::clone(self.run.simulator());
        let part = sim.named(name).map_err(unknown_name)?;
        let mut state = self.run.state().clone();
        let written = sim.set_named(&mut state, part, &value(new)?);
        written.map_err(|why| {
            argument(format!(
                "`{name}` cannot be {}: {why}",
                new.repr().map_or_else(|_| "that".into(), |r| r.to_string())
            ))
        })?;
        self.run.set_state(&state);
        Ok(())
    }

    /// All parts of the state that have a name, of instances that are there.
    fn values<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let (sim, all) = (self.run.simulator(), PyDict::new(py));
        for name in sim.names() {
            let part = sim.named(&name).map_err(question)?;
            all.set_item(name, object(py, &sim.named_value(self.run.state(), part))?)?;
        }
        Ok(all)
    }

    /// The innermost active mode of each group of an instance; empty if it is absent.
    fn modes(&self, instance: &str) -> PyResult<Vec<String>> {
        let slot = self.run.world().slot_named(instance);
        let slot = slot.ok_or_else(|| argument(format!("no instance `{instance}` in `{}`", self.run.world().name)))?;
        let of = self.run.instance(slot);
        Ok(of.modes().map(|mode| of.entity().modes[mode].path.clone()).collect())
    }

    /// The names of the instances that are there.
    #[getter]
    fn instances(&self) -> Vec<String> {
        let sim = self.run.simulator();
        sim.instances(self.run.state()).map(|instance| instance.name().to_string()).collect()
    }

    /// The goals that hold.
    #[getter]
    fn goals(&self) -> Vec<String> {
        let holds = self.run.world().goals.pairs().filter(|(id, _)| self.holds(Named::Goal(*id)));
        holds.map(|(_, goal)| goal.name.clone()).collect()
    }

    /// Each `never` that holds.
    #[getter]
    fn nevers(&self) -> Vec<String> {
        let holds = self.run.world().nevers.pairs().filter(|(id, _)| self.holds(Named::Never(*id)));
        holds.map(|(_, never)| never.name.clone()).collect()
    }

    /// The player that has left the bounds of its space, which ends a run; None if none has.
    #[getter]
    fn left(&self) -> Option<String> {
        let slot = self.run.simulator().left_bounds(self.run.state())?;
        Some(self.run.world().slots[slot].name.clone())
    }

    /// The state as bytes, for `restore` and for files.
    pub(crate) fn save<'py>(&self, py: Python<'py>) -> Bound<'py, PyBytes> {
        PyBytes::new(py, &self.run.simulator().save(self.run.state()))
    }

    /// Puts a saved state in place.
    #[pyo3(signature = (state, steps = 0))]
    fn restore(&mut self, state: &[u8], steps: u64) -> PyResult<()> {
        let state = self.run.simulator().load(state).map_err(|why| argument(why.to_string()))?;
        self.put(&state, past(steps)?);
        Ok(())
    }

    /// A run of its own that goes on from here.
    fn copy(&self, py: Python<'_>) -> Simulator {
        let (program, loaded) = (self.program.clone_ref(py), Arc::clone(&self.loaded));
        Simulator { program, loaded, world: self.world, run: self.run.clone(), seed: self.seed, last: None }
    }

    fn __copy__(&self, py: Python<'_>) -> Simulator {
        self.copy(py)
    }

    fn __deepcopy__(&self, py: Python<'_>, _memo: &Bound<'_, PyAny>) -> Simulator {
        self.copy(py)
    }

    /// A hash of the state, the same on every machine: FNV-1a of 64 bits over its bytes.
    fn hash(&self) -> u64 {
        sim::Fnv::of(self.run.state())
    }

    /// The bytes of the state, in the layout of the world.
    fn state<'py>(&self, py: Python<'py>) -> Bound<'py, PyBytes> {
        PyBytes::new(py, self.run.state())
    }

    /// Shape of pictures: height, width, 3.
    #[pyo3(signature = (scale = None, size = None))]
    fn picture_shape(&self, scale: Option<u32>, size: Option<(u32, u32)>) -> PyResult<(usize, usize, usize)> {
        let images = Images::default();
        let (width, height) = self.film(&images, scale, size, false)?.size();
        Ok((height, width, 3))
    }

    /// The picture of the state: shape (height, width, 3), uint8.
    #[pyo3(signature = (scale = None, size = None, dark = false))]
    fn render<'py>(
        &self,
        py: Python<'py>,
        scale: Option<u32>,
        size: Option<(u32, u32)>,
        dark: bool,
    ) -> PyResult<Bound<'py, PyArray3<u8>>> {
        let images = Images::default();
        let mut film = self.film(&images, scale, size, dark)?;
        let canvas = film.paint(self.run.state());
        let shape = [canvas.height(), canvas.width(), 3];
        PyArray1::from_slice(py, canvas.pixels().as_flattened()).reshape(shape)
    }

    /// The line of `hypedc sim --trace` for the state after an input.
    #[pyo3(signature = (inputs = None))]
    fn trace_line(&mut self, inputs: Option<&Bound<'_, PyAny>>) -> PyResult<String> {
        let input = self.input(inputs)?;
        let input = if self.run.steps() == 0 { input } else { self.run.drawn(&input) };
        let lines = TraceLines::new(self.run.simulator(), TraceFormat::Jsonl);
        let line = lines.state(self.run.steps(), &input, self.run.state());
        line.map(|line| line.trim_end().to_string()).map_err(|error| argument(error.to_string()))
    }

    fn _repr_svg_(&self) -> String {
        let loaded = &self.loaded;
        let sim = self.run.simulator();
        let mut recorder = hypedc::view::Recorder::new(sim);
        recorder.observe(0, &self.run.nothing(), self.run.state());
        let run = recorder.finish(self.run.state(), Vec::new());
        let mut observed = hypedc::ask::Observed::new(sim);
        observed.observe(self.run.steps(), self.run.state());
        let outcome = hypedc::ask::RunOutcome::new(&observed, "", &hypedc::ask::RunEnd::Done, true);
        hypedc::ask::run_svg((&loaded.program, self.world), &run, &outcome, &Images::default())
    }

    fn __repr__(&self) -> String {
        format!("<hyped.Simulator of {}, step {}>", self.run.world().name, self.run.steps())
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyTuple>)> {
        let resume = py.import("hyped._hyped")?.getattr("_resumed")?;
        let name = self.run.world().name.as_str();
        let parts = (self.program.clone_ref(py), name, self.seed, self.save(py), self.run.steps());
        Ok((resume, parts.into_pyobject(py)?))
    }
}

impl Simulator {
    /// Whether a goal or a `never` holds.
    fn holds(&self, part: Named) -> bool {
        self.run.simulator().named_number(self.run.state(), part) != 0.0
    }

    fn film<'s>(
        &'s self,
        images: &'s Images,
        scale: Option<u32>,
        size: Option<(u32, u32)>,
        is_dark: bool,
    ) -> PyResult<Film<'s>> {
        if scale.is_some_and(|scale| !(1..=64).contains(&scale)) {
            return Err(argument("`scale` is a whole number from 1 to 64"));
        }
        if size.is_some_and(|(w, h)| !(1..=MAX_SIDE).contains(&w) || !(1..=MAX_SIDE).contains(&h)) {
            return Err(argument(format!("`size` is width and height in pixels, from 1 to {MAX_SIDE}")));
        }
        let sim = self.run.simulator();
        let size = size.or_else(|| scale.map(|_| (MAX_SIDE / 4, MAX_SIDE / 4)));
        // The same in all states, so that the size of pictures is.
        let mut area = PlayerArea::new(sim);
        let first = sim.initial(&mut sim.scratch()).map_err(|fault| self.fault(fault))?;
        area.observe(sim, &first);
        Ok(Film::new(sim, FilmOptions { scale, size, is_dark }, images, &area))
    }
}

/// Number of steps of a run that goes on: it can be counted further.
pub(crate) fn past(steps: u64) -> PyResult<u64> {
    match steps <= u64::MAX / 2 {
        true => Ok(steps),
        false => Err(argument(format!("`steps` is at most {}, not {steps}", u64::MAX / 2))),
    }
}

/// A simulator that was pickled.
#[pyfunction]
#[pyo3(name = "_resumed")]
pub fn resumed(program: &Bound<'_, Program>, world: &str, seed: u64, state: &[u8], steps: u64) -> PyResult<Simulator> {
    let mut resumed = Simulator::new(program, Some(world), seed)?;
    resumed.restore(state, steps)?;
    Ok(resumed)
}
