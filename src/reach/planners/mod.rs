//! The planners, as one table of specifications. A sampling planner is a [`Strategy`] of the planning loop
//! (`sampler.rs`); RC, RG and EG are two ideas and their combination: `violation_frequency.rs` (failure feedback) and
//! `reachable.rs` (reachable states).
//!
//! To add a planner, add a file with its strategy, a variant of [`Planner`] and an entry of `SPECS`.

mod adaptive;
mod beam;
mod blended;
mod cells;
mod coverage_guided;
mod dead_ends;
mod distance_guided;
mod eg;
mod few;
mod guided;
mod ledge_guided;
mod player_cells;
mod rc;
mod reachable;
mod rg;
mod rrt;
mod time_guided;
mod violation_frequency;

use std::sync::Arc;

use super::distance::DistanceField;
use super::ledges::Ledges;
use super::metric::Metric;
use super::problem::Problem;
use super::strategy::Strategy;
use super::why_not::Margins;

/// A planner, described by its [`Planner::summary`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Default)]
#[expect(missing_docs, reason = "each is described in the table")]
pub enum Planner {
    #[default]
    Auto,
    Rrt,
    RcRrt,
    RgRrt,
    EgRrt,
    RrtPlus,
    AstarRrt,
    AstarRgRrt,
    Coverage,
    DistanceGuided,
    TimeGuided,
    Beam,
    LedgeGuided,
    Exhaustive,
    BestFirst,
}

/// The specification of a planner.
struct Spec {
    planner: Planner,
    name: &'static str,
    /// Range of the number of steps for which it holds an input.
    hold: (u16, u16),
    /// Number of nodes of its shortest tree before a restart.
    restart: u64,
    /// Whether it uses the distance field of the goal.
    uses_distances: bool,
    method: Method,
}

/// How a planner grows its trees.
#[derive(Clone, Copy)]
pub(super) enum Method {
    /// Alternates several planners.
    Portfolio,
    /// The planning loop with a strategy; `samples` if the strategy uses samples.
    Sampling { samples: bool, strategy: BuildStrategy },
    /// The planning loop with several strategies without samples, a tree of each in turns.
    Alternating { strategies: BuildStrategies },
    /// Visits each state once, breadth first or best first.
    Exhaustive { is_best_first: bool },
}

/// What leads planners to the goal of a question.
#[derive(Clone, Copy)]
pub(super) struct Guidance<'m> {
    /// The distances to it, if the planner uses them and there are any.
    pub distances: Option<&'m DistanceField>,
    /// What it asks of numbers.
    pub margins: &'m Margins,
    /// The ledges of the player, if the planner uses them and there are any.
    pub ledges: Option<&'m Arc<Ledges>>,
}

/// The strategy of `auto`, which is led by distances and by coverage.
pub(super) fn blended<'m>(
    problem: &Problem<'_>,
    metric: &'m Metric,
    guidance: Guidance<'m>,
) -> Box<dyn Strategy + Send + 'm> {
    Box::new(blended::Blended::new(problem, metric, guidance))
}

/// Builds a strategy for a problem, a metric and what leads to the goal.
pub(super) type BuildStrategy = for<'m> fn(&Problem<'_>, &'m Metric, Guidance<'m>) -> Box<dyn Strategy + Send + 'm>;

/// Builds several.
pub(super) type BuildStrategies =
    for<'m> fn(&Problem<'_>, &'m Metric, Guidance<'m>) -> Vec<Box<dyn Strategy + Send + 'm>>;

impl Spec {
    /// A sampling planner with the default settings.
    const fn sampling(planner: Planner, name: &'static str, strategy: BuildStrategy) -> Self {
        let method = Method::Sampling { samples: true, strategy };
        Spec { planner, name, hold: (10, 10), restart: 2_000, uses_distances: false, method }
    }

    /// An exhaustive planner. It holds inputs as briefly as the question allows.
    const fn exhaustive(planner: Planner, name: &'static str, is_best_first: bool) -> Self {
        let method = Method::Exhaustive { is_best_first };
        Spec { planner, name, hold: (1, 1), restart: 2_000, uses_distances: false, method }
    }
}

