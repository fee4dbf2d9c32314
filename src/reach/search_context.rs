//! The context of planners: the tree, the inputs of its nodes, the simulator, and the notes of the search. The loops
//! (`sampler.rs`, `exhaustive.rs`) own it; strategies borrow it.

use rand_pcg::Pcg64;

use crate::ir::{NeverId, SpaceId};
use crate::sim::{Fault, Input, Scratch, Script};
use crate::watch::{Meter, PollLimit, Watch};

use super::controls::ControlSets;
use super::coverage::Coverage;
use super::distance::DistanceField;
use super::explore::Reached;
use super::ledges::Gauge;
use super::luck::{Luck, only_read};
use super::metric::{Metric, Point};
use super::outcome::{Cut, Plan, Statistics, Visited, join_records};
use super::problem::{Problem, Start, StateStatus, Termination};
use super::strategy::Choice;
use super::tree::{NodeId, Tree};
use super::why_not::{Nearest, Tracker};
use super::window::Windows;

/// Number of polls after which a final short replay is stopped: a few tenths of a second.
pub(super) const REPLAY_POLLS: u32 = 100;

/// How an extension ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Extension {
    /// The input was held to the end.
    Open,
    /// The branch ended earlier.
    Dead,
    /// The target holds after this number of steps.
    Goal(u16),
}

/// Results of a search besides its tree.
#[derive(Debug, Default)]
pub(super) struct Notes {
    pub statistics: Statistics,
    /// The first counterexample to each `never`.
    pub violations: Vec<(NeverId, Script)>,
    /// The first run-time error, with its step.
    pub fault: Option<(Fault, u64)>,
    pub coverage: Coverage,
    /// Whether inputs were left out because there are too many.
    pub is_truncated: bool,
    /// Whether a step has read a draw of which not all values are tried.
    pub has_open_draws: bool,
    /// Every node, if nodes are recorded.
    pub record: Vec<Visited>,
    /// If all states were visited without an answer for inputs that change only every few steps: the finest such
    /// inputs, as the number of steps and of states. Proves nothing about others.
    pub exhausted: Option<(u16, u64)>,
    /// Branches given up at search windows although the target may lie beyond.
    pub cuts: Vec<Cut>,
    /// The states that came nearest to the target, if they are kept.
    pub nearest: Option<Nearest>,
}

impl Notes {
    /// Adds the notes of another search; first entries take precedence.
    pub fn join(&mut self, other: &Notes) {
        self.statistics.add(&other.statistics);
        for (never, script) in &other.violations {
            if self.violations.iter().all(|(known, _)| known != never) {
                self.violations.push((*never, script.clone()));
            }
        }
        if self.fault.is_none() {
            self.fault = other.fault;
        }
        self.coverage.join(&other.coverage);
        join_records(&mut self.record, &other.record);
        self.is_truncated |= other.is_truncated;
        self.has_open_draws |= other.has_open_draws;
        other.cuts.iter().for_each(|cut| self.cut(*cut));
        if let Some(nearest) = &other.nearest {
            self.nearest.get_or_insert_default().join(nearest);
        }
        self.exhausted = match (self.exhausted, other.exhausted) {
            (Some(a), Some(b)) => Some(if b.0 < a.0 { b } else { a }),
            (a, b) => a.or(b),
        };
    }

    /// Counts abandoned branches.
    fn cut(&mut self, cut: Cut) {
        match self.cuts.iter_mut().find(|known| known.space == cut.space) {
            Some(known) => {
                known.branches += cut.branches;
                known.soonest = known.soonest.min(cut.soonest);
            }
            None => self.cuts.push(cut),
        }
    }
}

