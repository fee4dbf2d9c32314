//! Long work on a thread of its own, while the calling thread looks for signals and tells how far it is. The GIL is free
//! meanwhile, and a panic becomes an exception.

use std::any::Any;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::mpsc::{self, RecvTimeoutError};
use std::sync::{Mutex, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

use hypedc::watch::{Progress, Watch};
use pyo3::exceptions::PyKeyboardInterrupt;
use pyo3::prelude::*;

use crate::error::class::HypedError;

/// How often signals are looked for.
const POLL: Duration = Duration::from_millis(50);
/// The stack of the thread: parsing is recursive, and a thread of Python may have little.
const STACK: usize = 64 << 20;

/// What work looks at and tells.
#[derive(Debug, Default)]
pub(crate) struct Flag {
    stop: AtomicBool,
    until: Mutex<Option<Instant>>,
    nodes: AtomicU64,
    budget: AtomicU64,
    places: AtomicU64,
}

impl Flag {
    /// Limits the work that begins now; no limit if none.
    pub fn limit(&self, seconds: Option<f64>) {
        let limit = seconds.and_then(|seconds| Duration::try_from_secs_f64(seconds.max(0.0)).ok());
        let until = limit.and_then(|limit| Instant::now().checked_add(limit));
        *self.until.lock().unwrap_or_else(PoisonError::into_inner) = until;
    }

    /// Whether a signal or an exception stopped it.
    pub fn is_interrupted(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }
}

impl Watch for Flag {
    fn stop(&self) -> bool {
        let until = *self.until.lock().unwrap_or_else(PoisonError::into_inner);
        self.is_interrupted() || until.is_some_and(|until| Instant::now() >= until)
    }

    fn progress(&self, progress: Progress) {
        self.nodes.store(progress.nodes, Ordering::Relaxed);
        self.budget.store(progress.budget, Ordering::Relaxed);
        self.places.store(progress.places, Ordering::Relaxed);
    }
}

/// Runs work; calls `progress(nodes, budget, places)` from time to time. `KeyboardInterrupt` stops the work, which then
/// returns what it has.
///
/// # Errors
/// An exception of `progress` or of a signal handler; a panic.
pub(crate) fn watched<T: Send>(
    py: Python<'_>,
    progress: Option<&Py<PyAny>>,
    work: impl FnOnce(&Flag) -> T + Send,
) -> PyResult<T> {
    let flag = Flag::default();
    let done = py.detach(|| on_a_thread(&flag, progress, work));
    done?
}

fn on_a_thread<T: Send>(
    flag: &Flag,
    progress: Option<&Py<PyAny>>,
    work: impl FnOnce(&Flag) -> T + Send,
) -> PyResult<PyResult<T>> {
    thread::scope(|scope| {
        let (sender, done) = mpsc::channel::<()>();
        let thread = thread::Builder::new().stack_size(STACK).spawn_scoped(scope, move || {
            let _sender = sender;
            work(flag)
        });
        let thread = thread.map_err(|error| HypedError::new_err(format!("no thread can be started: {error}")))?;
        let mut raised = None;
        while done.recv_timeout(POLL) == Err(RecvTimeoutError::Timeout) {
            if raised.is_none() {
                raised = Python::attach(|py| look(py, flag, progress)).err();
            }
        }
        let result = thread.join().map_err(|panic| HypedError::new_err(words(&*panic)))?;
        Ok(raised.map_or(Ok(result), Err))
    })
}

/// Looks for signals, and tells how far the work is.
fn look(py: Python<'_>, flag: &Flag, progress: Option<&Py<PyAny>>) -> PyResult<()> {
    let load = |number: &AtomicU64| number.load(Ordering::Relaxed);
    let told = py.check_signals().and_then(|()| match progress {
        Some(tell) => tell.call1(py, (load(&flag.nodes), load(&flag.budget), load(&flag.places))).map(|_| ()),
        None => Ok(()),
    });
    match told {
        Ok(()) => Ok(()),
        Err(error) => {
            flag.stop.store(true, Ordering::Relaxed);
            if error.is_instance_of::<PyKeyboardInterrupt>(py) { Ok(()) } else { Err(error) }
        }
    }
}

fn words(panic: &(dyn Any + Send)) -> String {
    let message = panic.downcast_ref::<&str>().map(|text| (*text).to_string());
    let message = message.or_else(|| panic.downcast_ref::<String>().cloned()).unwrap_or_default();
    format!("a mistake in hypedc: {message}; please report it with the program that causes it")
}
