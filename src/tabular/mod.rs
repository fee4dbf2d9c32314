//! Tables: in plain text for people, as CSV for programs. Whoever has rows to show brings the cells; nothing here knows
//! what they mean.

pub mod csv;
mod table;

pub use table::{Cell, Column, Table};
