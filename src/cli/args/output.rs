//! Paths of what is written. A path `-` would become a file of that name: it stands for standard output where a command says
//! so, and is refused elsewhere.

use std::io::{self, Write};
use std::path::{Path, PathBuf};

use clap::builder::{PathBufValueParser, TypedValueParser};

/// What stands for standard output.
const STANDARD: &str = "-";

/// The path of a file or of a folder; `-` is refused.
pub(in crate::cli) fn output() -> impl TypedValueParser<Value = PathBuf> {
    PathBufValueParser::new().try_map(|path| match is_standard(&path) {
        true => Err("standard output has the result already: give a path, which for the name `-` itself is `./-`"),
        false => Ok(path),
    })
}

/// Whether a path stands for standard output.
pub(in crate::cli) fn is_standard(path: &Path) -> bool {
    path.as_os_str() == STANDARD
}

/// Writes to a file, or to standard output.
pub(in crate::cli) fn write(path: &Path, bytes: &[u8]) -> io::Result<()> {
    match is_standard(path) {
        true => io::stdout().lock().write_all(bytes),
        false => std::fs::write(path, bytes),
    }
}

#[cfg(test)]
mod tests {
    use clap::error::ErrorKind;
    use clap::{Command, CommandFactory};

    use crate::cli::args::Arguments;

    /// The arguments of a command that name what it writes, each with the words before it and its help.
    fn outputs(command: &Command, before: &[String], out: &mut Vec<(Vec<String>, String)>) {
        for argument in command.get_arguments() {
            let help = argument.get_help().map(ToString::to_string).unwrap_or_default();
            let first = help.split_whitespace().next().unwrap_or_default();
            if argument.get_action().takes_values() && ["Writes", "Draws", "Also", "Appends"].contains(&first) {
                let option = argument.get_long().map(|long| format!("--{long}"));
                out.push((before.iter().cloned().chain(option).collect(), help));
            }
        }
        for inner in command.get_subcommands() {
            let words: Vec<String> = before.iter().cloned().chain([inner.get_name().to_string()]).collect();
            outputs(inner, &words, out);
        }
    }

    #[test]
    fn no_command_writes_a_file_named_by_a_hyphen() {
        let mut all = Vec::new();
        outputs(&Arguments::command(), &["hypedc".to_string()], &mut all);
        assert!(all.len() > 20, "{all:?}");
        for (words, help) in &all {
            let given = words.iter().map(String::as_str).chain(["-"]);
            let found = Arguments::command().try_get_matches_from(given).map_err(|error| error.kind());
            let is_refused = matches!(found, Err(ErrorKind::ValueValidation));
            let is_standard = help.contains("`-`") && help.contains("standard output");
            assert!(is_refused != is_standard, "{words:?}: {help}");
        }
        let folder = Arguments::command().try_get_matches_from(["hypedc", "new", "-"]);
        assert!(folder.is_err_and(|error| error.kind() == ErrorKind::ValueValidation));
        let folder = Arguments::command().try_get_matches_from(["hypedc", "test", "a.hyped", "--ways", "-"]);
        assert!(folder.is_err_and(|error| error.kind() == ErrorKind::ValueValidation));
    }
}
