//! Runs the searchers of a search side by side, in rounds, until there is an answer or the budget is spent, and builds the
//! outcome. While nothing is found it can pause for other questions, which decide whether it goes on.

use std::sync::Mutex;
use std::thread;

use crate::parallel;
use crate::sim::Fault;
use crate::watch::{Progress, Watch};

use super::outcome::{Argument, End, Outcome, Verdict};
use super::search::{Limits, Settings};
use super::search_context::Notes;
use super::searcher::{Ending, Searcher};

/// Number of nodes between two checks of the limits.
const ROUND: u64 = 512;

/// What is asked in a search that has not found anything yet: whether it can end there.
pub(super) struct Interlude<'i> {
    /// In order.
    pub pauses: &'i [Pause],
    /// The question.
    pub ends: &'i mut dyn FnMut(Pause, &mut GoOn<'_>) -> bool,
}

/// Goes on with a search for a while; returns its number of nodes, more than there can be once it has ended without an
/// answer, or `None` if it has one, or was stopped.
pub(super) type GoOn<'g> = dyn FnMut() -> Option<u64> + 'g;

/// When a search pauses.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Pause {
    /// At least after so many nodes.
    pub nodes: u64,
    /// After so many times the nodes that it took to come as near to the goal as it is.
    pub times: u64,
}

impl Pause {
    /// Whether a search pauses after some nodes, of which so many took it nearest to the goal.
    fn is_due(self, nodes: u64, nearest: u64) -> bool {
        self.nodes <= nodes && self.times.saturating_mul(nearest) <= nodes
    }

    /// The number of nodes until then, at least.
    fn left(self, nodes: u64) -> Option<u64> {
        self.nodes.checked_sub(nodes).filter(|left| *left > 0)
    }
}

/// Parallel searchers.
pub(super) struct ParallelSearch<'f, 'a> {
    pub trees: Vec<Box<dyn Searcher + 'a>>,
    pub settings: &'f Settings,
    pub limits: &'f Limits,
    pub watch: &'f dyn Watch,
    /// The first run-time error before the start of any tree, with its step.
    pub fault: Option<(Fault, u64)>,
    /// Whether the run of a start was over before the search, but would not have been with other draws.
    pub is_by_luck: bool,
    /// Whether axis values between -1, 0 and 1 matter.
    pub reads_between: bool,
    /// How near it has come to the goal, in places, and with how many nodes.
    pub nearest: (u32, u64),
}

/// How a search ended, and in which tree; `None` without an answer.
type Ended = (Option<Verdict>, End, usize);

impl ParallelSearch<'_, '_> {
    /// Grows all trees in rounds.
    pub fn grow(mut self, mut interlude: Option<Interlude<'_>>) -> Outcome {
        if self.watch.stop() {
            return self.outcome(Verdict::NotFound, End::Stopped, 0);
        }
        let (verdict, end, tree) = loop {
            let pause = interlude.as_ref().and_then(|interlude| interlude.pauses.first().copied());
            // What was found needs no proof that there is nothing.
            let pause = pause.filter(|_| !self.has_found());
            if let (Some(interlude), Some(pause)) = (&mut interlude, pause.filter(|pause| self.is_due(*pause))) {
                interlude.pauses = &interlude.pauses[1..];
                let mut ended = None;
                let mut go_on = || {
                    // Once it comes nearer to the goal, it needs no other answer until it is stuck again.
                    while ended.is_none() && !self.has_found() {
                        ended = self.advance(None);
                        if ended.is_none() && !self.has_found() && self.is_due(pause) {
                            return Some(self.nodes());
                        }
                    }
                    let is_unanswered = matches!(ended, Some((None, End::Nodes | End::Memory | End::Answered, _)));
                    is_unanswered.then_some(u64::MAX)
                };
                if (interlude.ends)(pause, &mut go_on) {
                    break (None, End::Stopped, 0);
                }
                if let Some(ended) = ended {
                    break ended;
                }
            } else if let Some(ended) = self.advance(pause) {
                break ended;
            }
        };
        match verdict {
            Some(verdict) => self.outcome(verdict, end, tree),
            None => self.unanswered(end, tree),
        }
    }

