//! Searches for a plan that many players carry out at once, each with timing errors of its own. A node of the tree is a
//! crowd: where each of the players is after the inputs so far. Who is lost on the way is replaced by a copy of one who is
//! not, and the share of those who were not is counted: the product over a path is its probability of success, however
//! small (splitting: Kahn and Harris, *Estimation of Particle Transmission by Random Sampling*, 1951; particles in the nodes
//! of a tree: Melchior and Simmons, *Particle RRT for Path Planning with Uncertainty*, 2007). Nodes are chosen as
//! `distance-guided` does, by the distance to the goal and by how often they were chosen, and by that probability.
//!
//! A change is planned for the middle of the time in which it can happen: it happens at once at the earliest, which is as
//! long before the planned time as errors reach.

use std::cmp::Reverse;
use std::collections::{BTreeMap, BinaryHeap};
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

/// Number of players of a crowd. The first one makes no errors: a plan must succeed as it is.
const PLAYERS: usize = 17;
/// Minimum number of them who are not lost in an extension.
const LEAST: usize = 9;
/// Number of extensions side by side.
const EXTENSIONS: usize = 8;
/// Standard deviations to which errors are cut: so long before the planned time a change can happen.
const EARLY: f64 = 2.5;
/// The costs of a place: its distance to the goal, and how often it was chosen.
const DISTANCE: u64 = 4;
const CHOSEN: u64 = 1;
/// The cost of a probability of 1/e.
const LOSS: f64 = 40.0;
/// Number of cells of which the best is extended, and what a choice before costs, as the logarithm of a probability.
const DRAWN: usize = 4;
const TIRED: f64 = 0.02;
/// By how much a beginning must be better than that of the best plan, as the logarithm of a probability.
const GAIN: f64 = 0.03;
/// A player who is so much further from the goal than the middle one is lost, in places.
const ASTRAY: u32 = 8;
/// The probability that is good enough.
const ENOUGH: f64 = 0.98;
/// Maximum number of crowds that are kept at one place with the same modes.
const MAX_AT_PLACE: usize = 4;
/// Maximum number of plans of one search.
const MAX_FOUND: usize = 4;
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
    /// The logarithm of the probability that a player is not lost.
    survival: f64,
}

/// A place with the modes of the players there.
#[derive(Default)]
struct Cell {
    nodes: Vec<usize>,
    distance: u32,
    chosen: u32,
    /// The best of its crowds.
    survival: f64,
}

/// What is asked of a search.
pub(super) struct CrowdSearch<'a> {
    pub course: &'a Course<'a>,
    pub distances: Option<&'a DistanceField>,
    pub jitter: &'a Jitter,
    /// The time for players who are late at the goal, steps.
    pub slack: u64,
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
    hold: u32,
}

