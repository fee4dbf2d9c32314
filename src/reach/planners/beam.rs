//! A beam through time: of the states that are reached at each time, only the nearest to the goal are extended, in all ways.
//!
//! The beam search of Lowerre, *The HARPY Speech Recognition System*, 1976, over cells (`player_cells.rs`): a state is as
//! near as it will be after one more extension at the pace of the last one, and of several states in one cell the first is
//! kept. Where all ways end, it goes back to states that it passed over, further each time, as in Furcy and Koenig, *Limited
//! Discrepancy Beam Search*, 2005; those that seem to be in dead ends (`dead_ends.rs`) come last. Each tree is wider than the
//! one before, so that the first ways cost little and later ones are nearly the fastest.

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
use super::dead_ends::DeadEnds;
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
/// The number of times that it goes back the first time that none is left, and how often in a row without coming nearer, each
/// time twice as far.
const BACK: usize = 4;
const RETURNS: u32 = 5;
/// As many times the states that are extended are kept to go back to.
const RESERVE: usize = 4;
/// The holds of the trees, in turns, steps.
const HOLDS: [u16; 3] = [8, 12, 6];
/// The side of a cell, px, and the number of cells for the range of velocities.
const CELL: f64 = PLACE / 2.0;
const VELOCITIES: f64 = 16.0;
/// The same for the kinds of states that dead ends are learned of.
const KIND: f64 = PLACE;
const KIND_VELOCITIES: f64 = 6.0;

/// A state that may be extended.
#[derive(Debug, Clone, Copy)]
struct Candidate {
    node: NodeId,
    /// The key of its place.
    place: u64,
    /// Its distance to the goal, and the one that is expected after the next extension, places.
    distance: f64,
    expected: f64,
    /// Its number among the states of the tree, and its kind.
    state: u32,
    kind: u64,
}