/// A tree with its world.
pub struct SearchContext<'a> {
    /// The question.
    pub problem: &'a Problem<'a>,
    /// The space that is sampled.
    pub metric: &'a Metric,
    windows: &'a Windows,
    /// The tree that grows.
    pub tree: Tree,
    /// The random number generator.
    pub rng: Pcg64,
    /// Counts work and polls the watch.
    pub(super) meter: Meter<'a>,
    pub(super) controls: ControlSets,
    pub(super) notes: Notes,
    /// Range of the number of steps for which an input is held.
    pub(super) hold: (u16, u16),
    pub(super) starts: Vec<Start>,
    /// Number of them that are of the question; the others are states on ways of other searches, of which `latest` came last.
    own: usize,
    pub(super) latest: usize,
    /// For each root of the tree, its start.
    roots: Vec<(NodeId, usize)>,
    scratch: Scratch,
    /// What nature draws, if it does.
    pub(super) luck: Option<Luck>,
    /// The state after the last simulation, or of the last root.
    work: Vec<u8>,
    /// For states of nodes.
    pub(super) buffer: Vec<u8>,
    /// Whether a state was outside the configuration space: one is enough.
    is_refuted: bool,
    /// The index of the tree's first node in the record, if nodes are recorded.
    recorded: Option<usize>,
    /// Keeps the nearest states, if a missing answer is to be explained.
    tracker: Option<Box<Tracker<'a>>>,
    /// Ends extensions where players land, if that is what a strategy looks for.
    pub(super) gauge: Option<Box<Gauge>>,
    /// The number of steps after which it has ended the last one.
    landed: Option<u16>,
}

impl<'a> SearchContext<'a> {
    /// The context of a search from some starts.
    pub(super) fn new(
        problem: &'a Problem<'a>,
        (metric, windows): (&'a Metric, &'a Windows),
        controls: ControlSets,
        starts: Vec<Start>,
        hold: (u16, u16),
        mut rng: Pcg64,
        watch: &'a dyn Watch,
    ) -> Self {
        let size = problem.sim.world().layout.size;
        let luck = Luck::new(problem, &mut rng);
        SearchContext {
            problem,
            metric,
            windows,
            tree: Tree::new(size),
            rng,
            meter: Meter::new(watch),
            controls,
            notes: Notes { coverage: Coverage::new(problem), ..Notes::default() },
            hold: {
                let least = hold.0.max(problem.min_hold());
                (least, hold.1.max(least))
            },
            own: starts.len(),
            latest: 0,
            starts,
            roots: Vec::new(),
            scratch: problem.sim.remembering_scratch(),
            luck,
            work: vec![0; size],
            buffer: Vec::with_capacity(size),
            is_refuted: false,
            recorded: None,
            tracker: None,
            gauge: None,
            landed: None,
        }
    }

    /// Keeps the states that come nearest to the target from now on.
    #[must_use]
    pub(super) fn tracking(mut self, tracks: bool, distances: Option<&'a DistanceField>) -> Self {
        self.tracker = tracks.then(|| Box::new(Tracker::new(self.problem, distances)));
        self
    }

    /// Keeps no more of them.
    pub(super) fn stop_tracking(&mut self) {
        self.tracker = None;
    }

    /// Records all nodes from now on.
    #[must_use]
    pub(super) fn recording(mut self, records: bool) -> Self {
        self.recorded = records.then_some(0);
        self
    }

    /// Records the node that was added last.
    fn record(&mut self, parent: NodeId) {
        let (Some(begin), Some(&player)) = (self.recorded, self.problem.players().first()) else { return };
        let place = |state: &[u8]| {
            let (x, y) = self.problem.sim.position(state, player);
            (self.problem.sim.space(state, player), [x as f32, y as f32])
        };
        let (space, at) = place(&self.work);
        let before = place(self.tree.state(parent, &mut self.buffer));
        let before = Some(before).filter(|(of, _)| *of == space).map(|(_, at)| at);
        let parent = (begin + parent.index()) as u32;
        self.notes.record.push(Visited { parent, space, at });
        self.meter.watch().node(space.0 as usize, at, before);
    }

    /// Number of starts of the question.
    pub(super) fn starts(&self) -> usize {
        self.own
    }

    /// Whether a start is one of several that nature could have led to.
    pub(super) fn is_by_luck(&self) -> bool {
        self.starts.iter().any(|start| start.is_by_luck)
    }

    /// The states of the starts, with the number of steps since the search began.
    pub(super) fn start_states(&self) -> impl Iterator<Item = (&[u8], u32)> {
        self.starts[..self.own].iter().map(|start| (&*start.state, start.steps()))
    }

    /// Removes the tree.
    pub(super) fn clear(&mut self) {
        if let Some(mut tracker) = self.tracker.take() {
            tracker.end_tree(|choice, step| self.script(choice, step));
            self.tracker = Some(tracker);
        }
        self.tree.clear();
        self.roots.clear();
        self.starts.drain(self.own..self.starts.len() - self.latest);
        self.luck.iter_mut().for_each(Luck::change);
        if let Some(begin) = &mut self.recorded {
            *begin = self.notes.record.len();
        }
    }

