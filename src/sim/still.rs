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
    watched: Vec<u32>,
    /// Where their contact bits are.
    rows: Vec<Row>,
    /// The slots that can refer to an instance or be on one.
    referrers: Vec<u32>,
}

/// The contact bits of watched slots whose blocks are neighbours in a state, and equal.
#[derive(Debug)]
struct Row {
    /// The first of them, and their number.
    first: usize,
    count: usize,
    /// Where the first block begins, and the size of each.
    from: usize,
    size: usize,
    /// Where the contact bits are in a block.
    bits: (usize, usize),
    /// The contact bits in each eight bytes, if blocks fill them.
    mask: Option<u64>,
}

impl Row {
    /// The row of one slot.
    fn of(actor: &Actor, first: usize) -> Row {
        let ((from, to), touches) = (actor.layout.block, actor.layout.touches);
        let bits = (touches - from, touches - from + actor.touches.div_ceil(8));
        let size = to - from;
        let mask = (size > 0 && 8 % size == 0).then(|| {
            let is_bit = |byte: usize| (bits.0..bits.1).contains(&(byte % size));
            u64::from_le_bytes(std::array::from_fn(|byte| if is_bit(byte) { 0xff } else { 0 }))
        });
        Row { first, count: 1, from, size, bits, mask }
    }

    /// Whether the slot of another row comes next.
    fn is_followed_by(&self, next: &Row) -> bool {
        self.from + self.size * self.count == next.from && (self.size, self.bits) == (next.size, next.bits)
    }

    /// Calls `found` with each watched slot that has a contact bit, in order.
    fn find(&self, state: &[u8], mut found: impl FnMut(usize)) {
        let blocks = &state[self.from..self.from + self.size * self.count];
        let mut each = |blocks: &[u8], first: usize| {
            for (at, block) in blocks.chunks_exact(self.size).enumerate() {
                if block[self.bits.0..self.bits.1].iter().any(|byte| *byte != 0) {
                    found(first + at);
                }
            }
        };
        let Some(mask) = self.mask else { return each(blocks, self.first) };
        // Most have none: 64 bytes at once.
        let (chunks, rest) = blocks.as_chunks::<64>();
        let per_chunk = 64 / self.size;
        for (at, chunk) in chunks.iter().enumerate() {
            let words = chunk.as_chunks::<8>().0;
            if words.iter().fold(0, |all, word| all | u64::from_le_bytes(*word)) & mask != 0 {
                each(chunk, self.first + at * per_chunk);
            }
        }
        each(rest, self.first + chunks.len() * per_chunk);
    }
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
        let mut out = Still {
            bodies,
            always: vec![],
            moving: vec![],
            timed: vec![],
            watched: vec![],
            rows: vec![],
            referrers: vec![],
        };
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
                let row = Row::of(actor, out.watched.len());
                out.watched.push(slot);
                match out.rows.last_mut().filter(|last| last.is_followed_by(&row)) {
                    Some(last) => last.count += 1,
                    None => out.rows.push(row),
                }
            }
        }
        let is_watched = |slot: &usize| out.watched.binary_search(&(*slot as u32)).is_ok();
        collision.contact_readers.retain(|slot| !is_watched(slot));
        Some(Box::new(out))
    }

    /// Working memory.
    pub fn scratch(&self) -> Scratch {
        let awake = self.watched.len();
        Scratch { awake: Vec::with_capacity(awake), visited: Vec::with_capacity(self.always.len() + awake) }
    }

    /// The slots that every step looks at.
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
        for row in &still.rows {
            row.find(state, |at| awake.push(still.watched[at]));
        }
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
