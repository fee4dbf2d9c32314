//! The graph of all reachable states: each state once, with the states that its inputs lead to. It is complete or it is
//! not given at all, since what is concluded from it is a proof.

use std::hash::BuildHasher;

use hashbrown::{DefaultHashBuilder, HashTable};

use crate::ir::SpaceId;
use crate::sim::{Fault, Input, Script};
use crate::watch::{Meter, Progress, Watch};

use super::super::controls::ControlSets;
use super::super::problem::{Problem, StateStatus};
use super::super::search::Limits;
use super::super::tree::{NodeId, Tree};
use super::super::window::Windows;

/// The number of steps that a state of the budget stands for.
const STEPS_PER_STATE: u64 = 32;
/// Number of states between two reports of the progress.
const ROUND: u32 = 512;

/// Why not all states were visited.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Gap {
    /// There are too many combinations of buttons.
    Inputs,
    /// Nature draws from too many values.
    Draws,
    /// A player left the search window of a space without written bounds.
    Window(SpaceId),
    /// A run-time error, with its step (from 1).
    Fault(Fault, u64),
    /// There are more states than nodes in the budget, or they have too many inputs for it.
    Nodes,
    /// The memory is full.
    Memory,
    /// The watch stopped it.
    Stopped,
}

/// All reachable states of a world, up to those in which the goal holds.
pub(super) struct StateGraph {
    /// The states in the order in which they were reached, each with a shortest way.
    pub tree: Tree,
    /// For each state, where its successors begin; one entry more than states.
    pub first: Vec<u32>,
    /// The successors: each state that an input leads to, once.
    pub next: Vec<u32>,
    /// Whether the goal holds. Such a state has no successors.
    pub is_goal: Vec<bool>,
    /// Whether an input ends the run.
    pub can_end: Vec<bool>,
    /// Whether no player is left.
    pub is_gone: Vec<bool>,
}

impl StateGraph {
    /// The number of states.
    pub fn len(&self) -> usize {
        self.is_goal.len()
    }

    /// The successors of a state.
    pub fn successors(&self, state: u32) -> &[u32] {
        successors(&self.first, &self.next, state)
    }
}

/// The successors of a state in two tables as those of [`StateGraph`].
pub(super) fn successors<'n>(first: &[u32], next: &'n [u32], state: u32) -> &'n [u32] {
    let at = state as usize;
    &next[first[at] as usize..first[at + 1] as usize]
}

/// The outcome of one input.
enum Stepped {
    /// A state in which the run goes on; whether the goal holds.
    To { is_goal: bool },
    /// The run is over.
    Over,
}

/// Visits states breadth first.
pub(super) struct Explorer<'p> {
    problem: &'p Problem<'p>,
    windows: Windows,
    controls: ControlSets,
    meter: Meter<'p>,
    /// Number of simulated steps.
    steps: u64,
    scratch: crate::sim::Scratch,
    work: Vec<u8>,
    graph: StateGraph,
    hashes: DefaultHashBuilder,
    /// The hash of each state.
    state_hashes: Vec<u64>,
    /// For the states of nodes.
    buffer: Vec<u8>,
    known: HashTable<u32>,
}

impl<'p> Explorer<'p> {
    /// An explorer of all states that can be reached from the start of a problem. `None` if the watch stops it, or if
    /// the run is over at its start.
    ///
    /// # Errors
    /// A [`Fault`] if the initial state breaks a rule.
    pub fn new(problem: &'p Problem<'p>, watch: &'p dyn Watch) -> Result<Option<Self>, Fault> {
        let Some(starts) = problem.starts(watch)? else { return Ok(None) };
        let Some(start) = starts.first() else { return Ok(None) };
        let is_goal = match problem.judge(&start.state)? {
            StateStatus::Dead(_) => return Ok(None),
            status => status == StateStatus::Goal,
        };
        let size = problem.sim.world().layout.size;
        let mut explorer = Explorer {
            problem,
            windows: Windows::new(problem, &starts),
            controls: ControlSets::complete().with_draws(problem),
            meter: Meter::new(watch),
            steps: 0,
            scratch: problem.sim.scratch(),
            work: start.state.to_vec(),
            graph: StateGraph {
                tree: Tree::new(size),
                first: vec![0],
                next: Vec::new(),
                is_goal: Vec::new(),
                can_end: Vec::new(),
                is_gone: Vec::new(),
            },
            hashes: DefaultHashBuilder::default(),
            state_hashes: Vec::new(),
            buffer: Vec::new(),
            known: HashTable::new(),
        };
        explorer.found(None, is_goal);
        Ok(Some(explorer))
    }

    /// Visits all states.
    ///
    /// # Errors
    /// Why there may be states that it cannot visit.
    pub fn explore(mut self, limits: &Limits) -> Result<(StateGraph, ControlSets), Gap> {
        let mut at = 0u32;
        while (at as usize) < self.graph.len() {
            if at.is_multiple_of(ROUND) {
                let nodes = self.graph.len() as u64;
                self.meter.watch().progress(Progress { nodes, budget: limits.nodes, places: 0 });
                if self.bytes() > limits.memory {
                    return Err(Gap::Memory);
                }
            }
            if self.graph.len() as u64 > limits.nodes || self.steps > limits.nodes.saturating_mul(STEPS_PER_STATE) {
                return Err(Gap::Nodes);
            }
            self.expand(at)?;
            at += 1;
        }
        Ok((self.graph, self.controls))
    }