impl CrowdSearch<'_> {
    /// The plan with which players arrive most probably, and the number of simulated steps. Some known plans are followed
    /// first.
    pub fn run(&self, known: &[Timeline]) -> (Vec<Timeline>, u64) {
        let Some(like) = known.first() else { return (Vec::new(), 0) };
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
            survival: 0.0,
        };
        let mut tree = Tree {
            nodes: Vec::new(),
            cells: HashMap::new(),
            queue: BinaryHeap::new(),
            order: Vec::new(),
            bands: BTreeMap::new(),
            band: 0,
            least: f64::NEG_INFINITY,
            best: Followed::default(),
        };
        let mut rng = Pcg64::seed_from_u64(self.seed);
        tree.add(root, self.place_of(state), self.distance_of(state), &mut rng);
        let (mut spent, mut found) = (0, Vec::new());
        let size = PLAYERS as u64 * (state.len() as u64 + 256);
        // Adds what an extension has led to; returns the node, and whether it is worth following the best plan from it.
        let mut grow = |tree: &mut Tree, grown: Grown, rng: &mut Pcg64| -> Option<usize> {
            match grown {
                Grown::Lost => None,
                Grown::Node(node) => {
                    let (place, distance) = self.whereabouts(&node)?;
                    tree.add(node, place, distance, rng)
                }
                Grown::Arrived(node) if node.survival > tree.least => {
                    tree.least = node.survival;
                    found.push(self.plan(&tree.nodes, &node, like));
                    tree.best = self.followed(&tree.nodes, &node);
                    None
                }
                Grown::Arrived(_) => None,
            }
        };
        for plan in known {
            let mut node = 0;
            for (input, hold) in plan.holds() {
                let extension = Extension { node, input, hold };
                let Some(grown) = self.extend(&tree.nodes, &extension, &mut spent) else { break };
                let Some(next) = grow(&mut tree, grown, &mut rng) else { break };
                node = next;
            }
        }
        let (mut round, mut idle) = (0_u64, 0);
        loop {
            let (most_steps, most_bytes) = self.budget;
            let used = tree.nodes.len() as u64 * size;
            if spent >= most_steps || used >= most_bytes || self.watch.stop() || tree.least >= libm::log(ENOUGH) {
                break;
            }
            // Until there is a plan, most of the time is for getting ahead.
            let sweeps = tree.least > f64::NEG_INFINITY || round % 4 == 0;
            round += 1;
            if sweeps {
                tree.next_band();
            }
            let place = |tree: &mut Tree, rng: &mut Pcg64| if sweeps { tree.swept(rng) } else { tree.cheapest(rng) };
            let mut chosen = Vec::with_capacity(EXTENSIONS);
            for _ in 0..EXTENSIONS {
                let at = place(&mut tree, &mut rng);
                chosen.extend(at.and_then(|at| tree.choose(at, &inputs, problem.min_hold(), &mut rng)));
            }
            if chosen.is_empty() {
                idle += 1;
                if idle > tree.bands.len() * 2 + 2 {
                    break;
                }
                continue;
            }
            idle = 0;
            let mut grown: Vec<Option<Grown>> = chosen.iter().map(|_| None).collect();
            let nodes = &tree.nodes;
            let task = |index: usize, context: &TaskContext<'_, (Option<Grown>, u64)>| {
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
            for grown in grown.into_iter().flatten() {
                let Some(mut node) = grow(&mut tree, grown, &mut rng) else { continue };
                // A better beginning with the rest of the best plan.
                let rest = tree.better_than_best(node, |state| self.place_of(state));
                for (input, hold) in rest {
                    let extension = Extension { node, input, hold };
                    let Some(grown) = self.extend(&tree.nodes, &extension, &mut spent) else { break };
                    let Some(next) = grow(&mut tree, grown, &mut rng) else { break };
                    node = next;
                }
            }
        }
        eprintln!("DBG nearest {:?}", tree.cells.values().map(|c| (c.distance, (c.survival*100.0) as i64)).min());
        eprintln!("DBG crowd nodes {} cells {} least {} found {}", tree.nodes.len(), tree.order.len(), libm::exp(tree.least), found.len());
        // The last ones are the best.
        (found.split_off(found.len().saturating_sub(MAX_FOUND)), spent)
    }

    /// Extends a crowd; `None` if the watch stops it.
    fn extend(&self, nodes: &[Node], extension: &Extension, steps: &mut u64) -> Option<Grown> {
        let from = &nodes[extension.node];
        let problem = self.course.problem;
        let mut changes = Vec::new();
        for player in problem.sim.world().players.ids() {
            differences(player, (from.input.of(player), extension.input.of(player)), from.step, &mut changes);
        }
        let early = self.early();
        let (mut scratch, meter) = (problem.sim.scratch(), Meter::new(self.watch));
        let mut particles = Vec::with_capacity(PLAYERS);
        let (mut lost, mut won) = (0, 0);
        for (index, particle) in (0_u64..).zip(&from.particles) {
            let mut particle = particle.clone();
            for (number, change) in (u64::from(from.all_changes)..).zip(&changes) {
                let drawn = i64::from(self.jitter.draw(self.seed, index, number)).clamp(-early, early);
                let error = if index == 0 { 0 } else { drawn };
                let time = from.step.saturating_add_signed(early + error);
                let last = particle.pending.iter().rev().find(|(_, other)| other.control == change.control);
                particle.pending.push((last.map_or(time, |(last, _)| time.max(last + 1)), *change));
            }
            self.play(&mut particle, (from.step, u64::from(extension.hold), index), steps, (&mut scratch, &meter))?;
            lost += usize::from(particle.status == Status::Lost);
            won += usize::from(particle.status == Status::Won);
            if lost > PLAYERS - LEAST || index == 0 && lost > 0 {
                return Some(Grown::Lost);
            }
            particles.push(particle);
        }
        let step = from.step + u64::from(extension.hold);
        if won > 0 {
            // The others hold on.
            for (index, particle) in (0_u64..).zip(&mut particles).filter(|(_, p)| p.status == Status::Plays) {
                self.play(particle, (step, self.slack, index), steps, (&mut scratch, &meter))?;
                won += usize::from(particle.status == Status::Won);
            }
        } else if self.distances.is_some() {
            let mut all: Vec<u32> = particles.iter().map(|particle| self.distance(particle)).collect();
            all.sort_unstable();
            let most = all.get(PLAYERS / 2).map_or(u32::MAX, |middle| middle.saturating_add(ASTRAY));
            for particle in particles.iter_mut().filter(|particle| self.distance(particle) > most) {
                particle.status = Status::Lost;
            }
        }
        let kept = match won {
            0 => particles.iter().filter(|particle| particle.status == Status::Plays).count(),
            won => won,
        };
        let is_lost = |status: Status| status == Status::Lost || won > 0 && status == Status::Plays;
        if kept < LEAST || particles.first().is_none_or(|exact| is_lost(exact.status)) {
            return Some(Grown::Lost);
        }
        if won == 0 {
            // Copies have errors of their own from now on.
            let remaining: Vec<Particle> = particles.iter().filter(|p| p.status == Status::Plays).cloned().collect();
            let lost = particles.iter_mut().filter(|particle| particle.status == Status::Lost);
            lost.zip(remaining.iter().cycle()).for_each(|(lost, other)| lost.clone_from(other));
        }
        let node = Node {
            parent: extension.node,
            step,
            input: extension.input.clone(),
            all_changes: from.all_changes + changes.len() as u32,
            changes,
            particles,
            survival: from.survival + libm::log((kept - 1) as f64 / (PLAYERS - 1) as f64),
        };
        Some(if won > 0 { Grown::Arrived(node) } else { Grown::Node(node) })
    }

    /// Lets a player play; `None` if the watch stops it.
    fn play(
        &self,
        particle: &mut Particle,
        (first, hold, index): (u64, u64, u64),
        steps: &mut u64,
        (scratch, meter): (&mut Scratch, &Meter<'_>),
    ) -> Option<()> {
        let problem: &Problem<'_> = self.course.problem;
        let most = problem.time().map_or(u64::MAX, |most| self.course.start().0 + u64::from(most));
        for step in first..first + hold {
            let input = &mut particle.input;
            particle.pending.retain(|(time, change)| {
                let is_due = *time <= step;
                if is_due {
                    input.set(change.control, change.value);
                }
                !is_due
            });
            let stepped = if problem.sim.draws().is_empty() {
                problem.sim.metered_step(&mut particle.state, &particle.input, scratch, meter)
            } else {
                let drawn = match problem.is_foretold() {
                    true => problem.draw(step + 1, &particle.input),
                    false => problem.sim.draw(mix(self.seed, index), step + 1, &particle.input),
                };
                problem.sim.metered_step(&mut particle.state, &drawn, scratch, meter)
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

    /// The place of a crowd and its distance: those of the player who makes no errors.
    fn whereabouts(&self, node: &Node) -> Option<(u64, u32)> {
        let exact = node.particles.first()?;
        Some((self.place_of(&exact.state), self.distance(exact)))
    }

    /// A plan as it can be followed from the places on its way.
    fn followed(&self, nodes: &[Node], last: &Node) -> Followed {
        let mut rest = Vec::new();
        let mut best = Followed::default();
        let (mut node, mut at) = (last, usize::MAX);
        loop {
            if at != usize::MAX
                && let Some((place, _)) = self.whereabouts(node)
            {
                let whole: Vec<(Input, u32)> = rest.iter().rev().cloned().collect();
                best.from.entry(place).or_insert((node.survival, whole));
            }
            if at == 0 {
                return best;
            }
            let from = &nodes[node.parent];
            rest.push((node.input.clone(), (node.step - from.step) as u32));
            (at, node) = (node.parent, from);
        }
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

/// What an extension leads to.
enum Grown {
    /// Too many are lost.
    Lost,
    Node(Node),
    /// Those who are not lost reach the target.
    Arrived(Node),
}

struct Tree {
    nodes: Vec<Node>,
    cells: HashMap<u64, Cell>,
    /// Cells by cost; what is outdated is skipped.
    queue: BinaryHeap<Reverse<(u64, u32, u64)>>,
    /// All cells in the order in which they were found.
    order: Vec<u64>,
    /// The cells by distance, and the distance that is swept.
    bands: BTreeMap<u32, Vec<u64>>,
    band: u32,
    /// The logarithm of the best probability so far: less is not extended.
    least: f64,
    best: Followed,
}

/// The best plan: for each place on its way, the logarithm of the probability of getting there, and the inputs from there.
#[derive(Default)]
struct Followed {
    from: HashMap<u64, (f64, Vec<(Input, u32)>)>,
}

impl Tree {
    /// Adds a crowd, unless others at its place are better.
    fn add(&mut self, node: Node, place: u64, distance: u32, rng: &mut Pcg64) -> Option<usize> {
        if node.survival <= self.least {
            return None;
        }
        let id = self.nodes.len();
        let (order, bands) = (&mut self.order, &mut self.bands);
        let cell = self.cells.entry(place).or_insert_with(|| {
            order.push(place);
            bands.entry(distance).or_default().push(place);
            Cell { distance, survival: f64::NEG_INFINITY, ..Cell::default() }
        });
        cell.distance = cell.distance.min(distance);
        cell.survival = cell.survival.max(node.survival);
        let nodes = &self.nodes;
        let better = |a: &Node, b: &Node| {
            a.survival.total_cmp(&b.survival).reverse().then((a.all_changes, a.step).cmp(&(b.all_changes, b.step)))
        };
        if cell.nodes.len() >= MAX_AT_PLACE {
            // The worst gives way, if it is worse.
            let worst = (0..cell.nodes.len()).max_by(|a, b| better(&nodes[cell.nodes[*a]], &nodes[cell.nodes[*b]]))?;
            if better(&nodes[cell.nodes[worst]], &node).is_le() {
                return None;
            }
            cell.nodes[worst] = id;
        } else {
            cell.nodes.push(id);
        }
        let cost = cell.cost();
        self.nodes.push(node);
        self.queue.push(Reverse((cost, rng.random(), place)));
        Some(id)
    }

    /// The inputs of the best plan from a node's place on, if the node is better than that plan is there.
    fn better_than_best(&self, node: usize, place_of: impl Fn(&[u8]) -> u64) -> Vec<(Input, u32)> {
        let node = &self.nodes[node];
        // The one without errors is as good as any.
        let place = node.particles.first().map(|particle| place_of(&particle.state));
        let known = place.and_then(|place| self.best.from.get(&place));
        known.filter(|(survival, _)| node.survival > survival + GAIN).map_or(Vec::new(), |(_, rest)| rest.clone())
    }

    /// Goes on to the next distance, from far to near, and then again.
    fn next_band(&mut self) {
        let nearer = self.bands.range(..self.band).next_back();
        let next = nearer.or_else(|| self.bands.iter().next_back());
        self.band = next.map_or(0, |(band, _)| *band);
    }

    /// A cell at the distance that is swept: of some, the best.
    fn swept(&self, rng: &mut Pcg64) -> Option<u64> {
        let places = self.bands.get(&self.band).filter(|places| !places.is_empty())?;
        let score = |place: &u64| {
            self.cells.get(place).map_or(f64::NEG_INFINITY, |cell| cell.survival - f64::from(cell.chosen) * TIRED)
        };
        let drawn = (0..DRAWN).map(|_| places[rng.random_range(0..places.len())]);
        let best = drawn.reduce(|a, b| if score(&b) > score(&a) { b } else { a })?;
        self.cells.get(&best).is_some_and(|cell| cell.survival > self.least).then_some(best)
    }

    /// The cell with the lowest cost.
    fn cheapest(&mut self, rng: &mut Pcg64) -> Option<u64> {
        if rng.random_ratio(1, RANDOM_ONE_IN) {
            return Some(self.order[rng.random_range(0..self.order.len())]);
        }
        loop {
            let Reverse((cost, _, place)) = self.queue.pop()?;
            let is_open = |cell: &Cell| cell.cost() == cost && cell.survival > self.least;
            if self.cells.get(&place).is_some_and(is_open) {
                return Some(place);
            }
        }
    }

    /// The next extension from a cell.
    fn choose(&mut self, place: u64, inputs: &[Input], min_hold: u16, rng: &mut Pcg64) -> Option<Extension> {
        let cell = self.cells.get_mut(&place)?;
        cell.chosen += 1;
        self.queue.push(Reverse((cell.cost(), rng.random(), place)));
        let drawn = [0, 1].map(|_| cell.nodes[rng.random_range(0..cell.nodes.len())]);
        let node = drawn.into_iter().reduce(|a, b| if self.nodes[b].survival > self.nodes[a].survival { b } else { a })?;
        // Few changes are easier than many: of some inputs, the one that is most like the last.
        let last = &self.nodes[node].input;
        let tries = if rng.random() { 3 } else { 1 };
        let mut drawn = (0..tries).map(|_| &inputs[rng.random_range(0..inputs.len())]).collect::<Vec<_>>();
        drawn.sort_by_key(|input| distance(last, input));
        let input = (*drawn.first()?).clone();
        let octaves = u32::from(HOLD.1 / HOLD.0).ilog2();
        let octave = rng.random_range(0..octaves);
        let hold = rng.random_range(HOLD.0 << octave..=HOLD.0 << (octave + 1));
        Some(Extension { node, input, hold: u32::from(hold.max(min_hold)) })
    }
}

impl Cell {
    fn cost(&self) -> u64 {
        u64::from(self.distance) * DISTANCE + u64::from(self.chosen) * CHOSEN + (-self.survival * dbg_env("LOSS", LOSS)) as u64
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

fn dbg_env(name: &str, or: f64) -> f64 {
    std::env::var(name).ok().and_then(|v| v.parse().ok()).unwrap_or(or)
}
