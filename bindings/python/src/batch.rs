//! Many runs at once over NumPy arrays, on all cores. What a step and an observation are is in `hypedc::batch`.

use std::process;
use std::sync::Arc;
use std::thread::available_parallelism;

use hypedc::batch;
use hypedc::batch::{Part, Rules, Status, View, Worker};
use hypedc::ir::{GoalId, NeverId, WorldId};
use hypedc::reach::Target;
use hypedc::reach::query::Kind;
use hypedc::sim;
use numpy::PyArray1;
use pyo3::exceptions::{PyIndexError, PyTypeError};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyList, PyTuple};
use rayon::{ThreadPool, ThreadPoolBuilder};

use crate::arrays::{Inputs, Outputs, Read, Write};
use crate::error::{argument, class::HypedError, step};
use crate::program::Program;
use crate::simulator::{Simulator, past};
use crate::views::{MAX_VIEWS, views};
use crate::world::World;

/// Maximum number of bytes of all states.
const MAX_BYTES: usize = 4 << 30;
/// Maximum number of threads, and the number of rows below which another thread costs more than it does.
const MAX_THREADS: usize = 1 << 10;
const ROWS: usize = 32;

/// Many runs of a world in one block of memory.
#[pyclass(module = "hyped", weakref)]
pub struct Batch {
    program: Py<Program>,
    world: WorldId,
    batch: batch::Batch,
    views: Vec<View>,
    workers: Vec<Worker>,
    /// The threads, and the process that they are of: they do not outlive a fork.
    pool: Option<(ThreadPool, u32)>,
}

/// What is done with a part of the rows.
#[derive(Clone, Copy)]
struct Job<'j> {
    views: &'j [View],
    width: usize,
    resets: bool,
}

/// The arrays of a part of the rows.
struct Arrays<'a> {
    inputs: Option<Read<'a>>,
    outputs: [Option<Write<'a>>; MAX_VIEWS],
    status: Option<&'a mut [u8]>,
}

impl Arrays<'_> {
    fn split_at(self, rows: usize, job: &Job<'_>) -> (Self, Self) {
        let (mut first, mut others) = (Arrays::none(), Arrays::none());
        if let Some(inputs) = self.inputs {
            let (a, b) = inputs.split_at(rows * job.width);
            (first.inputs, others.inputs) = (Some(a), Some(b));
        }
        for (at, (output, view)) in self.outputs.into_iter().zip(job.views).enumerate() {
            if let Some(output) = output {
                let (a, b) = output.split_at(rows * view.len());
                (first.outputs[at], others.outputs[at]) = (Some(a), Some(b));
            }
        }
        if let Some(status) = self.status {
            let (a, b) = status.split_at_mut(rows.min(status.len()));
            (first.status, others.status) = (Some(a), Some(b));
        }
        (first, others)
    }

    fn none() -> Self {
        Arrays { inputs: None, outputs: [const { None }; MAX_VIEWS], status: None }
    }
}

/// Does a job with all rows of a part, divided among the workers.
fn work(mut part: Part<'_>, arrays: Arrays<'_>, workers: &mut [Worker], job: &Job<'_>) {
    if workers.len() > 1 {
        let half = workers.len() / 2;
        let rows = part.len() * half / workers.len();
        let (ours, theirs) = workers.split_at_mut(half);
        let (first, others) = part.split_at(rows);
        let (a, b) = arrays.split_at(rows, job);
        rayon::join(|| work(first, a, ours, job), || work(others, b, theirs, job));
        return;
    }
    let Some(worker) = workers.first_mut() else { return };
    if let Some(inputs) = arrays.inputs {
        inputs.step(&mut part, job.resets, worker);
    }
    for (output, view) in arrays.outputs.into_iter().zip(job.views) {
        if let Some(output) = output {
            output.observe(&part, view);
        }
    }
    if let Some(status) = arrays.status {
        part.write_status(status);
    }
}

impl Batch {
    /// Starts the threads, anew in a process that was forked.
    fn threads(&mut self) -> PyResult<()> {
        if self.workers.len() < 2 || self.pool.as_ref().is_some_and(|(_, of)| *of == process::id()) {
            return Ok(());
        }
        let built = ThreadPoolBuilder::new().num_threads(self.workers.len()).build();
        let pool = built.map_err(|error| HypedError::new_err(format!("no threads can be started: {error}")))?;
        if let Some((lost, _)) = self.pool.replace((pool, process::id())) {
            // Its threads are of another process: waiting for them would never end.
            std::mem::forget(lost);
        }
        Ok(())
    }

