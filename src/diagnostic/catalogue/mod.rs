//! The facts that checks record, and the one place where each is put into words.
//!
//! The voice: say what was found, label it, label where the other half is, name the nearest way out. No "you",
//! no blame, names in backquotes.

pub mod file;
pub mod lint;
pub mod names;
pub mod run;
pub mod structure;
pub mod syntax;
pub mod types;
pub mod world;

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
