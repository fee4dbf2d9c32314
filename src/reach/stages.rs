//! The stages of the way to a goal: what leads to each subgoal (`subgoals.rs`), in the order in which they are to come
//! about, and from there to the goal. Gates (`gates.rs`) that are on every way to one of them are subgoals as well.

use crate::ir::{Id, SlotId, SpaceId, VarId};
use crate::sim::Simulator;
use crate::watch::Meter;

use super::distance::{CostField, Grid, UNREACHABLE, flood};
use super::gates::Gate;
use super::goal_positions::PositionBox;
use super::problem::Problem;
use super::subgoals::{Fact, MAX_SUBGOALS, Subgoal};

/// The distance to what comes about nobody knows where, places.
const ANYWHERE: u32 = 16;

/// What leads to a subgoal, or to the goal.
#[derive(Debug)]
pub(super) struct Stage {
    /// What is to come about; none for the goal.
    fact: Option<Fact>,
    /// What it is needed for.
    needed_for: Vec<Fact>,
    /// The distance of each place, in places; empty if it is not known where it comes about.
    pub places: CostField,
    /// The distance of places without a known path: larger than all others.
    pub far: u32,
    /// The distance from where it comes about to each of the stages after it.
    pub hops: Vec<u32>,
}

/// Ways through a level, with gates open or closed.
pub(super) struct Ways<'w> {
    problem: &'w Problem<'w>,
    grids: &'w [Grid],
    gates: Vec<Gate>,
    /// Where the player is at first.
    start: (SpaceId, usize),
    meter: &'w Meter<'w>,
}

impl<'w> Ways<'w> {
    /// The ways of a player, past gates that block it.
    pub fn new(
        problem: &'w Problem<'w>,
        player: SlotId,
        grids: &'w [Grid],
        mut gates: Vec<Gate>,
        meter: &'w Meter<'w>,
    ) -> Self {
        let slot = &problem.sim.world().slots[player];
        let at = (slot.vars[VarId::X][0], slot.vars[VarId::Y][0]);
        gates.retain(|gate| grids[gate.space.index()].is_blocked_by(problem, gate.tags));
        Ways { problem, grids, gates, start: (slot.space, grids[slot.space.index()].cell(at)), meter }
    }

    /// The distances to boxes, with all gates closed but some.
    fn flood(&self, to: &[PositionBox], is_open: impl Fn(&Gate) -> bool) -> CostField {
        let mut closed: Option<Vec<Grid>> = None;
        for gate in self.gates.iter().filter(|gate| !is_open(gate)) {
            let grids = closed.get_or_insert_with(|| self.grids.to_vec());
            grids[gate.space.index()].close(self.problem, gate.space, gate.bounds, self.meter);
        }
        flood(closed.as_deref().unwrap_or(self.grids), self.problem, to, [1, 1, 1], self.meter)
    }

    /// Whether there is a way from the start.
    fn leads(&self, field: &CostField) -> bool {
        field[self.start.0.index()][self.start.1] != UNREACHABLE
    }

    /// The distances to boxes with as many gates closed as possible, and those that have to be open for it; `opened` are
    /// open anyway.
    fn to(&self, to: &[PositionBox], opened: &[Fact]) -> (CostField, Vec<Fact>) {
        let is_opened = |gate: &Gate| opened.contains(&gate.is_open);
        let field = self.flood(to, is_opened);
        if self.gates.iter().all(is_opened) || self.leads(&field) {
            return (field, Vec::new());
        }
        let open = self.flood(to, |_| true);
        if !self.leads(&open) {
            return (open, Vec::new());
        }
        // A gate is needed if there is no way once it alone is closed.
        let is_needed =
            |gate: &&Gate| !is_opened(gate) && !self.leads(&self.flood(to, |other| other.is_open != gate.is_open));
        let needed: Vec<Fact> = self.gates.iter().filter(is_needed).map(|gate| gate.is_open).collect();
        let field = self.flood(to, |gate| is_opened(gate) || needed.contains(&gate.is_open));
        (if self.leads(&field) { field } else { open }, needed)
    }
}

