//! The inputs to try: buttons up or down, axes at -1, 0 and 1. Either those that an active mode reads, or all that any
//! mode reads. Also tells whether axis values in between matter.

use std::collections::BTreeMap;

use crate::ir::{By, Entity, Expr, ExprId, Function, Inputs, LeafId, Program};
use crate::sim::{Input, PlayerInput};

use super::problem::Problem;

/// Maximum number of inputs per node.
pub const MAX_CONTROLS: usize = 4_096;

/// The inputs for each combination of the players' active leaves, computed on demand.
#[derive(Debug, Clone, Default)]
pub struct ControlSets {
    sets: Vec<Vec<Input>>,
    known: BTreeMap<Vec<LeafId>, u16>,
    key: Vec<LeafId>,
    /// Whether one set with every input serves all states.
    is_complete: bool,
    /// Whether some inputs were left out because there were more than [`MAX_CONTROLS`].
    pub truncated: bool,
}

impl ControlSets {
    /// The same inputs in all states: all that any mode reads. Exhaustive search needs them, because a button that is
    /// already held cannot be pressed later.
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
        // Many combinations read the same inputs, so there are far fewer sets than a `u16` can number.
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

    /// Clears the buttons and axes that nothing reads.
    pub fn relevant(&self, problem: &Problem<'_>, input: &Input) -> Input {
        let (program, world) = (problem.sim.program(), problem.sim.world());
        let mut input = input.clone();
        for (given, &slot) in input.0.iter_mut().zip(problem.players()) {
            let reads = all_inputs(&program.entities[world.slots[slot].entity]);
            given.buttons &= reads.buttons;
            for (axis, value) in given.axes.iter_mut().enumerate().filter(|(axis, _)| reads.axes >> axis & 1 == 0) {
                debug_assert!(axis < 8);
                *value = 0.0;
            }
        }
        input
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
                reads = all_inputs(entity);
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

/// All inputs that an entity reads in any mode.
fn all_inputs(entity: &Entity) -> Inputs {
    entity.leaves.iter().fold(entity.inputs, |reads, leaf| reads.with(leaf.inputs))
}

/// Whether a player's entity reads more of an axis than its sign, so that values between -1, 0 and 1 matter. Two axes
/// that are read only as the nearest of some directions count as read by sign if their end values produce all of these
/// directions.
pub(super) fn reads_between(problem: &Problem<'_>) -> bool {
    let (program, world) = (problem.sim.program(), problem.sim.world());
    problem.players().iter().any(|&slot| entity_reads_between(program, &program.entities[world.slots[slot].entity]))
}

fn entity_reads_between(program: &Program, entity: &Entity) -> bool {
    let axis_of = |id: ExprId| match program.exprs[id] {
        Expr::Axis(axis) => Some(axis),
        _ => None,
    };
    let is_zero = |id: ExprId| matches!(program.exprs[id], Expr::Number(0.0));
    let code = || entity.code.ids().map(|id| (id, &program.exprs[id]));
    // Every other use of an axis depends on its exact value.
    let mut by_sign = Vec::new();
    for (_, expr) in code() {
        match *expr {
            Expr::Compare(_, a, b) if is_zero(b) || is_zero(a) => {
                by_sign.extend([a, b].into_iter().filter(|id| axis_of(*id).is_some()))
            }
            Expr::Call(Function::Sign, [a, ..]) if axis_of(a).is_some() => by_sign.push(a),
            _ => {}
        }
    }
    if code().any(|(id, _)| axis_of(id).is_some() && !by_sign.contains(&id)) {
        return true;
    }
    let signs = by_sign.into_iter().filter_map(axis_of);
    let by_axis = entity.envelopes.iter().filter_map(|e| if let By::Axis(axis) = e.by { Some(axis) } else { None });
    let signs: Vec<_> = signs.chain(by_axis).collect();
    let mut directions: Vec<(&[_; 2], &Vec<[f64; 2]>)> = Vec::new();
    for envelope in entity.envelopes.iter() {
        if let By::Axes(axes, ways) = &envelope.by {
            let is_known = directions.contains(&(axes, ways));
            let is_shared = directions.iter().any(|(others, _)| others.iter().any(|axis| axes.contains(axis)));
            if !is_known && is_shared || axes.iter().any(|axis| signs.contains(axis)) || !ends_produce(ways) {
                return true;
            }
            directions.push((axes, ways));
        }
    }
    false
}

/// Whether axes at -1, 0 and 1 produce each of some directions: vertical, horizontal and diagonal.
fn ends_produce(directions: &[[f64; 2]]) -> bool {
    const NEAR: f64 = 1e-9;
    let is_made = |[x, y]: &[f64; 2]| x.abs() < NEAR || y.abs() < NEAR || (x.abs() - y.abs()).abs() < NEAR;
    !directions.is_empty() && directions.iter().all(is_made)
}

/// Multiplies the inputs by the variants of one more button or axis; returns false, without doing so, if there would be
/// more than [`MAX_CONTROLS`].
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
