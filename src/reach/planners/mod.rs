//! The planners, by their names. What samples is a [`Strategy`] of the planning loop (`sampler.rs`); RC, RG and EG are
//! two ideas and their composition: `blame.rs` (failure feedback) and `reachable.rs` (reachable states).

mod adaptive;
mod blame;
mod cells;
mod coverage_guided;
mod eg;
mod guided;
mod lead;
mod rc;
mod reachable;
mod rg;
mod rrt;

use super::distance::Distances;
use super::metric::Metric;
use super::problem::Problem;
use super::strategy::Strategy;

/// A planner.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Default)]
pub enum Planner {
    /// Several in turns, chosen by measurement (`portfolio.rs`).
    #[default]
    Auto,
    /// LaValle 1998.
    Rrt,
    /// Cheng and LaValle 2002: failure feedback.
    RcRrt,
    /// Shkolnik, Walter and Tedrake 2009: reachable states.
    RgRrt,
    /// Jaillet et al. 2011: both.
    EgRrt,
    /// Kim and Esposito 2005: adaptive sample bias.
    RrtPlus,
    /// RRT with a bounded best-first search as local planner.
    AstarRrt,
    /// RG-RRT with the same.
    AstarRgRrt,
    /// After KPIECE (Şucan and Kavraki 2009) and EST: guided by what is covered, without neighbours.
    Coverage,
    /// After SyCLoP (Plaku, Kavraki and Vardi 2010): led by the distance to the goal through the level.
    Lead,
    /// Breadth first, each state once: shortest plans, and proofs.
    Exhaustive,
    /// The nearest to the goal first, each state once: proofs.
    BestFirst,
}

impl Planner {
    /// All of them.
    pub const ALL: [Planner; 12] = [
        Planner::Auto,
        Planner::Rrt,
        Planner::RcRrt,
        Planner::RgRrt,
        Planner::EgRrt,
        Planner::RrtPlus,
        Planner::AstarRrt,
        Planner::AstarRgRrt,
        Planner::Coverage,
        Planner::Lead,
        Planner::Exhaustive,
        Planner::BestFirst,
    ];

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Planner::Auto => "auto",
            Planner::Rrt => "rrt",
            Planner::RcRrt => "rc-rrt",
            Planner::RgRrt => "rg-rrt",
            Planner::EgRrt => "eg-rrt",
            Planner::RrtPlus => "rrt+",
            Planner::AstarRrt => "astar-rrt",
            Planner::AstarRgRrt => "astar-rg-rrt",
            Planner::Coverage => "coverage",
            Planner::Lead => "lead",
            Planner::Exhaustive => "exhaustive",
            Planner::BestFirst => "best-first",
        }
    }

    /// What it does, in a few words.
    pub fn summary(self) -> &'static str {
        match self {
            Planner::Auto => "several in turns, chosen by measurement",
            Planner::Rrt => "rapidly-exploring random tree (LaValle 1998)",
            Planner::RcRrt => "with failure feedback (Cheng and LaValle 2002)",
            Planner::RgRrt => "guided by reachable states (Shkolnik, Walter and Tedrake 2009)",
            Planner::EgRrt => "with both (Jaillet et al. 2011)",
            Planner::RrtPlus => "with adaptive sample bias (Kim and Esposito 2005)",
            Planner::AstarRrt => "RRT with a bounded best-first search as local planner",
            Planner::AstarRgRrt => "RG-RRT with the same",
            Planner::Coverage => "guided by what is covered, without neighbours (after KPIECE and EST)",
            Planner::Lead => "led by the distance to the goal through the level (after SyCLoP)",
            Planner::Exhaustive => "breadth first, each state once: shortest plans, and proofs of no",
            Planner::BestFirst => "the nearest to the goal first, each state once: proofs of no",
        }
    }

    /// The planner of a name.
    pub fn named(name: &str) -> Option<Planner> {
        Planner::ALL.into_iter().find(|p| p.name() == name)
    }

    /// For how many steps it holds an input, if nothing else is asked for.
    pub fn hold(self) -> (u16, u16) {
        match self {
            Planner::Coverage | Planner::Lead => (4, 60),
            // All that a question admits.
            Planner::Exhaustive | Planner::BestFirst => (1, 1),
            _ => (10, 10),
        }
    }

    /// The number of nodes of the shortest tree before it begins anew, if nothing else is asked for.
    pub fn restart(self) -> u64 {
        match self {
            // They come back to what they have passed by.
            Planner::Coverage => 20_000,
            Planner::Lead => 100_000,
            _ => 2_000,
        }
    }

    /// Its strategy in the planning loop; none of those that do not sample.
    pub(super) fn strategy<'m>(
        self,
        problem: &Problem<'_>,
        metric: &'m Metric,
        distances: Option<&'m Distances>,
    ) -> Option<Box<dyn Strategy + Send + 'm>> {
        Some(match self {
            Planner::Auto | Planner::Exhaustive | Planner::BestFirst => return None,
            Planner::Rrt => Box::new(rrt::Rrt::new(metric)),
            Planner::RcRrt => Box::new(rc::Rc::new(metric)),
            Planner::RgRrt => Box::new(rg::Rg::new(metric)),
            Planner::EgRrt => Box::new(eg::Eg::new(metric)),
            Planner::RrtPlus => Box::new(adaptive::Adaptive::new(metric)),
            Planner::AstarRrt => Box::new(guided::Guided::new(rrt::Rrt::new(metric))),
            Planner::AstarRgRrt => Box::new(guided::Guided::new(rg::Rg::new(metric))),
            Planner::Coverage => Box::new(coverage_guided::CoverageGuided::new(metric)),
            Planner::Lead => Box::new(lead::Lead::new(problem, metric, distances)),
        })
    }
}
