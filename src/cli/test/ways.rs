//! Where ways that were found are kept: a file each. In the user's cache it is named by the meaning of the program, the
//! question and the settings, so that the verdict is that of the search. In a folder of `--ways`, which belongs to the
//! project, it is named by the question alone, and outlives changes of the program.

use std::path::PathBuf;

use crate::ir::Program;
use crate::source::Files;
use crate::suite::{WayName, Ways};

use crate::cli::disk::{Disk, keep_in_cache, user_cache};
use crate::cli::report::{program_sha256, sha256};

/// A folder of ways.
pub(super) struct WayFolder {
    folder: PathBuf,
    /// The name of the program in the names of files; none in the user's cache.
    stem: Option<String>,
}

impl WayFolder {
    /// A folder that belongs to a project, for one of its programs.
    pub fn of_project(folder: PathBuf, file: &std::path::Path) -> Self {
        let stem = file.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        WayFolder { folder, stem: Some(stem) }
    }

    /// The user's cache; none if the system tells no place for it.
    pub fn in_cache() -> Option<Self> {
        Some(WayFolder { folder: user_cache()?.join("ways"), stem: None })
    }

    fn path(&self, program: &Program, name: &WayName<'_>) -> PathBuf {
        let short = |text: String| sha256(text.as_bytes()).chars().take(32).collect::<String>();
        let WayName { world, question, settings } = name;
        self.folder.join(match &self.stem {
            Some(stem) => format!("{stem}.{world}.{}.inputs", short(question.clone())),
            None => {
                format!("{}.inputs", short(format!("{}\n{world}\n{question}\n{settings}", program_sha256(program))))
            }
        })
    }
}

impl Ways for WayFolder {
    fn find(&self, program: &Program, name: &WayName<'_>) -> Option<String> {
        Disk.read(&self.path(program, name)).ok()
    }

    fn keep(&self, program: &Program, name: &WayName<'_>, script: &str) {
        // A way that cannot be kept is searched for again.
        keep_in_cache(&self.path(program, name), &format!("{script}\n"));
    }
}
