//! What every step looks up of a slot, at hand: its entity, its place in a state, its code with its parameters put in.

use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::Arc;

use crate::ir::{
    Entity, EntityId, Expr, ExprId, Id, IdVec, Origin, Program, Slot, SlotId, SlotLayout, Step, Subject, World,
};

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
    /// The range of its groups among those of all slots; and so on.
    pub groups: Range<usize>,
    pub vars: Range<usize>,
    pub clamps: Range<usize>,
    pub envelopes: Range<usize>,
    /// The number of the player who controls it.
    pub player: Option<usize>,
    /// Whether a group asks what another does in the same step.
    pub is_joint: bool,
    /// Whether it has clamps, or envelopes that keep whether their peak was reached.
    pub is_bounded: bool,
}

/// The actors of a world.
pub(super) fn actors<'p>(program: &'p Program, world: &'p World) -> Vec<Actor<'p>> {
    // Instances of one entity with the same parameters (as bits) share their code.
    type Key = (EntityId, Option<Vec<u64>>);
    let mut known: BTreeMap<Key, Arc<[Expr]>> = BTreeMap::new();
    let take = |from: &mut usize, count: usize| {
        *from += count;
        *from - count..*from
    };
    let (mut all_groups, mut all_vars, mut all_clamps, mut all_envelopes) = (0, 0, 0, 0);
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
        let is_joint = code.iter().any(|e| matches!(e, Expr::Joint(..)));
        let is_bounded = !entity.clamps.is_empty() || entity.envelopes.iter().any(|e| e.peak.is_some());
        out.push(Actor {
            id,
            slot,
            entity,
            layout,
            code,
            base,
            groups: take(&mut all_groups, entity.groups.len()),
            vars: take(&mut all_vars, entity.vars.len()),
            clamps: take(&mut all_clamps, entity.clamps.len()),
            envelopes: take(&mut all_envelopes, entity.envelopes.len()),
            player: slot.player.map(Id::index),
            is_joint,
            is_bounded,
        });
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

/// Whether no instance reads another one while it moves.
pub(super) fn is_private(actors: &[Actor<'_>]) -> bool {
    let other = |of: Subject| of != Subject::Me;
    actors.iter().all(|actor| {
        !actor.code.iter().any(|e| match *e {
            Expr::Var(of, ..) | Expr::Discrete(of, _) | Expr::Param(of, _) | Expr::InMode(of, _) => other(of),
            Expr::Touching(of, _) | Expr::InSpace(of, _) | Expr::Near { of, .. } => other(of),
            _ => false,
        })
    })
}

impl Actor<'_> {
    /// Its number.
    pub fn index(&self) -> usize {
        self.id.index()
    }
}
