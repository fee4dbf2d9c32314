//! The file of rows, one line of JSON each: parsing, recovery after a truncated line, sorting.
//!
//! Rows are appended as they are done, so that a killed process loses at most the line that it was writing. When all
//! are done, the file is rewritten in the order of the questions; lines stay byte for byte as they are. The file of a
//! shard begins with a header.

use std::collections::BTreeMap;
use std::fmt;

use serde::Deserialize;

use super::row::{Key, ROW_VERSION, Row};
use super::shard::{SHARD_VERSION, ShardHeader};
use crate::json::{self, Layout};

/// The prefix of every row, and that of every header of a shard.
const ROW_PREFIX: &str = "{\"row\":";
const SHARD_PREFIX: &str = "{\"shard\":";

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
    /// The keys in the order of their first rows.
    pub order: Vec<Key>,
    /// What the file is a shard of; of several headers the last counts: a shard that goes on with another plan appends
    /// one.
    pub shard: Option<ShardHeader>,
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
            match line(bytes) {
                Ok(Line::Shard(header)) => record.shard = Some(header),
                Ok(Line::Row(kept)) => {
                    let key = kept.row.key();
                    if record.rows.insert(key.clone(), *kept).is_none() {
                        record.order.push(key);
                    }
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

/// A line of a file of rows.
enum Line {
    Row(Box<StoredRow>),
    Shard(ShardHeader),
}

/// Reads a line.
fn line(bytes: &[u8]) -> Result<Line, String> {
    let line = std::str::from_utf8(bytes).map_err(|_| "not UTF-8".to_string())?;
    let line = line.trim_end_matches(['\n', '\r']);
    let not_a_row = |error| format!("not a row of `hypedc reach`: {error}");
    if line.starts_with(SHARD_PREFIX) {
        let VersionField { version } = serde_json::from_str(line).map_err(not_a_row)?;
        if version != SHARD_VERSION {
            return Err(format!("a shard of version {version}, this `hypedc` has version {SHARD_VERSION}"));
        }
        return serde_json::from_str(line).map(Line::Shard).map_err(not_a_row);
    }
    // The version first: rows of other versions have other fields.
    let VersionField { version } = serde_json::from_str(line).map_err(not_a_row)?;
    if version != ROW_VERSION {
        return Err(format!("a row of version {version}, this `hypedc` has version {ROW_VERSION}"));
    }
    let row = serde_json::from_str(line).map_err(not_a_row)?;
    Ok(Line::Row(Box::new(StoredRow { row, line: line.to_string() })))
}

/// The field with the version of a row or of a header.
#[derive(Deserialize)]
struct VersionField {
    #[serde(rename = "row", alias = "shard")]
    version: u32,
}

/// Whether this can be the beginning of a line: other text is not dropped.
fn is_cut(bytes: &[u8]) -> bool {
    [ROW_PREFIX, SHARD_PREFIX].iter().any(|prefix| {
        let length = bytes.len().min(prefix.len());
        bytes[..length] == prefix.as_bytes()[..length]
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::corpus::row::tests::row as a_row;
    use crate::corpus::shard::{PlannedQuestion, Shard};

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
    fn a_shard_has_a_header_and_the_last_counts() {
        let header = |plan: &str| ShardHeader {
            shard: SHARD_VERSION,
            of: Shard { index: 2, count: 3 },
            file: "game.hyped".into(),
            world: "Open".into(),
            program_sha256: "a0".into(),
            plan_sha256: plan.into(),
            questions: 4,
            part: vec![PlannedQuestion { at: 1, key: a_row("a").key() }],
        };
        let line = |plan: &str| serde_json::to_string(&header(plan)).unwrap() + "\n";
        let all = line("1") + &text(&["b", "a"]) + &line("2");
        let record = Record::read(all.as_bytes()).unwrap();
        assert_eq!((record.shard, record.rows.len()), (Some(header("2")), 2));
        assert_eq!(record.order, [a_row("b").key(), a_row("a").key()]);
        for end in 0..line("1").len() - 1 {
            let record = Record::read(&all.as_bytes()[..end]).unwrap();
            assert_eq!((record.shard, record.whole), (None, 0), "cut at {end}");
        }
        let newer = line("1").replace("\"shard\":1", "\"shard\":9");
        assert!(Record::read(newer.as_bytes()).unwrap_err().why.contains("a shard of version 9"));
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