    /// Adds a root at a start.
    pub(super) fn add_root(&mut self, start: usize, inputs_one_by_one: bool) -> NodeId {
        let (state, depth) = (&self.starts[start].state, self.starts[start].steps());
        self.work.copy_from_slice(state);
        let set = self.controls.of(self.problem, state);
        let inputs = if inputs_one_by_one { self.controls.count(set) } else { 0 };
        let root = self.tree.add_root(state, depth, set, inputs);
        self.roots.push((root, start));
        self.notes.statistics.nodes += 1;
        self.notes.coverage.visit(self.problem, state);
        self.record(root);
        if let Some(tracker) = &mut self.tracker {
            tracker.add_root(self.problem.sim, &self.starts[start].state, root);
        }
        if let Some(observer) = self.problem.observer() {
            let start = &self.starts[start];
            let reached = Reached { steps: u64::from(start.steps()), script: &|| start.script.clone() };
            observer.see(self.problem.sim, &start.state, &self.scratch, &reached);
        }
        self.check_root(start);
        root
    }

    /// Simulates a choice, and updates the statistics and notes.
    pub(super) fn extend(&mut self, choice: Choice) -> Extension {
        let extension = self.simulate(choice);
        let s = &mut self.notes.statistics;
        s.extensions += 1;
        s.failures += u64::from(extension == Extension::Dead);
        extension
    }

    /// Simulates a choice without adding to the tree; `point` is the resulting state.
    pub fn preview(&mut self, choice: Choice, point: &mut Point) -> Extension {
        let extension = self.simulate(choice);
        self.reached_point(point);
        extension
    }

    fn simulate(&mut self, choice: Choice) -> Extension {
        self.work.copy_from_slice(self.tree.state(choice.node, &mut self.buffer));
        let set = self.tree.set(choice.node);
        let left = self.problem.time().map_or(u32::MAX, |most| most.saturating_sub(self.tree.depth(choice.node)));
        let mut was_beyond = self.windows.left(self.problem, &self.work).is_some();
        let first = self.first_step(choice.node);
        if let Some(tracker) = &mut self.tracker {
            tracker.begin(self.problem.sim, &self.work, choice.node);
        }
        self.landed = None;
        if let Some(gauge) = &mut self.gauge {
            gauge.begin(self.problem.sim, &self.work);
        }
        for step in 1..=choice.hold {
            if u32::from(step) > left {
                return Extension::Dead;
            }
            self.notes.statistics.steps += 1;
            let mut input: &Input = self.controls.input(set, choice.input);
            if let Some(luck) = &mut self.luck {
                luck.draw(self.problem, &self.controls, (&self.tree, first), choice, step);
                input = &luck.input;
            }
            let stepped = self.problem.sim.metered_step(&mut self.work, input, &mut self.scratch, &self.meter);
            if self.meter.is_stopped() {
                // The tree is left unchanged; the result means nothing.
                return Extension::Dead;
            }
            if let Some(luck) = &self.luck {
                self.notes.has_open_draws |= luck.leaves_open(self.problem.sim, &self.scratch);
            }
            let judged = stepped.and_then(|()| self.problem.judge(&self.work));
            // A state that ends a run was reached, too.
            if let Some(observer) = self.problem.observer()
                && matches!(judged, Ok(StateStatus::Open | StateStatus::Dead(Termination::Never(_))))
            {
                let steps = u64::from(self.tree.depth(choice.node)) + u64::from(step);
                let reached = Reached { steps, script: &|| self.script(choice, step) };
                observer.see(self.problem.sim, &self.work, &self.scratch, &reached);
            }
            if let (Some(tracker), Ok(StateStatus::Open)) = (&mut self.tracker, judged) {
                tracker.see(self.problem.sim, &self.work, choice, step);
            }
            match judged {
                // Comparisons of a position take effect in the next step: one state beyond the window is simulated,
                // whatever the speed.
                Ok(StateStatus::Open) => {
                    match self.windows.left(self.problem, &self.work) {
                        Some(space) if was_beyond => {
                            self.record_cut(space, self.tree.depth(choice.node) + u32::from(step));
                            return Extension::Dead;
                        }
                        left => was_beyond = left.is_some(),
                    }
                    if let Some(gauge) = &mut self.gauge
                        && gauge.see(self.problem.sim, &self.work)
                        && step >= self.hold.0
                    {
                        self.landed = Some(step);
                        return Extension::Open;
                    }
                }
                Ok(StateStatus::Goal) => return Extension::Goal(step),
                Ok(StateStatus::Dead(death)) => {
                    self.record_termination(choice, step, death);
                    return Extension::Dead;
                }
                Err(fault) => {
                    if self.notes.fault.is_none() {
                        let path = self.script(choice, step);
                        self.notes.fault = Some((fault, path.len()));
                    }
                    return Extension::Dead;
                }
            }
        }
        Extension::Open
    }

