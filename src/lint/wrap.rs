//! What does not fit into a space that wraps: colliders that would meet a thing from both sides, links where nobody is.

use crate::diagnostic::Diagnostics;
use crate::diagnostic::catalogue::wrap::{LargeCollider, LinkBeyondSeam};
use crate::ir::{Extremes, Origin, Period};
use crate::sema::checked::{Checked, Collider, Instance, Shape, Space, World};
use crate::sema::{ConstantContext, evaluate};

/// Reports what does not fit into the spaces that wrap.
pub(super) fn wraps(checked: &Checked, found: &mut Diagnostics) {
    for world in checked.worlds.iter() {
        for (id, space) in world.spaces.pairs() {
            for (axis, period) in space.periods().into_iter().enumerate() {
                let Some(period) = period else { continue };
                links(space, axis, period, found);
                let mut told = Vec::new();
                for instance in world.instances.iter() {
                    let entity = &checked.entities[instance.entity];
                    let moves = entity.modes.iter().any(|mode| !mode.follows.is_empty());
                    if instance.space != id && !moves && instance.origin != Origin::Free {
                        continue;
                    }
                    for collider in entity.colliders.iter() {
                        let reach = reach(world, instance, collider, axis);
                        let at = collider.span;
                        let Some(reach) = reach.filter(|reach| *reach > period.size() / 2.0 && !told.contains(&at))
                        else {
                            continue;
                        };
                        told.push(at);
                        let (entity, space) = (entity.name.text.to_string(), space.name.text.to_string());
                        found.report(LargeCollider { at, entity, reach, size: period.size(), space });
                    }
                }
            }
        }
    }
}

/// How far a collider of constant size reaches from the position along an axis, px.
fn reach(world: &World, instance: &Instance, collider: &Collider, axis: usize) -> Option<f64> {
    let context = ConstantContext { params: Some(&instance.params), step: Some(world.step) };
    let (low, high) = match &collider.shape {
        Shape::Rect(numbers) => {
            let low = evaluate(&numbers[axis], context).ok()?;
            (low, low + evaluate(&numbers[axis + 2], context).ok()?)
        }
        Shape::Circle(numbers) => {
            let (middle, radius) = (evaluate(&numbers[axis], context).ok()?, evaluate(&numbers[2], context).ok()?);
            (middle - radius, middle + radius)
        }
    };
    Some(high.greatest(-low))
}

/// Reports links that begin where no position is.
fn links(space: &Space, axis: usize, period: Period, found: &mut Diagnostics) {
    let Period { low, high } = period;
    for link in &space.links {
        if link.from[axis] >= high || link.from[axis] + link.from[axis + 2] < low {
            let (space, axis) = (space.name.text.to_string(), ["x", "y"][axis]);
            found.report(LinkBeyondSeam { at: link.span, space, low, high, axis });
        }
    }
}
