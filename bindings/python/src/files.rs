//! The files of a program: texts in memory by path, before those on the disk. Only regular files of bounded size are read.

use std::collections::BTreeMap;
use std::fs::{self, File};
use std::io::{self, Read};
use std::path::{Path, PathBuf};

use hypedc::source::{Files, MAX_FILE_BYTES, ReadError, decode};

/// Texts by path, and the disk.
#[derive(Debug, Clone, Default)]
pub(crate) struct Texts(pub BTreeMap<PathBuf, String>);

impl Files for Texts {
    fn read(&self, path: &Path) -> Result<String, ReadError> {
        match self.0.get(path) {
            Some(text) => decode(text.clone().into_bytes()),
            None => decode(bytes(path)?),
        }
    }

    fn identity(&self, path: &Path) -> PathBuf {
        match self.0.contains_key(path) {
            true => path.to_path_buf(),
            false => path.canonicalize().unwrap_or_else(|_| path.to_path_buf()),
        }
    }
}

fn unreadable(error: &io::Error) -> ReadError {
    let text = error.to_string();
    // The system's message, without the error number.
    ReadError::Unreadable(text.split(" (os error").next().unwrap_or(&text).to_lowercase())
}

/// The bytes of a regular file: a device has no end, and opening a pipe blocks.
fn bytes(path: &Path) -> Result<Vec<u8>, ReadError> {
    let of = fs::metadata(path).map_err(|error| unreadable(&error))?;
    if !of.is_file() {
        let what = if of.is_dir() { "a folder" } else { "something else" };
        return Err(ReadError::Unreadable(format!("it is {what}, not a regular file")));
    }
    if of.len() > MAX_FILE_BYTES as u64 {
        return Err(ReadError::TooLarge(of.len()));
    }
    let mut bytes = Vec::new();
    let file = File::open(path).map_err(|error| unreadable(&error))?;
    file.take(MAX_FILE_BYTES as u64 + 1).read_to_end(&mut bytes).map_err(|error| unreadable(&error))?;
    Ok(bytes)
}
