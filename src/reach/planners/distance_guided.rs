//! Guided by distances: extends the places nearest to the goal through the level, less often the more often they were
//! tried.
//!
//! After SyCLoP, Plaku, Kavraki and Vardi, *Motion Planning With Dynamics by a Synergistic Combination of Layers of
//! Planning*, 2010, whose leads are paths through a decomposition of the workspace, and the archive of Ecoffet,
//! Huizinga, Lehman, Stanley and Clune, *First Return, Then Explore*, 2021. The cost of a place is its distance to the
//! goal (`distance.rs`) plus a penalty per choice, and the cheapest place is extended. So an open path is followed at
//! once; at an obstacle, the places before it are tried again and again, farther and farther back.
//!
//! It searches in one of two manners. As a planner of its own, it tries jumps as a whole: where players can rest (in modes in
//! which they were seen to stay where they are) is worth more choices than where they fly past, and what leaves a rest is
//! extended further until it comes to the next one, mostly with the input that it left with. For what has to be steered in
//! flight, some choices are made as if all places were alike, and are of a single extension; two queues alternate, after
//! Röger and Helmert, *The More, the Merrier: Combining Heuristic Estimators for Satisficing Planning*, 2010. Beside
//! coverage in one tree (`blended.rs`), and where players can rest in all modes that were seen, all places are alike.
//!
//! With a time limit, the cost is the number of steps to the place plus a lower bound of the rest, as in a weighted A*
//! (Pohl 1970), and of the nodes with a similar velocity at a place only the earliest are kept, as the archive of
//! Ecoffet et al. keeps the shortest path to each cell.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use hashbrown::HashMap;
use rand::RngExt;

use crate::reach::coverage::{PLACE, mix};
use crate::reach::distance::DistanceField;
use crate::reach::metric::{Metric, Point};
use crate::reach::problem::Problem;
use crate::reach::search_context::SearchContext;
use crate::reach::strategy::{Choice, Growth, Strategy};
use crate::reach::tree::NodeId;

use super::Guidance;
use super::cells::Cells;
use super::player_cells::PlayerCells;

/// How places are chosen.
#[derive(Debug, Clone, Copy)]
struct Manner {
    /// The costs by which they are chosen; if there are two, by the second ones now and then.
    costs: &'static [Costs],
    /// Maximum number of further extensions until a rest.
    further: u32,
    /// One choice in this number is a random place.
    random_one_in: u32,
}

/// Costs of a place: per place on the path to the goal, and per choice where players cannot rest; elsewhere it is 1.
#[derive(Debug, Clone, Copy)]
struct Costs {
    distance: u64,
    in_flight: u64,
}

/// By whole jumps, and by places alone.
const BY_JUMPS: Manner = Manner {
    costs: &[Costs { distance: 4, in_flight: 8 }, Costs { distance: 16, in_flight: 1 }],
    further: 8,
    random_one_in: 32,
};
const BY_PLACES: Manner = Manner { costs: &[Costs { distance: 4, in_flight: 1 }], further: 0, random_one_in: 8 };
/// One choice in this number is by the second costs.
const SECOND_ONE_IN: u32 = 3;
/// One input in this number is another than that before in a flight.
const CHANGES_ONE_IN: u32 = 4;
/// With a time limit: weight of the remaining steps, in quarters, and cost per choice; the steps to the place have
/// weight 1.
const REST: u64 = 6;
const CHOSEN_TIMED: u64 = 2;
/// Maximum delay of a node, in steps, after another at the same place with a similar velocity.
const MAX_DELAY: u32 = 8;
/// Number of cells for the range of velocities.
const VELOCITIES: f64 = 8.0;

/// A queue entry: cost, tie-breaking number, place.
type Queued = Reverse<(u64, u32, u32)>;

/// Estimates for a place.
#[derive(Debug, Clone, Copy, Default)]
struct Estimate {
    /// Distance to the goal, in places.
    places: u32,
    /// A lower bound of the steps to the goal, with a time limit.
    rest: u32,
    /// Minimum number of steps to it so far.
    soonest: u32,
    /// The modes of the players there.
    modes: u64,
}

/// What was extended last, to be extended further.
#[derive(Debug, Clone, Copy)]
struct Flight {
    node: NodeId,
    /// The place that it left.
    from: u32,
    /// Number of extensions left.
    left: u32,
}

/// A strategy that extends the places nearest to the goal.
#[derive(Debug)]
pub struct DistanceGuided<'m> {
    manner: Manner,
    distances: Option<&'m DistanceField>,
    players: PlayerCells<'m>,
    cells: Cells,
    /// For each place that was ever open.
    estimates: Vec<Estimate>,
    /// With a time limit: minimum number of steps to each innermost cell.
    soonest: HashMap<u64, u32>,
    /// By each of the costs.
    queues: [BinaryHeap<Queued>; 2],
    /// The least distance of a place of this tree.
    nearest: u32,
    /// The modes in which players were seen to rest, and those in which they were seen, but not to rest.
    restful: Vec<u64>,
    restless: Vec<u64>,
    flight: Option<Flight>,
    /// The point of a node before.
    before: Point,
}

