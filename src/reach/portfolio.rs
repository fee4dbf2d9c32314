//! A portfolio: alternates several planners with different strengths. Work is counted by a meter, so that it is the
//! same on every machine: a node of one planner costs many times that of another. The next turn is that of the planner
//! which, at its pace so far, would come to the goal with the least work for its share. Who gets stuck falls back by
//! itself, and who gets on has nearly all of the work, as in Gagliolo and Schmidhuber, *Learning Dynamic Algorithm
//! Portfolios*, 2006, who share time by what is expected of each algorithm as it runs. The first answer counts, or the
//! fastest path that is found with as much work again: what is found first is often a detour.

use super::outcome::Plan;
use super::problem::Start;
use super::search_context::Notes;
use super::searcher::{Ending, Searcher};

/// Number of nodes per share in the first turn, and the maximum number of shares there; turns grow with the nodes
/// spent, to limit their number.
const TURN: u64 = 32;
const SHARES: u64 = 8;
/// Number of nodes of the very first turn: much is found at once by the first planner.
const FIRST: u64 = 128;
/// Divisor: the maximum length of a turn as a share of the planner's nodes so far.
const SHARE: u64 = 8;
/// As many places must one be nearer to the goal for others to go on from its way. Everybody is taken to have come so
/// many places nearer than it has: the first ones say little about a pace.
const AHEAD: u32 = 3;
/// After so many nodes, a search takes long.
const LATE: u64 = 32_000;
/// The work that a node counts for besides what it took: it needs memory, and the budget is one of nodes.
const NODE: u64 = 2_048;

/// For a faster path, the search goes on for as much work as the first one took, and for some nodes at least: for so many
/// times those of the first one, and as many more, but not for more than a number of nodes; for so many times as long while
/// the fastest one takes more than so many times the lower bound of its time; and no longer once it takes at most so many
/// halves of it.
const FEWEST: [u64; 3] = [16, 1_000, 8_000];
const SLOW: [u64; 2] = [3, 2];
const FAST: u64 = 3;

/// A planner with its shares of the work: until a path is found, at first and when that takes long, and for a faster one.
pub(super) struct Arm<'a> {
    share: u64,
    share_when_late: u64,
    share_for_faster: u64,
    searcher: Box<dyn Searcher + 'a>,
    /// The cost at which it began anew, to look for a faster path, and that of the way of another one from which it goes on.
    base: u64,
    adopted: u64,
    /// Its least distance to the goal, places, and the cost when it came there.
    nearest: (u32, u64),
}

impl<'a> Arm<'a> {
    /// A planner with a share until a path is found, and none then.
    pub fn new(share: u64, searcher: Box<dyn Searcher + 'a>) -> Self {
        let nearest = (u32::MAX, 0);
        Arm { share, share_when_late: share, share_for_faster: 0, searcher, base: 0, adopted: 0, nearest }
    }

    /// The same, with another share once the search has gone on for [`LATE`] nodes.
    pub fn late(self, share_when_late: u64) -> Self {
        Arm { share_when_late, ..self }
    }

    /// The same, with a share in the search for a faster path.
    pub fn for_faster(self, share_for_faster: u64) -> Self {
        Arm { share_for_faster, ..self }
    }

    /// Its work, and that for which its nodes count.
    fn spent(&self) -> u64 {
        self.searcher.work().saturating_add(self.searcher.nodes().saturating_mul(NODE))
    }

    /// What it took to come where it is, with what it took another one whose way it has adopted.
    fn cost(&self) -> u64 {
        (self.spent() - self.base).saturating_add(self.adopted)
    }

    /// Grows by about `nodes` nodes, and notes whether it has come nearer to the goal.
    fn advance(&mut self, nodes: u64) -> Ending {
        let ending = self.searcher.advance(nodes);
        if let Some(nearest) = self.searcher.nearest().filter(|nearest| *nearest < self.nearest.0) {
            self.nearest = (nearest, self.cost());
        }
        ending
    }

    /// Goes on from the way of another one as well, which came to a distance at a cost.
    fn adopt(&mut self, (nearest, cost): (u32, u64), way: &[Start]) {
        self.searcher.adopt(nearest, way);
        self.adopted = self.adopted.max(cost);
    }

    /// From now on, looks for paths of fewer steps than a number.
    fn look_for_faster(&mut self, steps: u64) {
        self.searcher.look_for_faster(steps);
        if self.searcher.nearest() == Some(u32::MAX) {
            (self.base, self.adopted, self.nearest) = (self.spent(), 0, (u32::MAX, 0));
        }
    }

