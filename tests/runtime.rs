//! The behaviour of a compiled program: steps, states, traces, pictures, memory.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]
#![allow(clippy::disallowed_methods, reason = "a minimum in a test is of numbers other than -0")]

mod support;

mod allocation;
mod batch;
mod breakable;
mod conformance;
mod embedding;
mod examples;
mod members;
mod memory;
mod named;
mod probes;
mod properties;
mod recurring;
mod seams;
mod semantics;
mod slopes;
mod smb;
mod start;
mod studio;
mod studio_keep;
mod studio_looks;
mod studio_memory;
mod studio_paint;
mod studio_protocol;
mod trace;
mod view;
mod zelda;
