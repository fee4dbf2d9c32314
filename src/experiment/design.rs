//! What an experiment runs: questions, and the ways in which each is searched.

use crate::analysis::ConfigurationSpace;
use crate::ir::GoalId;
use crate::reach::{Limits, Measure, Planner, Problem, Restart, Sampling, Settings};
use crate::sim::Simulator;

/// A goal of a world, with what is known of it before any search.
pub struct Question<'a> {
    /// What results call the test; the goal's name comes beside it.
    pub test: String,
    /// Which test of the paper it is, if it is one.
    pub paper: Option<super::paper::Test>,
    /// The simulator of the world.
    pub sim: &'a Simulator,
    /// What the analysis finds that the world can be.
    pub space: &'a ConfigurationSpace,
    /// What is asked for.
    pub goal: GoalId,
    /// Of the flat IR, in hexadecimal digits.
    pub program_sha256: String,
    /// Seconds that the analysis of the world took.
    pub analysis_seconds: f64,
    /// Whether the analysis rules the goal out ([`crate::reach::Proof`]), so that there is nothing to search for.
    pub is_ruled_out: bool,
}

impl Question<'_> {
    /// As the planners are asked it.
    pub fn problem(&self) -> Problem<'_> {
        Problem::new(self.sim, self.goal)
    }

    /// The goal's name.
    pub fn goal_name(&self) -> &str {
        &self.sim.world().goals[self.goal].name
    }
}

/// A way to search: all that rows of a table differ in.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Setup {
    /// Who searches.
    pub planner: Planner,
    /// When trees are begun anew; as planners were published, one tree grows for ever.
    pub restart: Restart,
    /// Where samples are drawn from.
    pub sampling: Sampling,
    /// What distances are measured in.
    pub measure: Measure,
    /// For how many steps inputs are held; none: as the planner does by itself.
    pub hold: Option<(u16, u16)>,
}

impl Setup {
    /// All ways there are of these choices, in the order of a table: by distance, bounds and planner, each planner without
    /// restarts and then with them. One that does not sample has no trees to begin anew, and comes once.
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

    /// As the search takes it.
    pub fn settings(&self, seed: u64) -> Settings {
        let Setup { planner, restart, sampling, measure, hold } = *self;
        // Planners are measured, and nothing else.
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

    /// The bounds, as they are written in results.
    pub fn bounds(&self) -> &'static str {
        self.sampling.name()
    }

    /// The distance, as it is written in results.
    pub fn metric(&self) -> &'static str {
        self.measure.name()
    }

    /// The nodes of the shortest tree before a restart, or `never`; `own` for `auto`, whose planners each do as they do.
    pub fn restarts(&self) -> String {
        match (self.restart, self.planner) {
            (Restart::Never, _) => "never".to_string(),
            (Restart::After(nodes), _) => nodes.to_string(),
            (Restart::ByPlanner, Planner::Auto) => "own".to_string(),
            (Restart::ByPlanner, planner) => planner.restart().to_string(),
        }
    }

    /// For how many steps inputs are held, such as `10` or `4..60`; `own` for `auto`, whose
    /// planners each hold them as they do.
    pub fn held(&self) -> String {
        match (self.hold, self.planner) {
            (None, Planner::Auto) => "own".to_string(),
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
    /// The ways to search.
    pub setups: Vec<Setup>,
    /// How many seeds: 1 and so on.
    pub seeds: u32,
    /// The most seconds of the clock that a run may take.
    pub seconds: f64,
    /// What else a run may cost.
    pub limits: Limits,
}

impl Design {
    /// How many runs that makes.
    pub fn runs(&self, questions: &[Question<'_>]) -> usize {
        let open = questions.iter().filter(|q| !q.is_ruled_out).count();
        open * self.setups.len() * self.seeds as usize
    }
}
