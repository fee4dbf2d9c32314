//! The `hypedc` binary: everything is in the library, the command line in [`hypedc::cli`].

use std::process::ExitCode;

fn main() -> ExitCode {
    hypedc::cli::main()
}
