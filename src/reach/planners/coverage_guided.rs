//! Coverage-guided: grows what little is covered, without asking for neighbours.
//!
//! After KPIECE, Şucan and Kavraki, *Kinodynamic Motion Planning by Interior-Exterior Cell Exploration*, 2009, and EST, Hsu,
//! Latombe and Motwani, *Path Planning in Expansive Configuration Spaces*, 1997. From KPIECE it has the levels of cells over
//! a projection and the importance of a cell; from EST that a cell counts the less, the more it holds. Where KPIECE sorts
//! its cells, a few are drawn here and the most important of them is taken; that needs no order to be kept.
//!
//! The projections follow from the analysis and from what is seen. The first is what seldom changes: modes, spawned
//! instances and counts that few extensions change are what has been achieved (a door is open, a key is held). The second
//! is where the players are, the third everything else that varies.

use crate::reach::coverage::mixed;
use crate::reach::metric::{Metric, Point, Projected};
use crate::reach::search_context::SearchContext;
use crate::reach::strategy::{Choice, Growth, Strategy};
use crate::reach::tree::NodeId;

use super::cells::Cells;

/// The levels of cells.
const LEVELS: usize = 3;
/// What seldom changes is changed by fewer than one extension in so many.
const SELDOM: u64 = 40;
/// The number of extensions after which it is first looked at what seldom changes; then at each doubling.
const FIRST_LOOK: u64 = 256;

/// A coordinate or a mode, and the cells that it makes.
#[derive(Debug, Clone, Copy)]
struct Axis {
    level: usize,
    /// Cells along a distance of 1, and where the first one begins; of a mode each value is a cell.
    cells: Option<(f32, f32)>,
    /// Whether it can be something that is achieved: the level it has if it seldom changes, and the other.
    counts: bool,
    otherwise: usize,
    /// How many extensions changed it.
    changes: u64,
}

impl Axis {
    fn cell(&self, value: f32) -> u64 {
        match self.cells {
            Some((scale, offset)) => ((value - offset) * scale).floor() as i64 as u64,
            None => u64::from(value.to_bits()),
        }
    }
}

/// Grows where little is covered.
#[derive(Debug)]
pub struct CoverageGuided {
    /// The coordinates, then the modes.
    axes: Vec<Axis>,
    extensions: u64,
    next_look: u64,
    cells: Cells,
    before: Point,
}

impl CoverageGuided {
    /// A strategy for a space.
    pub fn new(metric: &Metric) -> Self {
        let axis = |(level, cells, counts): Projected| Axis {
            level: if counts { 0 } else { level },
            cells,
            counts,
            otherwise: level,
            changes: 0,
        };
        CoverageGuided {
            axes: metric.projection().into_iter().map(axis).collect(),
            extensions: 0,
            next_look: FIRST_LOOK,
            cells: Cells::default(),
            before: Point::default(),
        }
    }

    /// Notes what an extension changed.
    fn compare(&mut self, context: &SearchContext<'_>, from: NodeId, point: &Point) {
        context.point(from, &mut self.before);
        let before = self.before.reals.iter().chain(&self.before.modes);
        for ((axis, before), after) in self.axes.iter_mut().zip(before).zip(point.reals.iter().chain(&point.modes)) {
            axis.changes += u64::from(axis.counts && before != after);
        }
        self.extensions += 1;
    }

    /// Tells anew what seldom changes, and sorts all nodes accordingly.
    fn look(&mut self, context: &SearchContext<'_>) {
        self.next_look = self.extensions * 2;
        let mut is_other = false;
        for axis in &mut self.axes {
            let seldom = axis.changes * SELDOM < self.extensions;
            let level = if axis.counts && seldom { 0 } else { axis.otherwise };
            is_other |= level != axis.level;
            axis.level = level;
        }
        if !is_other {
            return;
        }
        self.cells.clear();
        let mut point = Point::default();
        for node in (0..context.tree.len()).map(|n| NodeId(n as u32)) {
            if context.tree.untried(node) > 0 {
                context.point(node, &mut point);
                self.cells.add(node, &self.keys(&point));
            }
        }
    }

    fn keys(&self, point: &Point) -> [u64; LEVELS] {
        let mut keys = [0; LEVELS];
        let mut key = 0;
        for (level, out) in keys.iter_mut().enumerate() {
            key = mixed(key, level as u64);
            for (axis, value) in self.axes.iter().zip(point.reals.iter().chain(&point.modes)) {
                if axis.level == level {
                    key = mixed(key, axis.cell(*value));
                }
            }
            *out = key;
        }
        keys
    }
}

impl Strategy for CoverageGuided {
    fn choose(&mut self, context: &mut SearchContext<'_>, _toward: &Point) -> Option<Choice> {
        let mut cell = self.cells.draw(context, self.cells.first())?;
        self.cells.choose(cell);
        for _ in 1..LEVELS {
            cell = self.cells.draw(context, self.cells.inside(cell))?;
            self.cells.choose(cell);
        }
        let node = self.cells.draw_node(context, cell);
        let choice = context.draw_untried(node);
        if context.tree.untried(node) == 0 {
            self.cells.remove(node);
        }
        choice
    }

    fn learn(&mut self, context: &mut SearchContext<'_>, choice: Option<Choice>, growth: Growth<'_>) {
        match (growth, choice) {
            (Growth::Rooted(root, point), _) => {
                self.cells.clear();
                self.cells.add(root, &self.keys(point));
            }
            (Growth::Added(node, point), Some(choice)) => {
                self.compare(context, choice.node, point);
                self.cells.add(node, &self.keys(point));
                if self.extensions >= self.next_look {
                    self.look(context);
                }
            }
            _ => {}
        }
    }

    fn bytes(&self) -> usize {
        self.cells.bytes()
    }
}
