//! The report of a state that the analysis excludes: the analysis is wrong about this world, which is a bug of
//! `hypedc`, and its proofs are withdrawn.

use std::fs::File;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use crate::ir::{Program, WorldId};
use crate::reach::Refutation;

pub(in crate::cli) use crate::ask::Refuted;

use crate::cli::report::program_sha256;

/// Maximum number of files with the same stem, distinguished by numbers.
const MAX_FILES: usize = 10_000;

/// The context of a run, for the report.
pub(in crate::cli) struct RunInfo<'o> {
    pub file: &'o Path,
    pub level: Option<&'o Path>,
    pub seed: u64,
    /// The command line.
    pub command: String,
}

impl Refuted {
    /// Creates the report, with a file that reproduces it.
    pub(in crate::cli) fn saved(
        program: &Program,
        world: WorldId,
        refutation: &Refutation,
        info: &RunInfo<'_>,
    ) -> Self {
        let mut refuted = Refuted::new(program, world, refutation);
        refuted.write(program, world, info);
        refuted
    }

    /// Writes everything needed to reproduce it beside the program, or else into the current directory. Overwrites
    /// nothing; `file` stays `None` on failure.
    fn write(&mut self, program: &Program, world: WorldId, info: &RunInfo<'_>) {
        let name: String =
            program.worlds[world].name.chars().map(|c| if c.is_alphanumeric() { c } else { '-' }).collect();
        let stem = format!("hypedc-refuted-{name}-{}", info.seed);
        let text = self.text(program, world, info);
        let beside = info.file.parent().unwrap_or(Path::new("")).to_path_buf();
        self.file = [beside, PathBuf::new()].iter().find_map(|folder| write_new(folder, &stem, &text).ok());
    }

    fn text(&self, program: &Program, world: WorldId, info: &RunInfo<'_>) -> String {
        let level = info.level.map_or(String::new(), |path| format!("level    {}\n", path.display()));
        format!(
            "A run of `hypedc` {} reached a state that its analysis excludes.\n\
             Please report this as a bug of `hypedc`, with the program, what it imports and its levels.\n\n\
             command  {}\nprogram  {}\ncompiled {}\n{level}world    {}\nseed     {}\nstep     {}\noutside  {}\ninputs   {}\n",
            env!("CARGO_PKG_VERSION"),
            info.command,
            info.file.display(),
            program_sha256(program),
            program.worlds[world].name,
            info.seed,
            self.steps,
            self.what,
            self.inputs,
        )
    }

    /// The report in one line.
    pub(in crate::cli) fn line(&self) -> String {
        let file = self.file.as_ref().map_or(String::new(), |path| format!("; see {}", path.display()));
        let steps = if self.steps == 1 { "step" } else { "steps" };
        format!("the analysis is wrong about this world: after {} {steps}, {}{file}", self.steps, self.what)
    }

    /// The report as text after the answers.
    pub(in crate::cli) fn human(&self) -> String {
        let steps = if self.steps == 1 { "step" } else { "steps" };
        let mut out = format!(
            "  the analysis is wrong about this world: nothing is proven by it\n    after {} {steps}, {}\n",
            self.steps, self.what
        );
        if !self.inputs.is_empty() {
            out.push_str(&format!("    inputs  {}\n", self.inputs));
        }
        match &self.file {
            Some(path) => out.push_str(&format!(
                "    this is a bug of `hypedc`: please report it, with {} and the program\n",
                path.display()
            )),
            None => out.push_str(
                "    this is a bug of `hypedc`: please report it, with this output and the program (no file could be written)\n",
            ),
        }
        out
    }
}

/// The command line of this process.
pub(in crate::cli) fn command_line() -> String {
    let quoted = |argument: String| {
        let plain = |c: char| c.is_alphanumeric() || "-_./=+:,*@%".contains(c);
        match !argument.is_empty() && argument.chars().all(plain) {
            true => argument,
            false => format!("'{}'", argument.replace('\'', r"'\''")),
        }
    };
    let arguments = std::env::args_os().map(|argument| quoted(argument.to_string_lossy().into_owned()));
    arguments.collect::<Vec<_>>().join(" ")
}

/// Writes a new file, numbered if the name exists.
fn write_new(folder: &Path, stem: &str, text: &str) -> io::Result<PathBuf> {
    for number in 1..=MAX_FILES {
        let name = if number == 1 { format!("{stem}.txt") } else { format!("{stem}-{number}.txt") };
        let path = folder.join(name);
        match File::options().write(true).create_new(true).open(&path) {
            Ok(mut file) => return file.write_all(text.as_bytes()).map(|()| path),
            Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {}
            Err(error) => return Err(error),
        }
    }
    Err(io::ErrorKind::AlreadyExists.into())
}
