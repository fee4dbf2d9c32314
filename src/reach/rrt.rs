//! RRT: sample, the nearest node with an untried input, one of its untried inputs.
//!
//! LaValle, *Rapidly-Exploring Random Trees: A New Tool for Path Planning*, 1998. Inputs are finitely many here, and
//! each is tried at most once at a node; a node without untried inputs is no longer looked at.

use rand::RngExt;
use rand_pcg::Pcg64;

use super::metric::{MODE_PENALTY, Metric, Point};
use super::nearest::Index;
use super::strategy::{Choice, Growth, Strategy};
use super::tree::{NodeId, Tree};

/// The plain RRT.
#[derive(Debug)]
pub struct Rrt {
    open: Index,
}

impl Rrt {
    /// A strategy for a space.
    pub fn new(metric: &Metric) -> Self {
        Rrt { open: Index::new(metric.coordinates().len(), metric.modes(), MODE_PENALTY) }
    }
}

impl Strategy for Rrt {
    fn choose(&mut self, tree: &mut Tree, toward: &Point, rng: &mut Pcg64) -> Option<Choice> {
        let node = NodeId(self.open.nearest(&toward.reals, &toward.modes)?.index as u32);
        let untried = tree.untried(node);
        if untried == 0 {
            self.open.remove(node.0 as usize);
            return None;
        }
        let nth = rng.random_range(0..untried);
        let input = tree.take_untried(node, nth);
        if untried == 1 {
            self.open.remove(node.0 as usize);
        }
        Some(Choice { node, input })
    }

    fn learn(&mut self, _tree: &Tree, _choice: Option<Choice>, growth: Growth<'_>) {
        match growth {
            Growth::Rooted(point) => {
                self.open.clear();
                self.open.push(&point.reals, &point.modes);
            }
            Growth::Added(point) => self.open.push(&point.reals, &point.modes),
            Growth::Failed => {}
        }
    }

    fn exhausted(&self, tree: &Tree) -> bool {
        tree.open_nodes() == 0
    }
}
