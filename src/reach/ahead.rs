//! What only the modes read that edges lead to, and read as long as it is held: who wants to rise far off a wall holds the
//! button before the mode comes in which that counts, and who wants to run on holds it as he lands.

use crate::ir::{By, Drive, Entity, Expr, Id, Inputs, Leaf, Press, Program};

/// The buttons and axes that leaves read while they are held and that an edge of a leaf leads to. What is only asked
/// whether it has just been pressed had better not be down already.
pub(super) fn held_ahead(program: &Program, entity: &Entity, leaf: &Leaf) -> Inputs {
    let targets = leaf.edges.iter().filter_map(|&edge| entity.edges[edge].target);
    let leaves = targets.flat_map(|mode| entity.modes[mode].leaves.ids());
    leaves.fold(Inputs::default(), |all, leaf| all.with(held_in(program, entity, &entity.leaves[leaf])))
}

/// What the drives and the guards of a leaf read, without the buttons of which its edges ask only whether they were just
/// pressed.
fn held_in(program: &Program, entity: &Entity, leaf: &Leaf) -> Inputs {
    let mut open: Vec<_> = leaf.edges.iter().chain(&leaf.internal).map(|&edge| entity.edges[edge].guard).collect();
    let mut held = Inputs::default();
    for drive in &leaf.drives {
        match *drive {
            Drive::Coast(_) => {}
            Drive::Flow { value, .. } => open.push(value),
            Drive::Envelope(envelope, _) => {
                let envelope = &entity.envelopes[envelope];
                open.extend([Some(envelope.sustain), envelope.guard].into_iter().flatten());
                match &envelope.by {
                    By::Button(button) => held.buttons |= 1 << button.index(),
                    By::Axis(axis) => held.axes |= 1 << axis.index(),
                    By::Axes(axes, _) => axes.iter().for_each(|axis| held.axes |= 1 << axis.index()),
                    By::Clock { .. } => {}
                }
            }
        }
    }
    for id in program.with_operands(open) {
        match program.exprs[id] {
            Expr::Button(Press::Pressed, _) => {}
            Expr::Button(_, button) => held.buttons |= 1 << button.index(),
            Expr::Axis(axis) => held.axes |= 1 << axis.index(),
            _ => {}
        }
    }
    held
}
