//! The files that a run over many levels writes as it proceeds: the record of rows, from which a later run resumes, and
//! the CSV.

use std::collections::BTreeSet;
use std::fs::{File, TryLockError};
use std::io::{self, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use crate::corpus::{CSV_HEADER, Key, Record, Row, ShardHeader, StoredRow, csv_line};
use crate::diagnostic::catalogue::file::Unreadable;
use crate::json::{self, Layout};
use crate::source::ReadError;
use crate::tabular::csv;

use crate::cli::disk::{is_regular, open, replace, rows as disk_rows};
use crate::cli::refusal::Refusal;

/// Reads a file of rows that is not written to.
///
/// Why it cannot be read; `not` says what it is not, such as `a baseline`.
pub(in crate::cli) fn read(path: &Path, not: &str) -> Result<Record, Refusal> {
    let mut file = open(path).map_err(|error| Refusal::of(Unreadable::named(path, error)))?;
    let text =
        disk_rows(&mut file).map_err(|why| Refusal::Plain(format!("cannot read `{}`: {why}", path.display())))?;
    Record::read(&text).map_err(|bad| Refusal::Plain(format!("`{}` is not {not}; {bad}", path.display())))
}

/// The file of rows, open for appending.
pub(in crate::cli) struct RecordFile {
    path: PathBuf,
    file: File,
    /// Its rows when it was opened.
    pub found: Record,
    /// Whether its last line was cut off.
    pub was_cut: bool,
    /// What it is a shard of.
    header: Option<ShardHeader>,
}

/// Refuses the file of something else than a shard, or than a whole run: at the end, its other rows would be removed.
fn check_shard(path: &Path, found: &Record, shard: Option<&ShardHeader>) -> Result<(), String> {
    let path = path.display();
    let own = "give each shard a file of its own";
    match (shard.map(|header| header.of), found.shard.as_ref().map(|header| header.of)) {
        (Some(new), Some(old)) if new != old => {
            Err(format!("`{path}` is the file of shard {old}, not of {new}; {own}"))
        }
        (Some(new), None) if !found.rows.is_empty() => {
            Err(format!("`{path}` has the rows of a run without shards, not those of shard {new}; {own}"))
        }
        (None, Some(old)) => Err(format!(
            "`{path}` is the file of shard {old}; go on with `--shard {old}`, or give another file for all questions"
        )),
        _ => Ok(()),
    }
}

/// The first line of a shard's file, with its end.
fn header_line(header: &ShardHeader) -> Result<String, String> {
    json::text(header, Layout::Compact).map(|line| format!("{line}\n")).map_err(|error| error.to_string())
}

impl RecordFile {
    /// Opens or creates a file of rows, that of a shard with its header. Removes an incomplete last line.
    ///
    /// Why it cannot be appended to: it is no such file, it is of another shard, or another process is writing to it.
    pub fn open(path: &Path, shard: Option<&ShardHeader>) -> Result<Self, String> {
        let cannot = |what: &str, error: io::Error| format!("cannot {what} `{}`: {error}", path.display());
        if path.exists()
            && let Err(ReadError::Unreadable(why)) = is_regular(path)
        {
            return Err(format!("cannot write `{}`: {why}", path.display()));
        }
        let mut file = File::options()
            .read(true)
            .write(true)
            .create(true)
            .truncate(false)
            .open(path)
            .map_err(|error| cannot("write", error))?;
        // Without file locks, other processes go unnoticed.
        if let Err(TryLockError::WouldBlock) = file.try_lock() {
            return Err(format!("another `hypedc` is writing to `{}`", path.display()));
        }
        let text = disk_rows(&mut file).map_err(|why| format!("cannot read `{}`: {why}", path.display()))?;
        let found = Record::read(&text).map_err(|bad| format!("`{}` is unchanged; {bad}", path.display()))?;
        check_shard(path, &found, shard)?;
        let was_cut = found.whole < text.len();
        // Rows of an older plan stay in the file until the end.
        let header = shard.filter(|shard| found.shard.as_ref() != Some(shard)).map(header_line).transpose()?;
        let mut mend = || -> io::Result<()> {
            if was_cut {
                file.set_len(found.whole as u64)?;
            }
            file.seek(SeekFrom::End(0))?;
            if found.is_open {
                file.write_all(b"\n")?;
            }
            if let Some(header) = &header {
                file.write_all(header.as_bytes())?;
            }
            file.sync_all()
        };
        mend().map_err(|error| cannot("write", error))?;
        Ok(RecordFile { path: path.to_path_buf(), file, found, was_cut, header: shard.cloned() })
    }

    /// Appends a row and flushes it to the disk.
    ///
    /// Why it cannot be written.
    pub fn add(&mut self, kept: &StoredRow) -> Result<(), String> {
        let line = format!("{}\n", kept.line);
        let written = self.file.write_all(line.as_bytes()).and_then(|()| self.file.sync_data());
        written.map_err(|error| format!("cannot write `{}`: {error}", self.path.display()))
    }

    /// Replaces the file by these rows, in this order; returns the number of removed rows.
    ///
    /// Why it cannot be written.
    pub fn finish(mut self, rows: &[&StoredRow]) -> Result<usize, String> {
        let cannot = |why: String| format!("cannot write `{}`: {why}", self.path.display());
        let head = self.header.as_ref().map(header_line).transpose()?.unwrap_or_default();
        let text = rows.iter().fold(head, |text, kept| text + &kept.line + "\n");
        self.file.rewind().map_err(|error| cannot(error.to_string()))?;
        let old = disk_rows(&mut self.file).map_err(cannot)?;
        if old != text.as_bytes() {
            replace(&self.path, &text).map_err(cannot)?;
        }
        let asked: BTreeSet<Key> = rows.iter().map(|kept| kept.row.key()).collect();
        Ok(self.found.rows.keys().filter(|key| !asked.contains(key)).count())
    }
}

/// The CSV file, open for appending.
pub(in crate::cli) struct CsvFile {
    path: PathBuf,
    file: File,
}

impl CsvFile {
    /// Creates the file, with its header.
    ///
    /// Why it cannot be written.
    pub fn create(path: &Path) -> Result<Self, String> {
        let file = File::create(path).and_then(|mut file| writeln!(file, "{}", csv::line(CSV_HEADER)).map(|()| file));
        let file = file.map_err(|error| format!("cannot write `{}`: {error}", path.display()))?;
        Ok(CsvFile { path: path.to_path_buf(), file })
    }

    /// Adds a row.
    ///
    /// Why it cannot be written.
    pub fn add(&mut self, row: &Row) -> Result<(), String> {
        let written = writeln!(self.file, "{}", csv_line(row));
        written.map_err(|error| format!("cannot write `{}`: {error}", self.path.display()))
    }

    /// Replaces the file by the rows in this order.
    ///
    /// Why it cannot be written.
    pub fn finish(self, rows: &[&StoredRow]) -> Result<(), String> {
        let mut text = format!("{}\n", csv::line(CSV_HEADER));
        rows.iter().for_each(|kept| text.push_str(&format!("{}\n", csv_line(&kept.row))));
        replace(&self.path, &text).map_err(|error| format!("cannot write `{}`: {error}", self.path.display()))
    }
}