impl<'m> DistanceGuided<'m> {
    /// A strategy for a problem, with what leads to its goal, that tries whole jumps.
    pub fn by_jumps(problem: &Problem<'_>, metric: &Metric, guidance: Guidance<'m>) -> Self {
        // With a time limit, the earliest node of a place counts.
        let manner = if problem.time().is_some() { BY_PLACES } else { BY_JUMPS };
        DistanceGuided::new(problem, metric, guidance, manner)
    }

    /// The same for a tree in which others choose, too, and a jump would be broken off.
    pub fn by_places(problem: &Problem<'_>, metric: &Metric, guidance: Guidance<'m>) -> Self {
        DistanceGuided::new(problem, metric, guidance, BY_PLACES)
    }

    fn new(problem: &Problem<'_>, metric: &Metric, guidance: Guidance<'m>, manner: Manner) -> Self {
        DistanceGuided {
            manner,
            distances: guidance.distances,
            players: PlayerCells::new(problem, metric, guidance, VELOCITIES),
            cells: Cells::default(),
            estimates: Vec::new(),
            soonest: HashMap::default(),
            queues: [BinaryHeap::new(), BinaryHeap::new()],
            nearest: u32::MAX,
            restful: Vec::new(),
            restless: Vec::new(),
            flight: None,
            before: Point::default(),
        }
    }

    /// Whether the node that was added last is nearer to the goal than all places of this tree.
    pub fn is_nearest(&self, context: &SearchContext<'_>) -> bool {
        let (sim, state) = (context.problem.sim, context.reached());
        self.distances.is_some_and(|distances| distances.of(sim, state) < self.nearest)
    }

    /// Forgets a node without untried inputs.
    pub fn close(&mut self, node: NodeId) {
        self.cells.remove(node);
    }

    fn add(&mut self, context: &mut SearchContext<'_>, node: NodeId, point: &Point, choice: Option<Choice>) {
        let from = choice.map(|choice| choice.node);
        let modes = self.modes(point);
        let [place, cell] = self.players.keys(context, point, PLACE);
        let keys = [mix(place, modes), cell];
        let (depth, is_timed) = (context.tree.depth(node), context.problem.time().is_some());
        if is_timed {
            let soonest = self.soonest.entry(keys[1]).or_insert(depth);
            if depth > *soonest + MAX_DELAY {
                return;
            }
            *soonest = depth.min(*soonest);
        }
        let is_rest = self.is_rest(context, (point, modes), choice);
        let (place, is_new) = self.cells.add(node, &keys);
        if place as usize >= self.estimates.len() {
            let estimates = self.distances.map_or(Estimate::default(), |distances| {
                let (sim, state) = (context.problem.sim, context.reached());
                let (places, rest) = (distances.of(sim, state), distances.least_steps(sim, state));
                Estimate { places, rest, soonest: depth, modes }
            });
            self.nearest = self.nearest.min(estimates.places);
            self.estimates.resize(place as usize + 1, estimates);
        }
        let soonest = &mut self.estimates[place as usize].soonest;
        let is_sooner = is_timed && depth < *soonest;
        *soonest = depth.min(*soonest);
        if is_new || is_sooner {
            self.enqueue(context, place);
        }
        let flight = self.flight.take().filter(|flight| Some(flight.node) == from && flight.left > 0);
        self.flight = flight.filter(|flight| !is_rest || place == flight.from).map(|flight| Flight {
            node,
            left: flight.left - 1,
            ..flight
        });
    }

    /// A key of the players' modes: all are one to who does not tell rests.
    fn modes(&self, point: &Point) -> u64 {
        if self.manner.further > 0 { self.players.modes(point) } else { 0 }
    }

    /// Whether players can rest in the modes of the node that was added last: they were seen to, or have just done so.
    fn is_rest(
        &mut self,
        context: &mut SearchContext<'_>,
        (point, modes): (&Point, u64),
        choice: Option<Choice>,
    ) -> bool {
        if self.manner.further == 0 || self.restful.contains(&modes) {
            return true;
        }
        let Some(choice) = choice else { return false };
        // A longer extension may have come back.
        let is_rest = choice.hold == context.least_hold()
            && self.players.are_at_rest(context, choice.node, (point, &mut self.before));
        let tried_jumps = self.manner().further > 0;
        if is_rest {
            self.restful.push(modes);
            self.restless.retain(|other| *other != modes);
        } else if !self.restless.contains(&modes) {
            self.restless.push(modes);
        }
        if is_rest || tried_jumps != (self.manner().further > 0) {
            // The costs of some places are others now.
            for at in 0..self.cells.first().len() {
                self.enqueue(context, self.cells.first()[at]);
            }
        }
        is_rest
    }

