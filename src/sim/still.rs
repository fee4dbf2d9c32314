//! Instances that never move, in a world with many of them: a step looks at one only if something touches it, or if it
//! may do anything without being touched. A world with few has no tables for them, and runs none of this.

use std::cell::Cell;
use std::sync::Arc;

use crate::ir::{Entity, Expr, ExprId, IdVec, SlotId, Subject, World};

use super::actor::{Actor, Code};
use super::chance::Frames;
use super::collision::Collision;
use super::discrete::{ActingGroup, TakenEdge};
use super::fault::Fault;
use super::simulator::Simulator;
use super::state::Life;
use super::still_bodies::StillBodies;

/// The instances of a world that never move.
#[derive(Debug)]
pub(super) struct Still {
    pub bodies: StillBodies,
    /// The slots that every step looks at.
    always: Vec<u32>,
    /// The slots of instances that may move.
    pub moving: Vec<u32>,
    /// The slots of instances that never move and have timers.
    timed: Vec<u32>,
    /// The slots that a step looks at only if a contact bit is set, in order.
    watched: Vec<Watched>,
    /// The slots that can refer to an instance or be on one.
    referrers: Vec<u32>,
}

/// The bytes of a slot's contact bits.
#[derive(Debug)]
struct Watched {
    slot: u32,
    bytes: (u32, u32),
}

/// Working memory.
#[derive(Debug, Clone, Default)]
pub(super) struct Scratch {
    /// The watched slots with a contact bit.
    pub awake: Vec<u32>,
    /// The slots that this step looks at.
    visited: Vec<u32>,
}

impl Still {
    /// The tables of a world with these slots; `None` if no instance is still.
    pub fn new(
        world: &World,
        still: &IdVec<SlotId, bool>,
        collision: &mut Collision,
        actors: &[Actor],
    ) -> Option<Box<Still>> {
        if !still.iter().any(|is| *is) {
            return None;
        }
        let bodies = StillBodies::new(world, collision);
        let mut out =
            Still { bodies, always: vec![], moving: vec![], timed: vec![], watched: vec![], referrers: vec![] };
        let mut known: Option<(&Arc<Code>, bool)> = None;
        for (actor, is_still) in actors.iter().zip(still.iter()) {
            let (slot, entity) = (actor.id.0, &*actor.entity);
            if !entity.refs.is_empty() || !is_still {
                out.referrers.push(slot);
            }
            if !is_still {
                out.always.push(slot);
                out.moving.push(slot);
                continue;
            }
            if !entity.timers.is_empty() {
                out.timed.push(slot);
            }
            let waits = match known {
                Some((code, waits)) if Arc::ptr_eq(code, &actor.code) => waits,
                _ => waits_for_contacts(actor),
            };
            known = Some((&actor.code, waits));
            if !waits {
                out.always.push(slot);
            } else if actor.touches > 0 {
                let from = actor.layout.touches;
                out.watched.push(Watched { slot, bytes: (from as u32, (from + actor.touches.div_ceil(8)) as u32) });
            }
        }
        let is_watched = |slot: &usize| out.watched.binary_search_by_key(&(*slot as u32), |w| w.slot).is_ok();
        collision.contact_readers.retain(|slot| !is_watched(slot));
        Some(Box::new(out))
    }

    /// Working memory.
    pub fn scratch(&self) -> Scratch {
        let awake = self.watched.len();
        Scratch { awake: Vec::with_capacity(awake), visited: Vec::with_capacity(self.always.len() + awake) }
    }

    /// The slots that every step looks at and whose instances never move.
    pub fn visits(&self) -> impl Iterator<Item = usize> {
        self.always.iter().map(|slot| *slot as usize)
    }
}

/// Whether an instance does nothing in any of its modes while it touches nothing.
fn waits_for_contacts(actor: &Actor) -> bool {
    let entity: &Entity = &actor.entity;
    let guard = |at: ExprId| untouched(actor, at) == Untouched::Is(false);
    let waits =
        |leaf: &crate::ir::Leaf| leaf.edges.iter().chain(&leaf.internal).all(|id| guard(entity.edges[*id].guard));
    entity.timers.is_empty() && entity.signals.is_empty() && entity.leaves.iter().all(waits)
}

/// What an expression is while its instance touches nothing and takes no edge.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Untouched {
    /// One truth value.
    Is(bool),
    /// Any value, without a fault.
    Any,
    /// It may be a fault, or cost much.
    Unknown,
}

