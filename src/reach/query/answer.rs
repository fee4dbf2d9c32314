//! The answer to one question, as a record of plain data, from which results, rows and text are made. It does not
//! depend on the machine, unless a limit of seconds ended the search.

use serde::{Deserialize, Serialize};

use crate::ir::{Bounds, World};
use crate::sim::Simulator;
use crate::source::SourceMap;

use super::super::conclusion::Conclusion;
use super::super::coverage::{Count, PLACE};
use super::super::outcome::{Argument, Cut, End, Outcome, Unfinished, Verdict};
use super::super::probability::Luck;
use super::super::problem::Target;
use super::super::why_not::WhyNot;
use super::robust::RobustRecord;
use super::wording::{is_bounded, reasons};

/// What kind of thing is asked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
#[serde(rename_all = "lowercase")]
pub enum Kind {
    /// A way to a goal.
    Goal,
    /// A way to break a `never`.
    Never,
}

impl Kind {
    /// The keyword.
    pub fn name(self) -> &'static str {
        match self {
            Kind::Goal => "goal",
            Kind::Never => "never",
        }
    }
}

impl Target {
    /// What kind of thing it is.
    pub fn kind(self) -> Kind {
        match self {
            Target::Goal(_) => Kind::Goal,
            Target::Never(_) => Kind::Never,
        }
    }

    /// The name that the author gave it.
    pub fn name(self, world: &World) -> &str {
        match self {
            Target::Goal(id) => &world.goals[id].name,
            Target::Never(id) => &world.nevers[id].name,
        }
    }
}

/// How it was proven that there is no way.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum ProofMethod {
    /// It holds in no state that the analysis allows, however that state is reached.
    Analysis,
    /// It is too far away for the time that there is.
    Distance,
    /// All states were visited.
    Exhaustion,
    /// Every run ends before its first step.
    NoRun,
}

impl ProofMethod {
    /// Its name in results.
    pub fn name(self) -> &'static str {
        match self {
            ProofMethod::Analysis => "analysis",
            ProofMethod::Distance => "distance",
            ProofMethod::Exhaustion => "exhaustion",
            ProofMethod::NoRun => "no-run",
        }
    }
}

/// How much a search covered.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct CoverageSummary {
    /// The side of a place, px.
    pub place: f64,
    /// Places that the players were in.
    pub places: u64,
    /// Combinations of modes and discrete values of all instances.
    pub mode_combinations: u64,
    /// Both together.
    pub places_with_modes: u64,
    /// Of the places, those that the second half of the nodes added.
    pub new_places: u64,
    /// Of the combinations, those that the second half of the nodes added.
    pub new_mode_combinations: u64,
    /// Of both together, those that the second half of the nodes added.
    pub new_places_with_modes: u64,
}

impl CoverageSummary {
    fn new(all: Count, half: Count) -> Self {
        CoverageSummary {
            place: PLACE,
            places: all.places,
            mode_combinations: all.modes,
            places_with_modes: all.both,
            new_places: all.places - half.places,
            new_mode_combinations: all.modes - half.modes,
            new_places_with_modes: all.both - half.both,
        }
    }
}

/// Inputs that change only every few steps, all of which were tried. It says nothing about other inputs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct ExhaustedHold {
    /// For how many steps each input is held.
    pub hold: u16,
    /// The number of states that they lead to.
    pub states: u64,
}

/// How far an exhaustive search of all inputs got that did not visit all states.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct UnfinishedVisit {
    /// The number of different states that it visited.
    pub states: u64,
    /// It visited all states that this number of steps leads to.
    pub steps: u32,
    /// The number of instances that it left out: they can act on the others only by contacts.
    pub left_out: u32,
}

/// The search window of a space, where branches ended because a player left it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct SearchWindow {
    /// The space.
    pub space: String,
    /// Its left end, px.
    pub left: f64,
    /// Its right end, px.
    pub right: f64,
    /// Its lower end, px.
    pub bottom: f64,
    /// The number of branches that ended there.
    pub branches: u64,
}

impl SearchWindow {
    fn new(world: &World, &Cut { space, window, branches, .. }: &Cut) -> Self {
        let Bounds { left, right, bottom, top: _ } = window;
        SearchWindow { space: world.spaces[space].name.clone(), left, right, bottom, branches }
    }
}

