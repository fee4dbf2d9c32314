//! Tests of claims about all runs, against concrete runs.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

mod support;

mod analysis;
mod bounds;
mod findings;
mod oracle;
mod replays;
mod soundness;
mod supply;
