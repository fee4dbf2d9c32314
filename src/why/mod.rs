//! Why an instance did what it did in a step of a run, and why it did not do something else: modes, edges with the parts of
//! their guards, contacts, what was written, and since when all of this is so.
//!
//! | file | holds |
//! |---|---|
//! | `record` | the records that the page of a play session shares |
//! | `step` | an instance after a step, and the edges that were considered in it |
//! | `whom` | what an instance touches |
//! | `run` | a run to a step, with what happened in it, and since when |
//! | `writes` | what the edges that were taken did |
//! | `lack` | what an expression lacks to be true |
//! | `nearly` | how near the guards of edges came in a run |
//! | `predicate` | a predicate of a world in a state, part by part |
//! | `coverage` | what runs cover: modes, edges, parts of guards |

mod coverage;
mod lack;
mod nearly;
mod predicate;
mod record;
mod run;
mod step;
mod whom;
mod writes;

pub use coverage::{Covered, EdgeCoverage, ModeCoverage, PartCoverage, PlaceCoverage};
pub use nearly::{Missing, Nearly, NearlyEdge, nearly};
pub use predicate::{predicate_atoms, predicate_distance};
pub use record::{Atom, Contact, EdgeState, Inspected, Place, Value};
pub use run::{AtomSince, EdgeWhy, ModeSince, RunError, Touched, Why, Write, why};
pub use step::{Moment, inspect, place, shown};
pub(crate) use whom::is_at;
