//! The boxes of bodies: where they are before contacts are detected (`collision.rs`).

use std::cell::Cell;
use std::ops::Range;
use std::sync::Arc;

use crate::ir::Id;

use super::chance::Frames;
use super::collision::Body;
use super::contact::Rect;
use super::fault::Fault;
use super::simulator::{Scratch, Simulator};
use super::state::leaf_at;

impl Simulator {
    /// Moves the boxes of some bodies to the positions of their instances.
    pub(super) fn place_boxes(&self, state: &[u8], scratch: &mut Scratch, of: Range<usize>) -> Result<(), Fault> {
        let Scratch { frames, collision, start, .. } = scratch;
        let fault = Cell::new(None);
        let mut is_same = true;
        for (body, rect) in self.collision.bodies[of.clone()].iter().zip(collision.boxes[of].iter_mut()) {
            let was_active = rect.active;
            rect.active = self.place_box(body, rect, (state, start[body.slot.index()]), frames, &fault);
            is_same &= rect.active == was_active;
        }
        collision.is_listed &= is_same;
        Self::check_fault(&fault)
    }

    /// Moves the box of a body, whose instance began the step somewhere; returns whether it can touch anything.
    #[inline(always)]
    fn place_box(
        &self,
        body: &Body,
        rect: &mut Rect,
        (state, (from_x, from_y)): (&[u8], (f64, f64)),
        frames: &Frames,
        fault: &Cell<Option<Fault>>,
    ) -> bool {
        let layout = body.layout;
        let is_there = |(at, leaves): &(usize, Arc<[bool]>)| leaves[leaf_at(state, *at).index()];
        if !layout.acts(state) || !body.by_leaf.as_ref().is_none_or(is_there) {
            return false;
        }
        let sides = match body.fixed {
            Some(sides) if body.is_plain => sides,
            _ => {
                rect.round = body.shape.is_round();
                // An empty collider touches nothing.
                let sides = self.evaluate_box(body, state, frames, fault);
                match sides.filter(|[.., width, height]| *width > 0.0 && *height > 0.0) {
                    Some(sides) => sides,
                    None => return false,
                }
            }
        };
        let [x, y, width, height] = sides;
        let (px, py) = layout.position(state);
        rect.left = px + x;
        rect.right = rect.left + width;
        rect.bottom = py + y;
        rect.top = rect.bottom + height;
        rect.back = (from_x - px, from_y - py);
        rect.space = layout.space(state).0;
        true
    }

    /// The box of a body that is not plain; `None` if its guard does not hold. Apart from the loop over all bodies, most of
    /// which are plain.
    #[inline(never)]
    pub(super) fn evaluate_box(
        &self,
        body: &Body,
        state: &[u8],
        frames: &Frames,
        fault: &Cell<Option<Fault>>,
    ) -> Option<[f64; 4]> {
        let actor = &self.actors[body.slot.index()];
        let reader = self.reader(actor, state, frames, &[], fault);
        if body.by_leaf.is_none() && !body.guard.is_none_or(|guard| reader.truth(guard)) {
            return None;
        }
        let read = || body.shape.sides(|id| Some(reader.number(id))).unwrap_or_default();
        Some(body.fixed.unwrap_or_else(read))
    }
}
