//! `hypedc lsp`: the language server over standard input and output.

use std::io::{self, BufReader, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Instant;

use crate::lsp::{Server, Settings, Transport, Workspace};
use crate::source::{Files, ReadError};

use super::disk::{Disk, keep_in_cache, user_cache};
use super::report::sha256;
use super::{Exit, memory};

/// Maximum number of compiled programs of a workspace, and of folders searched for them.
const MAX_PROGRAMS: usize = 2_000;
const MAX_FOLDERS: usize = 20_000;
/// Maximum number of files that may be levels of a program, and of folders searched for them.
const MAX_LEVELS: usize = 500;
const MAX_LEVEL_FOLDERS: usize = 200;

/// The programs on the disk.
struct Folders {
    started: Instant,
}

impl Files for Folders {
    fn read(&self, path: &Path) -> Result<String, ReadError> {
        Disk.read(path)
    }

    fn identity(&self, path: &Path) -> PathBuf {
        Disk.identity(path)
    }

    fn bad_picture(&self, path: &Path) -> Option<String> {
        Disk.bad_picture(path)
    }
}

impl Workspace for Folders {
    fn programs(&self, folder: &Path) -> Vec<PathBuf> {
        files(folder, &["hyped"], (MAX_PROGRAMS, MAX_FOLDERS))
    }

    fn files(&self, folder: &Path, endings: &[&str]) -> Vec<PathBuf> {
        files(folder, endings, (MAX_PROGRAMS, MAX_FOLDERS))
    }

    fn levels(&self, folder: &Path) -> Vec<PathBuf> {
        files(folder, &["txt", "tmx", "tmj", "ldtk"], (MAX_LEVELS, MAX_LEVEL_FOLDERS))
    }

    fn recall(&self, key: &str) -> Option<String> {
        Disk.read(&remembered(key)?).ok()
    }

    fn remember(&self, key: &str, text: &str) {
        if let Some(path) = remembered(key) {
            keep_in_cache(&path, text);
        }
    }

    fn release_memory(&self) {
        memory::release();
    }

    fn seconds(&self) -> f64 {
        self.started.elapsed().as_secs_f64()
    }
}

/// The files in a folder and its subfolders with one of some extensions, up to a number of files and of folders.
fn files(folder: &Path, extensions: &[&str], (most, most_folders): (usize, usize)) -> Vec<PathBuf> {
    let (mut found, mut folders, mut searched) = (Vec::new(), vec![folder.to_path_buf()], 0);
    let is_wanted = |path: &Path| {
        let extension = path.extension().and_then(|extension| extension.to_str());
        extension.is_some_and(|extension| extensions.iter().any(|wanted| extension.eq_ignore_ascii_case(wanted)))
    };
    while let Some(folder) = folders.pop() {
        searched += 1;
        if searched > most_folders || found.len() >= most {
            break;
        }
        let Ok(entries) = std::fs::read_dir(&folder) else { continue };
        for entry in entries.flatten() {
            let path = entry.path();
            let hidden = entry.file_name().to_string_lossy().starts_with('.');
            let built = matches!(entry.file_name().to_str(), Some("target" | "node_modules"));
            // Links are not followed: they may form cycles.
            match entry.file_type() {
                Ok(kind) if kind.is_dir() && !hidden && !built => folders.push(path),
                Ok(kind) if kind.is_file() && is_wanted(&path) => found.push(path),
                _ => {}
            }
        }
    }
    found.sort();
    found.truncate(most);
    found
}

/// Where a text is remembered in the user's cache.
fn remembered(key: &str) -> Option<PathBuf> {
    Some(user_cache()?.join("editor").join(format!("{}.json", sha256(key.as_bytes()))))
}

pub(super) fn run() -> io::Result<Exit> {
    // Editors keep what a server says here in a log.
    let report = |why: &str| drop(writeln!(io::stderr(), "hypedc lsp: {why}"));
    let (connection, transport) = Transport::start(BufReader::new(io::stdin()), io::stdout(), report);
    let orderly = Server::serve(connection, Arc::new(Folders { started: Instant::now() }), Settings::default());
    // A client that disconnected may have left the pipe open.
    if orderly {
        transport.join()?;
    }
    Ok(if orderly { Exit::Yes } else { Exit::No })
}
