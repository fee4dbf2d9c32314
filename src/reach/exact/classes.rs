//! Inputs that make no difference in a step: those that differ only in what nothing reads while some leaves are active.
//! Of each class one input is simulated. What the others leave behind, the buttons of the last step, is known without.

use std::collections::BTreeMap;
use std::sync::Arc;

use crate::ir::{By, Drive, Entity, Expr, ExprId, Id, Inputs, Leaf, LeafId, Program, Release};
use crate::sim::{Input, Simulator};

/// What is read of an input: of each player the buttons, and the bits of the axes.
type Read = Vec<(u64, Vec<u64>)>;

/// Inputs that lead to the same state, but for the buttons of the last step.
#[derive(Debug)]
pub(super) struct Class {
    /// The index of one of them.
    pub input: u16,
    /// For each combination of buttons that they leave behind, the index of an input, and the buttons of each player.
    pub variants: Vec<(u16, Box<[u64]>)>,
}

/// The classes for each combination of the players' active leaves.
#[derive(Debug, Default)]
pub(super) struct Classes {
    known: BTreeMap<Vec<LeafId>, Arc<[Class]>>,
    key: Vec<LeafId>,
}

impl Classes {
    /// The classes of all inputs in a state.
    pub fn of(&mut self, sim: &Simulator, inputs: &[Input], state: &[u8]) -> Arc<[Class]> {
        let (program, world) = (sim.program(), sim.world());
        self.key.clear();
        for player in world.players.iter() {
            let layout = &world.layout.slots[player.slot];
            let groups = program.entities[world.slots[player.slot].entity].groups.ids();
            self.key.extend(groups.map(|group| layout.leaf(state, group)));
        }
        if let Some(known) = self.known.get(&self.key) {
            return Arc::clone(known);
        }
        let mut leaves = self.key.iter();
        let reads = world.players.iter().map(|player| {
            let entity = &program.entities[world.slots[player.slot].entity];
            let leaves = leaves.by_ref().take(entity.groups.len());
            leaves.fold(entity.inputs, |reads, leaf| reads.with(of_step(program, entity, &entity.leaves[*leaf])))
        });
        let reads: Vec<Inputs> = reads.collect();
        let read_of = |input: &Input| -> Read {
            let players = world.players.ids().zip(&reads).map(|(player, reads)| {
                let of = input.of(player);
                let axes = of.axes.iter().enumerate().filter(|(axis, _)| reads.axes >> axis & 1 == 1);
                (of.buttons & reads.buttons, axes.map(|(_, value)| value.to_bits()).collect())
            });
            players.collect()
        };
        let left_of = |input: &Input| -> Box<[u64]> {
            world.players.ids().map(|player| input.of(player).buttons & sim.remembered_buttons()).collect()
        };
        let mut classes: Vec<(Read, Class)> = Vec::new();
        for (index, input) in (0..).zip(inputs) {
            let (read, left) = (read_of(input), left_of(input));
            match classes.iter_mut().find(|(known, _)| *known == read) {
                Some((_, class)) if class.variants.iter().all(|(_, known)| *known != left) => {
                    class.variants.push((index, left));
                }
                Some(_) => {}
                None => classes.push((read, Class { input: index, variants: vec![(index, left)] })),
            }
        }
        let classes: Arc<[Class]> = classes.into_iter().map(|(_, class)| class).collect();
        self.known.insert(self.key.clone(), Arc::clone(&classes));
        classes
    }
}

/// What an entity reads of its inputs in a step that begins in a leaf. What a leaf reads includes its edges with all
/// that they do; flows are read after them.
fn of_step(program: &Program, entity: &Entity, leaf: &Leaf) -> Inputs {
    let targets = leaf.edges.iter().filter_map(|edge| entity.edges[*edge].target);
    let leaves = targets.flat_map(|mode| entity.modes[mode].leaves.ids());
    let drives = leaves.flat_map(|leaf| &entity.leaves[leaf].drives);
    drives.fold(leaf.inputs, |reads, drive| reads.with(of_drive(program, entity, drive)))
}

fn of_drive(program: &Program, entity: &Entity, drive: &Drive) -> Inputs {
    match *drive {
        Drive::Coast(_) => Inputs::default(),
        Drive::Flow { value, .. } => of_exprs(program, vec![value]),
        Drive::Envelope(id, _) => {
            let envelope = &entity.envelopes[id];
            let axis = |axis: crate::ir::AxisId| Inputs { axes: 1 << axis.index(), ..Inputs::default() };
            let mut exprs: Vec<ExprId> = vec![envelope.sustain];
            exprs.extend([envelope.guard, envelope.attack, envelope.peak, envelope.decay].into_iter().flatten());
            if let Release::To { rate, level } = envelope.release {
                exprs.extend(rate);
                exprs.push(level);
            }
            let by = match envelope.by {
                By::Button(button) => Inputs { buttons: 1 << button.index(), ..Inputs::default() },
                By::Axis(id) => axis(id),
                By::Axes([x, y], _) => axis(x).with(axis(y)),
                By::Clock { rise, hold, fall, total, .. } => {
                    exprs.extend([rise, hold, fall, total]);
                    Inputs::default()
                }
            };
            by.with(of_exprs(program, exprs))
        }
    }
}

fn of_exprs(program: &Program, exprs: Vec<ExprId>) -> Inputs {
    program.with_operands(exprs).into_iter().fold(Inputs::default(), |reads, id| match program.exprs[id] {
        Expr::Button(_, button) => reads.with(Inputs { buttons: 1 << button.index(), ..Inputs::default() }),
        Expr::Axis(axis) => reads.with(Inputs { axes: 1 << axis.index(), ..Inputs::default() }),
        _ => reads,
    })
}
