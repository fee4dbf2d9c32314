//! `hypedc check --fix`: applies fixes to the files, and reports them on standard error.

use std::fs::{self, File};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use crate::compile::{Compilation, LevelFile, compile_with};
use crate::diagnostic::fix::{apply_edits, by_file, compatible_fixes};
use crate::source::{FileId, SourceMap, Span, decode};

use super::disk::{Disk, bytes};
use super::report::plain_error;

/// Maximum number of rounds: a fix can reveal the next mistake.
const MAX_ROUNDS: usize = 16;

/// The UTF-8 byte order mark.
const MARK: &[u8] = b"\xef\xbb\xbf";

/// Applies certain fixes until none are left. Returns false if a file could not be written.
pub(super) fn apply_fixes(root: &Path, level: LevelFile<'_>) -> io::Result<bool> {
    for _ in 0..MAX_ROUNDS {
        let Compilation { sources, diagnostics, .. } = compile_with(root, level, &Disk);
        let may = |file: FileId| is_ours(root, &sources.file(file).path);
        let chosen = compatible_fixes(diagnostics.iter(), |fix| fix.edits.iter().all(|(span, _)| may(span.file())));
        if chosen.is_empty() {
            break;
        }
        for (file, edits) in by_file(chosen.iter().map(|(_, fix)| *fix)) {
            if let Err(why) = write(&sources, file, &edits) {
                let path = sources.file(file).path.display();
                plain_error(&format!("cannot fix `{path}`: {why}"))?;
                return Ok(false);
            }
        }
        for (d, fix) in chosen {
            if let Some((span, _)) = fix.edits.first() {
                let file = sources.file(span.file());
                let (line, column) = file.line_column(span.range().start);
                let path = file.path.display();
                writeln!(io::stderr(), "fixed {path}:{line}:{column}: {} ({})", fix.title, d.code)?;
            }
        }
    }
    Ok(true)
}

/// Whether a file is the program itself, or one imported from its folder or a subfolder.
fn is_ours(root: &Path, path: &Path) -> bool {
    let real = |path: &Path| path.canonicalize().unwrap_or_else(|_| path.to_path_buf());
    let (root, path) = (real(root), real(path));
    let is_program = path.extension().is_some_and(|e| e == "hyped");
    path == root || (is_program && root.parent().is_some_and(|folder| path.starts_with(folder)))
}

/// Applies edits to a file atomically.
fn write(sources: &SourceMap, file: FileId, edits: &[(Span, &str)]) -> Result<(), String> {
    let source = sources.file(file);
    // Follows links: the target is replaced.
    let path = source.path.canonicalize().map_err(|e| e.to_string())?;
    let bytes = bytes(&path).map_err(|_| "it has changed meanwhile".to_string())?;
    if decode(bytes.clone()).ok().as_deref() != Some(source.text()) {
        return Err("it has changed meanwhile".to_string());
    }
    let (mark, rest) = if bytes.starts_with(MARK) { bytes.split_at(MARK.len()) } else { (&[][..], &bytes[..]) };
    let text = std::str::from_utf8(rest).map_err(|e| e.to_string())?;
    let Some(text) = apply_edits(text, edits) else {
        return Err("its fixes conflict with each other".to_string());
    };
    replace(&path, &[mark, text.as_bytes()].concat(), &bytes).map_err(|e| e.to_string())
}

/// Replaces a file, unless its content has changed.
fn replace(path: &Path, new: &[u8], old: &[u8]) -> io::Result<()> {
    let beside = beside(path);
    let mut file = File::options().write(true).create_new(true).open(&beside)?;
    let written = (|| {
        file.write_all(new)?;
        file.set_permissions(fs::metadata(path)?.permissions())?;
        file.sync_all()?;
        if bytes(path).ok().as_deref() != Some(old) {
            return Err(io::Error::other("it has changed meanwhile"));
        }
        fs::rename(&beside, path)
    })();
    if written.is_err() {
        // Nothing more can be done if this fails, too.
        let _ = fs::remove_file(&beside);
    }
    written
}

/// A temporary path in the folder of the file.
fn beside(path: &Path) -> PathBuf {
    let name = path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    path.with_file_name(format!(".{name}.{}.mended", std::process::id()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_that_changed_meanwhile_is_left_alone() {
        let path = std::env::temp_dir().join(format!("hypedc_changed_{}.hyped", std::process::id()));
        fs::write(&path, "const a = 1\n").unwrap();
        assert!(replace(&path, b"const b = 1\n", b"const c = 1\n").is_err());
        assert_eq!(fs::read(&path).unwrap(), b"const a = 1\n");
        assert!(!beside(&path).exists());
        let mut sources = SourceMap::new();
        let file = sources.add(path.clone(), "const c = 1\n");
        assert_eq!(write(&sources, file, &[]), Err("it has changed meanwhile".to_string()));
        fs::remove_file(&path).unwrap();
    }
}