    /// A choice with the number of steps for which it was held in the last extension.
    pub(super) fn as_held(&self, choice: Choice) -> Choice {
        Choice { hold: self.landed.unwrap_or(choice.hold), ..choice }
    }

    /// Whether the last extension ended where the player landed.
    pub(super) fn has_landed(&self) -> bool {
        self.landed.is_some()
    }

    fn record_cut(&mut self, space: SpaceId, soonest: u32) {
        if let Some(window) = self.windows.of(space) {
            self.notes.cut(Cut { space, window: *window, branches: 1, soonest });
        }
    }

    fn record_termination(&mut self, choice: Choice, step: u16, death: Termination) {
        if let Termination::Never(never) = death
            && self.notes.violations.iter().all(|(known, _)| *known != never)
        {
            let script = self.script(choice, step);
            self.notes.violations.push((never, script));
        }
    }

    /// Adds the result of the last simulation.
    pub(super) fn add(&mut self, choice: Choice, inputs_one_by_one: bool) -> NodeId {
        let set = self.controls.of(self.problem, &self.work);
        let inputs = if inputs_one_by_one { self.controls.count(set) } else { 0 };
        self.notes.statistics.nodes += 1;
        self.notes.coverage.visit(self.problem, &self.work);
        let node = self.tree.push(&self.work, choice.node, (choice.input as u16, choice.hold), set, inputs);
        self.record(choice.node);
        if let Some(tracker) = &mut self.tracker {
            tracker.add();
        }
        self.check(choice);
        node
    }

    /// Checks the result of the last simulation; its predecessor was checked before.
    fn check(&mut self, choice: Choice) {
        let Some(monitor) = self.problem.monitor().filter(|_| !self.is_refuted) else { return };
        self.notes.statistics.checked += 1;
        let before = self.tree.state(choice.node, &mut self.buffer);
        if !monitor.contains_after(self.problem.sim.world(), &self.work, before) {
            self.is_refuted = true;
            monitor.refute(self.problem, self.script(choice, choice.hold), &self.work, &self.meter);
        }
    }

    fn check_root(&mut self, start: usize) {
        let Some(monitor) = self.problem.monitor().filter(|_| !self.is_refuted) else { return };
        self.notes.statistics.checked += 1;
        let start = &self.starts[start];
        if !monitor.contains(self.problem.sim.world(), &start.state) {
            self.is_refuted = true;
            monitor.refute(self.problem, start.script.clone(), &start.state, &self.meter);
        }
    }

    /// The state after the last simulation, or of the root that was added after it.
    pub(super) fn reached(&self) -> &[u8] {
        &self.work
    }

    /// The same as a point of the sampled space.
    pub(super) fn reached_point(&self, out: &mut Point) {
        self.metric.point(self.problem.sim.world(), &self.work, out);
    }

    /// A node as a point of the sampled space.
    pub fn point(&mut self, node: NodeId, out: &mut Point) {
        self.metric.point(self.problem.sim.world(), self.tree.state(node, &mut self.buffer), out);
    }

    /// The start of the tree that a node is in.
    pub(super) fn start(&self, node: NodeId) -> &Start {
        let root = self.tree.root(node);
        let start = self.roots.iter().find(|(r, _)| *r == root).map_or(0, |(_, start)| *start);
        &self.starts[start]
    }

