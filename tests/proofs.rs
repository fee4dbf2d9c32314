//! Tests of claims about all runs, against concrete runs.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]
#![allow(clippy::disallowed_methods, reason = "a minimum in a test is of numbers other than -0")]

mod support;

mod analysis;
mod bounds;
mod findings;
mod oracle;
mod replays;
mod soundness;
mod supply;
