//! Watching long work: one trait for progress and for stopping, whoever asks (ctrl-C, a time budget, an editor).
//! Stages that can take long accept a [`Watch`]; the command line and the editor each bring their own.

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

/// Asked now and then between two units of work.
pub trait Watch {
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
