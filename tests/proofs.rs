//! What is claimed of all runs, against runs.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

mod support;

mod analysis;
mod bounds;
mod findings;
mod oracle;
mod soundness;
mod supply;
