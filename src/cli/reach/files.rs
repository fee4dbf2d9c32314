//! The output files of an answer of `hypedc reach`: the inputs of a path, and the picture of the search.

use std::fs::write;
use std::io;
use std::path::{Path, PathBuf};

use crate::ask::search_svg;
use crate::reach::query::{Answer, Found, Session};
use crate::watch::Watch;

use crate::cli::args::ReachArgs;
use crate::cli::pictures::images;
use crate::cli::refusal::Refusal;
use crate::cli::report::sha256;
use crate::cli::sim::save_script;

/// Maximum number of characters of a predicate in the name of a file.
const MAX_WORD: usize = 60;

/// The files that were written.
#[derive(Debug, Clone, Default)]
pub(in crate::cli) struct Saved {
    pub inputs: Option<PathBuf>,
    pub picture: Option<PathBuf>,
}

/// The output paths of an answer. If there are several levels or goals, their names become part of the paths.
pub(in crate::cli) struct Destination<'d> {
    args: &'d ReachArgs,
    level: Option<&'d str>,
    goal: Option<&'d str>,
}

impl<'d> Destination<'d> {
    /// `goals` is the number of goals.
    pub fn new(args: &'d ReachArgs, level: Option<&'d str>, goal: &'d str, goals: usize) -> Self {
        Destination { args, level, goal: (goals > 1).then_some(goal) }
    }

    /// The path of the inputs; `None` without `--save-inputs`.
    fn inputs(&self) -> Option<PathBuf> {
        self.args.save_inputs.as_deref().map(|path| self.named(path))
    }

    /// The path of the picture; `None` without `--svg`.
    fn picture(&self) -> Option<PathBuf> {
        self.args.svg.as_deref().map(|path| self.named(path))
    }

    /// Whether all files of an answer exist.
    pub fn is_complete(&self, has_inputs: bool) -> bool {
        self.inputs().filter(|_| has_inputs).into_iter().chain(self.picture()).all(|path| path.exists())
    }

    /// Writes the requested files.
    pub fn save(
        &self,
        session: &Session,
        found: &Found<'_>,
        answer: &Answer,
        watch: &dyn Watch,
    ) -> Result<Saved, Refusal> {
        let cannot =
            |path: &Path, error: io::Error| Refusal::Plain(format!("cannot write `{}`: {error}", path.display()));
        let mut saved = Saved::default();
        if let (Some(path), Some(inputs)) = (self.inputs(), &answer.inputs) {
            save_script(&path, inputs).map_err(|error| cannot(&path, error))?;
            saved.inputs = Some(path);
        }
        if let Some(path) = self.picture() {
            let images = images(session.simulator().program(), &self.args.file).map_err(Refusal::Plain)?;
            write(&path, search_svg(session, found, answer, &images, watch)).map_err(|error| cannot(&path, error))?;
            saved.picture = Some(path);
        }
        Ok(saved)
    }

    /// Inserts the names before the extension of a path.
    fn named(&self, path: &Path) -> PathBuf {
        let mut name = path.file_stem().unwrap_or_default().to_os_string();
        for word in self.level.map(str::to_string).into_iter().chain(self.goal.map(file_word)) {
            name.push(".");
            name.push(word);
        }
        if let Some(extension) = path.extension() {
            name.push(".");
            name.push(extension);
        }
        path.with_file_name(name)
    }
}

/// A goal as part of a file's name: a name as it is, a predicate with words for what names of files cannot have.
fn file_word(goal: &str) -> String {
    let is_plain = |c: char| c.is_alphanumeric() || c == '_';
    if goal.chars().all(is_plain) {
        return goal.to_string();
    }
    let mut word = String::new();
    for c in goal.chars() {
        let part = match c {
            '<' => "-lt-",
            '>' => "-gt-",
            '=' => "-eq-",
            '+' => "-plus-",
            '-' => "-minus-",
            '*' => "-times-",
            '/' => "-over-",
            '!' => "-not-",
            '\'' => "-rate-",
            c if is_plain(c) => {
                word.push(c);
                continue;
            }
            _ => "-",
        };
        word.push_str(part);
    }
    let words: Vec<&str> = word.split('-').filter(|part| !part.is_empty()).collect();
    let word = words.join("-");
    // What is left out, or cut off, must not make two predicates one file.
    if word.chars().count() <= MAX_WORD && !goal.contains(['(', ')']) {
        return word;
    }
    let cut: String = word.chars().take(MAX_WORD).collect();
    let hash = sha256(goal.as_bytes());
    format!("{cut}-{}", hash.get(..8).unwrap_or_default())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn predicates_become_names_of_files() {
        assert_eq!(file_word("arrive"), "arrive");
        assert_eq!(file_word("hero.x > 300"), "hero-x-gt-300");
        assert_eq!(file_word("hero.y' <= -3/4"), "hero-y-rate-lt-eq-minus-3-over-4");
        let (a, b) = (file_word("(a or b) and c"), file_word("a or (b and c)"));
        assert!(a != b && a.starts_with("a-or-b-and-c-"), "{a} {b}");
        assert!(file_word(&"hero.x > 3 and ".repeat(40)).len() < 80);
    }
}
