//! What a search keeps to explain a missing answer: for each part of the goal and for the whole the state that came
//! nearest, and what the first player was seen to do. Only what is nearer than before is noted, as a choice of the
//! tree; it becomes a script when the tree ends.

use crate::sim::{Script, Simulator};

use super::super::distance::DistanceField;
use super::super::problem::Problem;
use super::super::strategy::Choice;
use super::super::tree::NodeId;
use super::gauge::{Gauge, Seen};
use super::lack::Parts;

/// How a state is reached.
#[derive(Debug, Clone, PartialEq)]
enum Way {
    /// By a choice of the current tree, after this number of its steps.
    Choice(Choice, u16),
    /// By a script.
    Script(Script),
}

/// The nearest state so far.
#[derive(Debug, Clone, PartialEq)]
struct Best {
    cost: f64,
    /// Of the whole goal, the length of the way to it through the level, which decides between equal costs.
    way_left: u32,
    way: Option<Way>,
}

/// Keeps the nearest states of a search.
pub(in super::super) struct Tracker<'a> {
    parts: Parts,
    distances: Option<&'a DistanceField>,
    /// For each part, and for the whole last.
    best: Vec<Best>,
    gauge: Gauge,
}

/// A nearest state of a search that has ended.
#[derive(Debug, Clone, PartialEq)]
pub struct Near {
    /// What it lacks, in tiles.
    cost: f64,
    way_left: u32,
    /// The inputs from the initial state.
    pub script: Script,
}

/// What a search found out about a goal that it did not reach.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Nearest {
    /// For each part of the goal, the state in which it came nearest to holding.
    pub parts: Vec<Option<Near>>,
    /// The state in which the whole goal came nearest.
    pub whole: Option<Near>,
    /// What the first player was seen to do.
    pub(super) seen: Seen,
    /// Number of nodes of the search, if it was a small one beside a proof.
    sampled: Option<u64>,
}

impl Near {
    /// What the state lacks, in tiles of 16 px; for comparisons only.
    pub(super) fn cost(&self) -> f64 {
        self.cost
    }
}

impl Nearest {
    /// Found by a small search beside a proof.
    #[must_use]
    pub(in super::super) fn sampled(self, nodes: u64) -> Nearest {
        Nearest { sampled: Some(nodes), ..self }
    }

    /// Adds states in which the first player stands.
    pub(in super::super) fn stand(&mut self, states: &[Vec<u8>]) {
        self.seen.rests.extend(states.iter().cloned());
    }

    /// The number of nodes of the small search beside a proof that found it, if one did.
    pub(super) fn sample(&self) -> Option<u64> {
        self.sampled
    }

    /// Adds what another search found; the first of equally near states counts.
    pub(in super::super) fn join(&mut self, other: &Nearest) {
        let join = |mine: &mut Option<Near>, theirs: &Option<Near>| {
            if let Some(near) = theirs
                && mine.as_ref().is_none_or(|known| (near.cost, near.way_left) < (known.cost, known.way_left))
            {
                *mine = Some(near.clone());
            }
        };
        if self.parts.len() < other.parts.len() {
            self.parts.resize(other.parts.len(), None);
        }
        for (mine, theirs) in self.parts.iter_mut().zip(&other.parts) {
            join(mine, theirs);
        }
        join(&mut self.whole, &other.whole);
        self.seen.join(&other.seen);
    }
}

/// Of which nothing is known yet.
const NONE: Best = Best { cost: f64::INFINITY, way_left: u32::MAX, way: None };

impl<'a> Tracker<'a> {
    /// For a question of which nothing was searched yet.
    pub fn new(problem: &Problem<'_>, distances: Option<&'a DistanceField>) -> Self {
        let parts = Parts::new(problem);
        let best = vec![NONE; parts.terms.len() + 1];
        Tracker { parts, distances, best, gauge: Gauge::new(problem) }
    }

    /// Begins an extension of a node.
    #[inline]
    pub fn begin(&mut self, sim: &Simulator, state: &[u8], node: NodeId) {
        self.gauge.begin(sim, state, node);
    }

    /// Adds the last state as a node.
    #[inline]
    pub fn add(&mut self) {
        self.gauge.add();
    }

    /// Adds a root.
    pub fn add_root(&mut self, sim: &Simulator, state: &[u8], root: NodeId) {
        self.gauge.begin_tree(sim, state);
        self.see(sim, state, Choice { node: root, input: 0, hold: 0 }, 0);
        self.gauge.add();
    }

    /// Notes a state of a run that goes on.
    #[inline]
    pub fn see(&mut self, sim: &Simulator, state: &[u8], choice: Choice, step: u16) {
        self.gauge.see(sim, state);
        let Some((whole, parts)) = self.best.split_last_mut() else { return };
        let mut sum = 0.0;
        for (index, term) in self.parts.terms.iter().enumerate() {
            let best = &mut parts[index];
            let cost = term.cost(sim, state, if best.cost > whole.cost { best.cost } else { whole.cost });
            if cost < best.cost {
                *best = Best { cost, way_left: 0, way: Some(Way::Choice(choice, step)) };
            }
            sum += cost;
        }
        if sum > whole.cost || sum == f64::INFINITY {
            return;
        }
        let way_left = self.distances.map_or(0, |distances| distances.of(sim, state));
        if sum < whole.cost || way_left < whole.way_left {
            *whole = Best { cost: sum, way_left, way: Some(Way::Choice(choice, step)) };
        }
    }

    /// Turns choices of a tree that ends into scripts.
    pub fn end_tree(&mut self, script: impl Fn(Choice, u16) -> Script) {
        for best in &mut self.best {
            if let Some(Way::Choice(choice, step)) = best.way {
                best.way = Some(Way::Script(script(choice, step)));
            }
        }
        self.gauge.end_tree();
    }

    /// What was found so far.
    pub fn nearest(&self, script: impl Fn(Choice, u16) -> Script) -> Nearest {
        let near = |best: &Best| {
            let script = match best.way.as_ref()? {
                Way::Choice(choice, step) => script(*choice, *step),
                Way::Script(script) => script.clone(),
            };
            Some(Near { cost: best.cost, way_left: best.way_left, script })
        };
        let mut parts: Vec<Option<Near>> = self.best.iter().map(near).collect();
        let whole = parts.pop().flatten();
        Nearest { parts, whole, seen: self.gauge.seen(), sampled: None }
    }

    /// Memory use, bytes.
    pub fn bytes(&self) -> usize {
        self.gauge.bytes()
    }
}
