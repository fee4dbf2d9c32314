//! The boxes of bodies: where they are before contacts are detected (`collision.rs`).

use std::cell::Cell;
use std::ops::Range;
use std::sync::Arc;

use crate::ir::Id;

use super::chance::Frames;
use super::collision::Body;
use super::fault::Fault;
use super::simulator::{Scratch, Simulator};
use super::state::leaf_at;

impl Simulator {
    /// Moves the boxes of some bodies to the positions of their instances.
    pub(super) fn place_boxes(&self, state: &[u8], scratch: &mut Scratch, of: Range<usize>) -> Result<(), Fault> {
        let Scratch { frames, collision, start, .. } = scratch;
        let fault = Cell::new(None);
        for (body, rect) in self.collision.bodies[of.clone()].iter().zip(collision.boxes[of].iter_mut()) {
            let layout = body.layout;
            let is_there = |(at, leaves): &(usize, Arc<[bool]>)| leaves[leaf_at(state, *at).index()];
            rect.active = layout.acts(state) && body.by_leaf.as_ref().is_none_or(is_there);
            if !rect.active {
                continue;
            }
            let sides = match body.fixed {
                Some(sides) if body.is_plain => sides,
                _ => {
                    rect.round = body.shape.is_round();
                    // An empty collider touches nothing.
                    let sides = self.evaluate_box(body, state, frames, &fault);
                    let sides = sides.filter(|[.., width, height]| *width > 0.0 && *height > 0.0);
                    rect.active = sides.is_some();
                    let Some(sides) = sides else { continue };
                    sides
                }
            };
            let [x, y, width, height] = sides;
            let (px, py) = layout.position(state);
            let (from_x, from_y) = start[body.slot.index()];
            rect.left = px + x;
            rect.right = rect.left + width;
            rect.bottom = py + y;
            rect.top = rect.bottom + height;
            rect.back = (from_x - px, from_y - py);
            rect.space = layout.space(state).0;
        }
        Self::check_fault(&fault)
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
