//! What only the modes read that edges lead to, and read as long as it is held: who wants to rise far off a wall holds the
//! button before the mode comes in which that counts, and who wants to run on holds it as he lands.

use crate::ir::{Entity, Expr, Id, Inputs, Leaf, Press, Program};

/// The buttons and axes that leaves read while they are held and that an edge of a leaf leads to. What is only asked
/// whether it has just been pressed had better not be down already.
pub(super) fn held_ahead(program: &Program, entity: &Entity, leaf: &Leaf) -> Inputs {
    let targets = leaf.edges.iter().filter_map(|&edge| entity.edges[edge].target);
    let leaves = targets.flat_map(|mode| entity.modes[mode].leaves.ids());
    leaves.fold(Inputs::default(), |all, leaf| all.with(held_in(program, entity, &entity.leaves[leaf])))
}

/// What a leaf reads, without the buttons of which its edges ask only whether they were just pressed.
fn held_in(program: &Program, entity: &Entity, leaf: &Leaf) -> Inputs {
    let guards = leaf.edges.iter().chain(&leaf.internal).map(|&edge| entity.edges[edge].guard).collect();
    let (mut pressed, mut held) = (0_u64, 0_u64);
    for id in program.with_operands(guards) {
        match program.exprs[id] {
            Expr::Button(Press::Pressed, button) => pressed |= 1 << button.index(),
            Expr::Button(_, button) => held |= 1 << button.index(),
            _ => {}
        }
    }
    Inputs { buttons: leaf.inputs.buttons & !(pressed & !held), axes: leaf.inputs.axes, chances: 0 }
}
