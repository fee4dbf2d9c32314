//! EG-RRT: reachable states (`reachable.rs`) of nodes that failure feedback (`blame.rs`) lets take part.
//!
//! Jaillet, Hoffman, van den Berg, Abbeel, Porta and Goldberg, *EG-RRT: Environment-Guided Random Trees for Kinodynamic
//! Motion Planning with Uncertainty and Obstacles*, 2011.

use crate::reach::metric::{Metric, Point};
use crate::reach::search_context::SearchContext;
use crate::reach::strategy::{Choice, Growth, Strategy};

use super::blame::Blame;
use super::reachable::Reachable;

/// RRT guided by reachable states, with failure feedback.
#[derive(Debug)]
pub struct Eg {
    reachable: Reachable,
    blame: Blame,
}

impl Eg {
    /// A strategy for a space.
    pub fn new(metric: &Metric) -> Self {
        Eg { reachable: Reachable::new(metric), blame: Blame::default() }
    }
}

impl Strategy for Eg {
    fn choose(&mut self, context: &mut SearchContext<'_>, toward: &Point) -> Option<Choice> {
        let takes_part = self.blame.lottery(context);
        self.reachable.choose_where(context, toward, takes_part)
    }

    fn learn(&mut self, context: &mut SearchContext<'_>, choice: Option<Choice>, growth: Growth<'_>) {
        let node = match (growth, choice) {
            (Growth::Rooted(root, _), _) => {
                self.reachable.clear();
                self.blame.clear();
                root
            }
            (Growth::Added(node, _), _) => node,
            (Growth::Failed, Some(choice)) => return self.blame.fail(context, choice.node),
            (Growth::Failed, None) => return,
        };
        self.blame.add();
        for failed in self.reachable.add(context, node) {
            self.blame.fail(context, *failed);
        }
    }

    fn bytes(&self) -> usize {
        self.reachable.bytes() + self.blame.bytes()
    }
}