    /// How places are chosen now: no jumps are tried while none were seen.
    fn manner(&self) -> Manner {
        if self.restless.is_empty() && !self.restful.is_empty() { BY_PLACES } else { self.manner }
    }

    fn cost(&self, place: u32, costs: Costs, is_timed: bool) -> u64 {
        let estimates = &self.estimates[place as usize];
        let chosen = u64::from(self.cells.chosen(place));
        if is_timed {
            u64::from(estimates.soonest) + u64::from(estimates.rest) * REST / 4 + chosen * CHOSEN_TIMED
        } else {
            let per_choice = if self.restful.contains(&estimates.modes) { 1 } else { costs.in_flight };
            u64::from(estimates.places) * costs.distance + chosen * per_choice
        }
    }

    /// Queues an open place by its current costs.
    fn enqueue(&mut self, context: &mut SearchContext<'_>, place: u32) {
        let (manner, is_timed) = (self.manner(), context.problem.time().is_some());
        for (which, &costs) in manner.costs.iter().enumerate() {
            let cost = self.cost(place, costs, is_timed);
            self.queues[which].push(Reverse((cost, context.rng.random(), place)));
        }
    }

    /// The cheapest open place by some of the costs.
    fn cheapest(&mut self, which: usize, is_timed: bool) -> Option<u32> {
        let costs = self.manner().costs[which];
        while let Some(Reverse((cost, _, place))) = self.queues[which].pop() {
            // Skip entries that are outdated or closed.
            if self.cost(place, costs, is_timed) == cost && !self.cells.inside(place).is_empty() {
                return Some(place);
            }
        }
        None
    }

    /// An untried input of a node, which is forgotten with the last one: any, or the one that goes on with that before.
    fn draw(&mut self, context: &mut SearchContext<'_>, node: NodeId, goes_on: bool) -> Option<Choice> {
        let choice = if goes_on { context.draw_continuing(node) } else { context.draw_untried_holding(node) };
        if context.tree.untried(node) == 0 {
            self.cells.remove(node);
        }
        choice
    }
}

impl Strategy for DistanceGuided<'_> {
    fn choose(&mut self, context: &mut SearchContext<'_>, _toward: &Point) -> Option<Choice> {
        if let Some(flight) = self.flight {
            let goes_on = !context.rng.random_ratio(1, CHANGES_ONE_IN);
            if let Some(choice) = self.draw(context, flight.node, goes_on) {
                return Some(choice);
            }
        }
        let manner = self.manner();
        let mut left = manner.further;
        let place = if context.rng.random_ratio(1, manner.random_one_in) {
            let open = self.cells.first();
            if open.is_empty() {
                return None;
            }
            open[context.rng.random_range(0..open.len())]
        } else {
            let which = usize::from(manner.costs.len() > 1 && context.rng.random_ratio(1, SECOND_ONE_IN));
            if which > 0 {
                left = 0;
            }
            self.cheapest(which, context.problem.time().is_some())?
        };
        self.cells.choose(place);
        let inner = self.cells.draw(context, self.cells.inside(place))?;
        self.cells.choose(inner);
        let node = self.cells.draw_node(context, inner);
        let choice = self.draw(context, node, false);
        self.flight = (left > 0).then_some(Flight { node, from: place, left });
        if !self.cells.inside(place).is_empty() {
            self.enqueue(context, place);
        }
        choice
    }

    fn learn(&mut self, context: &mut SearchContext<'_>, choice: Option<Choice>, growth: Growth<'_>) {
        let from = choice.map(|choice| choice.node);
        match growth {
            Growth::Rooted(root, point) => {
                self.cells.clear();
                self.estimates.clear();
                self.soonest.clear();
                self.queues.iter_mut().for_each(BinaryHeap::clear);
                self.nearest = u32::MAX;
                self.flight = None;
                self.add(context, root, point, None);
            }
            Growth::Added(node, point) => self.add(context, node, point, choice),
            Growth::Failed | Growth::Late | Growth::Known(..) => {
                if let Growth::Known(_, point) = growth {
                    // Who waits comes to the same state.
                    self.is_rest(context, (point, self.modes(point)), choice);
                }
                self.flight = self.flight.filter(|flight| Some(flight.node) != from);
            }
        }
    }

    /// Whole jumps are tried from where others have not been.
    fn follows(&self) -> bool {
        self.manner.further == 0
    }

    fn bytes(&self) -> usize {
        self.cells.bytes()
            + self.estimates.capacity() * size_of::<Estimate>()
            + self.soonest.capacity() * 16
            + self.queues.iter().map(|queue| queue.capacity() * size_of::<Queued>()).sum::<usize>()
    }
}
