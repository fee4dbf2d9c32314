//! The interface of resumable searches: the planning loop, the exhaustive search and the portfolio.

use super::outcome::{Exhaustion, Plan};
use super::problem::Start;
use super::search_context::Notes;

/// How a part of a search ended.
#[derive(Debug)]
pub(super) enum Ending {
    /// It can continue.
    Paused,
    /// The watch stopped it.
    Stopped,
    /// It has found a path.
    Reached(Plan),
    /// Nothing is left to try: all states were visited that any inputs of the question lead to.
    Exhausted(Exhaustion),
    /// Nothing is left to try, but that proves nothing.
    Spent,
}

/// A resumable search.
pub(super) trait Searcher: Send {
    /// Grows by about `nodes` nodes.
    fn advance(&mut self, nodes: u64) -> Ending;

    /// A path that is not yet reported, as there might be a shorter one. Called when a search ends.
    fn pending(&mut self) -> Option<Plan> {
        None
    }

    /// Number of nodes so far.
    fn nodes(&self) -> u64;

    /// Its work so far, in units of a [`Meter`](crate::watch::Meter): what it cost, the same on every machine.
    fn work(&self) -> u64;

    /// Maximum number of places covered by one of its trees so far.
    fn places(&self) -> u64;

    /// The least distance of a node to the goal so far, in places; `None` if it does not count.
    fn nearest(&self) -> Option<u32> {
        None
    }

    /// The states on the way to the nearest node.
    fn way(&mut self) -> Vec<Start> {
        Vec::new()
    }

    /// Whether it goes on from the ways of other searches.
    fn follows(&self) -> bool {
        false
    }

    /// Goes on from states on the way of another search as well, which came to a distance.
    fn adopt(&mut self, _nearest: u32, _way: &[Start]) {}

    /// Whether it has a path already, and looks for a faster one.
    fn has_found(&self) -> bool {
        false
    }

    /// From now on, looks for paths of fewer steps than a number.
    fn look_for_faster(&mut self, _steps: u64) {}

    /// Adds its notes so far.
    fn report(&self, notes: &mut Notes);

    /// Memory use, bytes.
    fn bytes(&self) -> usize;

    /// The name of the active planner, or of the one that gave the answer.
    fn planner(&self) -> &'static str;
}
