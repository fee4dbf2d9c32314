//! Tables: in plain text for people, as CSV for programs. The caller brings the cells; nothing here knows
//! what they mean.

pub mod csv;
mod table;

pub use table::{Cell, Column, Table};
