//! The design of an experiment: questions, and search configurations.

use crate::analysis::ConfigurationSpace;
use crate::ir::GoalId;
use crate::reach::{Limits, Measure, Planner, Problem, Restart, Sampling, Settings};
use crate::sim::Simulator;

/// A goal of a world, with the results of the analysis.
pub struct Question<'a> {
    /// The name of the test in results, without the goal's name.
    pub test: String,
    /// The numbers of the program that are swept, with their values.
    pub set: Vec<(String, String)>,
    /// The test of the paper, if it is one.
    pub paper: Option<super::paper::Test>,
    /// The simulator of the world.
    pub sim: &'a Simulator,
    /// The configuration space from the analysis.
    pub space: &'a ConfigurationSpace,
    /// The goal.
    pub goal: GoalId,
    /// Hash of the flat IR, in hexadecimal digits.
    pub program_sha256: String,
    /// Duration of the analysis of the world, seconds.
    pub analysis_seconds: f64,
    /// Whether the analysis proves the goal unreachable ([`crate::reach::Proof`]), so that no search is run.
    pub is_ruled_out: bool,
}

impl Question<'_> {
    /// The question as a problem for planners.
    pub fn problem(&self) -> Problem<'_> {
        Problem::new(self.sim, self.goal)
    }

    /// The swept numbers as `--set` takes them.
    pub fn settings(&self) -> Vec<String> {
        self.set.iter().map(|(name, value)| format!("{name}={value}")).collect()
    }

    /// The goal's name.
    pub fn goal_name(&self) -> &str {
        &self.sim.world().goals[self.goal].name
    }
}

/// A search configuration: the factors in which the rows of a table differ.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Setup {
    /// The planner.
    pub planner: Planner,
    /// The restart rule; the published planners never restart.
    pub restart: Restart,
    /// The domain of samples.
    pub sampling: Sampling,
    /// The metric.
    pub measure: Measure,
    /// Number of steps that inputs are held; none: the planner's default.
    pub hold: Option<(u16, u16)>,
}

impl Setup {
    /// All combinations of these choices, in the order of a table: by metric, bounds and planner, each planner without
    /// restarts and then with them. A planner that does not sample has no trees to restart, and is listed once.
    pub fn all(
        planners: &[Planner],
        samplings: &[Sampling],
        measures: &[Measure],
        hold: Option<(u16, u16)>,
    ) -> Vec<Self> {
        let restarts = [Restart::Never, Restart::ByPlanner];
        let mut setups = Vec::new();
        for &measure in measures {
            for &sampling in samplings {
                for &planner in planners {
                    let count = if planner.restarts() { restarts.len() } else { 1 };
                    let ways = restarts.iter().take(count);
                    setups.extend(ways.map(|&restart| Setup { planner, restart, sampling, measure, hold }));
                }
            }
        }
        setups
    }

    /// The settings of the search.
    pub fn settings(&self, seed: u64) -> Settings {
        let Setup { planner, restart, sampling, measure, hold } = *self;
        // Only the planner is measured.
        let checks = false;
        Settings {
            seed,
            planner,
            restart,
            sampling,
            measure,
            hold,
            trees: 1,
            threads: 1,
            checks,
            ..Settings::default()
        }
    }

    /// The name of the bounds in results.
    pub fn bounds(&self) -> &'static str {
        self.sampling.name()
    }

    /// The name of the metric in results.
    pub fn metric(&self) -> &'static str {
        self.measure.name()
    }

    /// The nodes of the shortest tree before a restart, or `never`; `own` for `auto`, whose planners have different
    /// rules, and for `time-guided` and `beam`, which have one of their own.
    pub fn restarts(&self) -> String {
        match (self.restart, self.planner) {
            (Restart::Never | Restart::ByPlanner, Planner::TimeGuided | Planner::Beam) => "own".to_string(),
            (Restart::Never, _) => "never".to_string(),
            (Restart::After(nodes), _) => nodes.to_string(),
            (Restart::ByPlanner, Planner::Auto) => "own".to_string(),
            (Restart::ByPlanner, planner) => planner.restart().to_string(),
        }
    }

    /// Number of steps that inputs are held; none: the planner's default.
    pub fn held(&self) -> String {
        match (self.hold, self.planner) {
            (None, Planner::Auto | Planner::TimeGuided | Planner::Beam) => "own".to_string(),
            (hold, planner) => match hold.unwrap_or(planner.hold()) {
                (low, high) if low == high => low.to_string(),
                (low, high) => format!("{low}..{high}"),
            },
        }
    }
}

/// An experiment: every setup with every seed on every question that the analysis leaves open.
#[derive(Debug, Clone, PartialEq)]
pub struct Design {
    /// The search configurations.
    pub setups: Vec<Setup>,
    /// Number of seeds, from 1.
    pub seeds: u32,
    /// Maximum duration of a run by the clock, seconds.
    pub seconds: f64,
    /// The other limits of a run.
    pub limits: Limits,
}

impl Design {
    /// Number of runs.
    pub fn runs(&self, questions: &[Question<'_>]) -> usize {
        let open = questions.iter().filter(|q| !q.is_ruled_out).count();
        open * self.setups.len() * self.seeds as usize
    }
}