/// A way to break a `never` that was met while something else was searched.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct Counterexample {
    /// The name of the `never`.
    pub never: String,
    /// The number of steps.
    pub steps: u64,
    /// The inputs, as a script.
    pub inputs: String,
    /// The luck that it needs; left out in a world without chances.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub luck: Option<Luck>,
}

/// The answer to one question.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct Answer {
    /// What kind of thing is asked for.
    pub kind: Kind,
    /// Its name.
    pub goal: String,
    /// The verdict.
    pub verdict: Conclusion,
    /// Whether the author wants this verdict: a goal reached, a `never` proven.
    pub is_expected: bool,
    /// How it was proven that there is no way; null if it was not.
    pub proven_by: Option<ProofMethod>,
    /// Why there is no way, a sentence each; empty if that is not known.
    pub reasons: Vec<String>,
    /// What the reasons assume about the world, a sentence each.
    pub assumptions: Vec<String>,
    /// Whether a proof was withdrawn, because a run has refuted the analysis that it rests on.
    pub is_withdrawn: bool,
    /// If all states were visited: their number.
    pub states: Option<u64>,
    /// If all states were visited: the number of instances that were left out, as they can act on the others only by
    /// contacts. Left out if there are none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub left_out: Option<u32>,
    /// A lower bound of the number of steps, if one is known: of a goal that takes more than allowed, and of one that is
    /// reached, from where its path begins.
    pub least_steps: Option<u64>,
    /// The number of steps of the path; null if there is none.
    pub steps: Option<u64>,
    /// The duration of the path in the world, s; null if there is none.
    pub seconds_of_play: Option<f64>,
    /// The spaces that the players are in at the end of the path; empty if there is none.
    #[serde(default)]
    pub spaces: Vec<String>,
    /// Whether no allowed inputs (with axes at -1, 0 and 1) take fewer steps; null if there is no path.
    pub is_shortest: Option<bool>,
    /// Whether axes between -1, 0 and 1, which no search tries, can make a difference.
    pub reads_between: bool,
    /// The path, as an input script; null if there is none.
    pub inputs: Option<String>,
    /// The planner that gave the answer; `analysis` if nothing was searched; null if the question could not be asked.
    pub answered_by: Option<String>,
    /// What ended the search.
    pub end: End,
    /// Nodes of all trees.
    pub nodes: u64,
    /// Trees.
    pub trees: u64,
    /// Simulated extensions.
    pub extensions: u64,
    /// Extensions that led nowhere.
    pub failures: u64,
    /// Simulated steps.
    pub simulated_steps: u64,
    /// States that were checked against the space that proofs rest on.
    pub checked_states: u64,
    /// How much was covered.
    pub coverage: CoverageSummary,
    /// If nothing was found: inputs with the shortest hold that were all tried.
    pub exhausted: Option<ExhaustedHold>,
    /// If nothing was found: how far a search of all inputs got. Left out if there was none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub unfinished: Option<UnfinishedVisit>,
    /// If nothing was found: search windows that branches left.
    pub windows: Vec<SearchWindow>,
    /// Counterexamples that were met on the way.
    pub violations: Vec<Counterexample>,
    /// Whether some combinations of buttons were left out because there are too many.
    pub inputs_left_out: bool,
    /// Whether nature drew something of which not all values were tried: nothing is proven by trying then. Left out if not.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub draws_left_out: bool,
    /// The luck that the path needs: nature draws what helps. Left out if there is no path, in a world without chances,
    /// and where a seed fixes what is drawn.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub luck: Option<Luck>,
    /// What came nearest to a goal that is not reached, and where the way ends. Left out of other answers, and if it was not
    /// asked for.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub why_not: Option<WhyNot>,
    /// How robust the path is under timing errors, if that was asked; left out if not, and if there is no path.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub robust: Option<RobustRecord>,
}

