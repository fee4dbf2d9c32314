//! `hypedc lsp`: the language server over standard input and output.

use std::io::{self, BufReader, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::lsp::{Server, Settings, Transport, Workspace};
use crate::source::{Files, ReadError};

use super::Exit;
use super::disk::Disk;

/// Maximum number of compiled programs of a workspace, and of folders searched for them.
const MAX_PROGRAMS: usize = 2_000;
const MAX_FOLDERS: usize = 20_000;

/// The programs on the disk.
struct Folders;

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
        self.files(folder, &["hyped"])
    }

    fn files(&self, folder: &Path, endings: &[&str]) -> Vec<PathBuf> {
        let (mut found, mut folders, mut searched) = (Vec::new(), vec![folder.to_path_buf()], 0);
        let is_of = |path: &Path| path.extension().is_some_and(|e| endings.iter().any(|ending| e == *ending));
        while let Some(folder) = folders.pop() {
            searched += 1;
            if searched > MAX_FOLDERS || found.len() >= MAX_PROGRAMS {
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
                    Ok(kind) if kind.is_file() && is_of(&path) => found.push(path),
                    _ => {}
                }
            }
        }
        found.sort();
        found.truncate(MAX_PROGRAMS);
        found
    }
}

pub(super) fn run() -> io::Result<Exit> {
    // Editors keep what a server says here in a log.
    let report = |why: &str| drop(writeln!(io::stderr(), "hypedc lsp: {why}"));
    let (connection, transport) = Transport::start(BufReader::new(io::stdin()), io::stdout(), report);
    let orderly = Server::serve(connection, Arc::new(Folders), Settings::default());
    // A client that disconnected may have left the pipe open.
    if orderly {
        transport.join()?;
    }
    Ok(if orderly { Exit::Yes } else { Exit::No })
}
