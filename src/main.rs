//! The `hypedc` binary: everything is in the library, the command line in [`hypedc::cli`].

use std::process::ExitCode;

/// Analyses and searches make and drop many small configurations: with the allocators of most systems that takes up to a
/// third of their time.
#[global_allocator]
static ALLOCATOR: mimalloc::MiMalloc = mimalloc::MiMalloc;

fn main() -> ExitCode {
    hypedc::cli::main()
}
