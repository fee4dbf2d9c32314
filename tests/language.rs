//! From text to a program: diagnostics, layout, imports, levels, editors.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]
#![allow(clippy::disallowed_methods, reason = "a minimum in a test is of numbers other than -0")]

mod support;

mod compiled;
mod conditions;
mod docs;
mod editors;
mod explain;
mod fix;
mod fmt;
mod formats;
mod fuzz;
mod graph;
mod import;
mod level_editors;
mod looks;
mod lsp;
mod maps;
mod mutation;
mod new;
mod reference;
mod reparse;
mod robust;
mod scale;
mod schemas;
mod tidy;
mod ui;
