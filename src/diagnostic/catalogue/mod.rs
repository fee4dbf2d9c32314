//! The facts that checks record, and the only place where each becomes a message.
//!
//! Style of messages: say what was found, label the place, label the related place, suggest the most likely fix. No
//! "you", no blame, names in backquotes.
//!
//! To add a code:
//!
//! 1. a line in the list of [`Code`](super::Code): its name, severity, text and title;
//! 2. a fact here, in the file of its family, that becomes a [`Diagnostic`](super::Diagnostic) of this code;
//! 3. `pages/CODE.md`: what `hypedc explain CODE` shows, with a wrong and a right example (the form is described in
//!    [`page`](super::page)); without it nothing compiles, and `tests/explain.rs` tries its examples;
//! 4. a program in `tests/ui` in which it is found.
//!
//! `UPDATE=1 cargo test --test language reference` adds the code to the table in `grammar/README.md`.

pub mod file;
pub mod import;
pub mod lint;
pub mod look;
pub mod names;
pub mod run;
pub mod slope;
pub mod structure;
pub mod syntax;
pub mod test;
pub mod types;
pub mod values;
pub mod world;
pub mod wrap;

/// `a`, `a or b`, `a, b or c`.
pub(crate) fn list(words: &[String], joint: &str) -> String {
    match words {
        [] => String::new(),
        [only] => only.clone(),
        [init @ .., last] => format!("{} {joint} {last}", init.join(", ")),
    }
}

/// `; did you mean …?`, or nothing.
pub(crate) fn did_you_mean(near: Option<&String>) -> String {
    near.map_or(String::new(), |n| format!("; did you mean `{n}`?"))
}
