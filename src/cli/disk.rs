//! Files on the disk. Everything that the command line reads comes through here: only regular files of bounded size, as
//! a device has no end and opening a pipe blocks.

use std::collections::BTreeMap;
use std::fs::{self, File, FileType};
use std::io::{self, BufRead, Read, Write};
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

    fn bad_picture(&self, path: &Path) -> Option<String> {
        let mut file = match open(path) {
            Ok(file) => file,
            Err(ReadError::Unreadable(why)) => return Some(why),
            Err(_) => return Some("it cannot be read".to_string()),
        };
        let mut begin = [0; PNG.len()];
        match file.read_exact(&mut begin) {
            Ok(()) if begin == PNG => None,
            _ => Some("it is no PNG file".to_string()),
        }
    }
}

/// The files on the disk, of which some have another text.
#[derive(Default)]
pub(super) struct Changed {
    pub texts: BTreeMap<PathBuf, String>,
}

impl Files for Changed {
    fn read(&self, path: &Path) -> Result<String, ReadError> {
        self.texts.get(path).map_or_else(|| Disk.read(path), |text| Ok(text.clone()))
    }

    fn identity(&self, path: &Path) -> PathBuf {
        Disk.identity(path)
    }

    fn bad_picture(&self, path: &Path) -> Option<String> {
        Disk.bad_picture(path)
    }
}

/// How a PNG file begins.
const PNG: [u8; 8] = *b"\x89PNG\r\n\x1a\n";

/// Opens a regular file for reading.
///
/// [`ReadError::Unreadable`] if it cannot be opened or is not a regular file.
pub(super) fn open(path: &Path) -> Result<File, ReadError> {
    // Checked first, as opening alone may block.
    is_regular(path)?;
    File::open(path).map_err(unreadable)
}

/// Checks that a path leads to a regular file, possibly through links.
///
/// # Errors
/// [`ReadError::Unreadable`] if not.
pub(super) fn is_regular(path: &Path) -> Result<(), ReadError> {
    let kind = fs::metadata(path).map_err(unreadable)?.file_type();
    match kind.is_file() {
        true => Ok(()),
        false => Err(ReadError::Unreadable(format!("it is {}, not a regular file", name(kind)))),
    }
}

/// The kind of something that is not a regular file.
fn name(kind: FileType) -> &'static str {
    #[cfg(unix)]
    {
        use std::os::unix::fs::FileTypeExt;
        if kind.is_fifo() {
            return "a named pipe";
        }
        if kind.is_char_device() || kind.is_block_device() {
            return "a device";
        }
        if kind.is_socket() {
            return "a socket";
        }
    }
    if kind.is_dir() { "a folder" } else { "something else" }
}

/// The bytes of a file.
///
/// # Errors
/// [`ReadError`] if it cannot be read or is too large.
pub(super) fn bytes(path: &Path) -> Result<Vec<u8>, ReadError> {
    let file = open(path)?;
    let size = file.metadata().map_err(unreadable)?.len();
    if size > MAX_FILE_BYTES as u64 {
        return Err(ReadError::TooLarge(size));
    }
    all(file)
}

/// Maximum size of a compiled program, bytes; it may be larger than its source.
const MAX_COMPILED_BYTES: u64 = 1 << 28;

/// The text of a compiled program.
///
/// # Errors
/// [`ReadError`] if it cannot be read, is not UTF-8 or is too large.
pub(super) fn compiled(path: &Path) -> Result<String, ReadError> {
    let file = open(path)?;
    let mut bytes = Vec::new();
    file.take(MAX_COMPILED_BYTES + 1).read_to_end(&mut bytes).map_err(unreadable)?;
    match bytes.len() as u64 > MAX_COMPILED_BYTES {
        true => Err(ReadError::Unreadable(format!("it is larger than {} MiB", MAX_COMPILED_BYTES >> 20))),
        false => decode(bytes),
    }
}

/// All bytes of a stream.
///
/// [`ReadError`] if it cannot be read. Stops reading at the size limit.
pub(super) fn all(stream: impl Read) -> Result<Vec<u8>, ReadError> {
    let mut bytes = Vec::new();
    let limit = MAX_FILE_BYTES as u64 + 1;
    stream.take(limit).read_to_end(&mut bytes).map_err(unreadable)?;
    Ok(bytes)
}

