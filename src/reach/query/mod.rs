//! The pipeline from a question to its answer: prove, search, improve, shorten, replay, answer. A [`Query`] is a set of
//! questions about a world, a [`Session`] runs it and an [`Answer`] is the resulting record; the command line, tables
//! over many levels and editors only format that record.

mod answer;
pub mod layers;
mod robust;
mod session;
mod wording;

pub use answer::{
    Answer, Counterexample, CoverageSummary, ExhaustedHold, Kind, ProofMethod, SearchWindow, UnfinishedVisit,
};
pub use robust::{ChangeRecord, FirstPath, FoundRobust, RobustRecord, SuccessRecord, TimingErrors};
pub use session::{Found, Phase, Query, QueryError, Session, Supervisor, replay};
pub use wording::{is_bounded, proof_reasons, unpressed_words};