    fn nodes(&self) -> u64 {
        self.trees.iter().map(|tree| tree.nodes()).sum()
    }

    fn has_found(&self) -> bool {
        self.trees.iter().any(|tree| tree.has_found())
    }

    fn is_due(&self, pause: Pause) -> bool {
        pause.is_due(self.nodes(), self.nearest.1)
    }

    /// Grows all trees equally, until a pause at most; the first tree in order with an answer wins, so the result does not
    /// depend on timing. Returns how the search ends, if it does.
    fn advance(&mut self, pause: Option<Pause>) -> Option<Ended> {
        let nodes = self.nodes();
        let left = self.limits.nodes.saturating_sub(nodes);
        if left == 0 {
            return Some((None, End::Nodes, 0));
        }
        let bytes: usize = self.trees.iter().map(|t| t.bytes()).sum();
        if bytes as u64 > self.limits.memory {
            return Some((None, End::Memory, 0));
        }
        let places = self.trees.iter().map(|t| t.places()).max().unwrap_or(0);
        self.watch.progress(Progress { nodes, budget: self.limits.nodes, places });
        let left = pause.and_then(|pause| pause.left(nodes)).map_or(left, |pause| left.min(pause));
        let share = (left / self.trees.len() as u64).clamp(1, ROUND);
        let endings = self.round(share);
        let is_spent = endings.iter().all(|e| matches!(e, Ending::Spent));
        for (tree, ending) in endings.into_iter().enumerate() {
            match ending {
                Ending::Reached(plan) => return Some((Some(Verdict::Reached(plan)), End::Answered, tree)),
                Ending::Exhausted(found) => {
                    let verdict = match self.reads_between {
                        true => Verdict::Exhausted(found),
                        false => Verdict::Unreachable(Argument::Exhaustion(found)),
                    };
                    // A start that ended in a run-time error, or by bad luck, might have led further.
                    let is_open = self.fault.is_some() || self.is_by_luck;
                    return Some((Some(if is_open { Verdict::NotFound } else { verdict }), End::Answered, tree));
                }
                Ending::Stopped => return Some((None, End::Stopped, tree)),
                Ending::Paused | Ending::Spent => {}
            }
        }
        let near = self.trees.iter().filter_map(|tree| tree.nearest()).min();
        if let Some(near) = near.filter(|near| *near < self.nearest.0) {
            self.nearest = (near, self.nodes());
        }
        if is_spent {
            return Some((None, End::Answered, 0));
        }
        self.watch.stop().then_some((None, End::Stopped, 0))
    }

    /// Grows each tree by `nodes` nodes, on as many threads as the settings and the system allow.
    fn round(&mut self, nodes: u64) -> Vec<Ending> {
        let threads = self.settings.threads.clamp(1, self.trees.len());
        if threads == 1 {
            return self.trees.iter_mut().map(|tree| tree.advance(nodes)).collect();
        }
        // More threads than cores do not help.
        let threads = threads.min(parallel::threads(None).max(2));
        let mut endings: Vec<Option<Ending>> = self.trees.iter().map(|_| None).collect();
        let tasks = Mutex::new(self.trees.iter_mut().zip(&mut endings));
        let grow = || {
            // A poisoned lock ends the loop; the scope re-raises the panic.
            let next = || tasks.lock().map_or(None, |mut tasks| tasks.next());
            while let Some((tree, ending)) = next() {
                *ending = Some(tree.advance(nodes));
            }
        };
        thread::scope(|scope| {
            for _ in 1..threads {
                // If the system refuses a thread, the existing ones do all the work.
                if thread::Builder::new().spawn_scoped(scope, grow).is_err() {
                    break;
                }
            }
            grow();
        });
        endings.into_iter().map(|ending| ending.unwrap_or(Ending::Stopped)).collect()
    }

