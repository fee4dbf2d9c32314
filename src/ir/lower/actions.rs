//! Lowers actions: updates of variables and references, `spawn`, `destroy`, `send`.

use crate::sema::checked::{self, Given, TermKind};

use super::term::Context;
use crate::ir::{Actions, EntityId, Place, Program, RefUpdate, RefValue, Send, Spawn, Update};

/// The actions of one edge or entry.
pub(super) fn lower(
    program: &mut Program,
    entity: EntityId,
    actions: &[checked::Action],
    context: &Context<'_>,
) -> Actions {
    let (mut out, mut sends) = (Actions::default(), Vec::new());
    for action in actions {
        match action {
            checked::Action::Update(update) => match update.place {
                Place::Ref(reference) => {
                    out.refs.push(RefUpdate { reference, value: reference_value(&update.value) });
                }
                place => out.updates.push(Update { place, value: program.term(&update.value, context) }),
            },
            checked::Action::Spawn(spawn) => {
                let lowered = lower_spawn(program, spawn, context);
                program.spans.entities[entity].spawns.push(spawn.span);
                out.spawns.push(program.entity_mut(entity).spawns.push(lowered));
            }
            checked::Action::Destroy(what) => out.destroys.push(reference_value(what)),
            checked::Action::Send(send) => {
                let to = send.to.as_ref().map(reference_value);
                // Sent to `none`, it is lost.
                let to = match to {
                    Some(RefValue::None) => continue,
                    Some(RefValue::Of(subject)) => Some(subject),
                    None => None,
                };
                let value = send.number.as_ref().map(|number| program.term(number, context));
                let send = Send { to, entity: send.entity, signal: send.signal, value };
                sends.push(program.entity_mut(entity).sends.push(send));
            }
        }
    }
    out.sends = sends.into();
    out
}

fn lower_spawn(program: &mut Program, spawn: &checked::Spawn, context: &Context<'_>) -> Spawn {
    let mut out =
        Spawn { entity: spawn.entity, into: spawn.into, params: Vec::new(), updates: Vec::new(), refs: Vec::new() };
    for (what, term) in &spawn.given {
        match *what {
            Given::Param(param) => out.params.push((param, program.term(term, context))),
            Given::Var(var, degree) => {
                out.updates.push(Update { place: Place::Var(var, degree), value: program.term(term, context) });
            }
            Given::Discrete(id) => {
                out.updates.push(Update { place: Place::Discrete(id), value: program.term(term, context) });
            }
            Given::Ref(reference) => out.refs.push(RefUpdate { reference, value: reference_value(term) }),
        }
    }
    out
}

fn reference_value(term: &checked::Term) -> RefValue {
    match &term.kind {
        TermKind::Instance(subject) => RefValue::Of(*subject),
        _ => RefValue::None,
    }
}
