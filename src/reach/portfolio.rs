//! A portfolio: several planners in turns, each of which is good at what others are not. The first answer counts.

use crate::watch::Watch;

use super::ground::Notes;
use super::searcher::{Ending, Searcher};

/// A turn of the first round, nodes; turns grow with what was spent, so that few are taken.
const TURN: u64 = 128;
/// A turn is at most this share of what its planner has grown.
const SHARE: u64 = 8;

/// Planners in turns.
pub(super) struct Portfolio<'a> {
    arms: Vec<Box<dyn Searcher + 'a>>,
    /// What planners that gave up had noted.
    spent: Notes,
    turn: usize,
    /// An arm that takes more memory than this gives up, bytes; the last one does not.
    memory: u64,
    planner: &'static str,
}

impl<'a> Portfolio<'a> {
    /// Planners, those that come first having the first turn.
    pub fn new(arms: Vec<Box<dyn Searcher + 'a>>, memory: u64) -> Self {
        let memory = memory / arms.len().max(1) as u64;
        Portfolio { arms, spent: Notes::default(), turn: 0, memory, planner: "auto" }
    }

    fn retire(&mut self, at: usize) {
        self.arms.remove(at).report(&mut self.spent);
    }
}

impl Searcher for Portfolio<'_> {
    fn advance(&mut self, nodes: u64, watch: &dyn Watch) -> Ending {
        let until = self.nodes().saturating_add(nodes);
        while self.nodes() < until {
            let count = self.arms.len();
            if count == 0 {
                return Ending::Spent;
            }
            let at = self.turn % count;
            let arm = &mut self.arms[at];
            let slice = (arm.nodes() / SHARE).max(TURN);
            let ending = arm.advance(slice, watch);
            self.planner = arm.planner();
            match ending {
                Ending::Paused => {
                    let is_large = arm.bytes() as u64 > self.memory;
                    if is_large && count > 1 {
                        self.retire(at);
                    } else {
                        self.turn = at + 1;
                    }
                }
                Ending::Spent => self.retire(at),
                Ending::Stopped | Ending::Reached(_) | Ending::Exhausted(..) => return ending,
            }
        }
        Ending::Paused
    }

    fn nodes(&self) -> u64 {
        self.spent.statistics.nodes + self.arms.iter().map(|arm| arm.nodes()).sum::<u64>()
    }

    fn report(&self, notes: &mut Notes) {
        notes.join(&self.spent);
        self.arms.iter().for_each(|arm| arm.report(notes));
    }

    fn bytes(&self) -> usize {
        self.arms.iter().map(|arm| arm.bytes()).sum()
    }

    fn planner(&self) -> &'static str {
        self.planner
    }
}
