//! The files of a session on the disk: which have changed, and which a page may write.

use std::collections::BTreeMap;
use std::ffi::OsStr;
use std::fs;
use std::path::{Component, Path, PathBuf};
use std::time::SystemTime;

use crate::source::ReadError;

use super::super::disk::replace;

/// Why a file cannot be read, in a few words.
pub(super) fn reason(error: &ReadError) -> String {
    match error {
        ReadError::Unreadable(why) => why.clone(),
        ReadError::NotUtf8(byte) => format!("byte {byte} is not UTF-8"),
        ReadError::TooLarge(size) => format!("it has {size} bytes"),
    }
}

/// The files as they were when they were last looked at.
#[derive(Default)]
pub(super) struct Seen(BTreeMap<PathBuf, Option<(SystemTime, u64)>>);

impl Seen {
    /// The files that have changed since they were last looked at. A file that is looked at for the first time has not.
    pub fn changed(&mut self, paths: &[PathBuf]) -> Vec<PathBuf> {
        let mut changed = Vec::new();
        for path in paths {
            let now = fs::metadata(path).and_then(|of| Ok((of.modified()?, of.len()))).ok();
            if self.0.insert(path.clone(), now).is_some_and(|before| before != now) {
                changed.push(path.clone());
            }
        }
        changed
    }
}

/// Writes a file for the page: a program, a script or a level of the program, in the folder of the program or below.
///
/// # Errors
/// Why it is not written.
pub(super) fn save(root: &Path, known: &[PathBuf], path: &str, text: &str) -> Result<(), String> {
    let folder = root.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let folder = folder.canonicalize().map_err(|error| error.to_string())?;
    let (asked, is_known) = (Path::new(path), known.iter().any(|known| known.as_os_str() == OsStr::new(path)));
    let is_plain = asked.components().all(|part| matches!(part, Component::Normal(_) | Component::CurDir));
    let is_hidden = asked.file_name().is_none_or(|name| name.to_string_lossy().starts_with('.'));
    let is_ours = asked.extension().is_some_and(|extension| extension == "hyped" || extension == "inputs");
    // Files of the program are named as the program names them, others in its folder.
    let target = match is_known {
        true => asked.to_path_buf(),
        false if !is_plain || is_hidden => return Err(format!("`{path}` is not the name of a file in the folder")),
        false if !is_ours => return Err("only `.hyped` and `.inputs` files are written".to_string()),
        false => folder.join(asked),
    };
    // Wherever links lead, it must be in the folder.
    let real = match target.canonicalize() {
        Ok(real) => real,
        Err(_) => {
            let (Some(parent), Some(name)) = (target.parent(), target.file_name()) else {
                return Err(format!("`{path}` is not the name of a file"));
            };
            parent.canonicalize().map_err(|error| format!("cannot write `{path}`: {error}"))?.join(name)
        }
    };
    if !real.starts_with(&folder) {
        return Err(format!("`{path}` is not in the folder of the program"));
    }
    if real.symlink_metadata().is_ok_and(|of| !of.is_file()) {
        return Err(format!("`{path}` is no regular file"));
    }
    let written = match real.exists() {
        true => replace(&real, text),
        false => fs::write(&real, text).map_err(|error| error.to_string()),
    };
    written.map_err(|why| format!("cannot write `{path}`: {why}"))
}