    /// The inputs from the initial state to the end of a choice that lasts `steps` steps.
    pub(super) fn script(&self, choice: Choice, steps: u16) -> Script {
        let mut script = self.start(choice.node).script.clone();
        let last = Choice { hold: steps, ..choice };
        let Some(mut luck) = self.luck.clone() else {
            for choice in self.tree.choices(choice.node).into_iter().chain([last]) {
                let input = self.controls.input(self.tree.set(choice.node), choice.input);
                script.push(input, u32::from(choice.hold));
            }
            return script;
        };
        let all = self.tree.choices(choice.node).into_iter().map(|c| (c, c.hold)).chain([(choice, steps)]);
        for (choice, steps) in all {
            let first = self.first_step(choice.node);
            for step in 1..=steps {
                luck.draw(self.problem, &self.controls, (&self.tree, first), choice, step);
                script.push(&luck.input, 1);
            }
        }
        script
    }

    /// The number of the first step from a node, from the initial state on; 0 where it plays no part.
    pub(super) fn first_step(&self, node: NodeId) -> u64 {
        if !self.problem.is_foretold() {
            return 0;
        }
        let after = if let [only] = &*self.starts { only.after } else { self.start(node).after };
        after + u64::from(self.tree.depth(node)) + 1
    }

    /// The plan to the target, which a choice reaches after `steps` steps; replayed.
    pub(super) fn plan(&mut self, choice: Choice, steps: u16, is_shortest: bool) -> Option<Plan> {
        let after = self.start(choice.node).after;
        let script = self.script(choice, steps);
        // A path found before the stop still counts, if a short replay confirms it.
        let poll_limit = PollLimit::new(REPLAY_POLLS);
        let late = Meter::new(&poll_limit);
        let meter = if self.meter.is_stopped() { &late } else { &self.meter };
        let length = replays_to(self.problem, &script, after, &mut self.scratch, meter);
        debug_assert!(meter.is_stopped() || length == Some(script.len()), "a found path must replay");
        if length != Some(script.len()) {
            return None;
        }
        let script = if self.luck.is_some() { only_read(self.problem, &script, after, meter)? } else { script };
        Some(Plan { steps: script.len(), script, after, is_shortest })
    }

    /// The input of a node's start that is still held, as an index into the node's control set; `None` at an initial
    /// state, and if it is not in the set.
    pub(super) fn held_at_start(&self, root: NodeId) -> Option<u16> {
        let last = &self.start(root).script.steps.last()?.input;
        let set = self.tree.set(root);
        let read = self.controls.relevant(self.problem, last);
        (0..self.controls.count(set)).find(|&index| *self.controls.input(set, index) == read).map(|index| index as u16)
    }

    /// Adds the notes.
    pub(super) fn report(&self, notes: &mut Notes) {
        notes.join(&self.notes);
        notes.is_truncated |= self.controls.truncated;
        if let Some(tracker) = &self.tracker {
            let nearest = tracker.nearest(|choice, step| self.script(choice, step));
            notes.nearest.get_or_insert_default().join(&nearest);
        }
    }

    /// Memory use, bytes.
    pub(super) fn bytes(&self) -> usize {
        let tracked = self.tracker.as_ref().map_or(0, |tracker| tracker.bytes());
        let recorded = self.notes.record.capacity() * size_of::<Visited>();
        self.tree.bytes() + self.notes.coverage.bytes() + recorded + tracked + self.scratch.bytes()
    }
}

/// Runs a script from the initial state. Returns the number of steps after which the target first holds, ignoring the
/// first `skipped` ones; `None` if a branch ends before, or if the meter stops it.
pub(super) fn replays_to(
    problem: &Problem<'_>,
    script: &Script,
    skipped: u64,
    scratch: &mut Scratch,
    meter: &Meter<'_>,
) -> Option<u64> {
    let mut state = problem.sim.metered_initial(scratch, meter).ok().filter(|_| !meter.is_stopped())?;
    let mut inputs = script.inputs();
    let mut step = 0;
    let mut monitor = problem.monitor();
    loop {
        if step >= skipped {
            let status = problem.judge(&state).ok()?;
            if !status.is_over(problem.target)
                && monitor.is_some_and(|monitor| !monitor.contains(problem.sim.world(), &state))
            {
                monitor.take().inspect(|monitor| monitor.refute(problem, script.first(step), &state, meter));
            }
            match status {
                StateStatus::Open => {}
                StateStatus::Goal => return Some(step),
                StateStatus::Dead(_) => return None,
            }
        }
        let input = problem.draw(step + 1, inputs.next()?);
        problem.sim.metered_step(&mut state, &input, scratch, meter).ok()?;
        if meter.is_stopped() {
            return None;
        }
        step += 1;
    }
}