    fn bytes(&self) -> u64 {
        let graph = &self.graph;
        let tables = 4 * (graph.first.capacity() + graph.next.capacity()) + 3 * graph.is_goal.capacity();
        (graph.tree.bytes() + tables + self.known.capacity() * 5 + self.state_hashes.capacity() * 8) as u64
    }

    /// Tries all inputs of a state.
    fn expand(&mut self, at: u32) -> Result<(), Gap> {
        let begin = self.graph.next.len();
        let mut can_end = false;
        if !self.graph.is_goal[at as usize] {
            let node = NodeId(at);
            let set = self.graph.tree.set(node);
            let was_beyond = self.windows.left(self.problem, self.graph.tree.state(node, &mut self.buffer)).is_some();
            for input in 0..self.controls.count(set) {
                match self.step(node, input, was_beyond)? {
                    Stepped::Over => can_end = true,
                    Stepped::To { is_goal } => {
                        let next = self.found(Some((node, input)), is_goal);
                        if !self.graph.next[begin..].contains(&next) {
                            self.graph.next.push(next);
                        }
                    }
                }
            }
        }
        let end = u32::try_from(self.graph.next.len()).map_err(|_| Gap::Memory)?;
        self.graph.first.push(end);
        self.graph.can_end[at as usize] = can_end;
        Ok(())
    }

    /// Simulates an input of a state.
    fn step(&mut self, node: NodeId, index: usize, was_beyond: bool) -> Result<Stepped, Gap> {
        self.steps += 1;
        let Explorer { problem, work, scratch, controls, meter, graph, buffer, .. } = self;
        work.copy_from_slice(graph.tree.state(node, buffer));
        let input = input_of(controls, graph.tree.set(node), index);
        let stepped = problem.sim.metered_step(work, &input, scratch, meter);
        if meter.is_stopped() {
            return Err(Gap::Stopped);
        }
        let step = u64::from(graph.tree.depth(node)) + 1;
        let fault = |fault| Gap::Fault(fault, step);
        stepped.map_err(fault)?;
        if !problem.sim.draws().is_empty() {
            let read = problem.sim.drawn(&input, scratch).1;
            if read.iter().any(|(id, _)| input.1.get(id).is_none()) {
                return Err(Gap::Draws);
            }
        }
        let is_goal = match problem.judge(work).map_err(fault)? {
            StateStatus::Dead(_) => return Ok(Stepped::Over),
            StateStatus::Goal => true,
            StateStatus::Open => false,
        };
        // One state beyond a window is simulated, as in a search.
        if !is_goal
            && was_beyond
            && let Some(space) = self.windows.left(self.problem, &self.work)
        {
            return Err(Gap::Window(space));
        }
        Ok(Stepped::To { is_goal })
    }

    /// The number of the state after the last simulation, which is added if it is new.
    fn found(&mut self, from: Option<(NodeId, usize)>, is_goal: bool) -> u32 {
        let hash = self.hashes.hash_one(&self.work);
        let tree = &self.graph.tree;
        if let Some(known) = self.known.find(hash, |id| tree.has_state(NodeId(*id), &self.work)) {
            return *known;
        }
        let set = self.controls.of(self.problem, &self.work);
        let node = match from {
            None => self.graph.tree.add_root(&self.work, 0, set, 0),
            // At most `MAX_CONTROLS` inputs.
            Some((parent, input)) => self.graph.tree.push(&self.work, parent, (input as u16, 1), set, 0),
        };
        self.state_hashes.push(hash);
        self.known.insert_unique(hash, node.0, |id| self.state_hashes[*id as usize]);
        self.graph.is_goal.push(is_goal);
        self.graph.can_end.push(false);
        let mut players = self.problem.players().iter();
        self.graph.is_gone.push(players.all(|slot| !self.problem.sim.instance(&self.work, *slot).is_alive()));
        node.0
    }

    /// Whether inputs were left out because there are too many.
    pub fn leaves_out_inputs(&self) -> bool {
        self.controls.truncated
    }
}

/// An input of a control set, with what it fixes of nature.
pub(super) fn input_of(controls: &ControlSets, set: u16, index: usize) -> Input {
    let mut input = Input::of_players(controls.input(set, index).0.clone());
    controls.fix_draws(set, index, &mut input.1);
    input
}

/// The inputs of a shortest way to a state, and then one more input if one is given.
pub(super) fn script_to(graph: &StateGraph, controls: &ControlSets, state: u32, then: Option<usize>) -> Script {
    let mut script = Script::default();
    for choice in graph.tree.choices(NodeId(state)) {
        script.push(&input_of(controls, graph.tree.set(choice.node), choice.input), 1);
    }
    if let Some(index) = then {
        script.push(&input_of(controls, graph.tree.set(NodeId(state)), index), 1);
    }
    script
}
