//! What every step looks up of a slot, at hand: its entity, its place in a state, its code with its parameters put in.

use std::collections::BTreeMap;
use std::sync::Arc;

use crate::ir::{Entity, EntityId, Expr, ExprId, Id, IdVec, Origin, Program, Slot, SlotId, SlotLayout, Step, World};

/// A slot with what belongs to it.
#[derive(Debug)]
pub(super) struct Actor<'p> {
    pub id: SlotId,
    pub slot: &'p Slot,
    pub entity: &'p Entity,
    pub layout: SlotLayout,
    /// The entity's code, with what its parameters alone decide worked out.
    pub code: Arc<[Expr]>,
    /// The number of the first expression in it.
    pub base: u32,
    /// Where its groups begin among those of all slots; and so on.
    pub groups: usize,
    pub vars: usize,
    pub clamps: usize,
    pub envelopes: usize,
}

/// The actors of a world.
pub(super) fn actors<'p>(program: &'p Program, world: &'p World) -> Vec<Actor<'p>> {
    // Instances of one entity with the same parameters (as bits) share their code.
    type Key = (EntityId, Option<Vec<u64>>);
    let mut known: BTreeMap<Key, Arc<[Expr]>> = BTreeMap::new();
    let (mut groups, mut vars, mut clamps, mut envelopes) = (0, 0, 0, 0);
    let mut out = Vec::with_capacity(world.slots.len());
    for (id, slot) in world.slots.pairs() {
        let entity = &program.entities[slot.entity];
        // The parameters of a slot that can be used again are part of the state.
        let fixed = slot.origin == Origin::Named;
        let key = (slot.entity, fixed.then(|| slot.params.iter().map(|p| p.to_bits()).collect()));
        let none = IdVec::new();
        let params = if fixed { &slot.params } else { &none };
        let code = known.entry(key).or_insert_with(|| {
            (entity.code.0.0..entity.code.1.0).map(|e| folded(program, ExprId(e), params, world.step)).collect()
        });
        let layout = world.layout.slots[id].clone();
        let (code, base) = (code.clone(), entity.code.0.0);
        out.push(Actor { id, slot, entity, layout, code, base, groups, vars, clamps, envelopes });
        groups += entity.groups.len();
        vars += entity.vars.len();
        clamps += entity.clamps.len();
        envelopes += entity.envelopes.len();
    }
    out
}

/// An expression, or the value that it always has.
fn folded(program: &Program, id: ExprId, params: &IdVec<crate::ir::ParamId, f64>, step: Step) -> Expr {
    let expr = program.exprs[id];
    match (program.constant(id, params, step), expr) {
        (None, _) => expr,
        (Some(value), Expr::Bool(_) | Expr::Compare(..) | Expr::And(..) | Expr::Or(..) | Expr::Not(_)) => {
            Expr::Bool(value != 0.0)
        }
        (Some(value), _) => Expr::Number(value),
    }
}

impl Actor<'_> {
    /// The range of its variables among those of all slots.
    pub fn var_range(&self) -> std::ops::Range<usize> {
        self.vars..self.vars + self.entity.vars.len()
    }

    /// The range of its groups among those of all slots.
    pub fn group_range(&self) -> std::ops::Range<usize> {
        self.groups..self.groups + self.entity.groups.len()
    }

    /// The range of its clamps among those of all slots.
    pub fn clamp_range(&self) -> std::ops::Range<usize> {
        self.clamps..self.clamps + self.entity.clamps.len()
    }

    /// The range of its envelopes among those of all slots.
    pub fn envelope_range(&self) -> std::ops::Range<usize> {
        self.envelopes..self.envelopes + self.entity.envelopes.len()
    }

    /// Its number.
    pub fn index(&self) -> usize {
        self.id.index()
    }
}
