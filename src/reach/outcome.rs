//! The outcome of a search: verdict, statistics, coverage.

use serde::{Deserialize, Serialize};

use crate::ir::{Bounds, NeverId, SpaceId};
use crate::sim::{Fault, Script};

use super::coverage::Covered;
use super::monitor::{Monitor, Refutation};
use super::planners::Planner;
use super::proof::{Proof, TooFar};
use super::why_not::Nearest;

/// The answer to "can this be reached?".
#[derive(Debug, Clone, PartialEq)]
pub enum Verdict {
    /// Yes, by this plan, which was replayed.
    Reached(Plan),
    /// Nothing was found within the budget; this proves nothing.
    NotFound,
    /// No, and this is why.
    Unreachable(Argument),
    /// Not with any inputs with axes at -1, 0 and 1. The world also reads how far an axis is moved, and values in
    /// between were not tried.
    Exhausted(Exhaustion),
}

/// Why something cannot be reached.
#[derive(Debug, Clone, PartialEq)]
pub enum Argument {
    /// It holds in no state of the configuration space; nothing was searched.
    Analysis(Proof),
    /// It is too far away for the time limit; nothing was searched.
    Distance(TooFar),
    /// All inputs were tried.
    Exhaustion(Exhaustion),
    /// Every run is over before its first step.
    Over,
}

/// All reachable states were visited, for each combination of all buttons that are read and all axes at -1, 0 and 1.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Exhaustion {
    /// Number of distinct states.
    pub states: u64,
    /// Minimum number of steps for which each input is held.
    pub min_hold: u16,
    /// Number of instances that were left out, as they can act on the others only by contacts: these count as possible
    /// wherever they can be.
    pub left_out: u32,
}

/// An exhaustive search that did not visit all states.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Unfinished {
    /// Number of distinct states that it visited.
    pub states: u64,
    /// Number of steps within which it visited all states.
    pub steps: u32,
    /// As in [`Exhaustion`].
    pub left_out: u32,
}

/// A path to the target.
#[derive(Debug, Clone, PartialEq)]
pub struct Plan {
    /// The inputs from the initial state; the target holds after the last step.
    pub script: Script,
    /// Their number of steps.
    pub steps: u64,
    /// Number of steps before the start of the search.
    pub after: u64,
    /// Whether no admitted inputs, with axes at -1, 0 and 1, take fewer steps from the start of the search.
    pub is_shortest: bool,
}

/// Statistics of a search.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Statistics {
    /// Nodes over all trees, roots included.
    pub nodes: u64,
    /// Trees begun.
    pub trees: u64,
    /// Extensions simulated.
    pub extensions: u64,
    /// Extensions that ended in a `never`, out of bounds, out of the search window or in a fault.
    pub failures: u64,
    /// Steps simulated.
    pub steps: u64,
    /// States checked against the configuration space.
    pub checked: u64,
}

impl Statistics {
    /// Adds the statistics of another search.
    pub(super) fn add(&mut self, other: &Statistics) {
        self.nodes += other.nodes;
        self.trees += other.trees;
        self.extensions += other.extensions;
        self.failures += other.failures;
        self.steps += other.steps;
        self.checked += other.checked;
    }
}

/// A node of a tree, for pictures.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Visited {
    /// The index of its parent in the record; its own index for a root.
    pub parent: u32,
    /// The space that the first player is in.
    pub space: SpaceId,
    /// The first player's position, px.
    pub at: [f32; 2],
}

/// Adds the nodes of another search to a record.
pub(super) fn join_records(record: &mut Vec<Visited>, other: &[Visited]) {
    let before = record.len() as u32;
    record.extend(other.iter().map(|node| Visited { parent: node.parent + before, ..*node }));
}

/// Why a search came to an end.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
#[serde(rename_all = "lowercase")]
pub enum End {
    /// It has its answer, or its planner has nothing more to try.
    Answered,
    /// The nodes of its budget are grown.
    Nodes,
    /// Its memory is full.
    Memory,
    /// A limit of seconds or the user stopped it.
    Stopped,
}

/// The branches that a search gave up because a player left the search window of a space.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cut {
    /// The space.
    pub space: SpaceId,
    /// Its window.
    pub window: Bounds,
    /// Their number.
    pub branches: u64,
    /// Minimum number of steps to one of them.
    pub soonest: u32,
}

