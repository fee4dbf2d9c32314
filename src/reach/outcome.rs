//! How a search ends, and what it took.

use serde::{Deserialize, Serialize};

use crate::ir::{Bounds, NeverId, SpaceId};
use crate::sim::{Fault, Script};

use super::coverage::Covered;
use super::guard::{Guard, Refutation};
use super::planners::Planner;
use super::proof::{Proof, TooFar};

/// The answer to "can this be reached?".
#[derive(Debug, Clone, PartialEq)]
pub enum Verdict {
    /// Yes, by this plan, which was replayed.
    Reached(Plan),
    /// Nothing was found within the budget; this proves nothing.
    NotFound,
    /// No, and this is why.
    Unreachable(Argument),
    /// Not by any inputs with axes at -1, 0 and 1; the world also reads how far an axis is moved, and values between were
    /// not tried.
    Exhausted(Exhaustion),
}

/// Why something cannot be reached.
#[derive(Debug, Clone, PartialEq)]
pub enum Argument {
    /// It holds in no state that the world can be in; nothing was searched.
    Analysis(Proof),
    /// It is too far away for the time that there is; nothing was searched.
    Distance(TooFar),
    /// All that a player can do was tried.
    Exhaustion(Exhaustion),
    /// Every run is over before it begins.
    Over,
}

/// All states were visited that inputs lead to: each combination of all buttons that are read and all axes at -1, 0 and 1.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Exhaustion {
    /// How many different states there are.
    pub states: u64,
    /// For how many steps each input is held at least.
    pub least_hold: u16,
}

/// A way to what was asked for.
#[derive(Debug, Clone, PartialEq)]
pub struct Plan {
    /// The inputs from the initial state on; what was asked for holds after the last step.
    pub script: Script,
    /// How many steps they last.
    pub steps: u64,
    /// How many of the first steps lead to where the search began.
    pub after: u64,
    /// Whether no inputs that the question admits, with axes at -1, 0 and 1, take fewer steps from where the search began.
    pub is_shortest: bool,
}

/// What a search did.
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
    /// States checked against what the world can be.
    pub checked: u64,
}

impl Statistics {
    /// Adds what another search did.
    pub(super) fn add(&mut self, other: &Statistics) {
        self.nodes += other.nodes;
        self.trees += other.trees;
        self.extensions += other.extensions;
        self.failures += other.failures;
        self.steps += other.steps;
        self.checked += other.checked;
    }
}

/// A node of a tree, as far as pictures show it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Visited {
    /// The place of its parent in the record; its own for a root.
    pub parent: u32,
    /// The space that the first player is in.
    pub space: SpaceId,
    /// The first player's position, px.
    pub at: [f32; 2],
}

/// Why a search came to an end.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
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

/// Branches that a search gave up because a player left the window of a space.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cut {
    /// The space.
    pub space: SpaceId,
    /// Its window.
    pub window: Bounds,
    /// How many.
    pub branches: u64,
    /// The fewest steps that lead to one of them.
    pub soonest: u32,
}

/// The end of a search.
#[derive(Debug, Clone, PartialEq)]
pub struct Outcome {
    /// The answer.
    pub verdict: Verdict,
    /// What ended the search.
    pub end: End,
    /// Which planner gave the answer, or was the last.
    pub planner: &'static str,
    /// What it took.
    pub statistics: Statistics,
    /// What was covered.
    pub covered: Covered,
    /// Where nothing was found: the finest inputs that change only every few steps and were all tried; for how many steps
    /// they are held, and how many states they lead to. It says nothing of inputs that change at other steps.
    pub exhausted: Option<(u16, u64)>,
    /// What was given up at search windows though what is asked for may happen beyond: then no "no" is proven.
    pub cuts: Vec<Cut>,
    /// The first way found that broke each `never`.
    pub violations: Vec<(NeverId, Script)>,
    /// All nodes of all trees, if they were to be recorded.
    pub record: Vec<Visited>,
    /// Whether some combinations of inputs were left out because there are too many.
    pub truncated: bool,
    /// The first run-time error met, with the step of its path (from 1): a mistake of the program.
    pub fault: Option<(Fault, u64)>,
    /// Whether an axis is read for more than its sign, so that axes at -1, 0 and 1 are not all there is.
    pub reads_between: bool,
    /// A run into a state which the analysis says that there is not: it is wrong about this world.
    pub refuted: Option<Refutation>,
    /// Whether there was a proof, which rests on what is refuted: then there is no answer.
    pub is_withdrawn: bool,
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
    /// Whether it rests on what the analysis says the world can be.
    fn rests_on_analysis(&self) -> bool {
        match self {
            Argument::Analysis(_) | Argument::Distance(_) => true,
            Argument::Exhaustion(_) | Argument::Over => false,
        }
    }
}

impl Outcome {
    /// Whether it is a proof that rests on what the analysis says the world can be.
    pub fn rests_on_analysis(&self) -> bool {
        matches!(&self.verdict, Verdict::Unreachable(argument) if argument.rests_on_analysis())
    }

    /// Withdraws a proof that rests on a refuted analysis; the search for another answer may have refuted it.
    pub fn refute(&mut self, refutation: &Refutation) {
        self.refuted.get_or_insert_with(|| refutation.clone());
        if self.rests_on_analysis() {
            self.verdict = Verdict::NotFound;
            self.is_withdrawn = true;
        }
    }

    /// As [`Outcome::refute`], if a guard has found something.
    pub(super) fn refute_by(&mut self, guard: &Guard) {
        if let Some(refutation) = guard.refutation() {
            self.refute(&refutation);
        }
    }

    /// Of a search that was stopped before it began.
    pub fn stopped(planner: Planner) -> Self {
        Outcome { end: End::Stopped, ..Outcome::of(Verdict::NotFound, planner.name()) }
    }

    /// A verdict before any work.
    pub(super) fn of(verdict: Verdict, planner: &'static str) -> Self {
        Outcome {
            verdict,
            end: End::Answered,
            planner,
            statistics: Statistics::default(),
            covered: Covered::default(),
            exhausted: None,
            cuts: Vec::new(),
            violations: Vec::new(),
            record: Vec::new(),
            truncated: false,
            fault: None,
            reads_between: false,
            refuted: None,
            is_withdrawn: false,
        }
    }
}
