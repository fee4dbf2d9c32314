//! Guided by distances and by coverage in one tree: each extension is chosen by one of the two.
//!
//! After the several selection rules of Röger and Helmert, *The More, the Merrier: Combining Heuristic Estimators for
//! Satisficing Planning*, 2010. Theirs alternate over the same states; here each rule keeps cells of its own, and the one
//! that is led by distances gets most of the choices. Coverage learns from all extensions. The other one goes on from what
//! coverage finds only where that is progress: nearer than ever, or something that seldom changes has changed. It would
//! try all other places that coverage strays to again and again, as it does at an obstacle.

use crate::reach::metric::{Metric, Point};
use crate::reach::problem::Problem;
use crate::reach::search_context::SearchContext;
use crate::reach::strategy::{Choice, Growth, Strategy};

use super::Guidance;
use super::coverage_guided::CoverageGuided;
use super::distance_guided::DistanceGuided;

use rand::RngExt;

/// Of as many choices, those by distance: as a rule, with a time limit, and where the goal is not at a position.
const CHOICES: u32 = 8;
const BY_DISTANCE: u32 = 7;
const IN_TIME: u32 = 6;
const WITHOUT_DISTANCES: u32 = 3;

/// A strategy that chooses by distance or by coverage.
#[derive(Debug)]
pub struct Blended<'m> {
    by_distance: DistanceGuided<'m>,
    by_coverage: CoverageGuided<'m>,
    has_distances: bool,
    is_by_distance: bool,
}

impl<'m> Blended<'m> {
    /// A strategy for a problem, with what leads to its goal.
    pub fn new(problem: &Problem<'_>, metric: &Metric, guidance: Guidance<'m>) -> Self {
        Blended {
            by_distance: DistanceGuided::by_places(problem, metric, guidance),
            by_coverage: CoverageGuided::new(metric, guidance.margins),
            has_distances: guidance.distances.is_some(),
            is_by_distance: true,
        }
    }

    /// Whether the rule that is led by distances learns of an extension.
    fn is_shared(&self, context: &SearchContext<'_>, growth: Growth<'_>) -> bool {
        // The earliest of several nodes counts with a time limit, and without distances the least chosen.
        let is_by_nearness = self.has_distances && context.problem.time().is_none();
        match growth {
            Growth::Added(..) if is_by_nearness && !self.is_by_distance => {
                self.by_coverage.has_opened() || self.by_distance.is_nearest(context)
            }
            _ => true,
        }
    }

    /// How many of the choices are by distance.
    fn share(&self, is_timed: bool) -> u32 {
        match (self.has_distances, is_timed) {
            (false, _) => WITHOUT_DISTANCES,
            (true, true) => IN_TIME,
            (true, false) => BY_DISTANCE,
        }
    }
}

impl Strategy for Blended<'_> {
    fn choose(&mut self, context: &mut SearchContext<'_>, toward: &Point) -> Option<Choice> {
        let share = self.share(context.problem.time().is_some());
        self.is_by_distance = context.rng.random_ratio(share, CHOICES);
        let by_distance = if self.is_by_distance { self.by_distance.choose(context, toward) } else { None };
        // It may have tried all that it knows.
        self.is_by_distance = by_distance.is_some();
        let choice = by_distance.or_else(|| self.by_coverage.choose(context, toward))?;
        if context.tree.untried(choice.node) == 0 {
            self.by_distance.close(choice.node);
            self.by_coverage.close(choice.node);
        }
        Some(choice)
    }

    fn learn(&mut self, context: &mut SearchContext<'_>, choice: Option<Choice>, growth: Growth<'_>) {
        self.by_coverage.learn(context, choice, growth);
        if self.is_shared(context, growth) {
            self.by_distance.learn(context, choice, growth);
        }
    }

    fn planner(&self) -> Option<&'static str> {
        Some(if self.is_by_distance { "distance-guided" } else { "coverage" })
    }

    fn bytes(&self) -> usize {
        self.by_distance.bytes() + self.by_coverage.bytes()
    }
}
