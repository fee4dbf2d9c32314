//! Resolves leaves: for each, the drive of each variable (the innermost wins), the edges in evaluation order, and the
//! inputs that active code reads.

use crate::ordered::Ordered;
use crate::sema::checked::{self, DriveBy};

use super::term::Context;
use crate::ir::{
    Actions, By, Drive, EntityId, Expr, ExprId, FollowId, GroupId, Id, IdVec, Inputs, Leaf, ModeId, Program, Release,
    Update, VarId,
};

/// The lowered drives of an entity.
pub(super) struct Drives {
    owners: IdVec<VarId, Option<GroupId>>,
    /// For each mode, its own drives.
    modes: IdVec<ModeId, Vec<(VarId, Drive)>>,
    /// The drives of the entity itself.
    entity: Vec<(VarId, Drive)>,
    /// One for each variable that no group drives.
    pub free: Box<[Drive]>,
}

/// Lowers all flows of an entity once, so that leaves can share them.
pub(super) fn drives(program: &mut Program, e: &checked::Entity, context: &Context<'_>) -> Drives {
    let owners = owners(e);
    let mut lowered = |list: &[checked::Drive]| -> Vec<(VarId, Drive)> {
        list.iter().map(|d| (d.var, drive(program, e, d, context))).collect()
    };
    let entity = lowered(&e.drives);
    let modes = e.modes.iter().map(|m| lowered(&m.drives)).collect();
    let free = e.vars.ids().filter(|v| owners[*v].is_none()).map(|v| of(&entity, v).unwrap_or(Drive::Coast(v)));
    let free = free.collect();
    Drives { owners, modes, entity, free }
}

fn of(drives: &[(VarId, Drive)], var: VarId) -> Option<Drive> {
    drives.iter().find(|(v, _)| *v == var).map(|(_, d)| *d)
}

/// The resolved leaves of an entity.
pub(super) struct Leaves {
    pub leaves: IdVec<crate::ir::LeafId, Leaf>,
    /// Inputs that are read in all modes.
    pub always: Inputs,
}

/// Resolves the leaves.
pub(super) fn leaves(program: &Program, id: EntityId, e: &checked::Entity, drives: &Drives) -> Leaves {
    let reads = InputCollector { program, id };
    let mut always = Inputs::default();
    for drive in &drives.free {
        always = always.with(reads.drive(*drive));
    }
    let mut next = 0;
    let follows: IdVec<ModeId, Vec<FollowId>> = e
        .modes
        .iter()
        .map(|m| {
            next += m.follows.len() as u32;
            (next - m.follows.len() as u32..next).map(FollowId).collect()
        })
        .collect();
    let mut leaves = IdVec::new();
    for (mode, m) in e.modes.pairs().filter(|(_, m)| m.children.is_empty()) {
        let mut path = vec![mode];
        let mut outer = m.parent;
        while let Some(parent) = outer {
            path.push(parent);
            outer = e.modes[parent].parent;
        }
        path.reverse();
        let resolve = |var: VarId| {
            let inner = path.iter().rev().find_map(|&m| of(&drives.modes[m], var));
            inner.or_else(|| of(&drives.entity, var)).unwrap_or(Drive::Coast(var))
        };
        let own: Vec<Drive> = e.vars.ids().filter(|v| drives.owners[*v] == Some(m.group)).map(resolve).collect();
        let all = path.iter().flat_map(|&m| e.modes[m].edges.iter().copied());
        let (mut edges, internal): (Vec<_>, Vec<_>) = all.partition(|&edge| e.edges[edge].target.is_some());
        // Edges whose entire guard is `lost(…)` are tried first.
        edges.order_by_key(|&edge| e.edges[edge].lost.is_none());
        let follows: Vec<FollowId> = path.iter().flat_map(|&m| follows[m].iter().copied()).collect();
        let mut inputs = always;
        for drive in &own {
            inputs = inputs.with(reads.drive(*drive));
        }
        for edge in edges.iter().chain(&internal) {
            let edge = &program.entities[id].edges[*edge];
            inputs = inputs.with(reads.expr(edge.guard)).with(reads.actions(&edge.actions));
        }
        for &follow in &follows {
            let follow = &program.entities[id].follows[follow];
            inputs = inputs.with(reads.optional(follow.guard)).with(reads.actions(&follow.actions));
        }
        // A transition happens in a step of the source leaf, so its entry updates read that step's inputs.
        for target in edges.iter().filter_map(|&edge| e.edges[edge].target) {
            let modes = &program.entities[id].modes;
            let mut around = Some(target);
            while let Some(mode) = around {
                inputs = inputs.with(reads.actions(&modes[mode].entry));
                around = modes[mode].parent;
            }
            for inner in target.0..modes[target].end.0 {
                inputs = inputs.with(reads.actions(&modes[ModeId(inner)].entry));
            }
        }
        leaves.push(Leaf { mode, path, drives: own, edges, internal, follows, inputs });
    }
    Leaves { leaves, always }
}

