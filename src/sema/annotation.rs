//! Annotated dimensions such as `px/s^2`. Dimensions are inferred in `dimension`.

use crate::source::Span;
use crate::syntax::ast::{Dimension, Name};

/// A dimension that the author wrote.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Annotation {
    /// Exponent of px.
    pub px: i32,
    /// Exponent of s.
    pub s: i32,
    /// Its place.
    pub span: Span,
}

impl Annotation {
    /// Reads `px/s^2`.
    ///
    /// # Errors
    /// The first name that is no unit.
    pub fn read(d: &Dimension) -> Result<Self, Name> {
        let mut out = Annotation { px: 0, s: 0, span: d.span };
        for (name, exponent) in &d.factors {
            match &*name.text {
                "px" => out.px = out.px.saturating_add(*exponent),
                "s" => out.s = out.s.saturating_add(*exponent),
                "1" => {}
                _ => return Err(name.clone()),
            }
        }
        Ok(out)
    }
}
