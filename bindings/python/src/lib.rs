//! The extension module behind the Python package `hyped`: classes over the library's own API. What a call means is
//! decided in the library; what is convenient for Python is in `python/hyped`.

mod arrays;
mod batch;
mod error;
mod event;
mod files;
mod inputs;
mod named;
mod picture;
mod program;
mod questions;
mod search;
mod simulator;
mod trace;
mod tuning;
mod views;
mod watched;
mod world;

use pyo3::prelude::*;

#[pymodule]
mod _hyped {
    /// The version of the library.
    #[pymodule_export]
    const VERSION: &str = env!("CARGO_PKG_VERSION");

    #[pymodule_export]
    use super::batch::Batch;
    #[pymodule_export]
    use super::event::Event;
    #[pymodule_export]
    use super::program::{Program, compile, named, rebuilt};
    #[pymodule_export]
    use super::questions::{bounds, stuck, why};
    #[pymodule_export]
    use super::search::{explore, reach};
    #[pymodule_export]
    use super::simulator::{Simulator, resumed};
    #[pymodule_export]
    use super::trace::trace;
    #[pymodule_export]
    use super::tuning::tune;
    #[pymodule_export]
    use super::views::{Planes, Variables};
    #[pymodule_export]
    use super::world::World;
}
