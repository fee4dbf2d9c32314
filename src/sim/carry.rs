//! What rides on a carrier moves along with it, at the beginning of the collision phase.

use crate::ir::{Id, SlotId, VarId};

use super::simulator::Simulator;
use super::state::PositionLayout;

impl Simulator {
    /// Moves riders along with their carriers, and clears the carriers. A rider on something carried moves after it; in
    /// a cycle, the lowest slot moves first.
    pub(super) fn carry(&self, state: &mut [u8], start: &[(f64, f64)]) {
        let rides = |state: &[u8], slot: SlotId| {
            let layout = self.layout(slot);
            layout.moving_carrier(state).filter(|_| layout.acts(state))
        };
        let is_carried = |state: &[u8], slot| self.layout(slot).rest.is_none() && rides(state, slot).is_some();
        loop {
            let (mut first_waiting, mut has_moved) = (None, false);
            for me in self.collision.movable.iter().map(|slot| SlotId::from_index(*slot)) {
                let Some(carrier) = rides(state, me) else { continue };
                if is_carried(state, carrier) {
                    first_waiting = first_waiting.or(Some((me, carrier)));
                    continue;
                }
                self.ride(state, start, me, carrier);
                has_moved = true;
            }
            match first_waiting {
                Some((me, carrier)) if !has_moved => self.ride(state, start, me, carrier),
                Some(_) => {}
                None => break,
            }
        }
    }

    /// Moves an instance along with its carrier.
    fn ride(&self, state: &mut [u8], start: &[(f64, f64)], me: SlotId, carrier: SlotId) {
        let (layout, on) = (self.layout(me), self.layout(carrier));
        // What never moves carries nothing along.
        if on.rest.is_none() && on.acts(state) {
            let (own, on) = (PositionLayout::of(layout), PositionLayout::of(on));
            if own.space(state) == on.space(state) {
                let (x, y) = on.position(state);
                let (from_x, from_y) = start[carrier.index()];
                let (own_x, own_y) = own.position(state);
                layout.set_moving_var(state, VarId::X, 0, own_x + (x - from_x));
                layout.set_moving_var(state, VarId::Y, 0, own_y + (y - from_y));
            }
        }
        layout.set_moving_carrier(state, None);
    }
}
