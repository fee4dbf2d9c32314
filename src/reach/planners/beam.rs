//! A beam through time: of the states that are reached at each time, only the nearest to the goal are extended, in all ways.
//!
//! The beam search of Lowerre, *The HARPY Speech Recognition System*, 1976, over cells (`player_cells.rs`): a state is as
//! near as it will be after one more extension at the pace of the last one, and of several states in one cell the first is
//! kept. Each tree is wider than the one before, so that the first ways cost little and later ones are nearly the fastest.

use hashbrown::HashMap;

use crate::ir::Extremes;
use crate::reach::coverage::PLACE;
use crate::reach::distance::DistanceField;
use crate::reach::metric::{Metric, Point};
use crate::reach::problem::Problem;
use crate::reach::search_context::SearchContext;
use crate::reach::strategy::{Choice, Growth, Strategy};
use crate::reach::tree::NodeId;

use super::Guidance;
use super::player_cells::PlayerCells;

/// The number of states of a time that are extended in the first tree; it grows by half with each tree.
const WIDTH: usize = 8;
/// Maximum width.
const WIDEST: usize = 1 << 16;
/// The least number of places that the states of a time are in, if there are as many: the nearest ones may be stuck.
const PLACES: usize = 16;
/// After so many times, a cell may be entered again: who waits for a platform stays where he is.
const FORGETS: u32 = 4;
/// After so many times in which none comes nearer to the goal, a wider tree begins: where cells are entered again, no tree
/// ends by itself.
const STUCK: u32 = 64;
/// The holds of the trees, in turns, steps.
const HOLDS: [u16; 3] = [8, 12, 6];
/// The side of a cell, px, and the number of cells for the range of velocities.
const CELL: f64 = PLACE / 2.0;
const VELOCITIES: f64 = 16.0;

/// A state that may be extended.
#[derive(Debug, Clone, Copy)]
struct Candidate {
    node: NodeId,
    /// The key of its place.
    place: u64,
    /// Its distance to the goal, and the one that is expected after the next extension, places.
    distance: f64,
    expected: f64,
}

/// A strategy that extends the nearest states of each time.
#[derive(Debug)]
pub(super) struct Beam<'m> {
    distances: Option<&'m DistanceField>,
    players: PlayerCells<'m>,
    /// The number of trees so far, and of the last ones that had nothing left to extend.
    trees: u32,
    whole: u32,
    /// The number of times so far.
    layers: u32,
    /// The least distance in the tree, places, and the number of times since it was reached.
    nearest: (f64, u32),
    width: usize,
    /// Whether a layer had more states than were extended.
    is_cut: bool,
    /// What is extended, with its number of states that are done, and what it has led to.
    layer: Vec<Candidate>,
    done: usize,
    next: Vec<Candidate>,
    /// The least depth in each cell, lately.
    soonest: HashMap<u64, u32>,
    /// The number of states of the layer in each place.
    in_place: HashMap<u64, usize>,
}

impl<'m> Beam<'m> {
    /// A strategy for a problem, with what leads to its goal.
    pub fn new(problem: &Problem<'_>, metric: &Metric, guidance: Guidance<'m>) -> Self {
        Beam {
            distances: guidance.distances,
            players: PlayerCells::new(problem, metric, guidance, VELOCITIES),
            trees: 0,
            whole: 0,
            layers: 0,
            nearest: (f64::INFINITY, 0),
            width: WIDTH,
            is_cut: false,
            layer: Vec::new(),
            done: 0,
            next: Vec::new(),
            soonest: HashMap::default(),
            in_place: HashMap::default(),
        }
    }

    fn begin(&mut self) {
        if self.trees > 0 {
            self.whole = if self.is_cut { 0 } else { self.whole + 1 };
            self.width = (self.width + self.width / 2).min(WIDEST);
        }
        self.trees += 1;
        self.is_cut = false;
        self.nearest = (f64::INFINITY, 0);
        self.done = 0;
        self.layer.clear();
        self.next.clear();
        self.soonest.clear();
    }

    fn add(&mut self, context: &SearchContext<'_>, node: NodeId, point: &Point, from: Option<f64>) {
        let [place, key] = self.players.keys(context, point, CELL);
        let depth = context.tree.depth(node);
        let soonest = self.soonest.entry(key).or_insert(u32::MAX);
        if depth >= *soonest {
            return;
        }
        *soonest = depth;
        let distance = self.distances.map_or(0.0, |distances| distances.fine(context.problem.sim, context.reached()));
        let expected = from.map_or(distance, |from| distance + (distance - from));
        self.next.push(Candidate { node, place, distance, expected });
    }

    /// Goes on to the nearest of the states that the last ones led to.
    fn advance(&mut self) {
        self.layer.clear();
        self.done = 0;
        std::mem::swap(&mut self.layer, &mut self.next);
        let count = self.layer.len();
        self.layer.sort_by(|a, b| a.expected.total_cmp(&b.expected));
        let most = (self.width / PLACES).max(1);
        self.in_place.clear();
        self.layer.retain(|candidate| {
            let count = self.in_place.entry(candidate.place).or_insert(0);
            *count += 1;
            *count <= most
        });
        self.layer.truncate(self.width);
        self.is_cut |= self.layer.len() < count;
        let distance = self.layer.iter().map(|candidate| candidate.distance).fold(f64::INFINITY, f64::least);
        self.nearest = if distance < self.nearest.0 { (distance, 0) } else { (self.nearest.0, self.nearest.1 + 1) };
        self.is_cut |= self.is_stuck();
        self.layers += 1;
        if self.layers.is_multiple_of(FORGETS) {
            self.soonest.clear();
        }
    }

    fn is_stuck(&self) -> bool {
        self.nearest.1 >= STUCK
    }

    fn hold(&self, context: &SearchContext<'_>) -> u16 {
        let hold = HOLDS[self.trees.saturating_sub(1) as usize % HOLDS.len()];
        hold.clamp(context.hold.0, context.hold.1)
    }
}

impl Strategy for Beam<'_> {
    fn choose(&mut self, context: &mut SearchContext<'_>, _toward: &Point) -> Option<Choice> {
        if self.done == self.layer.len() {
            self.advance();
        }
        while let Some(candidate) = self.layer.get(self.done) {
            if let Some(choice) = context.draw_untried_holding(candidate.node) {
                return Some(Choice { hold: self.hold(context), ..choice });
            }
            self.done += 1;
        }
        None
    }

    fn learn(&mut self, context: &mut SearchContext<'_>, choice: Option<Choice>, growth: Growth<'_>) {
        match growth {
            Growth::Rooted(root, point) => {
                self.begin();
                self.add(context, root, point, None);
            }
            Growth::Added(node, point) => {
                let from = self.layer.get(self.done).filter(|_| choice.is_some()).map(|from| from.distance);
                self.add(context, node, point, from);
            }
            Growth::Failed => {}
        }
    }

    fn is_over(&self) -> bool {
        self.done == self.layer.len() && (self.next.is_empty() || self.is_stuck())
    }

    fn is_spent(&self) -> bool {
        // Each hold was tried with states of all cells.
        self.whole > HOLDS.len() as u32
    }

    fn bytes(&self) -> usize {
        self.soonest.capacity() * 16
            + self.in_place.capacity() * 24
            + (self.layer.capacity() + self.next.capacity()) * size_of::<Candidate>()
    }
}