fn untouched(actor: &Actor, id: ExprId) -> Untouched {
    use Untouched::{Any, Is, Unknown};
    let of = |id| untouched(actor, id);
    let Some(expr) = id.0.checked_sub(actor.base).and_then(|at| actor.code.exprs.get(at as usize)) else {
        return Unknown;
    };
    match *expr {
        Expr::Bool(value) => Is(value),
        Expr::Touching(Subject::Me | Subject::Touched(_), _) | Expr::Joint(..) => Is(false),
        Expr::InMode(Subject::Touched(_), _) | Expr::InSpace(Subject::Touched(_), _) => Is(false),
        Expr::Is(Subject::Touched(_), _) => Is(false),
        Expr::IsNone(Subject::Touched(_)) => Is(true),
        Expr::Not(a) => match of(a) {
            Is(value) => Is(!value),
            other => other,
        },
        Expr::And(a, b) => match (of(a), of(b)) {
            (Is(false), _) => Is(false),
            (Is(true), b) => b,
            (Any, Is(false)) => Is(false),
            (Any, Is(true) | Any) => Any,
            (Unknown, _) | (_, Unknown) => Unknown,
        },
        Expr::Or(a, b) => match (of(a), of(b)) {
            (Is(true), _) => Is(true),
            (Is(false), b) => b,
            (Any, Is(true)) => Is(true),
            (Any, Is(false) | Any) => Any,
            (Unknown, _) | (_, Unknown) => Unknown,
        },
        Expr::Compare(_, a, b) => match (of(a), of(b)) {
            (Unknown, _) | (_, Unknown) => Unknown,
            _ => Any,
        },
        Expr::Number(_)
        | Expr::Frames(_)
        | Expr::Param(Subject::Me, _)
        | Expr::Var(Subject::Me | Subject::Slot(_), ..)
        | Expr::Discrete(Subject::Me | Subject::Slot(_), _)
        | Expr::InMode(Subject::Me | Subject::Slot(_) | Subject::Ref(_), _)
        | Expr::InSpace(Subject::Me | Subject::Slot(_) | Subject::Ref(_), _)
        | Expr::IsNone(Subject::Me | Subject::Slot(_) | Subject::Ref(_))
        | Expr::Is(Subject::Me | Subject::Slot(_) | Subject::Ref(_), _)
        | Expr::Alive(_)
        | Expr::Button(..)
        | Expr::Axis(_)
        | Expr::Chance(_) => Any,
        _ => Unknown,
    }
}

impl Simulator {
    /// As [`Simulator::decide`], for the slots that a step looks at.
    #[inline(never)]
    pub(super) fn decide_awake(
        &self,
        scratch: &mut Scratch,
        state: &[u8],
        frames: &Frames,
        taken: &mut [Option<TakenEdge>],
        acting: &mut Vec<ActingGroup>,
        fault: &Cell<Option<Fault>>,
    ) {
        let Scratch { awake, visited } = scratch;
        let Some(still) = &self.still else { return };
        awake.clear();
        let is_set = |watched: &&Watched| {
            let (from, to) = watched.bytes;
            state[from as usize..to as usize].iter().any(|byte| *byte != 0)
        };
        awake.extend(still.watched.iter().filter(is_set).map(|watched| watched.slot));
        visited.clear();
        // Both are in order.
        let mut always = still.always.as_slice();
        for &slot in awake.iter() {
            let (before, after) = always.split_at(always.partition_point(|other| *other < slot));
            visited.extend_from_slice(before);
            visited.push(slot);
            always = after;
        }
        visited.extend_from_slice(always);
        self.decide(visited.iter().map(|slot| &self.actors[*slot as usize]), state, frames, taken, acting, fault);
    }

    /// Advances the timers of instances that never move.
    #[inline(never)]
    pub(super) fn count_still_timers(&self, state: &mut [u8]) {
        let Some(still) = &self.still else { return };
        for &slot in &still.timed {
            let actor = &self.actors[slot as usize];
            if actor.layout.acts(state) {
                self.count_timers(state, actor);
            }
        }
    }

    /// As [`Simulator::remove_destroyed`], where most slots need no look.
    #[cold]
    pub(super) fn remove_destroyed_of(&self, still: &Still, state: &mut [u8], destroyed: &[SlotId]) {
        for &me in &still.referrers {
            self.forget_destroyed(state, SlotId(me));
        }
        for &me in destroyed.iter() {
            if self.layout(me).life(state) == Life::Dying {
                self.layout(me).clear(state);
            }
        }
        for &me in &still.moving {
            let layout = self.layout(SlotId(me));
            if layout.life(state) == Life::Born {
                layout.set_life(state, Life::Alive);
            }
        }
    }
}
