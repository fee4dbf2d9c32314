//! Tables: in plain text for people, as CSV for programs. The caller provides the cells; their meaning is unknown here.

pub mod csv;
mod table;

pub use table::{Cell, Column, Table};
