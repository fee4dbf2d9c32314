//! Conformance with the 2017 Python system: its recorded runs, replayed step by step (each step from the record of the
//! one before, so that one difference does not hide the rest) and freely from the initial state.
//! The traces are data of that system (see `conformance/LICENSE-HyPED-2017`).

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

mod compare;
mod record;

use std::path::Path;
use std::sync::Arc;

use crate::support::Disk;
use hypedc::compile::compile;
use hypedc::ir::Program;

/// The world of a recorded run, with entities written by hand.
fn by_hand(name: &str) -> Arc<Program> {
    crate::support::program(compile(&Path::new("tests/conformance").join(format!("{name}.hyped")), &Disk))
}

#[test]
fn steps_agree_with_the_records() {
    insta::assert_snapshot!(compare::steps(by_hand));
}

#[test]
fn free_runs_agree_with_the_records() {
    insta::assert_snapshot!(compare::free_runs(by_hand));
}
