//! What a compiled program does: steps, states, traces, what is drawn of them, and what memory they take.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

mod support;

mod allocation;
mod conformance;
mod embedding;
mod examples;
mod memory;
mod properties;
mod semantics;
mod smb;
mod trace;
mod view;
mod zelda;