    fn run(&mut self, py: Python<'_>, arrays: Arrays<'_>, resets: bool) -> PyResult<()> {
        self.threads()?;
        let Batch { batch, views, workers, pool, .. } = self;
        let part = batch.whole();
        let job = Job { views, width: part.width(), resets };
        py.detach(|| match pool {
            Some((pool, _)) => pool.install(|| work(part, arrays, workers, &job)),
            None => work(part, arrays, workers, &job),
        });
        Ok(())
    }

    /// Borrows the arrays that observations are written to.
    fn outputs<'py>(&self, given: Option<&Bound<'py, PyAny>>) -> PyResult<Vec<Outputs<'py>>> {
        let Some(given) = given.filter(|given| !given.is_none()) else { return Ok(Vec::new()) };
        let all: Vec<Bound<'py, PyAny>> = match (given.cast::<PyList>(), given.cast::<PyTuple>()) {
            (Ok(list), _) => list.iter().collect(),
            (_, Ok(tuple)) => tuple.iter().collect(),
            _ => vec![given.clone()],
        };
        if all.len() != self.views.len() {
            return Err(argument(format!("{} arrays for {} observations of the batch", all.len(), self.views.len())));
        }
        let rows = self.batch.rows().len();
        let shape = |view: &View| [vec![rows], view.shape()].concat();
        all.iter().zip(&self.views).map(|(array, view)| Outputs::new("observations", array, &shape(view))).collect()
    }

    fn status_array<'py>(&self, given: Option<&Bound<'py, PyAny>>) -> PyResult<Option<Outputs<'py>>> {
        let rows = self.batch.rows().len();
        let given = given.filter(|given| !given.is_none());
        let found = given.map(|given| Outputs::new("`status`", given, &[rows])).transpose()?;
        match found {
            None | Some(Outputs::U8(_)) => Ok(found),
            Some(_) => Err(PyTypeError::new_err("`status` is an array of uint8")),
        }
    }

    fn row(&self, row: isize) -> PyResult<usize> {
        let rows = self.batch.rows().len();
        let at = if row < 0 { row.checked_add_unsigned(rows) } else { Some(row) };
        let at = at.and_then(|at| usize::try_from(at).ok()).filter(|at| *at < rows);
        at.ok_or_else(|| PyIndexError::new_err(format!("there is no row {row} in a batch of {rows}")))
    }
}

/// The arrays of a job, from those that were borrowed.
fn arrays<'a>(
    inputs: Option<Read<'a>>,
    outputs: &'a mut [Outputs<'_>],
    status: Option<&'a mut Outputs<'_>>,
) -> PyResult<Arrays<'a>> {
    let mut all = Arrays { inputs, ..Arrays::none() };
    for (place, output) in all.outputs.iter_mut().zip(outputs) {
        *place = Some(output.write("observations")?);
    }
    if let Some(Write::U8(status)) = status.map(|status| status.write("`status`")).transpose()? {
        all.status = Some(status);
    }
    Ok(all)
}