/// Maximum size of a file of rows, bytes.
const MAX_ROWS_BYTES: u64 = 1 << 30;

/// All bytes of a file of rows.
///
/// Why it cannot be read, as a short text.
pub(super) fn rows(file: &mut File) -> Result<Vec<u8>, String> {
    let mut bytes = Vec::new();
    file.take(MAX_ROWS_BYTES + 1).read_to_end(&mut bytes).map_err(|e| reason(&e))?;
    match bytes.len() as u64 > MAX_ROWS_BYTES {
        true => Err(format!("it is larger than {} MiB", MAX_ROWS_BYTES >> 20)),
        false => Ok(bytes),
    }
}

/// Maximum length of a line that is read on its own, bytes.
const MAX_LINE_BYTES: usize = 16 << 20;

/// The next line of a text, without its line end; `None` at the end of the text.
///
/// Why it cannot be read, as a short text. Stops reading at the length limit.
pub(super) fn line(text: &mut impl BufRead) -> Result<Option<String>, String> {
    let mut line = Vec::new();
    let limit = MAX_LINE_BYTES as u64 + 1;
    text.by_ref().take(limit).read_until(b'\n', &mut line).map_err(|e| reason(&e))?;
    if line.len() > MAX_LINE_BYTES {
        return Err(format!("a line is longer than {} MiB", MAX_LINE_BYTES >> 20));
    }
    if line.is_empty() {
        return Ok(None);
    }
    let line = String::from_utf8(line).map_err(|_| "it is not UTF-8 text".to_string())?;
    Ok(Some(line.trim_end_matches(['\n', '\r']).to_string()))
}

fn unreadable(error: io::Error) -> ReadError {
    ReadError::Unreadable(reason(&error))
}

/// Replaces a file atomically: writes a temporary file temporary it and renames it.
///
/// # Errors
/// Why it cannot be written.
pub(super) fn replace(path: &Path, text: &str) -> Result<(), String> {
    // Follows links to the file itself.
    let path = path.canonicalize().map_err(|e| reason(&e))?;
    let found = path.metadata().map_err(|e| reason(&e))?;
    if !found.is_file() {
        return Err("not a file".into());
    }
    if found.permissions().readonly() {
        return Err("it is read-only".into());
    }
    let name = path.file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
    let temporary = path.with_file_name(format!(".{name}.{}", std::process::id()));
    let written = || -> io::Result<()> {
        let mut file = File::options().write(true).create_new(true).open(&temporary)?;
        file.write_all(text.as_bytes())?;
        file.set_permissions(found.permissions())?;
        file.sync_all()?;
        fs::rename(&temporary, &path)
    };
    written().map_err(|e| {
        if e.kind() != io::ErrorKind::AlreadyExists {
            let _ = fs::remove_file(&temporary);
        }
        reason(&e)
    })
}

/// The folder of `hypedc` in the user's cache; `None` if the system tells no place for it.
pub(super) fn user_cache() -> Option<PathBuf> {
    let given = |name: &str| std::env::var_os(name).map(PathBuf::from).filter(|path| path.is_absolute());
    let at_home = if cfg!(target_os = "macos") { "Library/Caches" } else { ".cache" };
    let cache = given("XDG_CACHE_HOME").or_else(|| given("LOCALAPPDATA"));
    let cache = cache.or_else(|| given("HOME").map(|home| home.join(at_home)))?;
    Some(cache.join("hypedc"))
}

/// Writes a file of the cache atomically. What cannot be written is not kept.
pub(super) fn keep_in_cache(path: &Path, text: &str) {
    if let Some(folder) = path.parent() {
        let _ = fs::create_dir_all(folder);
    }
    let temporary = path.with_extension(format!("{}.tmp", std::process::id()));
    if fs::write(&temporary, text).and_then(|()| fs::rename(&temporary, path)).is_err() {
        let _ = fs::remove_file(&temporary);
    }
}

/// The system's message, without the error number.
fn reason(error: &io::Error) -> String {
    let text = error.to_string();
    text.split(" (os error").next().unwrap_or(&text).to_lowercase()
}
