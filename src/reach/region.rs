//! The goal region: boxes of coordinates derived from the goal's predicate, from which some samples are drawn to bias
//! the tree towards the goal.

use rand::{Rng, RngExt};

use crate::ir::{CompareOp, Entity, Expr, ExprId, Extremes, SlotId, Subject, TagSet, TouchId, VarId};

use super::goal_positions::{extent, overlapping, static_boxes};
use super::metric::{MODE_PENALTY, Metric, Point, Quantity};
use super::problem::Problem;

/// Maximum number of boxes per goal.
const MAX_BOXES: usize = 256;

/// One box: scaled ranges of some coordinates, and values of some modes.
#[derive(Debug, Clone, Default, PartialEq)]
struct Region {
    reals: Vec<(usize, f32, f32)>,
    modes: Vec<(usize, f32)>,
}

/// The boxes of a goal; empty if its predicate cannot be sampled.
#[derive(Debug, Clone, Default)]
pub(super) struct GoalRegion {
    boxes: Vec<Region>,
}

impl GoalRegion {
    /// The boxes of the problem's goal.
    pub fn new(problem: &Problem<'_>, metric: &Metric) -> Self {
        let finder = Finder { problem, metric };
        let mut boxes = finder.boxes(problem.predicate());
        boxes.retain(|b| *b != Region::default());
        GoalRegion { boxes }
    }

    /// The squared distance of a point to the nearest box; 0 if there is none.
    pub fn distance(&self, point: &Point) -> f32 {
        let to = |region: &Region| {
            let reals = region.reals.iter().map(|&(index, low, high)| {
                let out = (low - point.reals[index]).greatest(point.reals[index] - high).greatest(0.0);
                out * out
            });
            let modes = region.modes.iter().map(|&(i, mode)| if point.modes[i] == mode { 0.0 } else { MODE_PENALTY });
            reals.chain(modes).sum::<f32>()
        };
        self.boxes.iter().map(to).reduce(f32::least).unwrap_or(0.0)
    }

    /// Moves a sample into a random box, if there is one.
    pub fn pull(&self, rng: &mut impl Rng, sample: &mut Point) {
        if self.boxes.is_empty() {
            return;
        }
        let region = &self.boxes[rng.random_range(0..self.boxes.len())];
        for &(index, low, high) in &region.reals {
            sample.reals[index] = if low < high { rng.random_range(low..high) } else { low };
        }
        for &(index, mode) in &region.modes {
            sample.modes[index] = mode;
        }
    }
}

struct Finder<'a> {
    problem: &'a Problem<'a>,
    metric: &'a Metric,
}