/// A strategy that extends the nearest states of each time.
#[derive(Debug)]
pub(super) struct Beam<'m> {
    distances: Option<&'m DistanceField>,
    players: PlayerCells<'m>,
    /// The kinds of states, coarser than cells, and which of them are dead ends.
    kinds: PlayerCells<'m>,
    dead_ends: DeadEnds,
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
    /// For each layer so far, the nearest of the states that were not extended.
    reserve: Vec<Vec<Candidate>>,
    /// How often in a row it went back without coming nearer since, and the least distance then.
    returns: u32,
    before: f64,
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
            kinds: PlayerCells::new(problem, metric, guidance, KIND_VELOCITIES),
            dead_ends: DeadEnds::default(),
            trees: 0,
            whole: 0,
            layers: 0,
            nearest: (f64::INFINITY, 0),
            width: WIDTH,
            is_cut: false,
            layer: Vec::new(),
            done: 0,
            next: Vec::new(),
            reserve: Vec::new(),
            returns: 0,
            before: f64::INFINITY,
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
        self.dead_ends.end_tree();
        self.reserve.clear();
        (self.returns, self.before) = (0, f64::INFINITY);
        self.is_cut = false;
        self.nearest = (f64::INFINITY, 0);
        self.done = 0;
        self.layer.clear();
        self.next.clear();
        self.soonest.clear();
    }

    fn add(&mut self, context: &SearchContext<'_>, node: NodeId, point: &Point, from: Option<Candidate>) {
        let [place, key] = self.players.keys(context, point, CELL);
        let depth = context.tree.depth(node);
        let soonest = self.soonest.entry(key).or_insert(u32::MAX);
        if depth >= *soonest {
            if let Some(from) = from {
                self.dead_ends.leave(from.state);
            }
            return;
        }
        *soonest = depth;
        let [_, kind] = self.kinds.keys(context, point, KIND);
        let distance = self.distances.map_or(0.0, |distances| distances.fine(context.problem.sim, context.reached()));
        let expected = from.map_or(distance, |from| distance + (distance - from.distance));
        let state = self.dead_ends.add(from.map(|from| from.state), kind);
        self.next.push(Candidate { node, place, distance, expected, state, kind });
    }

    /// Goes on to the nearest of the states that the last ones led to.
    fn advance(&mut self) {
        self.layer.clear();
        self.done = 0;
        std::mem::swap(&mut self.layer, &mut self.next);
        let count = self.layer.len();
        self.layer.sort_by(|a, b| a.expected.total_cmp(&b.expected));
        self.layer.sort_by_cached_key(|candidate| self.dead_ends.is_dead(candidate.kind));
        let most = (self.width / PLACES).max(1);
        self.in_place.clear();
        let mut left = Vec::new();
        let (width, mut kept) = (self.width, 0);
        self.layer.retain(|candidate| {
            let count = self.in_place.entry(candidate.place).or_insert(0);
            *count += 1;
            let is_kept = kept < width && *count <= most;
            kept += usize::from(is_kept);
            if !is_kept && left.len() < width * RESERVE {
                left.push(*candidate);
            }
            is_kept
        });
        self.reserve.push(left);
        self.is_cut |= self.layer.len() < count;
        let distance = self.layer.iter().map(|candidate| candidate.distance).fold(f64::INFINITY, f64::least);
        self.nearest = if distance < self.nearest.0 { (distance, 0) } else { (self.nearest.0, self.nearest.1 + 1) };
        self.is_cut |= self.is_stuck();
        self.layers += 1;
        if self.layers.is_multiple_of(FORGETS) {
            self.soonest.clear();
        }
    }

    /// How often in a row it has gone back without coming nearer.
    fn vain_returns(&self) -> u32 {
        if self.nearest.0 < self.before { 0 } else { self.returns }
    }

    /// Whether it can go back to states that were not extended.
    fn can_return(&self) -> bool {
        self.vain_returns() < RETURNS && !self.reserve.is_empty()
    }

    /// Goes back, each time further as long as none comes nearer.
    fn go_back(&mut self) {
        self.dead_ends.learn();
        let returns = self.vain_returns();
        self.reserve.truncate(self.reserve.len().saturating_sub(BACK << returns).max(1));
        (self.returns, self.before) = (returns + 1, self.nearest.0);
        self.nearest.1 = 0;
        self.soonest.clear();
        while self.next.is_empty()
            && let Some(mut layer) = self.reserve.pop()
        {
            layer.retain(|candidate| !self.dead_ends.is_dead(candidate.kind));
            self.next = layer;
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
            if self.next.is_empty() {
                self.go_back();
            }
            self.advance();
        }
        while let Some(candidate) = self.layer.get(self.done) {
            if let Some(choice) = context.draw_untried_holding(candidate.node) {
                return Some(Choice { hold: self.hold(context), ..choice });
            }
            self.dead_ends.finish(candidate.state);
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
                let from = self.layer.get(self.done).filter(|_| choice.is_some()).copied();
                self.add(context, node, point, from);
            }
            Growth::Failed => {}
            Growth::Late | Growth::Known(..) => {
                if let Some(from) = self.layer.get(self.done) {
                    self.dead_ends.leave(from.state);
                }
            }
        }
    }

    fn counts_steps(&self) -> bool {
        true
    }

    fn follows(&self) -> bool {
        false
    }

    fn starts_over(&self) -> bool {
        true
    }

    fn is_over(&self) -> bool {
        self.done == self.layer.len() && (self.next.is_empty() && !self.can_return() || self.is_stuck())
    }

    fn is_spent(&self) -> bool {
        // Each hold was tried with states of all cells.
        self.whole > HOLDS.len() as u32
    }

    fn bytes(&self) -> usize {
        let reserved: usize = self.reserve.iter().map(Vec::capacity).sum();
        self.dead_ends.bytes()
            + self.soonest.capacity() * 16
            + self.in_place.capacity() * 24
            + (self.layer.capacity() + self.next.capacity() + reserved) * size_of::<Candidate>()
    }
}
