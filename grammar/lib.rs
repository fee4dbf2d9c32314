//! The parser that pest derives from `hyped.pest`. It accepts every text, including those with errors; what the parts
//! mean is the compiler's. A crate of its own, so that it is built beside the other dependencies and not before all of
//! the compiler.

pub use rules::{Grammar, Rule};

#[allow(missing_docs, reason = "derived code")]
mod rules {
    /// The parser.
    #[derive(pest_derive::Parser)]
    #[grammar = "hyped.pest"]
    pub struct Grammar;
}
