//! RC-RRT: the plain RRT, where nodes whose branches fail are passed over more and more often (`blame.rs`).
//!
//! Cheng and LaValle, *Resolution Complete Rapidly-Exploring Random Trees*, 2002.

use crate::reach::metric::{Metric, Point};
use crate::reach::search_context::SearchContext;
use crate::reach::strategy::{Choice, Growth, Strategy};

use super::blame::Blame;
use super::rrt::Rrt;

/// RRT with failure feedback.
#[derive(Debug)]
pub struct Rc {
    rrt: Rrt,
    blame: Blame,
}

impl Rc {
    /// A strategy for a space.
    pub fn new(metric: &Metric) -> Self {
        Rc { rrt: Rrt::new(metric), blame: Blame::default() }
    }
}

impl Strategy for Rc {
    fn choose(&mut self, context: &mut SearchContext<'_>, toward: &Point) -> Option<Choice> {
        let takes_part = self.blame.lottery(context);
        self.rrt.choose_where(context, toward, takes_part)
    }

    fn learn(&mut self, context: &mut SearchContext<'_>, choice: Option<Choice>, growth: Growth<'_>) {
        match (growth, choice) {
            (Growth::Rooted(..), _) => {
                self.blame.clear();
                self.blame.add();
            }
            (Growth::Added(..), _) => self.blame.add(),
            (Growth::Failed, Some(choice)) => self.blame.fail(context, choice.node),
            (Growth::Failed, None) => {}
        }
        self.rrt.learn(context, choice, growth);
    }

    fn bytes(&self) -> usize {
        self.rrt.bytes() + self.blame.bytes()
    }
}