#[pymethods]
impl Batch {
    #[new]
    #[pyo3(signature = (
        program, n, *, world = None, observe = None, goals = None, nevers = None, within = None, seed = 0, threads = None
    ))]
    #[allow(clippy::too_many_arguments, reason = "they are keywords in Python")]
    fn new(
        py: Python<'_>,
        program: &Bound<'_, Program>,
        n: usize,
        world: Option<&str>,
        observe: Option<&Bound<'_, PyAny>>,
        goals: Option<Vec<String>>,
        nevers: Option<Vec<String>>,
        within: Option<u64>,
        seed: u64,
        threads: Option<usize>,
    ) -> PyResult<Batch> {
        let of = program.get();
        let id = of.world_id(world)?;
        let table = &of.loaded.program.worlds[id];
        if n == 0 || n.checked_mul(table.layout.size.max(1)).is_none_or(|bytes| bytes > MAX_BYTES) {
            let size = table.layout.size;
            return Err(argument(format!(
                "`n` is from 1 to {}, not {n}: a state has {size} bytes",
                MAX_BYTES / size.max(1)
            )));
        }
        let threads = threads.unwrap_or_else(|| available_parallelism().map_or(1, |threads| threads.get()));
        if !(1..=MAX_THREADS).contains(&threads) {
            return Err(argument(format!("`threads` is from 1 to {MAX_THREADS}, not {threads}")));
        }
        let mut rules = Rules { within, ..Rules::of(table) };
        if let Some(names) = goals {
            rules.goals = names.iter().map(|name| goal_named(table, name)).collect::<PyResult<_>>()?;
        }
        if let Some(names) = nevers {
            rules.nevers = names.iter().map(|name| never_named(table, name)).collect::<PyResult<_>>()?;
        }
        let sim = Arc::new(sim::Simulator::new(&of.loaded.program, id));
        let views = views(&sim, observe)?;
        let fault = |fault: sim::Fault| step(&of.loaded.sources, fault.fact(&of.loaded.program, id, 0));
        let batch = py.detach(|| batch::Batch::new(sim, n, seed, rules)).map_err(fault)?;
        let workers = threads.min(n / ROWS).max(1);
        let workers = (0..workers).map(|_| batch.worker()).collect();
        Ok(Batch { program: program.clone().unbind(), world: id, batch, views, workers, pool: None })
    }

    /// The program.
    #[getter]
    fn program(&self, py: Python<'_>) -> Py<Program> {
        self.program.clone_ref(py)
    }

    /// The world.
    #[getter]
    fn world(&self, py: Python<'_>) -> World {
        World::new(self.program.clone_ref(py), &self.program.get().loaded, self.world)
    }

    fn __len__(&self) -> usize {
        self.batch.rows().len()
    }

    /// Shape of actions: (n, players, buttons + axes).
    #[getter]
    fn shape(&self) -> (usize, usize, usize) {
        let (players, controls) = self.batch.shape();
        (self.batch.rows().len(), players, controls)
    }

    /// Shape of each observation of all rows.
    #[getter]
    fn observation_shapes<'py>(&self, py: Python<'py>) -> PyResult<Vec<Bound<'py, PyTuple>>> {
        let rows = self.batch.rows().len();
        self.views.iter().map(|view| PyTuple::new(py, [vec![rows], view.shape()].concat())).collect()
    }

    /// Number of threads.
    #[getter]
    fn threads_used(&self) -> usize {
        self.workers.len()
    }

    /// One step of each row; writes observations and status into arrays.
    #[pyo3(signature = (actions, observations = None, status = None, *, reset = false))]
    fn step(
        &mut self,
        py: Python<'_>,
        actions: &Bound<'_, PyAny>,
        observations: Option<&Bound<'_, PyAny>>,
        status: Option<&Bound<'_, PyAny>>,
        reset: bool,
    ) -> PyResult<()> {
        let (rows, players, controls) = self.shape();
        let (whole, flat) = ([rows, players, controls], [rows, controls]);
        let shapes: &[&[usize]] = if players == 1 { &[&whole, &flat] } else { &[&whole] };
        let inputs = Inputs::new("actions", actions, shapes)?;
        let (mut outputs, mut status) = (self.outputs(observations)?, self.status_array(status)?);
        let arrays = arrays(Some(inputs.read("actions")?), &mut outputs, status.as_mut())?;
        self.run(py, arrays, reset)
    }

    /// Writes observations and status into arrays.
    #[pyo3(signature = (observations = None, status = None))]
    fn observe(
        &mut self,
        py: Python<'_>,
        observations: Option<&Bound<'_, PyAny>>,
        status: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<()> {
        let (mut outputs, mut status) = (self.outputs(observations)?, self.status_array(status)?);
        let arrays = arrays(None, &mut outputs, status.as_mut())?;
        self.run(py, arrays, false)
    }

    /// Begins anew: all rows, or those of a mask.
    #[pyo3(signature = (rows = None, *, seed = None))]
    fn reset(&mut self, rows: Option<&Bound<'_, PyAny>>, seed: Option<u64>) -> PyResult<()> {
        let Some(rows) = rows.filter(|rows| !rows.is_none()) else {
            match seed {
                Some(seed) => self.batch.whole().restart(seed),
                None => self.batch.whole().reset(|_| true),
            }
            return Ok(());
        };
        if seed.is_some() {
            return Err(argument("`seed` is for all rows: give no `rows`"));
        }
        match Inputs::new("`rows`", rows, &[&[self.batch.rows().len()]])? {
            inputs @ Inputs::Bool(_) => match inputs.read("`rows`")? {
                Read::Bool(mask) => self.batch.whole().reset(|at| mask.get(at) == Some(&true)),
                _ => return Err(PyTypeError::new_err("`rows` is an array of bool")),
            },
            _ => return Err(PyTypeError::new_err("`rows` is an array of bool: which rows begin anew")),
        }
        Ok(())
    }

    /// How the run of each row stands: 0 goes on, 1 goal, 2 never, 3 outside, 4 error, 5 time up; shape (n,), uint8.
    #[getter]
    fn status<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<u8>> {
        PyArray1::from_iter(py, self.batch.rows().iter().map(|row| row.status as u8))
    }

    /// Number of steps of the run of each row; shape (n,), uint64.
    #[getter]
    fn steps<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<u64>> {
        PyArray1::from_iter(py, self.batch.rows().iter().map(|row| row.steps))
    }

    /// The seed of what nature draws in each row; shape (n,), uint64.
    #[getter]
    fn seeds<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<u64>> {
        PyArray1::from_iter(py, self.batch.rows().iter().map(|row| row.seed))
    }

    /// What ended the run of a row, in words; None if it goes on.
    fn why(&self, row: isize) -> PyResult<Option<String>> {
        let row = &self.batch.rows()[self.row(row)?];
        let (program, sim) = (self.program.get(), self.batch.simulator());
        let world = sim.world();
        Ok(match row.status {
            Status::Running => None,
            Status::Goal => Some(Target::Goal(GoalId(row.which)).name(world).to_string()),
            Status::Never => Some(Target::Never(NeverId(row.which)).name(world).to_string()),
            Status::Outside => Some("a player has left the bounds of its space".to_string()),
            Status::TimeUp => Some("the time is up".to_string()),
            Status::Fault => row.fault.map(|fault| {
                let fact = fault.fact(&program.loaded.program, self.world, row.steps + 1);
                Python::attach(|py| step(&program.loaded.sources, fact).value(py).to_string())
            }),
        })
    }

    /// The state of a row, as `Simulator.save` gives it.
    fn save<'py>(&self, py: Python<'py>, row: isize) -> PyResult<Bound<'py, PyBytes>> {
        Ok(self.simulator(py, row)?.save(py))
    }

    /// Puts a saved state in place in a row.
    #[pyo3(signature = (row, state, steps = 0))]
    fn restore(&mut self, row: isize, state: &[u8], steps: u64) -> PyResult<()> {
        let row = self.row(row)?;
        let state = self.batch.simulator().load(state).map_err(|why| argument(why.to_string()))?;
        self.batch.set_state(row, &state, past(steps)?);
        Ok(())
    }

    /// The run of a row as a simulator of its own.
    fn simulator(&self, py: Python<'_>, row: isize) -> PyResult<Simulator> {
        let at = self.row(row)?;
        let row = self.batch.rows()[at];
        let sim = self.batch.simulator();
        let mut one = Simulator::of(self.program.clone_ref(py), &self.program.get().loaded, sim, row.seed)?;
        one.put_bytes(self.batch.state(at).unwrap_or_default(), row.steps);
        Ok(one)
    }

    /// A hash of the states of all rows: FNV-1a of 64 bits over their bytes.
    fn hash(&self) -> u64 {
        sim::Fnv::of(self.batch.states())
    }

    fn __repr__(&self) -> String {
        let rows = self.batch.rows().len();
        format!("<hyped.Batch of {rows} x {}>", self.batch.simulator().world().name)
    }
}

fn goal_named(world: &hypedc::ir::World, name: &str) -> PyResult<GoalId> {
    world.goal_named(name).ok_or_else(|| {
        let known: Vec<(Target, &str)> = world.goals.pairs().map(|(id, of)| (Target::Goal(id), &*of.name)).collect();
        crate::error::refusal(&Default::default(), hypedc::ask::unknown(world, Kind::Goal, name, &known))
    })
}

fn never_named(world: &hypedc::ir::World, name: &str) -> PyResult<NeverId> {
    world.never_named(name).ok_or_else(|| {
        let known: Vec<(Target, &str)> = world.nevers.pairs().map(|(id, of)| (Target::Never(id), &*of.name)).collect();
        crate::error::refusal(&Default::default(), hypedc::ask::unknown(world, Kind::Never, name, &known))
    })
}
