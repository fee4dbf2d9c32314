//! A search that can be continued: what the planning loop, the exhaustion and the portfolio have in common.

use super::outcome::{Exhaustion, Plan};
use super::search_context::Notes;

/// How a part of a search ended.
#[derive(Debug)]
pub(super) enum Ending {
    /// It can go on.
    Paused,
    /// The watch stopped it.
    Stopped,
    /// It has found a way.
    Reached(Plan),
    /// There is nothing more to try: all states were visited that any inputs of the question lead to.
    Exhausted(Exhaustion),
    /// It has nothing more to try, but that proves nothing.
    Spent,
}

/// A search that can be continued.
pub(super) trait Searcher: Send {
    /// Grows by about `nodes` nodes.
    fn advance(&mut self, nodes: u64) -> Ending;

    /// A way that it has found but not yet answered with, as there might be a shorter one. Asked where a search ends.
    fn pending(&mut self) -> Option<Plan> {
        None
    }

    /// The nodes grown so far.
    fn nodes(&self) -> u64;

    /// How many places were covered so far, by whichever of its trees has covered the most.
    fn places(&self) -> u64;

    /// Adds what it has noted so far.
    fn report(&self, notes: &mut Notes);

    /// The memory that it takes, bytes.
    fn bytes(&self) -> usize;

    /// The name of the planner at work, or of the one that had the answer.
    fn planner(&self) -> &'static str;
}
