//! Coverage-guided: extends nodes in sparsely covered cells, without nearest-neighbour queries.
//!
//! After KPIECE, Şucan and Kavraki, *Kinodynamic Motion Planning by Interior-Exterior Cell Exploration*, 2009, and EST,
//! Hsu, Latombe and Motwani, *Path Planning in Expansive Configuration Spaces*, 1997. From KPIECE it takes the levels
//! of cells over a projection and the importance of a cell; from EST, that fuller cells count less. Where KPIECE sorts
//! its cells, here a few are drawn and the most important is taken, so no order has to be maintained.
//!
//! The projections follow from the analysis and from observation. The first level holds what changes rarely: modes,
//! spawned instances and counters that few extensions change show progress (a door is open, a key is held). The second
//! is the position of the players, the third everything else that varies.

use crate::reach::coverage::mix;
use crate::reach::metric::{Metric, Point, Projected};
use crate::reach::search_context::SearchContext;
use crate::reach::strategy::{Choice, Growth, Strategy};
use crate::reach::tree::NodeId;
use crate::reach::why_not::Margins;

use super::cells::Cells;

/// The levels of cells.
const LEVELS: usize = 3;
/// A variable changes rarely if fewer than one extension in this number changes it.
const RARE_ONE_IN: u64 = 40;
/// Number of extensions before the first update of the levels; then at each doubling.
const FIRST_UPDATE: u64 = 256;

/// A coordinate or a mode, and its cells.
#[derive(Debug, Clone, Copy)]
struct Axis {
    level: usize,
    /// Cells per unit of distance, and the offset of the first; `None` for a mode: each value is a cell.
    cells: Option<(f32, f32)>,
    /// Whether it can show progress: then it is on the first level if it changes rarely, else on `otherwise`.
    counts: bool,
    otherwise: usize,
    /// Number of extensions that changed it.
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

/// A strategy that extends sparsely covered cells.
#[derive(Debug)]
pub struct CoverageGuided<'m> {
    /// The coordinates, then the modes.
    axes: Vec<Axis>,
    /// What the goal asks of numbers: on the last level.
    margins: &'m Margins,
    extensions: u64,
    next_update: u64,
    cells: Cells,
    before: Point,
    state: Vec<u8>,
    /// Whether the last node was the first in its cell of the first level.
    has_opened: bool,
}

impl<'m> CoverageGuided<'m> {
    /// A strategy for a space, and what the goal asks of numbers.
    pub fn new(metric: &Metric, margins: &'m Margins) -> Self {
        let axis = |(level, cells, counts): Projected| Axis {
            level: if counts { 0 } else { level },
            cells,
            counts,
            otherwise: level,
            changes: 0,
        };
        CoverageGuided {
            axes: metric.projection().into_iter().map(axis).collect(),
            margins,
            extensions: 0,
            next_update: FIRST_UPDATE,
            cells: Cells::default(),
            before: Point::default(),
            state: Vec::new(),
            has_opened: false,
        }
    }

    /// Whether the last node was the first with its values of what seldom changes.
    pub fn has_opened(&self) -> bool {
        self.has_opened
    }

    /// Forgets a node without untried inputs.
    pub fn close(&mut self, node: NodeId) {
        self.cells.remove(node);
    }

    /// Counts the changes of an extension.
    fn compare(&mut self, context: &mut SearchContext<'_>, from: NodeId, point: &Point) {
        context.point(from, &mut self.before);
        for (index, axis) in self.axes.iter_mut().enumerate() {
            axis.changes += u64::from(axis.counts && self.before.value(index) != point.value(index));
        }
        self.extensions += 1;
    }

    /// Updates the levels, and sorts all nodes into cells again if they changed.
    fn update_levels(&mut self, context: &mut SearchContext<'_>) {
        self.next_update = self.extensions * 2;
        let mut has_changed = false;
        for axis in &mut self.axes {
            let is_rare = axis.changes * RARE_ONE_IN < self.extensions;
            let level = if axis.counts && is_rare { 0 } else { axis.otherwise };
            has_changed |= level != axis.level;
            axis.level = level;
        }
        if !has_changed {
            return;
        }
        self.cells.clear();
        let mut point = Point::default();
        for node in (0..context.tree.len()).map(|n| NodeId(n as u32)) {
            if context.tree.untried(node) > 0 {
                context.point(node, &mut point);
                let mut buffer = std::mem::take(&mut self.state);
                let keys = self.keys(context, context.tree.state(node, &mut buffer), &point);
                self.state = buffer;
                self.cells.add(node, &keys);
            }
        }
    }

    fn keys(&self, context: &SearchContext<'_>, state: &[u8], point: &Point) -> [u64; LEVELS] {
        let mut keys = [0; LEVELS];
        let mut key = 0;
        for (level, out) in keys.iter_mut().enumerate() {
            key = mix(key, level as u64);
            for (index, axis) in self.axes.iter().enumerate() {
                if axis.level == level {
                    key = mix(key, axis.cell(point.value(index)));
                }
            }
            *out = key;
        }
        if !self.margins.is_empty() {
            keys[LEVELS - 1] = self.margins.key(context.problem.sim, state, key);
        }
        keys
    }
}

impl Strategy for CoverageGuided<'_> {
    fn choose(&mut self, context: &mut SearchContext<'_>, _toward: &Point) -> Option<Choice> {
        let mut cell = self.cells.draw(context, self.cells.first())?;
        self.cells.choose(cell);
        for _ in 1..LEVELS {
            cell = self.cells.draw(context, self.cells.inside(cell))?;
            self.cells.choose(cell);
        }
        let node = self.cells.draw_node(context, cell);
        let choice = context.draw_untried_holding(node);
        if context.tree.untried(node) == 0 {
            self.cells.remove(node);
        }
        choice
    }

    fn learn(&mut self, context: &mut SearchContext<'_>, choice: Option<Choice>, growth: Growth<'_>) {
        match (growth, choice) {
            (Growth::Rooted(root, point), _) => {
                self.cells.clear();
                self.cells.add(root, &self.keys(context, context.reached(), point));
            }
            (Growth::Known(_, point), Some(choice)) => self.compare(context, choice.node, point),
            (Growth::Added(node, point), Some(choice)) => {
                self.compare(context, choice.node, point);
                let (first, _) = self.cells.add(node, &self.keys(context, context.reached(), point));
                self.has_opened = self.cells.held(first) == 1;
                if self.extensions >= self.next_update {
                    self.update_levels(context);
                }
            }
            _ => {}
        }
    }

    fn bytes(&self) -> usize {
        self.cells.bytes()
    }
}
