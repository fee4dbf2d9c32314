//! The static obstacles of a space as a kind touches them: positions of contacts, ends of pushes.

use std::collections::BTreeSet;

use crate::analysis::domain::values::Interval;
use crate::analysis::geometry::body::Edges;
use crate::ir::Bounce;

/// The static obstacles that bodies of a kind can touch in a space.
#[derive(Debug, Clone)]
pub(in crate::analysis) struct Statics {
    /// For each contact query, per axis, the positions at which it can hold.
    pub places: Vec<[Vec<Interval>; 2]>,
    /// For each contact query, whether every matching obstacle here pushes the body.
    pub pushed: Vec<bool>,
    /// Where pushes end.
    pub edges: Edges,
    /// Where pushes end if the body is not deep inside an obstacle: only at faces that no neighbour covers.
    pub faces: Edges,
    /// Per axis, the size of the thinnest obstacle that pushes it, px; infinite if there is none.
    pub thinnest: [f64; 2],
    /// Per axis, the maximum length of a push, px.
    pub longest: [f64; 2],
    pub pushes: bool,
    /// Whether some push stops the velocity into the surface.
    pub stops: bool,
    /// How pushes turn the velocity into the surface back.
    pub bounces: BTreeSet<Bounce>,
    /// Whether some push does not stop it.
    pub slips: bool,
    /// Whether a push can end anywhere because the size of the pushed body is not constant.
    pub anywhere: bool,
    /// Whether something that pushes it can be broken, or is solid in a part of its box only.
    pub breaks: bool,
    /// Whether a slope pushes it.
    pub slopes: bool,
    /// Whether modes alone determine when the pushed bodies are active.
    pub is_steady: bool,
}

impl Default for Statics {
    fn default() -> Self {
        Statics {
            places: Vec::new(),
            pushed: Vec::new(),
            edges: Edges::default(),
            faces: Edges::default(),
            thinnest: [f64::INFINITY; 2],
            longest: [0.0; 2],
            pushes: false,
            stops: false,
            bounces: BTreeSet::new(),
            slips: false,
            anywhere: false,
            breaks: false,
            slopes: false,
            is_steady: true,
        }
    }
}
