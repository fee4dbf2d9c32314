//! Files from the disk.

use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

use crate::source::{Files, MAX_FILE_BYTES, ReadError, decode};

/// Reads from the disk.
pub(super) struct Disk;

impl Files for Disk {
    fn read(&self, path: &Path) -> Result<String, ReadError> {
        let unreadable = |e: std::io::Error| {
            let text = e.to_string();
            // The number of the error says nothing to a reader.
            ReadError::Unreadable(text.split(" (os error").next().unwrap_or(&text).to_lowercase())
        };
        let file = File::open(path).map_err(unreadable)?;
        let size = file.metadata().map_err(unreadable)?.len();
        if size > MAX_FILE_BYTES as u64 {
            return Err(ReadError::TooLarge(size));
        }
        let mut bytes = Vec::new();
        // A device may say it is empty and never end.
        file.take(MAX_FILE_BYTES as u64 + 1).read_to_end(&mut bytes).map_err(unreadable)?;
        decode(bytes)
    }

    fn identity(&self, path: &Path) -> PathBuf {
        path.canonicalize().unwrap_or_else(|_| path.to_path_buf())
    }
}
