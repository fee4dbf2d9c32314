//! `hypedc check --fix`: makes the fixes of findings in the files themselves, and tells on standard error what it did.

use std::fs::{self, File};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use crate::compile::{Compilation, LevelFile, compile_with};
use crate::diagnostic::fix::{by_file, mended, together};
use crate::source::{FileId, SourceMap, Span, decode};

use super::disk::{Disk, bytes};
use super::report::plain_error;

/// A fix can bring the next mistake to light; no program needs more rounds than this.
const MAX_ROUNDS: usize = 16;

/// The bytes that some editors put first.
const MARK: &[u8] = b"\xef\xbb\xbf";

/// Mends a program until there is nothing certain left. Returns false if a file could not be written.
pub(super) fn mend(root: &Path, level: LevelFile<'_>) -> io::Result<bool> {
    for _ in 0..MAX_ROUNDS {
        let Compilation { sources, diagnostics, .. } = compile_with(root, level, &Disk);
        let may = |file: FileId| is_ours(root, &sources.file(file).path);
        let chosen = together(diagnostics.iter(), |fix| fix.edits.iter().all(|(span, _)| may(span.file())));
        if chosen.is_empty() {
            break;
        }
        for (file, edits) in by_file(chosen.iter().map(|(_, fix)| *fix)) {
            if let Err(why) = write(&sources, file, &edits) {
                let path = sources.file(file).path.display();
                plain_error(&format!("cannot mend `{path}`: {why}"))?;
                return Ok(false);
            }
        }
        for (d, fix) in chosen {
            if let Some((span, _)) = fix.edits.first() {
                let file = sources.file(span.file());
                let (line, column) = file.line_column(span.range().start);
                let path = file.path.display();
                writeln!(io::stderr(), "mended {path}:{line}:{column}: {} ({})", fix.title, d.code)?;
            }
        }
    }
    Ok(true)
}

/// Whether a file is the program itself, or one that is imported from its folder or a folder in it.
fn is_ours(root: &Path, path: &Path) -> bool {
    let real = |path: &Path| path.canonicalize().unwrap_or_else(|_| path.to_path_buf());
    let (root, path) = (real(root), real(path));
    let is_program = path.extension().is_some_and(|e| e == "hyped");
    path == root || (is_program && root.parent().is_some_and(|folder| path.starts_with(folder)))
}

/// Makes edits in a file, all or none: the new text is written beside it and then takes its place.
fn write(sources: &SourceMap, file: FileId, edits: &[(Span, &str)]) -> Result<(), String> {
    let source = sources.file(file);
    // A link stays one: what it leads to is replaced.
    let path = source.path.canonicalize().map_err(|e| e.to_string())?;
    let bytes = bytes(&path).map_err(|_| "it has changed meanwhile".to_string())?;
    if decode(bytes.clone()).ok().as_deref() != Some(source.text()) {
        return Err("it has changed meanwhile".to_string());
    }
    let (mark, rest) = if bytes.starts_with(MARK) { bytes.split_at(MARK.len()) } else { (&[][..], &bytes[..]) };
    let text = std::str::from_utf8(rest).map_err(|e| e.to_string())?;
    let Some(text) = mended(text, edits) else {
        return Err("its fixes do not go together".to_string());
    };
    replace(&path, &[mark, text.as_bytes()].concat(), &bytes).map_err(|e| e.to_string())
}

/// Puts a new file in place of one that still holds what it did.
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
        // There is nothing to be done if this fails, too.
        let _ = fs::remove_file(&beside);
    }
    written
}

/// A path for the new text in the folder of the old one.
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
