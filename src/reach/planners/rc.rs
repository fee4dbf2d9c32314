//! RC-RRT: a plain RRT that skips nodes whose extensions fail often (`violation_frequency.rs`).
//!
//! Cheng and LaValle, *Resolution Complete Rapidly-Exploring Random Trees*, 2002.

use crate::reach::metric::{Metric, Point};
use crate::reach::search_context::SearchContext;
use crate::reach::strategy::{Choice, Growth, Strategy};

use super::rrt::Rrt;
use super::violation_frequency::ViolationFrequencies;

/// RRT with failure feedback.
#[derive(Debug)]
pub struct Rc {
    rrt: Rrt,
    violations: ViolationFrequencies,
}

impl Rc {
    /// A strategy for a space.
    pub fn new(metric: &Metric) -> Self {
        Rc { rrt: Rrt::new(metric), violations: ViolationFrequencies::default() }
    }
}

impl Strategy for Rc {
    fn choose(&mut self, context: &mut SearchContext<'_>, toward: &Point) -> Option<Choice> {
        let takes_part = self.violations.draw_participants(context);
        self.rrt.choose_where(context, toward, takes_part)
    }

    fn learn(&mut self, context: &mut SearchContext<'_>, choice: Option<Choice>, growth: Growth<'_>) {
        match (growth, choice) {
            (Growth::Rooted(..), _) => {
                self.violations.clear();
                self.violations.add();
            }
            (Growth::Added(..), _) => self.violations.add(),
            (Growth::Failed | Growth::Late | Growth::Known(..), Some(choice)) => {
                self.violations.fail(context, choice.node)
            }
            (Growth::Failed | Growth::Late | Growth::Known(..), None) => {}
        }
        self.rrt.learn(context, choice, growth);
    }

    fn bytes(&self) -> usize {
        self.rrt.bytes() + self.violations.bytes()
    }
}
