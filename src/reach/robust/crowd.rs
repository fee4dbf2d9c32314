//! Searches for a plan that many players carry out at once, each with timing errors of its own. A node of the tree is a
//! crowd: where each of the players is after the inputs so far. A crowd counts as being where all but a few of them are: the
//! others were lost on the way. Particles in place of a belief over states are those of Melchior and Simmons, *Particle RRT
//! for Path Planning with Uncertainty*, 2007; nodes are chosen by places and distances as `distance-guided` does.
//!
//! A change is planned for the middle of the time in which it can happen: it happens at once at the earliest, which is as
//! long before the planned time as errors reach.

use std::cmp::Reverse;
use std::collections::BinaryHeap;
use std::ops::ControlFlow;

use hashbrown::HashMap;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

use crate::ir::SlotId;
use crate::parallel::{self, TaskContext};
use crate::sim::{Input, Scratch};
use crate::watch::{Meter, Watch};

use super::super::controls::ControlSets;
use super::super::coverage::{PLACE, mix};
use super::super::distance::DistanceField;
use super::super::problem::{Problem, StateStatus};
use super::Course;
use super::jitter::Jitter;
use super::timeline::{Change, Timeline, differences};

/// Number of players of a crowd.
pub(super) const PLAYERS: usize = 16;
/// Number of extensions side by side.
const EXTENSIONS: usize = 8;
/// Standard deviations to which errors are cut: so long before the planned time a change can happen.
const EARLY: f64 = 2.5;
/// The costs of a place: its distance to the goal, and how often it was chosen.
const DISTANCE: u64 = 4;
const CHOSEN: u64 = 1;
/// Maximum number of crowds that are kept at one place with the same modes.
const MAX_AT_PLACE: usize = 4;
/// In one of so many extensions, any place is chosen.
const RANDOM_ONE_IN: u32 = 6;
/// The range of the time for which an input is held, steps.
const HOLD: (u16, u16) = (4, 64);

/// What a player does.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Status {
    Plays,
    Won,
    Lost,
}

/// One player of a crowd.
#[derive(Debug, Clone)]
struct Particle {
    state: Vec<u8>,
    input: Input,
    /// Changes that will happen, with their times.
    pending: Vec<(u64, Change)>,
    status: Status,
}

/// A crowd after some inputs.
struct Node {
    parent: usize,
    /// Number of steps from the initial state on.
    step: u64,
    /// The inputs as planned.
    input: Input,
    /// The changes that led here from the parent, at the parent's step.
    changes: Vec<Change>,
    /// Number of changes from the root on.
    all_changes: u32,
    particles: Vec<Particle>,
    /// Number of players who are further from the goal than the crowd.
    astray: usize,
}

/// A place with the modes of the players there.
#[derive(Default)]
struct Cell {
    nodes: Vec<usize>,
    distance: u32,
    chosen: u32,
}

/// What is asked of a search.
pub(super) struct CrowdSearch<'a> {
    pub course: &'a Course<'a>,
    pub distances: Option<&'a DistanceField>,
    pub jitter: &'a Jitter,
    /// Number of players who may be lost.
    pub allowed: usize,
    pub seed: u64,
    pub threads: usize,
    /// Maximum number of simulated steps, and bytes.
    pub budget: (u64, u64),
    pub watch: &'a dyn Watch,
}

/// An extension: a node, the next input, and for how long it is held.
struct Extension {
    node: usize,
    input: Input,
    hold: u16,
}

