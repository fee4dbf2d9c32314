//! Watching long work: one trait for progress and for stopping (by ctrl-C, a time budget, an editor).
//! Stages that can take long accept a [`Watch`]; the command line and the editor each bring their own. They count what they
//! do with a [`Meter`], which asks the watch often enough whatever a unit of work costs.

use std::cell::Cell;
use std::sync::atomic::{AtomicU32, Ordering};

/// How far a search has come.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Progress {
    /// Nodes added so far, over all restarts.
    pub nodes: u64,
    /// The most nodes the budget allows.
    pub budget: u64,
    /// Places covered so far.
    pub places: u64,
}

/// Asked now and then between two units of work, by any thread.
pub trait Watch: Sync {
    /// Whether the work should end and report what it has.
    fn stop(&self) -> bool;

    /// Told how far the work has come.
    fn progress(&self, _progress: Progress) {}
}

/// Never stops and shows nothing.
#[derive(Debug, Clone, Copy, Default)]
pub struct Unwatched;

impl Watch for Unwatched {
    fn stop(&self) -> bool {
        false
    }
}

/// Stops work that takes long: after it has been asked a number of times.
#[derive(Debug)]
pub struct Patience(AtomicU32);

impl Patience {
    /// Stops after it has been asked `times` times.
    pub fn new(times: u32) -> Self {
        Patience(AtomicU32::new(times))
    }
}

impl Watch for Patience {
    fn stop(&self) -> bool {
        let less = |left: u32| left.checked_sub(1);
        self.0.fetch_update(Ordering::Relaxed, Ordering::Relaxed, less).is_err()
    }
}

/// After so much work a watch is asked; a unit is about as much as comparing two boxes, some nanoseconds.
pub const WORK: u64 = 1 << 18;

/// Counts work, and asks a watch each time that [`WORK`] of it is done.
pub struct Meter<'w> {
    watch: &'w dyn Watch,
    /// Work since the watch was asked.
    since: Cell<u64>,
    is_stopped: Cell<bool>,
}

impl<'w> Meter<'w> {
    /// Asks this watch.
    pub fn new(watch: &'w dyn Watch) -> Self {
        Meter { watch, since: Cell::new(0), is_stopped: Cell::new(false) }
    }

    /// Counts work that was done or is about to be; returns whether all should end.
    pub fn spend(&self, work: u64) -> bool {
        let since = self.since.get().saturating_add(work);
        if since < WORK {
            self.since.set(since);
            return self.is_stopped.get();
        }
        self.ask()
    }

    /// Asks at once; returns whether all should end.
    pub fn ask(&self) -> bool {
        self.since.set(0);
        // Once stopped, the watch need not be asked again.
        if !self.is_stopped.get() && self.watch.stop() {
            self.is_stopped.set(true);
        }
        self.is_stopped.get()
    }

    /// Whether the watch has said that all should end.
    pub fn is_stopped(&self) -> bool {
        self.is_stopped.get()
    }
}

impl std::fmt::Debug for Meter<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Meter").field("since", &self.since).field("is_stopped", &self.is_stopped).finish()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Stops when it is asked for the third time.
    struct Third(AtomicU32);

    impl Watch for Third {
        fn stop(&self) -> bool {
            self.0.fetch_add(1, Ordering::Relaxed) == 2
        }
    }

    #[test]
    fn a_watch_is_asked_by_work_done() {
        let watch = Third(AtomicU32::new(0));
        let meter = Meter::new(&watch);
        let spent = (1..).find(|_| meter.spend(1)).unwrap_or(0);
        assert_eq!(spent, 3 * WORK);
        assert!(meter.spend(0) && meter.ask(), "it stays stopped");
        assert_eq!(watch.0.load(Ordering::Relaxed), 3, "and nobody is asked any more");
    }
}
