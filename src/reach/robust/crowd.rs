//! A search with a crowd of players: all have the same plan, each with errors of its own, drawn once and for all. A node of
//! the search is a beginning of a plan with the states that it brings the players to; it is extended by further changes of
//! inputs. In each place along a known path, the beginnings are kept with which most of the crowd gets there. What grows
//! is therefore not the path of one player, but of all, and a plan is preferred in which a fault is made up for before the
//! next one: at a wall, on a wide platform.
//!
//! The states of a node as particles come from Melchior and Simmons, *Particle RRT for Path Planning with Uncertainty*,
//! 2007, where an extension is simulated under several frictions; here the errors are those of all changes so far, and
//! particles are counted, not clustered. The archive of the best beginning for each place is that of Ecoffet et al., *First
//! return, then explore*, 2021 (Go-Explore).

use std::collections::BTreeMap;
use std::ops::ControlFlow;
use std::sync::Arc;

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

use crate::ir::Id;
use crate::ordered::Ordered;
use crate::parallel::{self, TaskContext};
use crate::sim::Control;
use crate::watch::{Meter, Progress, Watch};

use super::super::coverage::mix;
use super::Course;
use super::guide::{Guide, Mark};
use super::jitter::Jitter;
use super::play::{Ending, Nature, Plays};
use super::timeline::{Change, Timeline, differences};

/// Number of players, beside one without errors.
const CROWD: usize = 48;
/// Number of extensions that are tried side by side.
const BATCH: usize = 64;
/// Number of beginnings that are kept for each place along the path.
const KEPT: usize = 10;
/// Number of places at the front in which half of all extensions begin.
const FRONT: usize = 8;
/// Number of places within which a loss counts as soon.
const SOON: usize = 5;
/// Errors beyond this number of standard deviations count as so large.
const REACH: f64 = 3.5;
/// Number of plans that are returned.
const PLANS: usize = 3;
/// Number of batches without a better plan after which the search ends, once it has one.
const PATIENCE: u32 = 400;
const CROWDED: u64 = 0x0063_726f_7764;

/// What a search with a crowd needs.
pub(super) struct Crowd<'a> {
    pub course: &'a Course<'a>,
    pub guide: Guide<'a>,
    pub jitter: &'a Jitter,
    pub seed: u64,
    pub threads: usize,
    /// Maximum number of simulated steps, and maximum memory of states, bytes.
    pub budget: (u64, u64),
    /// Simulated steps for a node of the budget that progress is shown of, and the budget in nodes.
    pub shown: (u64, u64),
    pub watch: &'a dyn Watch,
}

/// A player of the crowd.
#[derive(Debug, Clone)]
struct Player {
    state: Vec<u8>,
    mark: Mark,
    is_over: bool,
    is_there: bool,
}

/// A beginning of a plan.
struct Node {
    plan: Timeline,
    /// The time up to which its inputs are settled: later changes are at this step at the earliest.
    time: u64,
    /// The number of steps that have been simulated: earlier, as a later change can be too early.
    simulated: u64,
    /// The one without errors first.
    players: Vec<Player>,
    /// When it got to which place, at the time of the one without errors.
    log: Vec<(usize, u64)>,
}

/// A node in the archive.
struct Entry {
    node: Arc<Node>,
    kind: u64,
    count: usize,
    chosen: u32,
}

/// An extension: the changes, and the time up to which inputs are settled then.
type Extension = (Vec<Change>, u64);

/// An extended node: the number of its players that keep up, its place and kind.
struct Grown {
    node: Node,
    count: usize,
    place: usize,
    kind: u64,
}

