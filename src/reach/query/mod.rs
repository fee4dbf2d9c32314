//! The way from a question to its answer: prove, search, improve, shorten, replay, answer. A [`Query`] is what is asked of a
//! world, a [`Session`] asks it and an [`Answer`] is the record that comes of it; the command line, rows of many levels and
//! editors only format that record.

mod answer;
mod session;
mod wording;

pub use answer::{Answer, Counterexample, CoverageSummary, ExhaustedHold, Kind, ProofMethod, SearchWindow};
pub use session::{Found, Phase, Query, Session, Supervisor, Unasked};
pub use wording::{is_bounded, proof_reasons};