impl CrowdSearch<'_> {
    /// A plan with which all players but those allowed reach the target; and the number of simulated steps.
    pub fn run(&self, like: &Timeline) -> (Option<Timeline>, u64) {
        let problem = self.course.problem;
        let mut controls = ControlSets::complete();
        let (first, state) = self.course.start();
        let set = controls.of(problem, state);
        let inputs: Vec<Input> = (0..controls.count(set)).map(|index| controls.input(set, index).clone()).collect();
        let particle =
            Particle { state: state.to_vec(), input: like.held().clone(), pending: Vec::new(), status: Status::Plays };
        let root = Node {
            parent: 0,
            step: first,
            input: like.held().clone(),
            changes: Vec::new(),
            all_changes: 0,
            particles: vec![particle; PLAYERS],
            astray: 0,
        };
        let mut tree = Tree { nodes: Vec::new(), cells: HashMap::new(), queue: BinaryHeap::new(), order: Vec::new() };
        let mut rng = Pcg64::seed_from_u64(self.seed);
        tree.add(root, self.place_of(state), self.distance_of(state), &mut rng);
        let (mut spent, mut bytes) = (0, 0);
        let size = PLAYERS as u64 * (state.len() as u64 + 256);
        while spent < self.budget.0 && bytes < self.budget.1 && !self.watch.stop() {
            let chosen: Vec<Extension> =
                (0..EXTENSIONS).filter_map(|_| tree.choose(&inputs, problem.min_hold(), &mut rng)).collect();
            if chosen.is_empty() {
                break;
            }
            let mut grown: Vec<Option<Node>> = chosen.iter().map(|_| None).collect();
            let nodes = &tree.nodes;
            let task = |index: usize, context: &TaskContext<'_, (Option<Node>, u64)>| {
                let mut steps = 0;
                let node = self.extend(nodes, &chosen[index], &mut steps);
                context.submit((node, steps));
            };
            let stop = || self.watch.stop();
            parallel::work(chosen.len(), self.threads, &stop, &task, &mut |index, (node, steps)| {
                grown[index] = node;
                spent += steps;
                ControlFlow::Continue(())
            });
            if self.watch.stop() {
                break;
            }
            for node in grown.into_iter().flatten() {
                bytes += size;
                let won = node.particles.iter().filter(|particle| particle.status == Status::Won).count();
                if won + self.allowed >= PLAYERS {
                    return (Some(self.plan(&tree.nodes, &node, like)), spent);
                }
                let Some((place, distance)) = self.whereabouts(&node) else { continue };
                tree.add(node, place, distance, &mut rng);
            }
        }
        (None, spent)
    }

    /// Extends a crowd; `None` if too many are lost.
    fn extend(&self, nodes: &[Node], extension: &Extension, steps: &mut u64) -> Option<Node> {
        let from = &nodes[extension.node];
        let problem = self.course.problem;
        let mut changes = Vec::new();
        for player in problem.sim.world().players.ids() {
            differences(player, (from.input.of(player), extension.input.of(player)), from.step, &mut changes);
        }
        let early = self.early();
        let (mut scratch, meter) = (problem.sim.scratch(), Meter::new(self.watch));
        let mut particles = Vec::with_capacity(PLAYERS);
        let mut lost = 0;
        for (index, particle) in (0_u64..).zip(&from.particles) {
            let mut particle = particle.clone();
            for (number, change) in (u64::from(from.all_changes)..).zip(&changes) {
                let error = i64::from(self.jitter.draw(self.seed, index, number)).clamp(-early, early);
                let time = from.step.saturating_add_signed(early + error);
                let last = particle.pending.iter().rev().find(|(_, other)| other.control == change.control);
                particle.pending.push((last.map_or(time, |(last, _)| time.max(last + 1)), *change));
            }
            if particle.status == Status::Plays {
                self.play(&mut particle, (from.step, extension.hold, index), steps, (&mut scratch, &meter))?;
            }
            lost += usize::from(particle.status == Status::Lost);
            if lost > self.allowed {
                return None;
            }
            particles.push(particle);
        }
        Some(Node {
            parent: extension.node,
            step: from.step + u64::from(extension.hold),
            input: extension.input.clone(),
            all_changes: from.all_changes + changes.len() as u32,
            changes,
            particles,
            astray: lost,
        })
    }

    /// Lets a player play; `None` if the watch stops it.
    fn play(
        &self,
        particle: &mut Particle,
        (first, hold, index): (u64, u16, u64),
        steps: &mut u64,
        (scratch, meter): (&mut Scratch, &Meter<'_>),
    ) -> Option<()> {
        let problem: &Problem<'_> = self.course.problem;
        let most = problem.time().map_or(u64::MAX, |most| self.course.start().0 + u64::from(most));
        for step in first..first + u64::from(hold) {
            let input = &mut particle.input;
            particle.pending.retain(|(time, change)| {
                let is_due = *time <= step;
                if is_due {
                    input.set(change.control, change.value);
                }
                !is_due
            });
            let stepped = match problem.is_foretold() {
                _ if problem.sim.draws().is_empty() => {
                    problem.sim.metered_step(&mut particle.state, &particle.input, scratch, meter)
                }
                true => {
                    let drawn = problem.draw(step + 1, &particle.input);
                    problem.sim.metered_step(&mut particle.state, &drawn, scratch, meter)
                }
                false => {
                    let drawn = problem.sim.draw(mix(self.seed, index), step + 1, &particle.input);
                    problem.sim.metered_step(&mut particle.state, &drawn, scratch, meter)
                }
            };
            *steps += 1;
            if meter.is_stopped() {
                return None;
            }
            particle.status = match stepped.and_then(|()| problem.judge(&particle.state)) {
                Ok(StateStatus::Open) if step < most => Status::Plays,
                Ok(StateStatus::Goal) if step < most => Status::Won,
                _ => Status::Lost,
            };
            if particle.status != Status::Plays {
                return Some(());
            }
        }
        Some(())
    }

    /// How many steps before its planned time a change can happen.
    fn early(&self) -> i64 {
        (EARLY * self.jitter.sigma()).ceil() as i64
    }

    /// The place of a crowd and its distance: those of the last of its players but for those who may be lost.
    fn whereabouts(&self, node: &Node) -> Option<(u64, u32)> {
        let mut all: Vec<(u32, usize)> = node.particles.iter().map(|p| self.distance(p)).zip(0..).collect();
        all.sort_unstable();
        // Without distances, those who are lost are the furthest.
        let &(distance, index) = all.get(PLAYERS - 1 - self.allowed)?;
        let particle = node.particles.get(index).filter(|particle| particle.status == Status::Plays)?;
        Some((self.place_of(&particle.state), distance))
    }

    fn distance(&self, particle: &Particle) -> u32 {
        match particle.status {
            Status::Won => 0,
            Status::Lost => u32::MAX,
            Status::Plays => self.distance_of(&particle.state).max(1),
        }
    }

    fn distance_of(&self, state: &[u8]) -> u32 {
        let Some(distances) = self.distances else { return 1 };
        let sim = self.course.problem.sim;
        let (x, y) = sim.position(state, distances.player);
        distances.of(sim.space(state, distances.player), x, y)
    }

    /// The place of the players in a state, with their modes and discrete variables.
    fn place_of(&self, state: &[u8]) -> u64 {
        let problem = self.course.problem;
        let (program, world) = (problem.sim.program(), problem.sim.world());
        let mut place = 0;
        let mut add = |number: f64| place = mix(place, number as i64 as u64);
        for &slot in problem.players() {
            let slot: SlotId = slot;
            let layout = &world.layout.slots[slot];
            let (x, y) = problem.sim.position(state, slot);
            [f64::from(layout.space(state).0), (x / PLACE).floor(), (y / PLACE).floor()].into_iter().for_each(&mut add);
            let entity = &program.entities[world.slots[slot].entity];
            entity.groups.ids().for_each(|group| add(f64::from(layout.leaf(state, group).0)));
            entity.discretes.ids().for_each(|id| add(layout.discrete(state, id) as f64));
        }
        place
    }

    /// The plan that leads to a crowd.
    fn plan(&self, nodes: &[Node], last: &Node, like: &Timeline) -> Timeline {
        let mut path: Vec<&Node> = vec![last];
        let mut at = last.parent;
        while at > 0 {
            path.push(&nodes[at]);
            at = nodes[at].parent;
        }
        let early = self.early();
        let changes = path.iter().rev().flat_map(|node| &node.changes);
        let planned = (0..).zip(changes).map(|(key, change)| Change {
            step: change.step.saturating_add_signed(early),
            key,
            ..*change
        });
        like.with(planned.collect(), last.step)
    }
}