    /// The cost at which it would come to the goal at its pace so far, from a distance `start`; who comes to no distance is
    /// as near as `nearest`.
    fn expected(&self, start: u32, nearest: u32) -> u128 {
        let left = self.searcher.nearest().unwrap_or(nearest).min(start);
        let [whole, done] = [start, start - left].map(|places| u128::from(places.saturating_add(AHEAD)));
        u128::from(self.cost()) * whole / done
    }
}

/// Whether a distance is so much nearer than another that others go on from there.
fn is_ahead(nearest: u32, other: u32) -> bool {
    other >= nearest.saturating_add(AHEAD)
}

/// The fastest path so far.
struct Fastest {
    plan: Plan,
    planner: &'static str,
    /// The nodes and the work until the first one, and how many more of both follow at least.
    first: [u64; 2],
    more: [u64; 2],
}

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
    fastest: Option<Fastest>,
    /// A lower bound of the steps of a path, and the distance of the start, places; 0 if none is known.
    least: u64,
    start: u32,
    /// Makes the first path faster, with little work.
    hasten: Box<dyn Fn(&Plan) -> Plan + Send + 'a>,
}

impl<'a> Portfolio<'a> {
    /// Alternates planners; the first has the first turn. No path takes fewer than `least` steps, as far as is known, and the
    /// goal is so many places from the `start`.
    pub fn new(
        arms: Vec<Arm<'a>>,
        memory: u64,
        (least, start): (u64, u32),
        hasten: impl Fn(&Plan) -> Plan + Send + 'a,
    ) -> Self {
        let memory = memory / arms.len().max(1) as u64;
        let (spent, planner, hasten) = (Notes::default(), "auto", Box::new(hasten));
        Portfolio { arms, spent, spent_work: 0, turn: None, memory, planner, fastest: None, least, start, hasten }
    }

    fn retire(&mut self, at: usize) {
        self.turn = None;
        let Arm { searcher, .. } = self.arms.remove(at);
        self.spent_work += searcher.work();
        searcher.report(&mut self.spent);
    }

    /// Takes a path; returns it if no planner is to look for a faster one.
    fn take(&mut self, mut plan: Plan) -> Option<Plan> {
        if plan.is_shortest || self.arms.iter().all(|arm| arm.share_for_faster == 0) {
            self.fastest = None;
            return Some(plan);
        }
        let (first, more) = match &self.fastest {
            Some(fastest) => (fastest.first, fastest.more),
            None => {
                let first = [self.nodes(), self.work()];
                while let Some(at) = self.arms.iter().position(|arm| arm.share_for_faster == 0) {
                    self.retire(at);
                }
                if !self.is_fast(&plan) {
                    plan = (self.hasten)(&plan);
                }
                let [times, more, most] = FEWEST;
                (first, [(times * first[0] + more).min(most), first[1]])
            }
        };
        self.turn = None;
        let steps = plan.steps - plan.after;
        self.fastest = Some(Fastest { plan, planner: self.planner, first, more });
        self.arms.iter_mut().for_each(|arm| arm.look_for_faster(steps));
        None
    }

    /// Whether no faster path is to be looked for, as far as the lower bound tells.
    fn is_fast(&self, plan: &Plan) -> bool {
        self.least > 0 && 2 * (plan.steps - plan.after) <= FAST * self.least
    }

    /// Whether there is a path, and enough was done for a faster one.
    fn is_fast_enough(&self) -> bool {
        self.fastest.as_ref().is_some_and(|fastest| {
            if self.is_fast(&fastest.plan) {
                return true;
            }
            let [longer, slow] = SLOW;
            let steps = fastest.plan.steps - fastest.plan.after;
            let is_slow = self.least > 0 && steps > slow * self.least;
            let times = if is_slow { longer } else { 1 };
            let until = [0, 1].map(|of| fastest.first[of] + times * fastest.more[of]);
            until[0] <= self.nodes() && until[1] <= self.work() || self.arms.is_empty()
        })
    }

