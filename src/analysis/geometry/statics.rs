//! What a kind of instances meets in a space that never moves: where contacts with it are, and where its pushes end.

use crate::analysis::domain::values::Interval;
use crate::analysis::geometry::body::Edges;

/// What bodies of a kind meet in a space that never moves.
#[derive(Debug, Clone)]
pub(in crate::analysis) struct Statics {
    /// Of each contact question, along both axes, where an instance is when it holds.
    pub places: Vec<[Vec<Interval>; 2]>,
    /// Of each contact question, whether all that it asks for here pushes the body that asks.
    pub pushed: Vec<bool>,
    /// Where pushes put it.
    pub edges: Edges,
    /// So, where what pushes it is not deep inside of other things: by faces that no neighbour covers.
    pub faces: Edges,
    /// Of both axes, the size of the thinnest thing that pushes it, px; infinite if there is none.
    pub thinnest: [f64; 2],
    /// Of both axes, how far a push can be, px.
    pub longest: [f64; 2],
    pub pushes: bool,
    /// Whether some push stops the velocity into the surface.
    pub stops: bool,
    /// Whether some push does not.
    pub slips: bool,
    /// Whether a push can end anywhere: the body that is pushed is not always the same.
    pub anywhere: bool,
    /// Whether modes alone decide when what is pushed is there.
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
            slips: false,
            anywhere: false,
            is_steady: true,
        }
    }
}
