//! RRT+: samples are biased towards the goal or towards the edge of the covered region, with weights that adapt to the
//! growth of the tree.
//!
//! Kim and Esposito, *Adaptive Sample Bias for Rapidly-Exploring Random Trees with Applications to Test Generation*,
//! 2005. As there, uniform and biased distributions are mixed, and the weight moves towards the one under which the
//! tree grows faster. Here growth is the number of new cells of a grid over the sampled space, instead of a dispersion,
//! and there are two biased distributions: the goal's region, and uncovered cells beside covered ones. (The planner
//! called RRT+ in the 2017 system is a plain RRT.)

use hashbrown::HashTable;
use rand::RngExt;

use crate::ir::Extremes;
use crate::reach::coverage::mix;
use crate::reach::metric::{Metric, Point};
use crate::reach::region::GoalRegion;
use crate::reach::search_context::SearchContext;
use crate::reach::strategy::{Choice, Growth, Strategy};

use super::rrt::Rrt;

/// Cells along each coordinate's unit.
const CELLS: f32 = 32.0;
/// Decay of the yields per extension.
const MEMORY: f32 = 0.99;
/// Minimum share of each distribution.
const MIN_SHARE: f32 = 0.05;
/// Maximum number of attempts to find an uncovered neighbour.
const MAX_ATTEMPTS: usize = 4;

/// Where a sample came from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Source {
    Uniform,
    Goal,
    Edge,
}

const SOURCES: [Source; 3] = [Source::Uniform, Source::Goal, Source::Edge];

/// RRT with adaptive sample bias.
#[derive(Debug)]
pub struct Adaptive {
    rrt: Rrt,
    cells: HashTable<u64>,
    /// For each source: recent new cells and extensions.
    yields: [(f32, f32); 3],
    source: Source,
    point: Point,
}

impl Adaptive {
    /// A strategy for a space.
    pub fn new(metric: &Metric) -> Self {
        Adaptive {
            rrt: Rrt::new(metric),
            cells: HashTable::new(),
            yields: [(1.0, 1.0); 3],
            source: Source::Uniform,
            point: Point::default(),
        }
    }

    /// The weight of each source.
    fn weights(&self) -> [f32; 3] {
        let rates = self.yields.map(|(new, all)| new / all.greatest(1e-3));
        let sum: f32 = rates.iter().sum::<f32>().greatest(1e-6);
        rates.map(|rate| MIN_SHARE + (1.0 - 3.0 * MIN_SHARE) * rate / sum)
    }

    fn is_covered(&self, cell: u64) -> bool {
        self.cells.find(cell, |known| *known == cell).is_some()
    }

    /// Moves the sample into an uncovered cell beside a covered one; returns false if none was found.
    fn beside(&mut self, context: &mut SearchContext<'_>, toward: &mut Point) -> bool {
        for _ in 0..MAX_ATTEMPTS {
            let node = context.draw_node();
            context.point(node, &mut self.point);
            if self.point.reals.is_empty() {
                return false;
            }
            let at = context.rng.random_range(0..self.point.reals.len());
            self.point.reals[at] += if context.rng.random_bool(0.5) { 1.0 / CELLS } else { -1.0 / CELLS };
            if !self.is_covered(cell(&self.point)) {
                toward.clone_from(&self.point);
                return true;
            }
        }
        false
    }
}

impl Strategy for Adaptive {
    fn aim(&mut self, context: &mut SearchContext<'_>, goal: &GoalRegion, toward: &mut Point) -> bool {
        let weights = self.weights();
        let mut drawn = context.rng.random::<f32>();
        self.source = Source::Uniform;
        for (source, weight) in SOURCES.into_iter().zip(weights) {
            if drawn < weight {
                self.source = source;
                break;
            }
            drawn -= weight;
        }
        match self.source {
            Source::Goal => goal.pull(&mut context.rng, toward),
            Source::Edge => {
                if !self.beside(context, toward) {
                    self.source = Source::Uniform;
                }
            }
            Source::Uniform => {}
        }
        true
    }

    fn choose(&mut self, context: &mut SearchContext<'_>, toward: &Point) -> Option<Choice> {
        self.rrt.choose(context, toward)
    }

    fn learn(&mut self, context: &mut SearchContext<'_>, choice: Option<Choice>, growth: Growth<'_>) {
        let is_new = match growth {
            Growth::Rooted(_, point) | Growth::Added(_, point) => {
                if matches!(growth, Growth::Rooted(..)) {
                    self.cells.clear();
                }
                let cell = cell(point);
                let is_new = !self.is_covered(cell);
                if is_new {
                    self.cells.insert_unique(cell, cell, |known| *known);
                }
                is_new
            }
            Growth::Failed | Growth::Late | Growth::Known(..) => false,
        };
        if choice.is_some() {
            let (new, all) = &mut self.yields[self.source as usize];
            *new = *new * MEMORY + f32::from(is_new);
            *all = *all * MEMORY + 1.0;
        }
        self.rrt.learn(context, choice, growth);
    }

    fn bytes(&self) -> usize {
        self.rrt.bytes() + self.cells.capacity() * 9
    }
}

/// The cell of a point.
fn cell(point: &Point) -> u64 {
    let reals = point.reals.iter().map(|x| (x * CELLS).floor() as i64 as u64);
    reals.chain(point.modes.iter().map(|m| u64::from(m.to_bits()))).fold(0, mix)
}
