//! Files from and to the disk.

use std::fs::File;
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};

use crate::source::{Files, MAX_FILE_BYTES, ReadError, decode};

/// Reads from the disk.
pub(super) struct Disk;

impl Files for Disk {
    fn read(&self, path: &Path) -> Result<String, ReadError> {
        decode(bytes(path)?)
    }

    fn identity(&self, path: &Path) -> PathBuf {
        path.canonicalize().unwrap_or_else(|_| path.to_path_buf())
    }
}

/// The bytes of a file.
///
/// # Errors
/// [`ReadError`] if it cannot be read or is too large.
pub(super) fn bytes(path: &Path) -> Result<Vec<u8>, ReadError> {
    let unreadable = |e| ReadError::Unreadable(reason(&e));
    let file = File::open(path).map_err(unreadable)?;
    let size = file.metadata().map_err(unreadable)?.len();
    if size > MAX_FILE_BYTES as u64 {
        return Err(ReadError::TooLarge(size));
    }
    all(file)
}

/// All bytes of a stream.
///
/// # Errors
/// [`ReadError`] if it cannot be read. Of one that is too large no more than that is read.
pub(super) fn all(stream: impl Read) -> Result<Vec<u8>, ReadError> {
    let mut bytes = Vec::new();
    // A device may say it is empty and never end.
    let limit = MAX_FILE_BYTES as u64 + 1;
    stream.take(limit).read_to_end(&mut bytes).map_err(|e| ReadError::Unreadable(reason(&e)))?;
    Ok(bytes)
}

/// Puts a text in place of a file in one go: it is written beside it first, so that nothing is lost on the way.
///
/// # Errors
/// Why it cannot be written.
pub(super) fn replace(path: &Path, text: &str) -> Result<(), String> {
    // Through a link, the file itself is replaced.
    let path = path.canonicalize().map_err(|e| reason(&e))?;
    let found = path.metadata().map_err(|e| reason(&e))?;
    if !found.is_file() {
        return Err("not a file".into());
    }
    if found.permissions().readonly() {
        return Err("it is read-only".into());
    }
    let name = path.file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
    let beside = path.with_file_name(format!(".{name}.{}", std::process::id()));
    let written = || -> io::Result<()> {
        let mut file = File::options().write(true).create_new(true).open(&beside)?;
        file.write_all(text.as_bytes())?;
        file.set_permissions(found.permissions())?;
        file.sync_all()?;
        std::fs::rename(&beside, &path)
    };
    written().map_err(|e| {
        if e.kind() != io::ErrorKind::AlreadyExists {
            let _ = std::fs::remove_file(&beside);
        }
        reason(&e)
    })
}

/// What the system says, without the number of the error: that says nothing to a reader.
fn reason(error: &io::Error) -> String {
    let text = error.to_string();
    text.split(" (os error").next().unwrap_or(&text).to_lowercase()
}