struct Tree {
    nodes: Vec<Node>,
    cells: HashMap<u64, Cell>,
    /// Cells by cost; what is outdated is skipped.
    queue: BinaryHeap<Reverse<(u64, u32, u64)>>,
    /// All cells in the order in which they were found.
    order: Vec<u64>,
}

impl Tree {
    fn add(&mut self, node: Node, place: u64, distance: u32, rng: &mut Pcg64) {
        let id = self.nodes.len();
        let order = &mut self.order;
        let cell = self.cells.entry(place).or_insert_with(|| {
            order.push(place);
            Cell { distance, ..Cell::default() }
        });
        cell.distance = cell.distance.min(distance);
        let nodes = &self.nodes;
        let rank = |node: &Node| (node.astray, node.all_changes, node.step);
        if cell.nodes.len() >= MAX_AT_PLACE {
            // The worst gives way, if it is worse.
            let Some(worst) = (0..cell.nodes.len()).max_by_key(|at| rank(&nodes[cell.nodes[*at]])) else { return };
            if rank(&nodes[cell.nodes[worst]]) <= rank(&node) {
                return;
            }
            cell.nodes[worst] = id;
        } else {
            cell.nodes.push(id);
        }
        let cost = cell.cost();
        self.nodes.push(node);
        self.queue.push(Reverse((cost, rng.random(), place)));
    }

