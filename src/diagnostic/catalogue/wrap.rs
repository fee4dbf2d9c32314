//! Facts about spaces that wrap.

use crate::diagnostic::suggestion::BlockKind;
use crate::diagnostic::{Code, Diagnostic, Fact};
use crate::source::Span;

/// A `wrap` that cannot be.
pub struct BadWrap {
    /// The line.
    pub at: Span,
    /// The space.
    pub space: String,
    /// The reason.
    pub why: WhyNoWrap,
}

/// Why a space cannot wrap.
pub enum WhyNoWrap {
    /// It wraps already.
    Twice(Span),
    /// It has neither `bounds` nor a map.
    NoBorders,
    /// Its map does not fill its `bounds`.
    Map {
        /// Where the bounds begin, px.
        low: f64,
        /// Their size, px.
        size: f64,
        /// The size of the map, px.
        map: f64,
        /// `wide` or `high`.
        side: &'static str,
    },
    /// A rectangle is longer than what repeats.
    Rect {
        /// The rectangle.
        at: Span,
        /// Its side, px.
        long: f64,
        /// What repeats, px.
        size: f64,
        /// `wide` or `high`.
        side: &'static str,
    },
}

impl Fact for BadWrap {
    fn into_diagnostic(self) -> Diagnostic {
        let BadWrap { at, space, why } = self;
        let new = |message: String, label: &str| {
            Diagnostic::new(Code::BadWrap, message).at(at, label).or_remove("`wrap`", at)
        };
        match why {
            WhyNoWrap::Twice(other) => new(format!("`{space}` wraps already"), "a second time").and(other, "here"),
            WhyNoWrap::NoBorders => new(format!("`{space}` has no borders to be made one"), "how far is it around?")
                .help("add `bounds rect(0, 0, 256, 240)` to the space, or give it a map")
                .or_add(BlockKind::Space, at, "bounds rect(0, 0, 256, 240)"),
            WhyNoWrap::Map { low, size, map, side } => {
                let message = format!(
                    "the map of `{space}` is {map} px {side} from 0, its bounds are {size} px {side} from {low}: they \
                     cannot repeat together"
                );
                new(message, "what repeats is the bounds")
                    .help(format!("let the bounds be as {side} as the map, from 0 to {map} px, or leave them out"))
            }
            WhyNoWrap::Rect { at: rect, long, size, side } => new(
                format!("a `rect` of `{space}` is {long} px {side}, longer than what repeats"),
                &format!("every {size} px"),
            )
            .and(rect, "would overlap itself")
            .help(format!("{size} px reach all around")),
        }
    }
}

/// A collider that could touch itself around a space that wraps.
pub struct LargeCollider {
    /// The collider.
    pub at: Span,
    /// The entity.
    pub entity: String,
    /// How far it reaches from the position, px.
    pub reach: f64,
    /// What repeats, px.
    pub size: f64,
    /// The space.
    pub space: String,
}

impl Fact for LargeCollider {
    fn into_diagnostic(self) -> Diagnostic {
        let LargeCollider { at, entity, reach, size, space } = self;
        let message = format!(
            "a collider of `{entity}` reaches {reach} px from its position, more than half of the {size} px after \
             which `{space}` repeats"
        );
        Diagnostic::new(Code::BadWrap, message)
            .at(at, "would meet the same thing from both sides")
            .help(format!("make it reach at most {} px, or the space larger", size / 2.0))
    }
}

/// A link that begins beyond the border of a space that wraps.
pub struct LinkBeyondSeam {
    /// The link.
    pub at: Span,
    /// The space.
    pub space: String,
    /// The borders, px.
    pub low: f64,
    /// The upper one.
    pub high: f64,
    /// `x` or `y`.
    pub axis: &'static str,
}

impl Fact for LinkBeyondSeam {
    fn into_diagnostic(self) -> Diagnostic {
        let LinkBeyondSeam { at, space, low, high, axis } = self;
        let message =
            format!("nobody is where this link begins: `{space}` wraps, so `{axis}` is from {low} to below {high}");
        Diagnostic::new(Code::BadWrap, message)
            .at(at, "beyond the border")
            .help("a space that wraps needs no link to its other side; any other link begins between its borders")
    }
}