impl Crowd<'_> {
    /// Plans with which most of a crowd arrives, the best first, and the simulated steps.
    pub fn search(&self, first: &Timeline) -> (Vec<Timeline>, u64) {
        let mut archive: BTreeMap<usize, Vec<Entry>> = BTreeMap::new();
        let mut plans: Vec<(usize, Timeline)> = Vec::new();
        let Some(root) = self.root(first) else { return (Vec::new(), 0) };
        let size = root.players.iter().map(|player| player.state.len()).sum::<usize>().max(1);
        let most = (self.budget.1 as usize / size).max(2 * FRONT);
        archive.entry(0).or_default().push(Entry { node: Arc::new(root), kind: 0, count: CROWD, chosen: 0 });
        let (mut spent, mut round, mut idle) = (0, 0, 0);
        while spent < self.budget.0 && idle < PATIENCE && !self.watch.stop() {
            let mut rng = Pcg64::seed_from_u64(mix(mix(self.seed, CROWDED), round));
            round += 1;
            let best = plans.first().map_or(0, |(count, _)| *count);
            let lost = losses(&archive);
            let tasks: Vec<(Arc<Node>, Extension)> =
                (0..BATCH).filter_map(|_| self.choose(&mut archive, (best, &lost), &mut rng)).collect();
            let mut grown: Vec<Option<Grown>> = tasks.iter().map(|_| None).collect();
            let (known, stop) = (&archive, || self.watch.stop());
            let task = |index: usize, context: &TaskContext<'_, (Option<Grown>, u64)>| {
                let (node, extension) = &tasks[index];
                context.submit(self.extend(node, extension, known, best));
            };
            parallel::work(tasks.len(), self.threads, &stop, &task, &mut |index, (result, steps)| {
                grown[index] = result;
                spent += steps;
                ControlFlow::Continue(())
            });
            idle += u32::from(!plans.is_empty());
            for found in grown.into_iter().flatten() {
                if found.node.players[0].is_there {
                    if found.count > plans.first().map_or(0, |(count, _)| *count) {
                        idle = 0;
                    }
                    let at = plans.partition_point(|(count, _)| *count >= found.count);
                    plans.insert(at, (found.count, found.node.plan));
                    plans.truncate(PLANS);
                    continue;
                }
                keep(archive.entry(found.place).or_default(), found);
            }
            let held: usize = archive.values().map(Vec::len).sum();
            if held > most {
                thin(&mut archive, most);
            }
            let nodes = spent / self.shown.0;
            self.watch.progress(Progress { nodes, budget: self.shown.1, places: archive.len() as u64 });
        }
        (plans.into_iter().map(|(_, plan)| plan).collect(), spent)
    }

    fn root(&self, first: &Timeline) -> Option<Node> {
        let (time, state) = self.course.start();
        let mark = self.guide.start(state)?;
        let player = Player { state: state.to_vec(), mark, is_over: false, is_there: false };
        let players = vec![player; CROWD + 1];
        let plan = first.with(Vec::new(), time);
        Some(Node { plan, time, simulated: time, players, log: vec![(0, time)] })
    }

    /// A node and an extension of it.
    fn choose(
        &self,
        archive: &mut BTreeMap<usize, Vec<Entry>>,
        (best, lost): (usize, &[usize]),
        rng: &mut Pcg64,
    ) -> Option<(Arc<Node>, Extension)> {
        let places = archive.len();
        let all: usize = lost.iter().sum();
        let index = match rng.random_range(0..4) {
            0 | 1 if best == 0 => places.saturating_sub(1 + rng.random_range(0..FRONT)),
            // Where many are lost.
            1..=3 if all > 0 => {
                let mut left = rng.random_range(0..all);
                let at = lost.iter().position(|lost| {
                    let is_here = left < *lost;
                    left = left.saturating_sub(*lost);
                    is_here
                });
                at.unwrap_or(0)
            }
            _ => rng.random_range(0..places),
        };
        let entries = archive.values_mut().nth(index)?;
        // Of two the one with more players, unless it was chosen often.
        let (a, b) = (rng.random_range(0..entries.len()), rng.random_range(0..entries.len()));
        let worth = |entry: &Entry| entry.count as f64 - 0.5 * f64::from(entry.chosen).sqrt();
        let at = if worth(&entries[a]) >= worth(&entries[b]) { a } else { b };
        // Players that are lost do not come back.
        if entries[at].count <= best {
            return None;
        }
        entries[at].chosen += 1;
        let node = entries[at].node.clone();
        let extension = match rng.random_range(0..3) {
            0 => self.follow(&node, archive, rng),
            _ => None,
        };
        let extension = extension.unwrap_or_else(|| self.invent(&node, rng));
        Some((node, extension))
    }

    /// Goes on as another plan does from the same place.
    fn follow(&self, node: &Node, archive: &BTreeMap<usize, Vec<Entry>>, rng: &mut Pcg64) -> Option<Extension> {
        let here = node.players[0].mark.place;
        let own = (&self.guide.plan, self.guide.log.as_slice(), earliest(self.jitter));
        let ahead: Vec<&Entry> = archive.range(here + 1..).take(3 * FRONT).flat_map(|(_, entries)| entries).collect();
        let other = match ahead.len() {
            0 => None,
            count => {
                ahead.get(rng.random_range(0..count)).map(|entry| (&entry.node.plan, entry.node.log.as_slice(), 0))
            }
        };
        // The states of a node are behind the time up to which its inputs are settled.
        let (plan, log, behind) = other.filter(|_| rng.random_range(0..4) > 0).unwrap_or(own);
        let from = log.iter().find(|(place, _)| *place >= here)?.1 + behind;
        let length = rng.random_range(10..90);
        let held = (plan.input_before(from), node.plan.input_before(node.time));
        let mut changes = Vec::new();
        for player in self.course.problem.sim.world().players.ids() {
            differences(player, (held.1.of(player), held.0.of(player)), node.time, &mut changes);
        }
        let later = plan.changes.iter().filter(|change| (from..from + length).contains(&change.step));
        changes.extend(later.map(|change| Change { step: change.step - from + node.time, ..*change }));
        Some((changes, node.time + length))
    }

    /// Changes of inputs at random: one is changed, or a button is tapped, or nothing is done.
    fn invent(&self, node: &Node, rng: &mut Pcg64) -> Extension {
        let least = u64::from(self.course.problem.min_hold());
        let hold = |rng: &mut Pcg64, most: u64| least.max(rng.random_range(0..=most));
        let controls = &self.guide.controls;
        let kind = if controls.is_empty() { 0 } else { rng.random_range(0..10) };
        let now = node.plan.input_before(node.time);
        let mut changes = Vec::new();
        let last = node.plan.changes.last().map_or(node.plan.after, |change| change.step);
        let free = node.time.max(last + least);
        let time = match kind {
            0 => node.time + 1 + hold(rng, 60),
            _ => {
                let control = controls[rng.random_range(0..controls.len())];
                let at = free + [0, rng.random_range(0..8), rng.random_range(0..30)][rng.random_range(0..3)];
                let old = now.get(control);
                let new = match control {
                    Control::Button(..) => 1.0 - old,
                    Control::Axis(..) => match rng.random_range(0..2) {
                        0 if old == 0.0 => -1.0,
                        1 if old == 0.0 => 1.0,
                        0 => 0.0,
                        _ => -old,
                    },
                };
                changes.push(Change { control, step: at, value: new, key: 0 });
                match kind {
                    // And back again.
                    1..=5 => {
                        let back = at + 1 + hold(rng, 40);
                        changes.push(Change { control, step: back, value: old, key: 0 });
                        back + 1 + hold(rng, 30)
                    }
                    _ => at + 1 + hold(rng, 40),
                }
            }
        };
        (changes, time)
    }

    /// Plays an extension; `None` if it is not worth keeping. Also the simulated steps.
    fn extend(
        &self,
        node: &Node,
        (changes, time): &Extension,
        archive: &BTreeMap<usize, Vec<Entry>>,
        best: usize,
    ) -> (Option<Grown>, u64) {
        let mut plays = Plays::new(self.course.problem);
        let meter = Meter::new(self.watch);
        let grown = self.grow(node, (changes, *time), (archive, best), (&mut plays, &meter));
        (grown, plays.steps)
    }

    fn grow(
        &self,
        node: &Node,
        (changes, time): (&[Change], u64),
        (archive, best): (&BTreeMap<usize, Vec<Entry>>, usize),
        (plays, meter): (&mut Plays<'_>, &Meter<'_>),
    ) -> Option<Grown> {
        let mut all = node.plan.changes.clone();
        all.extend_from_slice(changes);
        // The errors of a change are those of its number.
        let mut plan = node.plan.with(all, time);
        plan.number();
        if self.course.problem.time().is_some_and(|most| time - plan.after > u64::from(most)) {
            return None;
        }
        let earliest = earliest(self.jitter);
        let until = time.saturating_sub(earliest).max(node.simulated);
        let slack = self.course.slack;
        let mut errors: Vec<i32> = vec![0; plan.changes.len()];
        let move_on = |plays: &mut Plays<'_>, player: &Player, errors: &[i32], until: u64, trial: u64| {
            plan.times(errors, &mut plays.times);
            let nature = if trial == 0 { Nature::Planned } else { Nature::Anew(mix(self.seed, trial)) };
            let ending = plays.play(&plan, (node.simulated, &player.state), until, nature, meter);
            let mark = self.guide.advance(player.mark, until - node.simulated, &plays.state);
            let state = plays.state.clone();
            (
                ending,
                Player { state, mark, is_over: ending == Ending::Over, is_there: matches!(ending, Ending::Reached(_)) },
            )
        };
        let (ending, mut front) = move_on(plays, &node.players[0], &errors, until, 0);
        let is_there = match ending {
            Ending::Stopped | Ending::Over => return None,
            Ending::Reached(_) => true,
            Ending::Late => false,
        };
        // The target is reached: what follows is the same for all, as the last inputs are held.
        let until = if is_there { until + slack } else { until };
        let (place, kind) = (front.mark.place, self.guide.kind(&front.state));
        let least = match is_there {
            true => best,
            false => archive.get(&place).map_or(0, |entries| least_kept(entries, kind)),
        };
        front.is_there = is_there;
        let mut players = Vec::with_capacity(CROWD + 1);
        players.push(front);
        let behind = place.saturating_sub(1 + self.guide.spread);
        let (mut count, mut lost) = (0, 0);
        for (player, trial) in node.players[1..].iter().zip(1..) {
            if player.is_over || player.is_there {
                count += usize::from(player.is_there);
                lost += usize::from(player.is_over);
                players.push(player.clone());
            } else {
                errors.clear();
                let drawn = plan.changes.iter().map(|c| self.jitter.draw(self.seed, trial, u64::from(c.key)));
                errors.extend(drawn.map(|error| error.max(-(earliest as i32))));
                let (ending, mut moved) = move_on(plays, player, &errors, until, trial);
                if ending == Ending::Stopped {
                    return None;
                }
                let keeps_up = moved.is_there || !is_there && !moved.is_over && moved.mark.place >= behind;
                // Who has fallen far behind is not simulated any more.
                moved.is_over |= !keeps_up && !is_there && moved.mark.place + 4 * (1 + self.guide.spread) < place;
                count += usize::from(keeps_up);
                lost += usize::from(!keeps_up);
                players.push(moved);
            }
            if lost + least > CROWD {
                return None;
            }
        }
        let mut log = node.log.clone();
        if log.last().is_none_or(|(known, _)| *known < place) {
            log.push((place, time));
        }
        Some(Grown { node: Node { plan, time, simulated: until, players, log }, count, place, kind })
    }
}