impl Answer {
    /// The record of a question that could not be asked.
    pub fn failed(kind: Kind, goal: String) -> Self {
        Answer {
            kind,
            goal,
            verdict: Conclusion::Error,
            is_expected: false,
            proven_by: None,
            reasons: Vec::new(),
            assumptions: Vec::new(),
            is_withdrawn: false,
            states: None,
            left_out: None,
            least_steps: None,
            steps: None,
            seconds_of_play: None,
            spaces: Vec::new(),
            is_shortest: None,
            reads_between: false,
            inputs: None,
            answered_by: None,
            end: End::Answered,
            nodes: 0,
            trees: 0,
            extensions: 0,
            failures: 0,
            simulated_steps: 0,
            checked_states: 0,
            coverage: CoverageSummary::default(),
            exhausted: None,
            unfinished: None,
            windows: Vec::new(),
            violations: Vec::new(),
            inputs_left_out: false,
            draws_left_out: false,
            luck: None,
            why_not: None,
            robust: None,
        }
    }

    /// The record of an outcome. `sources` hold the text of the program's predicates.
    pub(super) fn new(sim: &Simulator, sources: &SourceMap, target: Target, outcome: &Outcome) -> Self {
        let (program, world) = (sim.program(), sim.world());
        let plan = match &outcome.verdict {
            Verdict::Reached(plan) => Some(plan),
            Verdict::NotFound | Verdict::Unreachable(_) | Verdict::Exhausted(_) => None,
        };
        let reasons = reasons(sources, program, world, &outcome.verdict);
        let rests_on_bounds = !reasons.is_empty() && is_bounded(world);
        let assumption = "a run ends where a player leaves the bounds of its space, below or beside";
        let argument = match &outcome.verdict {
            Verdict::Unreachable(argument) => Some(argument),
            _ => None,
        };
        let statistics = &outcome.statistics;
        Answer {
            verdict: outcome.conclusion(target),
            is_expected: outcome.conclusion(target).is_expected(target),
            proven_by: argument.map(|argument| match argument {
                Argument::Analysis(_) => ProofMethod::Analysis,
                Argument::Distance(_) => ProofMethod::Distance,
                Argument::Exhaustion(_) => ProofMethod::Exhaustion,
                Argument::Over => ProofMethod::NoRun,
            }),
            assumptions: rests_on_bounds.then(|| assumption.to_string()).into_iter().collect(),
            reasons,
            is_withdrawn: outcome.is_withdrawn,
            states: match outcome.verdict {
                Verdict::Unreachable(Argument::Exhaustion(all)) | Verdict::Exhausted(all) => Some(all.states),
                _ => None,
            },
            left_out: match outcome.verdict {
                Verdict::Unreachable(Argument::Exhaustion(all)) | Verdict::Exhausted(all) => {
                    Some(all.left_out).filter(|left_out| *left_out > 0)
                }
                _ => None,
            },
            least_steps: match argument {
                Some(Argument::Distance(far)) => Some(far.least),
                _ => None,
            },
            steps: plan.map(|plan| plan.steps),
            seconds_of_play: plan.map(|plan| plan.steps as f64 * world.step.seconds()),
            is_shortest: plan.map(|plan| plan.is_shortest),
            reads_between: outcome.reads_between,
            inputs: plan.map(|plan| plan.script.text(program, sim.world_id())),
            answered_by: Some(outcome.planner.to_string()),
            end: outcome.end,
            nodes: statistics.nodes,
            trees: statistics.trees,
            extensions: statistics.extensions,
            failures: statistics.failures,
            simulated_steps: statistics.steps,
            checked_states: statistics.checked,
            coverage: CoverageSummary::new(outcome.covered.all, outcome.covered.half),
            exhausted: outcome.exhausted.map(|(hold, states)| ExhaustedHold { hold, states }),
            unfinished: outcome.unfinished.map(|Unfinished { states, steps, left_out }| UnfinishedVisit {
                states,
                steps,
                left_out,
            }),
            windows: match outcome.verdict {
                Verdict::NotFound => outcome.cuts.iter().map(|cut| SearchWindow::new(world, cut)).collect(),
                _ => Vec::new(),
            },
            violations: Vec::new(),
            inputs_left_out: outcome.truncated,
            draws_left_out: outcome.has_open_draws,
            ..Answer::failed(target.kind(), target.name(world).to_string())
        }
    }
}
