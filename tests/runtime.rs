//! What a compiled program does: steps, states, traces, what is drawn of them, and what memory they take.

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
