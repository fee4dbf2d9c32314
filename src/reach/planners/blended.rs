//! Guided by distances and by coverage in one tree: each extension is chosen by one of the two, and both learn from it.
//!
//! What one of them finds the other goes on from, which two trees in turns cannot. After the several selection rules over
//! one open list of Röger and Helmert, *The More, the Merrier: Combining Heuristic Estimators for Satisficing Planning*,
//! 2010; here the rules keep cells of their own, and the one that is led by distances gets most of the choices while it
//! comes nearer to the goal.

use crate::reach::distance::DistanceField;
use crate::reach::metric::{Metric, Point};
use crate::reach::problem::Problem;
use crate::reach::search_context::SearchContext;
use crate::reach::strategy::{Choice, Growth, Strategy};

use super::coverage_guided::CoverageGuided;
use super::distance_guided::DistanceGuided;

use rand::RngExt;

/// Of as many choices, those by distance: as a rule, while it comes nearer to the goal, with a time limit, and where the
/// goal is not at a position.
const CHOICES: u32 = 8;
const BY_DISTANCE: u32 = 5;
const WHILE_NEARER: u32 = 7;
const IN_TIME: u32 = 6;
const WITHOUT_DISTANCES: u32 = 3;
/// It comes nearer if it did in this part of the choices, or within as many.
const RECENT: u64 = 4;
const PATIENCE: u64 = 1_000;

/// A strategy that chooses by distance or by coverage.
#[derive(Debug)]
pub struct Blended<'m> {
    by_distance: DistanceGuided<'m>,
    by_coverage: CoverageGuided,
    has_distances: bool,
    is_by_distance: bool,
    /// Choices in this tree, and how many there were at the last record of the least distance.
    choices: u64,
    record: (u32, u64),
}

impl<'m> Blended<'m> {
    /// A strategy for a problem, with its distance field if there is one.
    pub fn new(problem: &Problem<'_>, metric: &Metric, distances: Option<&'m DistanceField>) -> Self {
        Blended {
            by_distance: DistanceGuided::new(problem, metric, distances),
            by_coverage: CoverageGuided::new(metric),
            has_distances: distances.is_some(),
            is_by_distance: true,
            choices: 0,
            record: (u32::MAX, 0),
        }
    }

    /// How many of the choices are by distance now.
    fn share(&self, is_timed: bool) -> u32 {
        let since = self.choices - self.record.1;
        match () {
            () if !self.has_distances => WITHOUT_DISTANCES,
            () if is_timed => IN_TIME,
            () if since < PATIENCE || since < self.choices / RECENT => WHILE_NEARER,
            () => BY_DISTANCE,
        }
    }
}

impl Strategy for Blended<'_> {
    fn choose(&mut self, context: &mut SearchContext<'_>, toward: &Point) -> Option<Choice> {
        self.choices += 1;
        let share = self.share(context.problem.time().is_some());
        self.is_by_distance = context.rng.random_ratio(share, CHOICES);
        let choice = match self.is_by_distance {
            true => self.by_distance.choose(context, toward),
            false => self.by_coverage.choose(context, toward),
        }?;
        if context.tree.untried(choice.node) == 0 {
            self.by_distance.close(choice.node);
            self.by_coverage.close(choice.node);
        }
        Some(choice)
    }

    fn learn(&mut self, context: &mut SearchContext<'_>, choice: Option<Choice>, growth: Growth<'_>) {
        if let Growth::Rooted(..) = growth {
            (self.choices, self.record) = (0, (u32::MAX, 0));
        }
        self.by_distance.learn(context, choice, growth);
        self.by_coverage.learn(context, choice, growth);
        let nearest = self.by_distance.nearest();
        if nearest < self.record.0 {
            self.record = (nearest, self.choices);
        }
    }

    fn planner(&self) -> Option<&'static str> {
        Some(if self.is_by_distance { "distance-guided" } else { "coverage" })
    }

    fn bytes(&self) -> usize {
        self.by_distance.bytes() + self.by_coverage.bytes()
    }
}
