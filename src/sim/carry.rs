//! What rides on a carrier moves along with it, at the beginning of the collision phase.

use crate::ir::{Id, SlotId, VarId};

use super::simulator::Simulator;

impl Simulator {
    /// Moves riders along with their carriers, and clears the carriers. A rider on something carried moves after it; in
    /// a cycle, the lowest slot moves first.
    pub(super) fn carry(&self, state: &mut [u8], start: &[(f64, f64)]) {
        let rides = |state: &[u8], slot: SlotId| {
            let layout = self.layout(slot);
            layout.carrier(state).filter(|_| layout.acts(state))
        };
        loop {
            let (mut first_waiting, mut has_moved) = (None, false);
            for me in self.collision.movable.iter().map(|slot| SlotId::from_index(*slot)) {
                let Some(carrier) = rides(state, me) else { continue };
                if rides(state, carrier).is_some() {
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
        let layout = self.layout(me);
        if self.layout(carrier).acts(state) && self.space(state, carrier) == layout.space(state) {
            let (x, y) = self.position(state, carrier);
            let (from_x, from_y) = start[carrier.index()];
            let (own_x, own_y) = self.position(state, me);
            layout.set_var(state, VarId::X, 0, own_x + (x - from_x));
            layout.set_var(state, VarId::Y, 0, own_y + (y - from_y));
        }
        layout.set_carrier(state, None);
    }
}