impl Finder<'_> {
    /// Boxes whose union approximates the set where an expression holds; unsupported expressions are unrestricted.
    fn boxes(&self, id: ExprId) -> Vec<Region> {
        let anything = || vec![Region::default()];
        match self.problem.sim.program().exprs[id] {
            Expr::Bool(false) => Vec::new(),
            Expr::And(a, b) => {
                let (a, b) = (self.boxes(a), self.boxes(b));
                let mut both = Vec::new();
                for a in &a {
                    for b in &b {
                        if both.len() < MAX_BOXES {
                            let mut region = a.clone();
                            region.reals.extend(&b.reals);
                            region.modes.extend(&b.modes);
                            both.push(region);
                        }
                    }
                }
                both
            }
            Expr::Or(a, b) => {
                let mut either = self.boxes(a);
                either.extend(self.boxes(b));
                either.truncate(MAX_BOXES);
                either
            }
            Expr::Near { of: Subject::Slot(slot), x, y, radius } => {
                let (Some(x), Some(y), Some(r)) = (self.constant(x), self.constant(y), self.constant(radius)) else {
                    return anything();
                };
                // The square inscribed in the circle.
                let r = r.greatest(0.0) / std::f64::consts::SQRT_2;
                vec![self.position_box(slot, (x - r, x + r), (y - r, y + r))]
            }
            Expr::Compare(op, a, b) => vec![self.comparison(op, a, b).unwrap_or_default()],
            Expr::InMode(Subject::Slot(slot), mode) => {
                let world = self.problem.sim.world();
                let mode = &self.problem.sim.program().entities[world.slots[slot].entity].modes[mode];
                let Some(index) = self.metric.mode_index(slot, mode.group) else {
                    return anything();
                };
                let leaves = mode.leaves.ids().take(MAX_BOXES);
                leaves.map(|leaf| Region { reals: Vec::new(), modes: vec![(index, leaf.0 as f32)] }).collect()
            }
            Expr::Touching(Subject::Slot(slot), touch) => {
                let boxes = self.touching(slot, touch);
                if boxes.is_empty() { anything() } else { boxes }
            }
            _ => anything(),
        }
    }

    fn constant(&self, id: ExprId) -> Option<f64> {
        let none = crate::ir::IdVec::new();
        self.problem.sim.program().constant(id, &none, self.problem.sim.world().step)
    }

    fn range(&self, quantity: Quantity, low: f64, high: f64) -> Option<(usize, f32, f32)> {
        let index = self.metric.coordinates().iter().position(|c| c.quantity == quantity)?;
        let c = &self.metric.coordinates()[index];
        Some((
            index,
            c.scaled(low.greatest(c.low).least(c.high.greatest(low))),
            c.scaled(high.least(c.high).greatest(c.low.least(high))),
        ))
    }

    fn position_box(&self, slot: SlotId, x: (f64, f64), y: (f64, f64)) -> Region {
        let axes = [(VarId::X, x), (VarId::Y, y)];
        let ranges = axes.iter().filter_map(|(var, (low, high))| self.range(Quantity::Var(slot, *var, 0), *low, *high));
        Region { reals: ranges.collect(), modes: Vec::new() }
    }

    fn comparison(&self, op: CompareOp, a: ExprId, b: ExprId) -> Option<Region> {
        let exprs = &self.problem.sim.program().exprs;
        let quantity = |id: ExprId| match exprs[id] {
            Expr::Var(Subject::Slot(slot), var, degree) => Some(Quantity::Var(slot, var, degree)),
            Expr::Discrete(Subject::Slot(slot), discrete) => Some(Quantity::Discrete(slot, discrete)),
            _ => None,
        };
        let (quantity, value, above) = match (quantity(a), self.constant(b), quantity(b), self.constant(a)) {
            (Some(q), Some(v), ..) => (q, v, matches!(op, CompareOp::Greater | CompareOp::AtLeast)),
            (_, _, Some(q), Some(v)) => (q, v, matches!(op, CompareOp::Less | CompareOp::AtMost)),
            _ => return None,
        };
        let c = self.metric.coordinates().iter().find(|c| c.quantity == quantity)?;
        let range = match op {
            CompareOp::Equal => self.range(quantity, value, value),
            CompareOp::Unequal => None,
            _ if above => self.range(quantity, value, c.high.greatest(value)),
            _ => self.range(quantity, c.low.least(value), value),
        };
        Some(Region { reals: vec![range?], modes: Vec::new() })
    }

    /// The positions at which a collider of the slot overlaps a tile or a rectangle with the tag.
    fn touching(&self, slot: SlotId, touch: TouchId) -> Vec<Region> {
        let (program, world) = (self.problem.sim.program(), self.problem.sim.world());
        let s = &world.slots[slot];
        let entity: &Entity = &program.entities[s.entity];
        let touch = entity.touches[touch];
        let wanted = TagSet::of(touch.other);
        let mut boxes = Vec::new();
        for collider in entity.colliders.iter().filter(|c| touch.mine.meets(c.tags)) {
            let Some(mine) = extent(self.problem, slot, collider) else { continue };
            let targets = static_boxes(&world.spaces[s.space], wanted, MAX_BOXES).take(MAX_BOXES);
            boxes.extend(targets.map(|target| {
                let [x, y] = overlapping(&mine, &target);
                self.position_box(slot, x, y)
            }));
        }
        boxes.truncate(MAX_BOXES);
        boxes
    }
}
