//! A portfolio: alternates several planners with different strengths. The first answer counts. Their shares are shares
//! of work, which a meter counts, so that they are the same on every machine: a node of one planner costs many times that
//! of another.

use super::outcome::Plan;
use super::search_context::Notes;
use super::searcher::{Ending, Searcher};

/// Number of nodes per share in the first turn; turns grow with the nodes spent, to limit their number.
const TURN: u64 = 64;
/// Divisor: the maximum length of a turn as a share of the planner's nodes so far.
const SHARE: u64 = 8;
/// As many places must one be nearer to the goal for others to go on from its way.
const AHEAD: u32 = 3;
/// The work that a node counts for besides what it took: it needs memory, and the budget is one of nodes.
const NODE: u64 = 2_048;

/// A planner with its share of the work.
type Arm<'a> = (u64, Box<dyn Searcher + 'a>);

/// Alternates planners.
pub(super) struct Portfolio<'a> {
    arms: Vec<Arm<'a>>,
    /// The notes of planners that gave up, and their work.
    spent: Notes,
    spent_work: u64,
    /// The current planner, and the number of its nodes at which its turn ends.
    turn: Option<(usize, u64)>,
    /// Memory limit of an arm, bytes; the last one has no limit.
    memory: u64,
    planner: &'static str,
}

impl<'a> Portfolio<'a> {
    /// Alternates planners; the first has the first turn.
    pub fn new(arms: Vec<Arm<'a>>, memory: u64) -> Self {
        let memory = memory / arms.len().max(1) as u64;
        Portfolio { arms, spent: Notes::default(), spent_work: 0, turn: None, memory, planner: "auto" }
    }

    fn retire(&mut self, at: usize) {
        self.turn = None;
        let (_, arm) = self.arms.remove(at);
        self.spent_work += arm.work();
        arm.report(&mut self.spent);
    }

    /// Lets all go on from the way of the one that came nearest to the goal, where it is ahead.
    fn exchange(&mut self) {
        let distances = self.arms.iter().enumerate().filter_map(|(at, (_, arm))| Some((arm.nearest()?, at)));
        let Some((nearest, first)) = distances.min() else { return };
        let is_behind = |arm: &dyn Searcher| arm.nearest().is_some_and(|other| other >= nearest.saturating_add(AHEAD));
        if !self.arms.iter().any(|(_, arm)| is_behind(&**arm)) {
            return;
        }
        let way = self.arms[first].1.way();
        for (_, arm) in self.arms.iter_mut().filter(|(_, arm)| is_behind(&**arm)) {
            arm.adopt(nearest, &way);
        }
    }

    /// The planner that is furthest behind its share.
    fn next(&self) -> Option<usize> {
        (0..self.arms.len()).min_by_key(|at| {
            let (share, arm) = &self.arms[*at];
            arm.work().saturating_add(arm.nodes().saturating_mul(NODE)) / share.max(&1)
        })
    }
}

impl Searcher for Portfolio<'_> {
    fn advance(&mut self, nodes: u64) -> Ending {
        let until = self.nodes().saturating_add(nodes);
        loop {
            let left = until.saturating_sub(self.nodes());
            if left == 0 {
                return Ending::Paused;
            }
            let (at, turn_ends) = match self.turn {
                Some(turn) => turn,
                None => {
                    self.exchange();
                    let Some(at) = self.next() else { return Ending::Spent };
                    let (share, arm) = &self.arms[at];
                    (at, arm.nodes() + (arm.nodes() / SHARE).max(TURN * share))
                }
            };
            let is_last = self.arms.len() == 1;
            let (_, arm) = &mut self.arms[at];
            let ending = arm.advance(turn_ends.saturating_sub(arm.nodes()).min(left));
            self.turn = (arm.nodes() < turn_ends).then_some((at, turn_ends));
            self.planner = arm.planner();
            match ending {
                Ending::Paused if !is_last && arm.bytes() as u64 > self.memory => match arm.pending() {
                    Some(plan) => return Ending::Reached(plan),
                    None => self.retire(at),
                },
                Ending::Paused => {}
                Ending::Spent => self.retire(at),
                Ending::Stopped | Ending::Reached(_) | Ending::Exhausted(_) => return ending,
            }
        }
    }

    fn pending(&mut self) -> Option<Plan> {
        let Portfolio { arms, planner, .. } = self;
        arms.iter_mut().find_map(|(_, arm)| {
            let plan = arm.pending()?;
            *planner = arm.planner();
            Some(plan)
        })
    }

    fn nodes(&self) -> u64 {
        self.spent.statistics.nodes + self.arms.iter().map(|(_, arm)| arm.nodes()).sum::<u64>()
    }

    fn work(&self) -> u64 {
        self.spent_work + self.arms.iter().map(|(_, arm)| arm.work()).sum::<u64>()
    }

    fn places(&self) -> u64 {
        self.arms.iter().map(|(_, arm)| arm.places()).max().unwrap_or(0)
    }

    fn report(&self, notes: &mut Notes) {
        notes.join(&self.spent);
        self.arms.iter().for_each(|(_, arm)| arm.report(notes));
    }

    fn bytes(&self) -> usize {
        self.arms.iter().map(|(_, arm)| arm.bytes()).sum()
    }

    fn planner(&self) -> &'static str {
        self.planner
    }
}

/// Runs searches in sequence, each of which can prove more than the one before.
pub(super) struct Refinement<'a> {
    /// The last one is active.
    stages: Vec<Box<dyn Searcher + 'a>>,
    done: Notes,
    done_work: u64,
}

impl<'a> Refinement<'a> {
    /// Runs at least one search, the coarsest first.
    pub fn new(mut stages: Vec<Box<dyn Searcher + 'a>>) -> Self {
        stages.reverse();
        Refinement { stages, done: Notes::default(), done_work: 0 }
    }
}

impl Searcher for Refinement<'_> {
    fn advance(&mut self, nodes: u64) -> Ending {
        let Some(stage) = self.stages.last_mut() else { return Ending::Spent };
        let ending = stage.advance(nodes);
        let is_last = self.stages.len() == 1;
        match ending {
            // The next one is finer.
            Ending::Spent if !is_last => {
                if let Some(stage) = self.stages.pop() {
                    self.done_work += stage.work();
                    stage.report(&mut self.done);
                }
                Ending::Paused
            }
            ending => ending,
        }
    }

    fn pending(&mut self) -> Option<Plan> {
        self.stages.last_mut()?.pending()
    }

    fn nodes(&self) -> u64 {
        self.done.statistics.nodes + self.stages.last().map_or(0, |stage| stage.nodes())
    }

    fn work(&self) -> u64 {
        self.done_work + self.stages.last().map_or(0, |stage| stage.work())
    }

    fn places(&self) -> u64 {
        self.stages.last().map_or(0, |stage| stage.places())
    }

    fn report(&self, notes: &mut Notes) {
        notes.join(&self.done);
        if let Some(stage) = self.stages.last() {
            stage.report(notes);
        }
    }

    fn bytes(&self) -> usize {
        self.stages.last().map_or(0, |stage| stage.bytes())
    }

    fn planner(&self) -> &'static str {
        self.stages.last().map_or("auto", |stage| stage.planner())
    }
}
