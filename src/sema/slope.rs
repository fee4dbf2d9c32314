//! Tiles that are solid up to a line: where it begins and ends, and whether it divides the tile.

use crate::diagnostic::catalogue::slope::{BadSlope, WhyNoSlope};
use crate::ir::{Misfit, Slope};
use crate::source::Span;
use crate::syntax::ast;

use super::Checker;
use super::checked::World;
use super::constant::ConstantContext;
use super::expression::Scope;

/// Deviation of an end from the side of a tile that is a rounding error, px.
const ROUNDING: f64 = 1e-6;

/// The ends of the line of a slope, px.
pub(super) struct SlopeEnds {
    left: (f64, f64),
    right: (f64, f64),
    at: Span,
}

impl Checker<'_> {
    /// The numbers of a slope; `None` of a tile that is solid up to its top, or if they are wrong.
    pub(super) fn slope_ends(&mut self, syntax: Option<&ast::Slope>, world: &mut World) -> Option<SlopeEnds> {
        let syntax = syntax?;
        let mut known = Vec::new();
        for e in syntax.ends.iter().flatten() {
            let term = self.number(e, &Scope::constant());
            let value = term.and_then(|term| {
                let value = self.evaluated(&term, ConstantContext::LITERALS)?;
                world.lengths.push(term);
                self.length(value, e.span)
            });
            known.extend(value);
        }
        let &[left, low, right, high] = known.as_slice() else { return None };
        Some(SlopeEnds { left: (left, low), right: (right, high), at: syntax.span })
    }

    /// The slope with these ends in a tile of a size; `None` with a finding if it does not fit.
    pub(super) fn slope(&mut self, ends: &SlopeEnds, (width, height): (f64, f64)) -> Option<Slope> {
        let is = |x: f64, side: f64| (x - side).abs() <= ROUNDING;
        let near = |y: f64| if is(y, height) { height } else { y };
        let slope = Slope { left: near(ends.left.1) + 0.0, right: near(ends.right.1) + 0.0 };
        let spans = is(ends.left.0, 0.0) && is(ends.right.0, width);
        let why = match slope.misfit(height) {
            _ if !spans && is(ends.left.0, width) && is(ends.right.0, 0.0) => Some(WhyNoSlope::Backwards),
            _ if !spans => Some(WhyNoSlope::Width),
            Some(Misfit::Outside) => Some(WhyNoSlope::Height),
            Some(Misfit::Full) => Some(WhyNoSlope::Full),
            Some(Misfit::Empty) => Some(WhyNoSlope::Empty),
            None => None,
        };
        if let Some(why) = why {
            let SlopeEnds { left, right, at } = *ends;
            self.diagnostics.report(BadSlope { at, left, right, tile: (width, height), why });
            return None;
        }
        Some(slope)
    }
}
