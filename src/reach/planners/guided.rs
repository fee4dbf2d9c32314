//! A*-guided: when the base planner extends a node, a bounded best-first search continues from it towards the same
//! sample.
//!
//! After the local planners that Tremblay, Borodovski and Verbrugge, *I Can Jump! Exploring Search Algorithms for
//! Simulating Platformer Players*, 2014, compare; Osborn, Lambrigger and Mateas name it as future work. Everything that
//! the local search visits stays in the tree. Costs and estimates are numbers of extensions: an estimate is the
//! distance to the sample divided by the average length of an extension.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use crate::ir::Extremes;
use crate::reach::metric::{MODE_PENALTY, Point};
use crate::reach::search_context::SearchContext;
use crate::reach::strategy::{Choice, Growth, Strategy};
use crate::reach::tree::NodeId;

/// Maximum number of extensions of a local search.
const MAX_EXTENSIONS: u32 = 24;

/// A strategy with a best-first search as local planner.
#[derive(Debug)]
pub struct Guided<S> {
    base: S,
    open: BinaryHeap<Ranked>,
    toward: Point,
    /// Number of extensions left for the local search.
    left: u32,
    /// Squared distance at which the sample counts as reached.
    near: f32,
    /// Average length of an extension: the sum and the number.
    extension_length: (f64, u64),
    point: Point,
}

/// A node of the local search; the greatest is the best.
#[derive(Debug, PartialEq)]
struct Ranked {
    /// Extensions so far and those still to go.
    cost: f32,
    so_far: u32,
    node: NodeId,
}

impl Eq for Ranked {}

impl Ord for Ranked {
    fn cmp(&self, other: &Self) -> Ordering {
        other.cost.total_cmp(&self.cost).then(other.node.cmp(&self.node))
    }
}

impl PartialOrd for Ranked {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl<S: Strategy> Guided<S> {
    /// Wraps a strategy.
    pub fn new(base: S) -> Self {
        Guided {
            base,
            open: BinaryHeap::new(),
            toward: Point::default(),
            left: 0,
            near: 0.0,
            extension_length: (0.0, 0),
            point: Point::default(),
        }
    }

    fn rank(&mut self, node: NodeId, so_far: u32, at: &Point) {
        let distance = self.toward.distance(at, MODE_PENALTY);
        if distance <= self.near {
            // As close as an extension can get.
            self.left = 0;
            return;
        }
        let step = (self.extension_length.0 / self.extension_length.1.max(1) as f64).greatest(1e-6) as f32;
        self.open.push(Ranked { cost: so_far as f32 + distance.sqrt() / step, so_far, node });
    }
}

impl<S: Strategy> Strategy for Guided<S> {
    fn choose(&mut self, context: &mut SearchContext<'_>, toward: &Point) -> Option<Choice> {
        while self.left > 0 {
            let Some(best) = self.open.peek() else { break };
            if let Some(choice) = context.draw_untried(best.node) {
                self.left -= 1;
                return Some(choice);
            }
            self.open.pop();
        }
        let choice = self.base.choose(context, toward)?;
        self.open.clear();
        self.left = MAX_EXTENSIONS;
        self.toward.clone_from(toward);
        context.point(choice.node, &mut self.point);
        let from = std::mem::take(&mut self.point);
        self.rank(choice.node, 0, &from);
        self.point = from;
        Some(choice)
    }

    fn learn(&mut self, context: &mut SearchContext<'_>, choice: Option<Choice>, growth: Growth<'_>) {
        match (growth, choice) {
            (Growth::Rooted(..), _) => {
                self.open.clear();
                self.left = 0;
            }
            (Growth::Added(node, point), Some(choice)) => {
                context.point(choice.node, &mut self.point);
                let extension_length = self.point.distance(point, MODE_PENALTY);
                self.extension_length.0 += f64::from(extension_length.sqrt());
                self.extension_length.1 += 1;
                self.near = extension_length / 4.0;
                let so_far = self.open.peek().map_or(0, |best| best.so_far) + 1;
                if self.left > 0 {
                    self.rank(node, so_far, point);
                }
            }
            _ => {}
        }
        self.base.learn(context, choice, growth);
    }

    fn bytes(&self) -> usize {
        self.base.bytes() + self.open.capacity() * size_of::<Ranked>()
    }
}
