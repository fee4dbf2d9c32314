//! The file of rows, one line of JSON each: parsing, recovery after a truncated line, sorting.
//!
//! Rows are appended as they are done, so that a killed process loses at most the line that it was writing. When all
//! are done, the file is rewritten in the order of the questions; lines stay byte for byte as they are.

use std::collections::BTreeMap;
use std::fmt;

use serde::Deserialize;

use super::row::{Key, ROW_VERSION, Row};
use crate::json::{self, Layout};

/// The prefix of every line.
const LINE_PREFIX: &str = "{\"row\":";

/// A row and the line that it was read from.
#[derive(Debug, Clone, PartialEq)]
pub struct StoredRow {
    /// The row.
    pub row: Row,
    /// Its line, without the line's end.
    pub line: String,
}

impl StoredRow {
    /// A row with its line.
    ///
    /// If it cannot be serialised, for example a number that is not finite.
    pub fn new(row: Row) -> Result<StoredRow, serde_json::Error> {
        let line = json::text(&row, Layout::Compact)?;
        Ok(StoredRow { row, line })
    }
}

/// The contents of a file of rows.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Record {
    /// The rows by their keys; of several with the same key the last counts.
    pub rows: BTreeMap<Key, StoredRow>,
    /// Number of bytes in complete lines; the rest was truncated.
    pub whole: usize,
    /// Whether the last complete line lacks its line's end.
    pub is_open: bool,
}

/// The reason why a text is no file of rows.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct BadRecord {
    /// The line, from 1.
    pub line: usize,
    /// The reason.
    pub why: String,
}

impl fmt::Display for BadRecord {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "line {}: {}", self.line, self.why)
    }
}

impl Record {
    /// Reads the text of a file. A truncated last line is dropped.
    ///
    /// [`BadRecord`] if a complete line is no row, or one of another version: this is some other file.
    pub fn read(text: &[u8]) -> Result<Record, BadRecord> {
        let mut record = Record::default();
        for (index, bytes) in text.split_inclusive(|b| *b == b'\n').enumerate() {
            let is_whole = bytes.ends_with(b"\n");
            match row(bytes) {
                Ok(kept) => {
                    record.rows.insert(kept.row.key(), kept);
                }
                Err(_) if !is_whole && is_cut(bytes) => break,
                Err(why) => return Err(BadRecord { line: index + 1, why }),
            }
            record.whole += bytes.len();
            record.is_open = !is_whole;
        }
        Ok(record)
    }

    /// The stored row with the key of `new`, if it would be the same again: with these settings, this program and this
    /// level. A row with an error is run again.
    pub fn same(&self, new: &Row) -> Option<&StoredRow> {
        self.rows.get(&new.key()).filter(|kept| {
            let old = &kept.row;
            old.error.is_none()
                && old.program_sha256.is_some()
                && (&old.program_sha256, &old.level_sha256) == (&new.program_sha256, &new.level_sha256)
                && (&old.settings, &old.world, &old.file) == (&new.settings, &new.world, &new.file)
        })
    }
}

/// The row of a line.
fn row(bytes: &[u8]) -> Result<StoredRow, String> {
    let line = std::str::from_utf8(bytes).map_err(|_| "not UTF-8".to_string())?;
    let line = line.trim_end_matches(['\n', '\r']);
    let not_a_row = |error| format!("not a row of `hypedc reach`: {error}");
    // The version first: rows of other versions have other fields.
    let VersionField { row: version } = serde_json::from_str(line).map_err(not_a_row)?;
    if version != ROW_VERSION {
        return Err(format!("a row of version {version}, this `hypedc` has version {ROW_VERSION}"));
    }
    let row = serde_json::from_str(line).map_err(not_a_row)?;
    Ok(StoredRow { row, line: line.to_string() })
}

/// The field with a row's version.
#[derive(Deserialize)]
struct VersionField {
    row: u32,
}

/// Whether this can be the beginning of a line: other text is not dropped.
fn is_cut(bytes: &[u8]) -> bool {
    let length = bytes.len().min(LINE_PREFIX.len());
    bytes[..length] == LINE_PREFIX.as_bytes()[..length]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::corpus::row::tests::row as a_row;

    fn text(levels: &[&str]) -> String {
        levels.iter().map(|level| StoredRow::new(a_row(level)).unwrap().line + "\n").collect()
    }

    #[test]
    fn a_line_that_is_cut_off_anywhere_is_left_out() {
        let whole = text(&["a", "b"]);
        let first = text(&["a"]).len();
        for end in first..=whole.len() {
            let record = Record::read(&whole.as_bytes()[..end]).unwrap();
            let rows = if end >= whole.len() - 1 { 2 } else { 1 };
            assert_eq!(record.rows.len(), rows, "cut at {end}");
            assert_eq!(record.whole, if rows == 2 { end } else { first });
            assert_eq!(record.is_open, end == whole.len() - 1);
        }
    }

    #[test]
    fn another_file_is_refused() {
        assert_eq!(Record::read(b"entity A { }").unwrap_err().line, 1);
        assert_eq!(Record::read(b"\n").unwrap_err().line, 1);
        let mut two = text(&["a"]);
        two.push_str("{\"row\":1,\n");
        assert_eq!(Record::read(two.as_bytes()).unwrap_err().line, 2, "a whole line is not cut off");
        let newer = text(&["a"]).replace(&format!("{{\"row\":{ROW_VERSION},"), "{\"row\":99,");
        assert!(Record::read(newer.as_bytes()).unwrap_err().why.contains("version 99"));
        let older = "{\"row\":2,\"level\":null,\"is_as_wished\":true}\n";
        assert!(Record::read(older.as_bytes()).unwrap_err().why.contains("version 2,"), "it has other fields");
    }

    #[test]
    fn a_row_counts_only_for_the_same_question() {
        let old = a_row("a");
        let record = Record::read(text(&["a", "b"]).as_bytes()).unwrap();
        assert!(record.same(&old).is_some());
        assert!(record.same(&Row { level: Some("c".into()), ..old.clone() }).is_none());
        assert!(record.same(&Row { program_sha256: Some("1".into()), ..old.clone() }).is_none());
        assert!(record.same(&Row { level_sha256: Some("1".into()), ..old.clone() }).is_none());
        let mut settings = old.settings.clone();
        settings.seed += 1;
        assert!(record.same(&Row { settings, ..old.clone() }).is_none());
        let failed = Row { error: Some("gone".into()), ..old.clone() };
        let record = Record::read((StoredRow::new(failed).unwrap().line + "\n").as_bytes()).unwrap();
        assert!(record.same(&old).is_none(), "what could not be asked is asked again");
    }

    #[test]
    fn of_several_rows_the_last_counts() {
        let mut later = a_row("a");
        later.answer.nodes = 777;
        let all = text(&["a", "b"]) + &StoredRow::new(later).unwrap().line + "\n";
        let record = Record::read(all.as_bytes()).unwrap();
        assert_eq!(record.same(&a_row("a")).unwrap().row.answer.nodes, 777);
        assert_eq!(record.rows.len(), 2);
    }
}
