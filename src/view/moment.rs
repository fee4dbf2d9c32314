//! Moments of a path that need timing: a ring where each is, with how much too early or too late it can be.

use crate::ir::SpaceId;
use crate::ordered::Ordered;

use super::frame::{Frame, Rect};
use super::label::Labels;
use super::route::Route;
use super::svg::{Number, put};
use super::track::Moment;

/// The style of the rings, for pictures that have some.
pub(super) const STYLE: &str =
    "\n.moment{fill:none;stroke:#9a6700;stroke-width:2}.hardest{stroke:#cf222e;stroke-width:3}";
/// The radius of a ring.
pub(super) const RADIUS: f64 = 6.0;

/// The class of a ring.
pub(super) fn class(is_hardest: bool) -> &'static str {
    if is_hardest { "moment hardest" } else { "moment" }
}

/// Draws the moments that are in a panel; the hardest one gets the best place for its words.
pub(super) fn draw(
    out: &mut String,
    moments: &[Moment],
    route: &Route<'_>,
    (frame, id): (&Frame, SpaceId),
    labels: &mut Labels,
) {
    let here = moments.iter().filter_map(|moment| Some((moment, route.place(frame, id, moment.step)?)));
    let mut here: Vec<(&Moment, [f64; 2])> = here.collect();
    here.order_by_key(|(moment, _)| !moment.is_hardest);
    for (moment, [x, y]) in &here {
        let class = class(moment.is_hardest);
        put!(out, "<circle class=\"{class}\" cx=\"{}\" cy=\"{}\" r=\"{RADIUS}\"/>\n", Number(*x), Number(*y));
        labels.keep_free(Rect::around([*x, *y], RADIUS));
    }
    for (moment, at) in here {
        let class = if moment.is_hardest { "name red" } else { "name" };
        labels.write(class, &moment.words, Rect::around(at, RADIUS));
    }
}