    /// The outcome of a search without an answer, unless a pending path is one.
    fn unanswered(mut self, end: End, tree: usize) -> Outcome {
        let pending = self.trees.iter_mut().enumerate().find_map(|(tree, t)| Some((tree, t.pending()?)));
        match pending {
            Some((tree, plan)) => self.outcome(Verdict::Reached(plan), End::Answered, tree),
            None => self.outcome(Verdict::NotFound, end, tree),
        }
    }

    fn outcome(self, verdict: Verdict, end: End, tree: usize) -> Outcome {
        let mut notes = Notes::default();
        self.trees.iter().for_each(|tree| tree.report(&mut notes));
        let planner = match end {
            End::Answered => self.trees[tree].planner(),
            _ => self.settings.planner.name(),
        };
        Outcome {
            verdict,
            end,
            planner,
            statistics: notes.statistics,
            covered: notes.coverage.covered(),
            exhausted: notes.exhausted,
            unfinished: None,
            cuts: notes.cuts,
            violations: notes.violations,
            record: notes.record,
            truncated: notes.is_truncated,
            has_open_draws: notes.has_open_draws,
            fault: self.fault.or(notes.fault),
            reads_between: self.reads_between,
            refuted: None,
            is_withdrawn: false,
            nearest: notes.nearest,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::watch::Unwatched;

    /// A searcher that has nothing left to try after some nodes.
    struct Limited {
        nodes: u64,
        most: u64,
    }

    impl Searcher for Limited {
        fn advance(&mut self, nodes: u64) -> Ending {
            self.nodes += nodes;
            if self.nodes < self.most { Ending::Paused } else { Ending::Spent }
        }

        fn nodes(&self) -> u64 {
            self.nodes
        }

        fn work(&self) -> u64 {
            self.nodes
        }

        fn places(&self) -> u64 {
            0
        }

        fn report(&self, _notes: &mut Notes) {}

        fn bytes(&self) -> usize {
            0
        }

        fn planner(&self) -> &'static str {
            "limited"
        }
    }

    #[test]
    fn a_question_has_all_that_is_left_once_the_search_has_ended_without_an_answer() {
        let (settings, limits) = (Settings::default(), Limits { nodes: 10_000, ..Limits::default() });
        let mut seen = Vec::new();
        let mut ends = |_: Pause, go_on: &mut GoOn<'_>| {
            seen.extend((0..6).map_while(|_| go_on()));
            false
        };
        let pauses = [Pause { nodes: 1_000, times: 1 }];
        let search = ParallelSearch {
            trees: vec![Box::new(Limited { nodes: 0, most: 2_100 })],
            settings: &settings,
            limits: &limits,
            watch: &Unwatched,
            fault: None,
            is_by_luck: false,
            reads_between: false,
            nearest: (u32::MAX, 0),
        };
        let outcome = search.grow(Some(Interlude { pauses: &pauses, ends: &mut ends }));
        assert_eq!((outcome.verdict, outcome.end), (Verdict::NotFound, End::Answered));
        assert_eq!(seen, [1_512, 2_024, u64::MAX, u64::MAX, u64::MAX, u64::MAX]);
    }

    #[test]
    fn a_pause_is_due_after_its_nodes_and_where_the_search_is_stuck() {
        let pause = Pause { nodes: 1_000, times: 4 };
        assert_eq!([0, 999].map(|nodes| pause.is_due(nodes, 0)), [false; 2]);
        assert!(pause.is_due(1_000, 250) && !pause.is_due(1_000, 251) && pause.is_due(1_004, 251));
        assert_eq!([0, 999, 1_000, 2_000].map(|nodes| pause.left(nodes)), [Some(1_000), Some(1), None, None]);
    }
}
