//! Progress and cancellation of long work (by ctrl-C, a time budget, an editor). Stages that can take long accept a
//! [`Watch`]; the command line and the editor each have an implementation. Stages count work with a [`Meter`], which
//! polls the watch often enough whatever a unit of work costs.

use std::cell::Cell;
use std::sync::atomic::{AtomicU32, Ordering};

/// The progress of a search.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Progress {
    /// Nodes added so far, over all restarts.
    pub nodes: u64,
    /// The budget of nodes.
    pub budget: u64,
    /// Places covered so far.
    pub places: u64,
}

/// The receiver of progress, and the source of cancellation. Polled between units of work, by any thread.
pub trait Watch: Sync {
    /// Whether the work should stop and return its partial result.
    fn stop(&self) -> bool;

    /// Reports progress.
    fn progress(&self, _progress: Progress) {}

    /// Reports the place of a new node of a search that records its nodes: the space of the first player by its index,
    /// the player's position, px, and the position in the node before, if it is in the same space.
    fn node(&self, _space: usize, _at: [f32; 2], _before: Option<[f32; 2]>) {}
}

/// Never stops, and ignores progress.
#[derive(Debug, Clone, Copy, Default)]
pub struct Unwatched;

impl Watch for Unwatched {
    fn stop(&self) -> bool {
        false
    }
}

/// Stops work after a number of polls.
#[derive(Debug)]
pub struct PollLimit(AtomicU32);

impl PollLimit {
    /// Stops at poll number `times`.
    pub fn new(times: u32) -> Self {
        PollLimit(AtomicU32::new(times))
    }
}

impl Watch for PollLimit {
    fn stop(&self) -> bool {
        let less = |left: u32| left.checked_sub(1);
        self.0.fetch_update(Ordering::Relaxed, Ordering::Relaxed, less).is_err()
    }
}

/// Units of work between two polls; a unit costs about as much as the comparison of two boxes, some nanoseconds.
pub const WORK_PER_POLL: u64 = 1 << 18;

/// Counts work, and polls a watch after each [`WORK_PER_POLL`] units.
pub struct Meter<'w> {
    watch: &'w dyn Watch,
    /// Work since the last poll, and before it.
    since: Cell<u64>,
    before: Cell<u64>,
    is_stopped: Cell<bool>,
}

impl<'w> Meter<'w> {
    /// A meter that polls this watch.
    #[inline]
    pub fn new(watch: &'w dyn Watch) -> Self {
        Meter { watch, since: Cell::new(0), before: Cell::new(0), is_stopped: Cell::new(false) }
    }

    /// The watch that it polls.
    pub fn watch(&self) -> &'w dyn Watch {
        self.watch
    }

    /// Counts work that was or will be done; returns whether to stop.
    #[inline]
    pub fn spend(&self, work: u64) -> bool {
        let since = self.since.get().saturating_add(work);
        self.since.set(since);
        if since < WORK_PER_POLL {
            return self.is_stopped.get();
        }
        self.poll()
    }

    /// All work so far: the same on every machine.
    pub fn total(&self) -> u64 {
        self.before.get().saturating_add(self.since.get())
    }

    /// Polls at once; returns whether to stop.
    pub fn poll(&self) -> bool {
        self.before.set(self.total());
        self.since.set(0);
        // Once stopped, the watch is not polled again.
        if !self.is_stopped.get() && self.watch.stop() {
            self.is_stopped.set(true);
        }
        self.is_stopped.get()
    }

    /// Whether a poll told the work to stop.
    #[inline]
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

    /// Stops at the third poll.
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
        assert_eq!(spent, 3 * WORK_PER_POLL);
        assert_eq!(meter.total(), 3 * WORK_PER_POLL);
        assert!(meter.spend(0) && meter.poll(), "it stays stopped");
        assert_eq!(watch.0.load(Ordering::Relaxed), 3, "and nobody is asked any more");
    }
}