/// For each place that was reached, the number of players that are lost soon after it.
fn losses(archive: &BTreeMap<usize, Vec<Entry>>) -> Vec<usize> {
    let most: Vec<usize> = archive.values().map(|entries| entries.iter().map(|e| e.count).max().unwrap_or(0)).collect();
    let later = |place: usize| most.get(place + SOON).or(most.last()).copied().unwrap_or(0);
    most.iter().enumerate().map(|(place, count)| count.saturating_sub(later(place))).collect()
}

/// The number of players with which a beginning of a kind is kept.
fn least_kept(entries: &[Entry], kind: u64) -> usize {
    match entries.iter().find(|entry| entry.kind == kind) {
        Some(entry) => entry.count,
        None if entries.len() >= KEPT => entries.iter().map(|entry| entry.count).min().unwrap_or(0) + 1,
        None => CROWD / 8,
    }
}

/// Keeps what is better than what is known.
fn keep(entries: &mut Vec<Entry>, found: Grown) {
    let Grown { node, count, kind, .. } = found;
    let is_simpler = |known: &Entry| {
        let rank = |node: &Node| (node.plan.changes.len(), node.time);
        count > known.count || count == known.count && rank(&node) < rank(&known.node)
    };
    if let Some(known) = entries.iter_mut().find(|entry| entry.kind == kind) {
        if is_simpler(known) {
            *known = Entry { node: Arc::new(node), kind, count, chosen: 0 };
        }
        return;
    }
    if entries.len() >= KEPT {
        let worst =
            entries.iter().enumerate().min_by_key(|(_, entry)| entry.count).map(|(at, entry)| (at, entry.count));
        match worst {
            Some((at, least)) if least < count => drop(entries.remove(at)),
            _ => return,
        }
    }
    entries.push(Entry { node: Arc::new(node), kind, count, chosen: 0 });
}

/// Forgets the worst beginnings of each place.
fn thin(archive: &mut BTreeMap<usize, Vec<Entry>>, most: usize) {
    let each = (most / archive.len().max(1) * 3 / 4).max(1);
    for entries in archive.values_mut() {
        entries.order_by_key(|entry| usize::MAX - entry.count);
        entries.truncate(each);
    }
}

/// The largest error by which a change is too early.
pub(super) fn earliest(jitter: &Jitter) -> u64 {
    (REACH * jitter.sigma()).ceil() as u64
}

/// The buttons and axes of all players.
pub(super) fn controls(course: &Course<'_>) -> Vec<Control> {
    let problem = course.problem;
    let is_used = |control: &Control| match control {
        Control::Button(player, button) => problem.unpressed(player.index()) >> button.index() & 1 == 0,
        Control::Axis(..) => true,
    };
    let players = problem.sim.world().players.ids();
    players.flat_map(|player| problem.sim.controls(player)).filter(is_used).collect()
}