    /// The next extension.
    fn choose(&mut self, inputs: &[Input], min_hold: u16, rng: &mut Pcg64) -> Option<Extension> {
        let place = if rng.random_ratio(1, RANDOM_ONE_IN) {
            self.order[rng.random_range(0..self.order.len())]
        } else {
            loop {
                let Reverse((cost, _, place)) = self.queue.pop()?;
                if self.cells.get(&place).is_some_and(|cell| cell.cost() == cost) {
                    break place;
                }
            }
        };
        let cell = self.cells.get_mut(&place)?;
        cell.chosen += 1;
        self.queue.push(Reverse((cell.cost(), rng.random(), place)));
        let node = cell.nodes[rng.random_range(0..cell.nodes.len())];
        // Few changes are easier than many: of some inputs, the one that is most like the last.
        let last = &self.nodes[node].input;
        let tries = if rng.random() { 3 } else { 1 };
        let mut drawn = (0..tries).map(|_| &inputs[rng.random_range(0..inputs.len())]).collect::<Vec<_>>();
        drawn.sort_by_key(|input| distance(last, input));
        let input = (*drawn.first()?).clone();
        let octaves = u32::from(HOLD.1 / HOLD.0).ilog2();
        let octave = rng.random_range(0..octaves);
        let hold = rng.random_range(HOLD.0 << octave..=HOLD.0 << (octave + 1));
        Some(Extension { node, input, hold: hold.max(min_hold) })
    }
}

impl Cell {
    fn cost(&self) -> u64 {
        u64::from(self.distance) * DISTANCE + u64::from(self.chosen) * CHOSEN
    }
}

/// Number of changes from one input to another; none is worse than one.
fn distance(old: &Input, new: &Input) -> u32 {
    let players = old.0.iter().zip(&new.0);
    let count = players.map(|(a, b)| {
        (a.buttons ^ b.buttons).count_ones() + a.axes.iter().zip(b.axes).filter(|(a, b)| **a != *b).count() as u32
    });
    match count.sum() {
        0 => 2,
        count => count,
    }
}
