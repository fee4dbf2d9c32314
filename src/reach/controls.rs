//! The inputs worth trying: buttons up or down, axes at -1, 0 and 1. Either those that an active mode reads, or all that
//! anything ever reads.

use std::collections::BTreeMap;

use crate::ir::{Inputs, LeafId};
use crate::sim::{Input, PlayerInput};

use super::problem::Problem;

/// The most inputs that are tried at one node.
pub const MAX_CONTROLS: usize = 4_096;

/// The inputs for each combination of the players' active leaves, made when a combination is first met.
#[derive(Debug, Clone, Default)]
pub struct ControlSets {
    sets: Vec<Vec<Input>>,
    known: BTreeMap<Vec<LeafId>, u16>,
    key: Vec<LeafId>,
    /// One set for all states: every input that anything reads.
    is_complete: bool,
    /// Whether some inputs were left out because there were more than [`MAX_CONTROLS`].
    pub truncated: bool,
}

impl ControlSets {
    /// The same inputs everywhere: all that any mode reads. A button that is held unseen is not pressed later, so that
    /// an exhaustion of all that can be done needs them.
    pub fn complete() -> Self {
        ControlSets { is_complete: true, ..ControlSets::default() }
    }

    /// The number of the set for a state.
    pub fn of(&mut self, problem: &Problem<'_>, state: &[u8]) -> u16 {
        self.key.clear();
        let (program, world) = (problem.sim.program(), problem.sim.world());
        if !self.is_complete {
            for &slot in problem.players() {
                let layout = &world.layout.slots[slot];
                let groups = program.entities[world.slots[slot].entity].groups.ids();
                self.key.extend(groups.map(|group| layout.leaf(state, group)));
            }
        }
        if let Some(&set) = self.known.get(&self.key) {
            return set;
        }
        let (inputs, truncated) = self.inputs_of(problem);
        self.truncated |= truncated;
        // Many combinations read the same inputs: there are at most as many sets as sets of buttons and axes that
        // modes read, far fewer than numbers.
        let set = match self.sets.iter().position(|s| *s == inputs) {
            Some(same) => same as u16,
            None => {
                self.sets.push(inputs);
                (self.sets.len() - 1).min(usize::from(u16::MAX)) as u16
            }
        };
        self.known.insert(self.key.clone(), set);
        set
    }

    /// The inputs of a set.
    pub fn inputs(&self, set: u16) -> &[Input] {
        &self.sets[usize::from(set)]
    }

    /// The inputs for the leaves of the key, and whether some were left out.
    fn inputs_of(&self, problem: &Problem<'_>) -> (Vec<Input>, bool) {
        let mut whole = true;
        let (program, world) = (problem.sim.program(), problem.sim.world());
        let mut all = vec![Input::nothing(world.players.len())];
        let mut leaves = self.key.iter();
        for (player, &slot) in problem.players().iter().enumerate() {
            let entity = &program.entities[world.slots[slot].entity];
            let mut reads: Inputs = entity.inputs;
            if self.is_complete {
                reads = entity.leaves.iter().fold(reads, |reads, leaf| reads.with(leaf.inputs));
            } else {
                for leaf in leaves.by_ref().take(entity.groups.len()) {
                    reads = reads.with(entity.leaves[*leaf].inputs);
                }
            }
            for button in (0..64).filter(|b| reads.buttons >> b & 1 == 1) {
                whole &= multiply(&mut all, player, &[|_, _| {}, |p: &mut PlayerInput, b| p.buttons |= 1 << b], button);
            }
            for axis in (0..8).filter(|a| reads.axes >> a & 1 == 1) {
                whole &=
                    multiply(&mut all, player, &[|_, _| {}, |p, a| p.axes[a] = -1.0, |p, a| p.axes[a] = 1.0], axis);
            }
        }
        (all, !whole)
    }
}

/// Every input so far with every variant of one more button or axis; false where that would be more than
/// [`MAX_CONTROLS`], and the button or axis is left alone.
fn multiply(all: &mut Vec<Input>, player: usize, variants: &[fn(&mut PlayerInput, usize)], which: usize) -> bool {
    if all.len() * variants.len() > MAX_CONTROLS {
        return false;
    }
    let mut next = Vec::with_capacity(all.len() * variants.len());
    for variant in variants {
        for input in all.iter() {
            let mut input = input.clone();
            if let Some(p) = input.0.get_mut(player) {
                variant(p, which);
            }
            next.push(input);
        }
    }
    *all = next;
    true
}