/// The outcome of a search.
#[derive(Debug, Clone, PartialEq)]
pub struct Outcome {
    /// The answer.
    pub verdict: Verdict,
    /// What ended the search.
    pub end: End,
    /// The planner that gave the answer, or the last one.
    pub planner: &'static str,
    /// Statistics.
    pub statistics: Statistics,
    /// The coverage.
    pub covered: Covered,
    /// If nothing was found: the finest completely tried class of inputs that change only every few steps, as the
    /// number of steps and the number of states. It says nothing about other inputs.
    pub exhausted: Option<(u16, u64)>,
    /// How far an exhaustive search of all inputs got that began when nothing was found.
    pub unfinished: Option<Unfinished>,
    /// Branches given up at search windows although the target may lie beyond; then a "no" cannot be proven.
    pub cuts: Vec<Cut>,
    /// The first counterexample found for each `never`.
    pub violations: Vec<(NeverId, Script)>,
    /// All nodes of all trees, if they are recorded.
    pub record: Vec<Visited>,
    /// Whether some combinations of inputs were left out because there are too many.
    pub truncated: bool,
    /// Whether a step has read a draw of nature of which not all values were tried; then a "no" cannot be proven by
    /// trying.
    pub has_open_draws: bool,
    /// The first run-time error, with its step (from 1): a mistake in the program.
    pub fault: Option<(Fault, u64)>,
    /// Whether an axis is read for more than its sign, so that -1, 0 and 1 do not cover all inputs.
    pub reads_between: bool,
    /// A run into a state that the analysis excludes: the analysis is wrong about this world.
    pub refuted: Option<Refutation>,
    /// Whether a proof was withdrawn because it rests on a refuted analysis; then there is no answer.
    pub is_withdrawn: bool,
    /// The states that came nearest to the target, if they were kept.
    pub nearest: Option<Nearest>,
}

impl End {
    /// Its name in results.
    pub fn name(self) -> &'static str {
        match self {
            End::Answered => "answered",
            End::Nodes => "nodes",
            End::Memory => "memory",
            End::Stopped => "stopped",
        }
    }
}

impl Argument {
    /// Whether it is a proof that rests on the analysis.
    fn rests_on_analysis(&self) -> bool {
        match self {
            Argument::Analysis(_) | Argument::Distance(_) => true,
            Argument::Exhaustion(_) | Argument::Over => false,
        }
    }
}

impl Outcome {
    /// Whether a search has ended by itself without an answer, so that another way of asking may have one.
    pub(super) fn is_open(&self) -> bool {
        self.verdict == Verdict::NotFound && self.end != End::Stopped && self.fault.is_none()
    }

    /// Whether it is a proof that rests on the analysis.
    pub fn rests_on_analysis(&self) -> bool {
        matches!(&self.verdict, Verdict::Unreachable(argument) if argument.rests_on_analysis())
    }

    /// Records a refutation and withdraws a proof that rests on the analysis.
    pub fn refute(&mut self, refutation: &Refutation) {
        self.refuted.get_or_insert_with(|| refutation.clone());
        if self.rests_on_analysis() {
            self.verdict = Verdict::NotFound;
            self.is_withdrawn = true;
        }
    }

    /// As [`Outcome::refute`], if the monitor has found a refutation.
    pub(super) fn refute_by(&mut self, monitor: &Monitor) {
        if let Some(refutation) = monitor.refutation() {
            self.refute(&refutation);
        }
    }

    /// The outcome of a search that was stopped before it started.
    pub fn stopped(planner: Planner) -> Self {
        Outcome { end: End::Stopped, ..Outcome::of(Verdict::NotFound, planner.name()) }
    }

    /// An outcome without any work.
    pub(super) fn of(verdict: Verdict, planner: &'static str) -> Self {
        Outcome {
            verdict,
            end: End::Answered,
            planner,
            statistics: Statistics::default(),
            covered: Covered::default(),
            exhausted: None,
            unfinished: None,
            cuts: Vec::new(),
            violations: Vec::new(),
            record: Vec::new(),
            truncated: false,
            has_open_draws: false,
            fault: None,
            reads_between: false,
            refuted: None,
            is_withdrawn: false,
            nearest: None,
        }
    }
}
