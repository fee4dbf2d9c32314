//! EG-RRT: reachable states (`reachable.rs`) of nodes that pass the failure feedback (`violation_frequency.rs`).
//!
//! Jaillet, Hoffman, van den Berg, Abbeel, Porta and Goldberg, *EG-RRT: Environment-Guided Random Trees for Kinodynamic
//! Motion Planning with Uncertainty and Obstacles*, 2011.

use crate::reach::metric::{Metric, Point};
use crate::reach::search_context::SearchContext;
use crate::reach::strategy::{Choice, Growth, Strategy};

use super::reachable::Reachable;
use super::violation_frequency::ViolationFrequencies;

/// RRT guided by reachable states, with failure feedback.
#[derive(Debug)]
pub struct Eg {
    reachable: Reachable,
    violations: ViolationFrequencies,
}

impl Eg {
    /// A strategy for a space.
    pub fn new(metric: &Metric) -> Self {
        Eg { reachable: Reachable::new(metric), violations: ViolationFrequencies::default() }
    }
}

impl Strategy for Eg {
    fn choose(&mut self, context: &mut SearchContext<'_>, toward: &Point) -> Option<Choice> {
        let takes_part = self.violations.draw_participants(context);
        self.reachable.choose_where(context, toward, takes_part)
    }

    fn learn(&mut self, context: &mut SearchContext<'_>, choice: Option<Choice>, growth: Growth<'_>) {
        let node = match (growth, choice) {
            (Growth::Rooted(root, _), _) => {
                self.reachable.clear();
                self.violations.clear();
                root
            }
            (Growth::Added(node, _), _) => node,
            (Growth::Failed | Growth::Late | Growth::Known(..), Some(choice)) => {
                return self.violations.fail(context, choice.node);
            }
            (Growth::Failed | Growth::Late | Growth::Known(..), None) => return,
        };
        self.violations.add();
        for failed in self.reachable.add(context, node) {
            self.violations.fail(context, *failed);
        }
    }

    fn bytes(&self) -> usize {
        self.reachable.bytes() + self.violations.bytes()
    }
}
