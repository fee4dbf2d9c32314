//! The inputs to try: buttons up or down, axes at -1, 0 and 1, what nature draws. Either those that an active mode reads,
//! or all that any mode reads. Also tells whether axis values in between matter.

use std::collections::BTreeMap;

use crate::ir::{By, Entity, Expr, ExprId, Function, Id, Inputs, Leaf, LeafId, Program, SlotId};
use crate::sim::state::Life;
use crate::sim::{Draw, DrawId, Draws, Input, PlayerInput};

use super::ahead::held_ahead;
use super::problem::Problem;

/// Maximum number of inputs per node.
pub const MAX_CONTROLS: usize = 4_096;

/// The inputs for each combination of the players' active leaves, computed on demand. Where nature draws, each input of
/// the players occurs with each combination of draws, as far as these are not too many.
#[derive(Debug, Clone, Default)]
pub struct ControlSets {
    sets: Vec<Set>,
    lists: Vec<List>,
    known: BTreeMap<Vec<LeafId>, u16>,
    key: Vec<LeafId>,
    /// The slots whose entities have chances, unless the draws of all inputs are left open.
    lucky: Option<Vec<SlotId>>,
    /// Whether one set with every input serves all states.
    is_complete: bool,
    /// Whether some inputs were left out because there were more than [`MAX_CONTROLS`].
    pub truncated: bool,
}

/// Inputs of the players. Those at first hold nothing but what is read; the same follow with each combination of what only
/// the modes read that edges lead to.
#[derive(Debug, Clone, Default, PartialEq)]
struct List {
    inputs: Vec<Input>,
    /// The number of those at first.
    read: usize,
    /// For each player, what only the modes ahead read.
    ahead: Vec<Inputs>,
}

/// The inputs of the players, and the draws that go with each.
#[derive(Debug, Clone, PartialEq, Eq)]
struct Set {
    /// The index of the list of inputs.
    list: usize,
    /// Draws of which all combinations occur.
    draws: Vec<(DrawId, Draw)>,
    /// The number of inputs with draws.
    count: usize,
}

/// How often an input of the players occurs where some draws are left to chance.
const TRIALS: usize = 16;

impl ControlSets {
    /// The same inputs in all states: all that any mode reads. Exhaustive search needs them, because a button that is
    /// already held cannot be pressed later.
    pub fn complete() -> Self {
        ControlSets { is_complete: true, ..ControlSets::default() }
    }

    /// With the draws of nature, too.
    #[must_use]
    pub fn with_draws(mut self, problem: &Problem<'_>) -> Self {
        let mut slots: Vec<SlotId> = problem.sim.draws().iter().map(|draw| draw.slot).collect();
        slots.dedup();
        self.lucky = (!slots.is_empty() && !problem.is_foretold()).then_some(slots);
        self
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
        for &slot in self.lucky.iter().flatten() {
            let layout = &world.layout.slots[slot];
            if layout.life(state) != Life::Alive {
                self.key.push(NO_LEAF);
                continue;
            }
            let groups = program.entities[world.slots[slot].entity].groups.ids();
            self.key.extend(groups.map(|group| layout.leaf(state, group)));
        }
        if let Some(&set) = self.known.get(&self.key) {
            return set;
        }
        let (list, truncated) = self.inputs_of(problem);
        self.truncated |= truncated;
        let list = match self.lists.iter().position(|known| *known == list) {
            Some(same) => same,
            None => {
                self.lists.push(list);
                self.lists.len() - 1
            }
        };
        let set = self.with_drawn(problem, state, list);
        // Many combinations read the same inputs, so there are far fewer sets than a `u16` can number.
        let set = match self.sets.iter().position(|s| *s == set) {
            Some(same) => same,
            None => {
                self.sets.push(set);
                self.sets.len() - 1
            }
        };
        let set = set.min(usize::from(u16::MAX)) as u16;
        self.known.insert(self.key.clone(), set);
        set
    }

    /// The number of inputs of a set.
    pub fn count(&self, set: u16) -> usize {
        self.sets[usize::from(set)].count
    }

    /// What the players do in an input of a set.
    pub fn input(&self, set: u16, index: usize) -> &Input {
        let set = &self.sets[usize::from(set)];
        let list = &self.lists[set.list];
        &list.inputs[index / set.count * list.read + index % set.count % list.read]
    }

    /// The number of combinations of what only the modes ahead of a set read, with that in which nothing is held.
    pub fn combinations_ahead(&self, set: u16) -> usize {
        let list = &self.lists[self.sets[usize::from(set)].list];
        list.inputs.len() / list.read
    }

    /// The combination that an input holds.
    pub fn combination_of(&self, set: u16, held: &Input) -> usize {
        let list = &self.lists[self.sets[usize::from(set)].list];
        let (mut number, mut weight) = (0, 1);
        for (of, ahead) in held.0.iter().zip(&list.ahead) {
            for button in (0..64).filter(|b| ahead.buttons >> b & 1 == 1) {
                number += weight * (of.buttons >> button & 1) as usize;
                weight *= BUTTON.len();
            }
            for axis in (0..8).filter(|a| ahead.axes >> a & 1 == 1) {
                let value = of.axes[axis];
                number += weight * (usize::from(value != 0.0) + usize::from(value > 0.0));
                weight *= AXIS.len();
            }
        }
        number % self.combinations_ahead(set)
    }

    /// The index of the input that does what one of the counted ones does, and holds a combination of what only the modes
    /// ahead read: they come after those that are counted.
    pub fn holding_ahead(&self, set: u16, index: usize, combination: usize) -> usize {
        let number = index + combination * self.count(set);
        if number > usize::from(u16::MAX) { index } else { number }
    }

