//! How far an instance can get in a number of steps.
//!
//! Along an axis, an instance moves by at most its maximum velocity in a step, or is pushed to an end of a push
//! (`surroundings`). Each push can take it over a known distance; it has to travel the rest by itself. Nothing is known
//! if anything can move it elsewhere: an update of the position, a link, a carrier, a spawn.

use crate::ir::{Entity, ExprId, Extremes, Origin, Place, Program, SlotId, SpaceId, VarId, World, WorldId};
use crate::ordered::Ordered;

use crate::analysis::ConfigurationSpace;
use crate::analysis::domain::values::Interval;
use crate::analysis::geometry::seam;
use crate::analysis::step::evaluate::{Pinned, Reader};

/// Upper bound of the rounding error of a step, px.
const ROUNDED: f64 = 1e-6;

impl ConfigurationSpace {
    /// The positions that an instance can have at most `steps` steps after a position, per axis; `None` if unbounded.
    pub fn within_steps(
        &self,
        program: &Program,
        world: WorldId,
        slot: SlotId,
        from: [f64; 2],
        steps: u64,
    ) -> Option<[Interval; 2]> {
        let table = &program.worlds[world];
        let entity = &program.entities[table.slots[slot].entity];
        let goes_through = !entity.follows.is_empty() && table.spaces.iter().any(|s| !s.links.is_empty());
        let of = table.slots[slot].entity;
        let is_spawned = table.slots[slot].origin != Origin::Named
            && program.entities.iter().any(|e| e.spawns.iter().any(|spawn| spawn.entity == of));
        if goes_through || is_spawned || self.slots[slot].is_given_up {
            return None;
        }
        let step = table.step.seconds();
        let speed = self.overall[slot].speed;
        let far = [0, 1].map(|axis| {
            let push_reach = self.surroundings.of(slot).push_reach(axis, speed, step).filter(|_| {
                !has_position_update(entity, axis) && !seam::wraps(table, &self.overall[slot].spaces, axis)
            })?;
            let own = (speed[axis] * step + ROUNDED) * steps as f64;
            // Pushes towards lower coordinates are the mirror image.
            let [up, down] = push_reach;
            let down = down.into_iter().map(|i| Interval { low: -i.high, high: -i.low }).collect();
            Some(Interval { low: -travel_end(down, -from[axis], own), high: travel_end(up, from[axis], own) })
        });
        let all = far.iter().all(|axis| axis.is_none_or(|i| i.low.is_infinite() && i.high.is_infinite()));
        (!all).then(|| far.map(|axis| axis.unwrap_or(Interval::ALL)))
    }

    /// Whether a predicate of the world can hold while an instance is in a box of a space.
    pub fn can_hold_in(
        &self,
        program: &Program,
        world: WorldId,
        predicate: ExprId,
        (slot, space, part): (SlotId, SpaceId, [Interval; 2]),
    ) -> bool {
        let table: &World = &program.worlds[world];
        let reader = self.reader(program, table, None);
        let can = |part| Reader { pinned: Some((slot, Pinned::Part(space, part))), ..reader }.truth(predicate).can_hold;
        let regions = self.surroundings.regions(slot);
        if regions.is_empty() || self.overall[slot].can_be_absent || self.not_kept_out(slot).next().is_some() {
            return can(part);
        }
        let boxes = regions.iter().filter(|(s, _)| *s == space).flat_map(|(_, region)| region.boxes());
        let mut parts = boxes.filter_map(|[x, y]| Some([x.and(part[0])?, y.and(part[1])?]));
        parts.any(can)
    }
}

/// Whether an update can set the position of an instance along an axis.
fn has_position_update(entity: &Entity, axis: usize) -> bool {
    let is_position = |place: Place| matches!(place, Place::Var(var, 0) if var == VarId::XY[axis]);
    entity.action_lists().flat_map(|actions| &actions.updates).any(|update| is_position(update.place))
}

/// The highest coordinate that a body reaches from `from`, if it travels `own` px by itself and pushes take it over
/// some intervals.
fn travel_end(mut push_reach: Vec<Interval>, from: f64, mut own: f64) -> f64 {
    push_reach.order_by(|a, b| a.low.total_cmp(&b.low));
    let mut at = from;
    for over in push_reach {
        if over.high <= at {
            continue;
        }
        let gap = (over.low - at).greatest(0.0);
        if gap > own {
            break;
        }
        own -= gap;
        at = over.high;
    }
    at + own
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pushes_cost_no_travel() {
        let over = |low, high| Interval { low, high };
        assert_eq!(travel_end(vec![], 10.0, 5.0), 15.0);
        assert_eq!(travel_end(vec![over(12.0, 20.0)], 10.0, 5.0), 23.0);
        assert_eq!(travel_end(vec![over(16.0, 20.0)], 10.0, 5.0), 15.0, "it does not get there");
        assert_eq!(travel_end(vec![over(0.0, 8.0), over(8.0, 11.0)], 10.0, 5.0), 16.0);
        assert_eq!(travel_end(vec![over(14.0, 20.0), over(12.0, 13.0), over(12.5, 15.0)], 10.0, 5.0), 23.0);
    }
}