    /// Lets all go on from the way of the one that came nearest to the goal, where it is ahead.
    fn exchange(&mut self) {
        let distances = self.arms.iter().enumerate().filter_map(|(at, arm)| Some((arm.searcher.nearest()?, at)));
        let Some((nearest, first)) = distances.min() else { return };
        let is_behind = |arm: &Arm<'_>| {
            let other = arm.searcher.nearest().filter(|_| arm.searcher.follows());
            other.is_some_and(|other| is_ahead(nearest, other))
        };
        if !self.arms.iter().any(is_behind) {
            return;
        }
        let (way, cost) = (self.arms[first].searcher.way(), self.arms[first].nearest.1);
        for arm in self.arms.iter_mut().filter(|arm| is_behind(arm)) {
            arm.adopt((nearest, cost), &way);
        }
    }

    /// Whether the search takes long.
    fn is_late(&self) -> bool {
        self.nodes() >= LATE
    }

    /// The share of a planner.
    fn share(&self, arm: &Arm<'_>) -> u64 {
        match self.fastest {
            Some(_) => arm.share_for_faster,
            None if self.is_late() => arm.share_when_late,
            None => arm.share,
        }
    }

    /// The planner that would come to the goal with the least work for its share.
    fn next(&self) -> Option<usize> {
        let nearest = self.arms.iter().filter_map(|arm| arm.searcher.nearest()).min().unwrap_or(0);
        (0..self.arms.len()).min_by_key(|at| {
            let arm = &self.arms[*at];
            // With a few digits more than whole ones.
            (arm.expected(self.start, nearest) << 8) / u128::from(self.share(arm).max(1))
        })
    }
}

impl Searcher for Portfolio<'_> {
    fn advance(&mut self, nodes: u64) -> Ending {
        let until = self.nodes().saturating_add(nodes);
        loop {
            if self.is_fast_enough()
                && let Some(plan) = self.pending()
            {
                return Ending::Reached(plan);
            }
            let left = until.saturating_sub(self.nodes());
            if left == 0 {
                return Ending::Paused;
            }
            let (at, turn_ends) = match self.turn {
                Some(turn) => turn,
                None => {
                    if self.fastest.is_none() {
                        self.exchange();
                    }
                    let Some(at) = self.next() else { return Ending::Spent };
                    let (share, nodes) = (self.share(&self.arms[at]), self.arms[at].searcher.nodes());
                    let at_first = if self.nodes() == 0 { FIRST } else { 0 };
                    (at, nodes + (nodes / SHARE).max(TURN * share.min(SHARES)).max(at_first))
                }
            };
            let is_last = self.arms.len() == 1;
            let arm = &mut self.arms[at];
            let ending = arm.advance(turn_ends.saturating_sub(arm.searcher.nodes()).min(left));
            let arm = &mut arm.searcher;
            self.turn = (arm.nodes() < turn_ends).then_some((at, turn_ends));
            self.planner = arm.planner();
            match ending {
                Ending::Paused if !is_last && arm.bytes() as u64 > self.memory => match arm.pending() {
                    Some(plan) => return Ending::Reached(plan),
                    None => self.retire(at),
                },
                Ending::Paused => {}
                Ending::Spent => self.retire(at),
                Ending::Reached(plan) => {
                    if let Some(plan) = self.take(plan) {
                        return Ending::Reached(plan);
                    }
                }
                Ending::Stopped | Ending::Exhausted(_) => return ending,
            }
        }
    }

    fn pending(&mut self) -> Option<Plan> {
        let Portfolio { arms, planner, fastest, .. } = self;
        if let Some(fastest) = fastest.take() {
            *planner = fastest.planner;
            return Some(fastest.plan);
        }
        arms.iter_mut().find_map(|arm| {
            let plan = arm.searcher.pending()?;
            *planner = arm.searcher.planner();
            Some(plan)
        })
    }

    fn has_found(&self) -> bool {
        self.fastest.is_some()
    }

    fn nodes(&self) -> u64 {
        self.spent.statistics.nodes + self.arms.iter().map(|arm| arm.searcher.nodes()).sum::<u64>()
    }

    fn work(&self) -> u64 {
        self.spent_work + self.arms.iter().map(|arm| arm.searcher.work()).sum::<u64>()
    }

    fn places(&self) -> u64 {
        self.arms.iter().map(|arm| arm.searcher.places()).max().unwrap_or(0)
    }

    fn nearest(&self) -> Option<u32> {
        self.arms.iter().filter_map(|arm| arm.searcher.nearest()).min()
    }

    fn report(&self, notes: &mut Notes) {
        notes.join(&self.spent);
        self.arms.iter().for_each(|arm| arm.searcher.report(notes));
    }

    fn bytes(&self) -> usize {
        self.arms.iter().map(|arm| arm.searcher.bytes()).sum()
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