    /// Fixes what nature draws in an input of a set; other draws stay as they are.
    pub fn fix_draws(&self, set: u16, index: usize, draws: &mut Draws) {
        let set = &self.sets[usize::from(set)];
        let mut number = (index % set.count / self.lists[set.list].read) as u64;
        for (id, draw) in &set.draws {
            draws.set(*id, Some(draw.value(number % draw.values())));
            number /= draw.values();
        }
    }

    /// Clears the buttons and axes that nothing reads, and what is drawn.
    pub fn relevant(&self, problem: &Problem<'_>, input: &Input) -> Input {
        let (program, world) = (problem.sim.program(), problem.sim.world());
        let mut input = Input::of_players(input.0.clone());
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

    /// Adds the draws that can be read in a step from a state, as far as their combinations are few.
    fn with_drawn(&self, problem: &Problem<'_>, state: &[u8], list: usize) -> Set {
        let mut set = Set { list, draws: Vec::new(), count: self.lists[list].read };
        let Some(lucky) = &self.lucky else { return set };
        let (program, world) = (problem.sim.program(), problem.sim.world());
        let mut are_left = false;
        for (id, draw) in (0..).map(DrawId).zip(problem.sim.draws()) {
            let layout = &world.layout.slots[draw.slot];
            let entity = &program.entities[world.slots[draw.slot].entity];
            if lucky.binary_search(&draw.slot).is_err() || layout.life(state) != Life::Alive {
                continue;
            }
            let reads = match self.is_complete {
                true => all_inputs(entity),
                false => entity.groups.ids().fold(entity.inputs, |reads, group| {
                    reads.with(inputs_around(entity, &entity.leaves[layout.leaf(state, group)]))
                }),
            };
            if reads.chances >> draw.chance.index() & 1 == 0 {
                continue;
            }
            match usize::try_from(draw.values()).ok().and_then(|values| set.count.checked_mul(values)) {
                Some(count) if count <= MAX_CONTROLS => {
                    set.count = count;
                    set.draws.push((id, *draw));
                }
                _ => are_left = true,
            }
        }
        // More inputs with the same players' part: what is left open is drawn for each of them.
        if are_left && !self.is_complete {
            set.count *= (MAX_CONTROLS / set.count).clamp(1, TRIALS);
        }
        set
    }

    /// The inputs for the leaves of the key, and whether some were left out.
    fn inputs_of(&self, problem: &Problem<'_>) -> (List, bool) {
        let mut whole = true;
        let (program, world) = (problem.sim.program(), problem.sim.world());
        let mut all = vec![Input::nothing(world.players.len())];
        let mut leaves = self.key.iter();
        let (mut read, mut ahead) = (Vec::new(), Vec::new());
        for (player, &slot) in problem.players().iter().enumerate() {
            let entity = &program.entities[world.slots[slot].entity];
            let mut reads: Inputs = entity.inputs;
            let mut later = Inputs::default();
            if self.is_complete {
                reads = all_inputs(entity);
            } else {
                for leaf in leaves.by_ref().take(entity.groups.len()) {
                    reads = reads.with(entity.leaves[*leaf].inputs);
                    later = later.with(held_ahead(program, entity, &entity.leaves[*leaf]));
                }
            }
            reads.buttons &= !problem.unpressed(player);
            later.buttons &= !problem.unpressed(player);
            read.push((reads.buttons, u64::from(reads.axes)));
            whole &= multiply_by(&mut all, player, reads);
            let (buttons, axes) = (later.buttons & !reads.buttons, later.axes & !reads.axes);
            ahead.push(Inputs { buttons, axes, ..Inputs::default() });
        }
        if let Some(restriction) = problem.restriction() {
            all.retain(|input| restriction.allows(input, &read));
            ahead.clear();
        }
        let read = all.len();
        let mut with_ahead = all.clone();
        let fits = ahead
            .iter()
            .enumerate()
            .fold(true, |fits, (player, later)| fits && multiply_by(&mut with_ahead, player, *later));
        if fits {
            (List { inputs: with_ahead, read, ahead }, !whole)
        } else {
            (List { inputs: all, read, ahead: Vec::new() }, !whole)
        }
    }
}

/// In the key: there is no instance that acts.
const NO_LEAF: LeafId = LeafId(u32::MAX);

/// What an entity reads in a leaf and in those that its edges lead to: flows are read after edges.
fn inputs_around(entity: &Entity, leaf: &Leaf) -> Inputs {
    let targets = leaf.edges.iter().filter_map(|&edge| entity.edges[edge].target);
    let leaves = targets.flat_map(|mode| entity.modes[mode].leaves.ids());
    leaves.fold(leaf.inputs, |reads, leaf| reads.with(entity.leaves[leaf].inputs))
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

/// The ways in which an input can have a button, and an axis.
const BUTTON: [fn(&mut PlayerInput, usize); 2] = [|_, _| {}, |p, b| p.buttons |= 1 << b];
const AXIS: [fn(&mut PlayerInput, usize); 3] = [|_, _| {}, |p, a| p.axes[a] = -1.0, |p, a| p.axes[a] = 1.0];

/// Multiplies the inputs by all that a player can do with some buttons and axes; returns false if not all have a place.
fn multiply_by(all: &mut Vec<Input>, player: usize, by: Inputs) -> bool {
    let buttons = (0..64).filter(|b| by.buttons >> b & 1 == 1).map(|b| (&BUTTON[..], b));
    let axes = (0..8).filter(|a| by.axes >> a & 1 == 1).map(|a| (&AXIS[..], a));
    let mut whole = true;
    for (variants, which) in buttons.chain(axes) {
        whole &= multiply(all, player, variants, which);
    }
    whole
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
