//! Candidates for soft locks where not all states can be visited: places at which players rest and from which nothing
//! arrives, neither a way of the roadmap nor a search of its own.

use std::collections::BTreeMap;

use crate::analysis::ConfigurationSpace;
use crate::ordered::Ordered;
use crate::sim::{Fault, Script};
use crate::watch::{Meter, Progress, Watch};

use super::super::outcome::{Argument, Verdict};
use super::super::problem::{BadStart, Problem};
use super::super::reach;
use super::super::search::{Limits, Settings};
use super::super::window::Windows;
use super::Spot;
use super::roadmap::Roadmap;
use super::rollout::{RolloutEnd, Rollouts};

/// Number of ways from each place.
const FIRST_WAYS: u32 = 96;
/// Maximum number of ways from a place from which none arrives.
const MAX_WAYS: u32 = 1536;
/// Number of ways from the start after which players that have never rested are taken never to rest.
const WAYS_WITHOUT_REST: u32 = 768;
/// The parts of all nodes that a search from a candidate has: first from all of them, then from those that are left.
const CHECK_PARTS: [u64; 2] = [40, 10];
/// The minimum of these nodes.
const MIN_CHECK: u64 = 4_000;
/// Number of steps of a found path between two looks for places to rest.
const PATH_STRIDE: usize = 6;

/// A group of places from which no search arrived.
#[derive(Debug, Clone, PartialEq)]
pub struct Candidate {
    /// Where the players are where it begins, in words.
    pub place: String,
    /// Where they were at rest before, in words.
    pub from: String,
    /// The inputs from the initial state to where it begins.
    pub script: Script,
    /// What differs from where they were before, in words, of all but the players and of what moves by itself.
    pub changes: Vec<String>,
    /// The number of places.
    pub places: u64,
    /// The nodes of the search that did not arrive.
    pub nodes: u64,
    /// Whether that search visited all states there are: the goal cannot be reached from where it begins.
    pub is_proven: bool,
}

/// Why there are no candidates.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Unknown {
    /// The goal was not found from the start.
    NotFound,
    /// The goal is proven unreachable from the start.
    Unreachable,
    /// The players never rest.
    NoRest,
    /// The watch stopped the search.
    Stopped,
}

/// The answer where not all states were visited.
#[derive(Debug, Clone, PartialEq)]
pub struct CandidateAnswer {
    /// The candidates, the largest first.
    pub candidates: Vec<Candidate>,
    /// The number of places at which players rest.
    pub rest_places: u64,
    /// The number of those of which nothing is known: the budget was spent.
    pub open_places: u64,
    /// Where the first player is in the places of candidates.
    pub spots: Vec<Spot>,
}

/// The budget of the search for candidates.
#[derive(Debug, Clone, Copy)]
pub struct CandidateLimits {
    /// Nodes and memory.
    pub limits: Limits,
    /// The seed.
    pub seed: u64,
}

/// Searches for candidates.
///
/// # Errors
/// A [`Fault`] if the initial state breaks a rule. Within it, why nothing can be said.
pub fn find_candidates(
    problem: &Problem<'_>,
    space: &ConfigurationSpace,
    CandidateLimits { limits, seed }: &CandidateLimits,
    watch: &dyn Watch,
) -> Result<Result<CandidateAnswer, Unknown>, Fault> {
    let settings = Settings { seed: *seed, checks: false, ..Settings::default() };
    let outcome = reach(problem, space, &settings, limits, watch)?;
    let path = match outcome.verdict {
        Verdict::Reached(plan) => plan.script,
        Verdict::Unreachable(_) => return Ok(Err(Unknown::Unreachable)),
        Verdict::NotFound | Verdict::Exhausted(_) if watch.stop() => return Ok(Err(Unknown::Stopped)),
        Verdict::NotFound | Verdict::Exhausted(_) => return Ok(Err(Unknown::NotFound)),
    };
    let Some(starts) = problem.starts(watch)? else { return Ok(Err(Unknown::Stopped)) };
    let Some(start) = starts.first() else { return Ok(Err(Unknown::NotFound)) };
    let mut roadmap = Roadmap::new(problem, &start.state)?;
    roadmap.places[0].is_at_goal = true;
    let rollouts = Rollouts::new(problem, Windows::new(problem, &starts), *seed);
    let mut search = Search {
        roadmap,
        rollouts,
        meter: Meter::new(watch),
        limits: *limits,
        failed: BTreeMap::new(),
        checks: (space, settings),
    };
    search.rest_along(&path);
    if !search.explore() {
        return Ok(Err(if search.meter.is_stopped() { Unknown::Stopped } else { Unknown::NoRest }));
    }
    search.check_all(CHECK_PARTS[0])?;
    search.try_again();
    search.check_all(CHECK_PARTS[1])?;
    Ok(Ok(search.answer()))
}