/// All planners, in the order of [`Planner`].
const SPECS: [Spec; 15] = [
    Spec {
        planner: Planner::Auto,
        name: "auto",
        hold: (10, 10),
        restart: 2_000,
        uses_distances: true,
        method: Method::Portfolio,
    },
    Spec::sampling(Planner::Rrt, "rrt", |_, metric, _| Box::new(rrt::Rrt::new(metric))),
    Spec::sampling(Planner::RcRrt, "rc-rrt", |_, metric, _| Box::new(rc::Rc::new(metric))),
    Spec::sampling(Planner::RgRrt, "rg-rrt", |_, metric, _| Box::new(rg::Rg::new(metric))),
    Spec::sampling(Planner::EgRrt, "eg-rrt", |_, metric, _| Box::new(eg::Eg::new(metric))),
    Spec::sampling(Planner::RrtPlus, "rrt+", |_, metric, _| Box::new(adaptive::Adaptive::new(metric))),
    Spec::sampling(Planner::AstarRrt, "astar-rrt", |_, metric, _| Box::new(guided::Guided::new(rrt::Rrt::new(metric)))),
    Spec::sampling(Planner::AstarRgRrt, "astar-rg-rrt", |_, metric, _| {
        Box::new(guided::Guided::new(rg::Rg::new(metric)))
    }),
    Spec {
        planner: Planner::Coverage,
        name: "coverage",
        hold: (4, 60),
        // It returns to places that it passed.
        restart: 20_000,
        uses_distances: false,
        method: Method::Sampling {
            samples: false,
            strategy: |_, metric, guidance| Box::new(coverage_guided::CoverageGuided::new(metric, guidance.margins)),
        },
    },
    Spec {
        planner: Planner::DistanceGuided,
        name: "distance-guided",
        hold: (1, 60),
        restart: 100_000,
        uses_distances: true,
        method: Method::Sampling {
            samples: false,
            strategy: |problem, metric, guidance| {
                Box::new(distance_guided::DistanceGuided::by_jumps(problem, metric, guidance))
            },
        },
    },
    Spec {
        planner: Planner::TimeGuided,
        name: "time-guided",
        hold: (1, 16),
        restart: u64::MAX,
        uses_distances: true,
        method: Method::Alternating {
            strategies: |problem, metric, guidance| {
                let strategies = time_guided::TimeGuided::of_all_manners(problem, metric, guidance);
                strategies.into_iter().map(|strategy| Box::new(strategy) as Box<dyn Strategy + Send>).collect()
            },
        },
    },
    Spec {
        planner: Planner::Beam,
        name: "beam",
        hold: (1, 16),
        restart: u64::MAX,
        uses_distances: true,
        method: Method::Sampling {
            samples: false,
            strategy: |problem, metric, guidance| Box::new(beam::Beam::new(problem, metric, guidance)),
        },
    },
    Spec {
        planner: Planner::LedgeGuided,
        name: "ledge-guided",
        hold: (1, 60),
        restart: 100_000,
        uses_distances: true,
        method: Method::Sampling {
            samples: false,
            strategy: |_, _, guidance| Box::new(ledge_guided::LedgeGuided::new(guidance)),
        },
    },
    Spec::exhaustive(Planner::Exhaustive, "exhaustive", false),
    Spec::exhaustive(Planner::BestFirst, "best-first", true),
];

impl Planner {
    /// All of them.
    pub const ALL: [Planner; SPECS.len()] = {
        let mut all = [Planner::Auto; SPECS.len()];
        let mut at = 0;
        while at < SPECS.len() {
            all[at] = SPECS[at].planner;
            assert!(all[at] as usize == at, "the table is in the order of the variants");
            at += 1;
        }
        all
    };

    fn spec(self) -> &'static Spec {
        &SPECS[self as usize]
    }

    /// Its name.
    pub fn name(self) -> &'static str {
        self.spec().name
    }

    /// A short description, with its paper. Not in the table: programs that show none are smaller without.
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
            Planner::DistanceGuided => "guided by the distance to the goal through the level (after SyCLoP)",
            Planner::TimeGuided => "guided by the time to the goal (weighted A* over cells, after Pohl 1970)",
            Planner::Beam => "of all states of a time, only the nearest to the goal (beam search, after Lowerre 1976)",
            Planner::LedgeGuided => "from ledge to ledge: inputs that lead there, by local search",
            Planner::Exhaustive => "breadth first, each state once: shortest plans, and proofs of unreachability",
            Planner::BestFirst => "the nearest to the goal first, each state once: proofs of unreachability",
        }
    }

    /// A name that it had before, which old scripts use.
    pub fn former_name(self) -> Option<&'static str> {
        (self == Planner::DistanceGuided).then_some("lead")
    }

    /// The planner with a name, which may be a former one.
    pub fn named(name: &str) -> Option<Planner> {
        Planner::ALL.into_iter().find(|p| p.name() == name || p.former_name() == Some(name))
    }

    /// Default range of the number of steps for which it holds an input, ends included.
    pub fn hold(self) -> (u16, u16) {
        self.spec().hold
    }

    /// Default number of nodes of its shortest tree before a restart.
    pub fn restart(self) -> u64 {
        self.spec().restart
    }

    /// Whether it is a question of settings when its trees restart: `time-guided` has a sequence of its own, and exhaustive
    /// planners visit each state once.
    pub fn restarts(self) -> bool {
        !matches!(self.spec().method, Method::Exhaustive { .. }) && self.spec().restart < u64::MAX
    }

    /// Whether it uses the distance field of the goal.
    pub(super) fn uses_distances(self) -> bool {
        self.spec().uses_distances
    }

    /// Whether it uses the ledges of the player.
    pub(super) fn uses_ledges(self) -> bool {
        matches!(self, Planner::Auto | Planner::LedgeGuided)
    }

    /// How it grows its trees.
    pub(super) fn method(self) -> Method {
        self.spec().method
    }
}