/// Finds the inputs that code reads.
struct InputCollector<'a> {
    program: &'a Program,
    id: EntityId,
}

impl InputCollector<'_> {
    fn actions(&self, actions: &Actions) -> Inputs {
        let entity = &self.program.entities[self.id];
        let sent = actions.sends.iter().filter_map(|&send| entity.sends[send].value);
        let sent = sent.fold(self.updates(&actions.updates), |all, value| all.with(self.expr(value)));
        let spawns = actions.spawns.iter().map(|&s| &entity.spawns[s]);
        spawns.fold(sent, |all, spawn| {
            let params = spawn.params.iter().fold(Inputs::default(), |all, (_, e)| all.with(self.expr(*e)));
            all.with(params).with(self.updates(&spawn.updates))
        })
    }

    fn optional(&self, id: Option<ExprId>) -> Inputs {
        id.map_or(Inputs::default(), |e| self.expr(e))
    }

    fn updates(&self, updates: &[Update]) -> Inputs {
        updates.iter().fold(Inputs::default(), |all, u| all.with(self.expr(u.value)))
    }

    fn drive(&self, drive: Drive) -> Inputs {
        match drive {
            Drive::Coast(_) => Inputs::default(),
            Drive::Flow { value, .. } => self.expr(value),
            Drive::Envelope(id, _) => {
                let envelope = &self.program.entities[self.id].envelopes[id];
                let axis = |id: crate::ir::AxisId| Inputs { axes: 1 << id.index(), ..Inputs::default() };
                let by = match &envelope.by {
                    By::Button(button) => Inputs { buttons: 1 << button.index(), ..Inputs::default() },
                    By::Axis(id) => axis(*id),
                    By::Axes([x, y], _) => axis(*x).with(axis(*y)),
                    By::Clock { total, .. } => self.expr(*total),
                };
                let release = match envelope.release {
                    Release::Hold => Inputs::default(),
                    Release::To { rate, level } => {
                        rate.map_or(Inputs::default(), |r| self.expr(r)).with(self.expr(level))
                    }
                };
                let ramps = [envelope.guard, envelope.attack, envelope.peak, envelope.decay];
                let ramps = ramps.into_iter().fold(Inputs::default(), |all, e| all.with(self.optional(e)));
                by.with(self.expr(envelope.sustain)).with(release).with(ramps)
            }
        }
    }

    fn expr(&self, id: ExprId) -> Inputs {
        match self.program.exprs[id] {
            Expr::Button(_, button) => Inputs { buttons: 1 << button.index(), ..Inputs::default() },
            Expr::Axis(axis) => Inputs { axes: 1 << axis.index(), ..Inputs::default() },
            Expr::Chance(chance) => Inputs { chances: 1 << chance.index(), ..Inputs::default() },
            expr => expr.operands().into_iter().fold(Inputs::default(), |all, a| all.with(self.expr(a))),
        }
    }
}

/// Lowers one flow or envelope component.
fn drive(program: &mut Program, e: &checked::Entity, drive: &checked::Drive, context: &Context<'_>) -> Drive {
    match &drive.by {
        DriveBy::Flow(value) => {
            let value = program.term(value, context);
            Drive::Flow { var: drive.var, degree: drive.degree, value }
        }
        DriveBy::Envelope(id) => {
            let component = e.envelopes[*id].vars.iter().position(|v| *v == drive.var).unwrap_or(0);
            Drive::Envelope(*id, component as u8)
        }
    }
}

/// For each variable, the group that drives it in some mode.
fn owners(e: &checked::Entity) -> IdVec<VarId, Option<GroupId>> {
    let mut owners: IdVec<VarId, Option<GroupId>> = e.vars.iter().map(|_| None).collect();
    for mode in e.modes.iter() {
        for drive in &mode.drives {
            owners[drive.var] = Some(mode.group);
        }
    }
    owners
}