/// What a search from a place showed that did not arrive.
#[derive(Debug, Clone, Copy)]
struct Failure {
    /// Where it began.
    from: u32,
    /// The nodes that it could have.
    budget: u64,
    nodes: u64,
    is_proven: bool,
}

struct Search<'p> {
    roadmap: Roadmap<'p>,
    rollouts: Rollouts<'p>,
    meter: Meter<'p>,
    limits: Limits,
    /// The places from which a search of their own did not arrive.
    failed: BTreeMap<u32, Failure>,
    checks: (&'p ConfigurationSpace, Settings),
}

impl Search<'_> {
    /// Adds the places at which players rest when they let go on a path.
    fn rest_along(&mut self, path: &Script) {
        let problem = self.roadmap.problem;
        let (mut state, mut scratch) = (self.roadmap.places[0].state.clone(), problem.sim.scratch());
        for (step, input) in path.inputs().enumerate() {
            if step.is_multiple_of(PATH_STRIDE) {
                self.rollouts.start(&state);
                if self.rollouts.settle(self.checks.1.seed, &self.meter) == RolloutEnd::Rest {
                    let mut inputs = path.first(step as u64);
                    self.rollouts.script.steps.iter().for_each(|step| inputs.push(&step.input, step.count));
                    let place = self.roadmap.add(&self.rollouts.state, 0, inputs);
                    self.roadmap.connect(0, place);
                }
            }
            if problem.sim.step(&mut state, input, &mut scratch).is_err() {
                return;
            }
        }
    }

    /// Tries ways from all places until nothing new is found or the budget is spent. Returns false if the players never
    /// rest, or if it was stopped.
    fn explore(&mut self) -> bool {
        while self.rollouts.nodes < self.limits.nodes {
            let (nodes, places) = (self.rollouts.nodes, self.roadmap.places.len());
            let progress = Progress { nodes, budget: self.limits.nodes, places: places as u64 };
            self.meter.watch().progress(progress);
            let untried = (0..places as u32).filter(|place| self.roadmap.places[*place as usize].tried == 0);
            // Where players have not been yet comes before what only differs otherwise.
            let next = untried.min_by_key(|place| (self.roadmap.at_same_spot(*place), *place));
            let Some(place) = next else { break };
            self.try_ways(place, FIRST_WAYS);
            if self.meter.poll() {
                return false;
            }
        }
        if self.roadmap.places.len() > 1 {
            return true;
        }
        // Only the start: whether it is a place to rest is all that counts.
        while self.roadmap.places.len() == 1 && self.roadmap.places[0].tried < WAYS_WITHOUT_REST {
            self.try_ways(0, FIRST_WAYS);
            if self.meter.is_stopped() {
                return false;
            }
        }
        self.roadmap.places.len() > 1 || {
            self.rollouts.start(&self.roadmap.places[0].state.clone());
            self.rollouts.settle(0, &self.meter) == RolloutEnd::Rest
        }
    }

    /// Tries more ways from the places from which a search did not arrive, and from what they find, with half as many nodes
    /// again.
    fn try_again(&mut self) {
        let limit = self.rollouts.nodes + self.limits.nodes / 2;
        while self.rollouts.nodes < limit && !self.meter.poll() {
            let covered = self.covered(&self.suspects());
            let places = &self.roadmap.places;
            let untried = (0..places.len() as u32).find(|place| places[*place as usize].tried == 0);
            let next = untried.or_else(|| {
                let open = covered.into_keys().filter(|place| places[*place as usize].tried < MAX_WAYS);
                // From where searches began before what is behind them.
                open.min_by_key(|place| (!self.failed.contains_key(place), places[*place as usize].tried, *place))
            });
            let Some(place) = next else { return };
            let tried = places[place as usize].tried;
            self.try_ways(place, FIRST_WAYS.max(tried));
        }
    }

    fn try_ways(&mut self, from: u32, count: u32) {
        let state = self.roadmap.places[from as usize].state.clone();
        let tried = self.roadmap.places[from as usize].tried;
        for index in tried..tried + count {
            match self.rollouts.way(&state, (from, index), &self.meter) {
                RolloutEnd::Goal => self.roadmap.places[from as usize].is_at_goal = true,
                RolloutEnd::Rest => {
                    let to = self.roadmap.add(&self.rollouts.state, from, self.rollouts.script.clone());
                    self.roadmap.connect(from, to);
                }
                RolloutEnd::Lost => {}
                RolloutEnd::Stopped => return,
            }
        }
        self.roadmap.places[from as usize].tried += count;
    }

    /// The places from which nothing arrives, and that lead to no place of which nothing is known.
    fn suspects(&self) -> Vec<u32> {
        let leads = self.roadmap.leading_to(|place| place.is_at_goal || place.tried == 0);
        let mut suspects: Vec<u32> = (0..leads.len() as u32).filter(|place| !leads[*place as usize]).collect();
        suspects.order_by_key(|place| (self.roadmap.places[*place as usize].steps, *place));
        suspects
    }

    /// The suspects that are behind one from which a search did not arrive, with that search.
    fn covered(&self, suspects: &[u32]) -> BTreeMap<u32, Failure> {
        let mut is_suspect = vec![false; self.roadmap.places.len()];
        suspects.iter().for_each(|place| is_suspect[*place as usize] = true);
        let mut covered = BTreeMap::new();
        for (place, failure) in self.failed.iter().filter(|(place, _)| is_suspect[**place as usize]) {
            for behind in self.roadmap.behind(*place, |next| is_suspect[next as usize]) {
                covered.entry(behind).or_insert(*failure);
            }
        }
        covered
    }

    /// The nodes of a search from a candidate that has a part of all.
    fn budget(&self, part: u64) -> u64 {
        (self.limits.nodes / part).max(MIN_CHECK)
    }

    /// Searches from the suspects, those that are reached soonest first, until each is known to arrive or is behind one
    /// from which a search did not.
    fn check_all(&mut self, part: u64) -> Result<(), Fault> {
        let (budget, mut nodes) = (self.budget(part), 0);
        loop {
            let suspects = self.suspects();
            let mut covered = self.covered(&suspects);
            covered.retain(|_, failure| failure.is_proven || failure.budget >= budget);
            let Some(&place) = suspects.iter().find(|place| !covered.contains_key(place)) else { return Ok(()) };
            if nodes >= self.limits.nodes || self.meter.poll() {
                return Ok(());
            }
            nodes += self.check(place, budget)?;
        }
    }

    /// Searches from a place; returns the number of nodes.
    fn check(&mut self, place: u32, budget: u64) -> Result<u64, Fault> {
        let (space, settings) = self.checks;
        let watch = self.meter.watch();
        let problem = Problem::asking(self.roadmap.problem.sim, self.roadmap.problem.target);
        let mark = |search: &mut Self| {
            search.roadmap.places[place as usize].is_at_goal = true;
            Ok(1)
        };
        let problem = match problem.after_watched(self.roadmap.script(place), watch) {
            Ok(problem) => problem,
            Err(BadStart::Fault(fault, _)) => return Err(fault),
            // What cannot be replayed is no candidate.
            Err(BadStart::Over(..) | BadStart::Stopped) => return mark(self),
        };
        let is_replayed = problem.starts(watch)?.is_some_and(|starts| {
            starts.first().is_some_and(|start| *start.state == *self.roadmap.places[place as usize].state)
        });
        debug_assert!(is_replayed, "a way to a place must replay");
        if !is_replayed {
            return mark(self);
        }
        let limits = Limits { nodes: budget, ..self.limits };
        let outcome = reach(&problem, space, &settings, &limits, watch)?;
        let nodes = outcome.statistics.nodes;
        let is_proven = match outcome.verdict {
            Verdict::Reached(_) => return mark(self).map(|_| nodes.max(1)),
            Verdict::Unreachable(Argument::Exhaustion(_)) => true,
            Verdict::Unreachable(_) | Verdict::NotFound | Verdict::Exhausted(_) => false,
        };
        if !self.meter.poll() {
            self.failed.insert(place, Failure { from: place, budget, nodes, is_proven });
        }
        Ok(nodes.max(1))
    }

    fn answer(&self) -> CandidateAnswer {
        let suspects = self.suspects();
        let mut covered = self.covered(&suspects);
        // Of what was not searched for long enough, nothing is said.
        let budget = self.budget(CHECK_PARTS[1]);
        let is_tried = |place: u32| self.roadmap.places[place as usize].tried >= MAX_WAYS;
        covered.retain(|_, failure| failure.is_proven || (failure.budget >= budget && is_tried(failure.from)));
        let untried = self.roadmap.places.iter().filter(|place| place.tried == 0).count();
        let open_places = (untried + suspects.len() - covered.len()) as u64;
        let covered = self.going_on(covered);
        let mut candidates: Vec<Candidate> =
            self.regions(&covered).iter().filter_map(|region| self.candidate(region, &covered)).collect();
        // The largest first, of equally large ones what is reached sooner.
        candidates.order_by_key(|candidate| (u64::MAX - candidate.places, candidate.script.len()));
        CandidateAnswer {
            candidates,
            rest_places: self.roadmap.places.len() as u64,
            open_places,
            spots: covered.keys().filter_map(|place| self.spot(*place)).collect(),
        }
    }

    /// Those of some places from which the run can go on for ever among them: where all ways end the run, nobody is stuck.
    fn going_on(&self, mut places: BTreeMap<u32, Failure>) -> BTreeMap<u32, Failure> {
        loop {
            let goes_on = |place: &u32| {
                let place = &self.roadmap.places[*place as usize];
                place.returns || place.next.iter().any(|next| places.contains_key(next))
            };
            let ends: Vec<u32> = places.keys().copied().filter(|place| !goes_on(place)).collect();
            if ends.is_empty() {
                return places;
            }
            ends.iter().for_each(|place| {
                places.remove(place);
            });
        }
    }

    /// Groups of places that ways connect.
    fn regions(&self, covered: &BTreeMap<u32, Failure>) -> Vec<Vec<u32>> {
        let mut region_of: BTreeMap<u32, u32> = covered.keys().map(|place| (*place, *place)).collect();
        let mut has_changed = true;
        while has_changed {
            has_changed = false;
            for &from in covered.keys() {
                for to in &self.roadmap.places[from as usize].next {
                    let (Some(&a), Some(&b)) = (region_of.get(&from), region_of.get(to)) else { continue };
                    if a != b {
                        region_of.insert(from, a.min(b));
                        region_of.insert(*to, a.min(b));
                        has_changed = true;
                    }
                }
            }
        }
        let mut regions: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
        for (place, region) in region_of {
            regions.entry(region).or_default().push(place);
        }
        regions.into_values().collect()
    }

    fn candidate(&self, region: &[u32], covered: &BTreeMap<u32, Failure>) -> Option<Candidate> {
        let places = &self.roadmap.places;
        let first = *region.iter().min_by_key(|place| (places[**place as usize].steps, **place))?;
        let (at, failure) = (&places[first as usize], covered.get(&first)?);
        let from = &places[at.parent as usize];
        let names = &self.roadmap.names;
        Some(Candidate {
            place: names.words(&at.key.0),
            from: names.words(&from.key.0),
            script: self.roadmap.script(first),
            changes: names.differences(&from.state, &at.state, &self.roadmap.calm),
            places: region.len() as u64,
            nodes: failure.nodes,
            // The proof is about the state from which the search began.
            is_proven: self.failed.get(&first).is_some_and(|failure| failure.is_proven),
        })
    }

    fn spot(&self, place: u32) -> Option<Spot> {
        let problem = self.roadmap.problem;
        let player = *problem.players().first()?;
        let state = &self.roadmap.places[place as usize].state;
        let (x, y) = problem.sim.position(state, player);
        Some((problem.sim.space(state, player), [x as f32, y as f32]))
    }
}