/// The stages of subgoals and of a goal, with the gates that have to be opened. `None` if there is no place of the goal.
pub(super) fn stages(
    ways: &Ways<'_>,
    (before, goal): (Vec<Subgoal>, &[PositionBox]),
    of_gate: &dyn Fn(Fact) -> Vec<Subgoal>,
) -> Option<Vec<Stage>> {
    let mut stages = Stages { ways, of_gate, opened: Vec::new(), all: Vec::new(), boxes: Vec::new() };
    for Subgoal { fact, needed_for, boxes } in before {
        stages.add(Some(fact), needed_for, boxes);
    }
    stages.add(None, Vec::new(), goal.to_vec());
    let Stages { mut all, boxes, .. } = stages;
    all.last().filter(|last| last.fact.is_none())?;
    for (from, boxes) in boxes.iter().enumerate() {
        all[from].hops = all.iter().map(|to| to.least(ways.grids, boxes)).collect();
    }
    Some(all)
}

/// Stages so far.
struct Stages<'s> {
    ways: &'s Ways<'s>,
    of_gate: &'s dyn Fn(Fact) -> Vec<Subgoal>,
    /// The gates that are open after them.
    opened: Vec<Fact>,
    all: Vec<Stage>,
    /// Where each comes about.
    boxes: Vec<Vec<PositionBox>>,
}

impl Stages<'_> {
    /// Adds a stage, after the gates on the way to it.
    fn add(&mut self, fact: Option<Fact>, needed_for: Vec<Fact>, to: Vec<PositionBox>) {
        let is_known = fact.is_some() && self.all.iter().any(|stage| stage.fact == fact);
        if is_known || fact.is_some() && self.all.len() >= MAX_SUBGOALS {
            return;
        }
        if to.is_empty() {
            self.all.push(Stage { fact, needed_for, far: 0, places: Vec::new(), hops: Vec::new() });
            self.boxes.push(to);
            return;
        }
        let (places, gates) = self.ways.to(&to, &self.opened);
        for gate in gates {
            // First, so that the way to what opens it does not ask for it again.
            self.opened.push(gate);
            for subgoal in (self.of_gate)(gate) {
                let needed = subgoal.needed_for.into_iter().chain(fact).chain(needed_for.iter().copied());
                self.add(Some(subgoal.fact), needed.collect(), subgoal.boxes);
            }
        }
        // Without such a place, there is no such stage.
        if let Some(most) = places.iter().flatten().filter(|d| **d != UNREACHABLE).max() {
            self.all.push(Stage { fact, needed_for, far: most + 1, places, hops: Vec::new() });
            self.boxes.push(to);
        }
    }
}

impl Stage {
    /// Whether it is still to come about in a state.
    pub fn is_open(&self, sim: &Simulator, state: &[u8]) -> bool {
        let holds = |fact: &Fact| fact.holds(sim, state);
        self.fact.as_ref().is_none_or(|fact| !holds(fact)) && !self.needed_for.iter().any(holds)
    }

    /// The distance of a place.
    pub fn of(&self, space: SpaceId, cell: usize) -> u32 {
        self.places.get(space.index()).map_or(0, |places| places[cell].min(self.far))
    }

    /// The least distance of a place in boxes.
    fn least(&self, grids: &[Grid], boxes: &[PositionBox]) -> u32 {
        if self.places.is_empty() {
            return ANYWHERE;
        }
        let spaces = (0..grids.len()).map(|space| SpaceId(space as u32));
        let cells = spaces.flat_map(|space| {
            let inside = boxes.iter().filter(move |b| b.space.is_none_or(|of| of == space));
            inside.flat_map(move |b| grids[space.index()].cells(b.x, b.y)).map(move |cell| (space, cell))
        });
        cells.map(|(space, cell)| self.of(space, cell)).min().unwrap_or(self.far)
    }
}
