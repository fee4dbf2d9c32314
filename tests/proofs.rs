//! What is claimed of all runs, against runs.

mod support;

mod analysis;
mod bounds;
mod findings;
mod oracle;
mod soundness;
mod supply;
