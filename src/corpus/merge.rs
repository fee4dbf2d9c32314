//! Joins files of rows: those of shards, or of runs over different levels. Refuses rows that do not belong together,
//! and says what is missing. The result has the rows that one run on one machine would have, in the same order.

use std::collections::{BTreeMap, BTreeSet};

use serde_json::Value;

use super::record::{Record, StoredRow};
use super::row::{Key, Row};
use super::shard::{Shard, ShardHeader};

/// A file to join.
#[derive(Debug, Clone)]
pub struct Part {
    /// Its name in messages.
    pub name: String,
    /// What it holds.
    pub record: Record,
}

/// The rows of several files.
#[derive(Debug, Clone, PartialEq)]
pub struct Merged<'p> {
    /// The rows, in the order of the whole run.
    pub rows: Vec<&'p StoredRow>,
    /// The number of shards; none if the files are not of shards.
    pub shards: Option<u32>,
    /// The number of questions of the whole run.
    pub questions: usize,
    /// The shards of which something is missing, in order.
    pub incomplete: Vec<Incomplete<'p>>,
}

/// A shard whose rows are not all there.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Incomplete<'p> {
    /// Which shard.
    pub shard: Shard,
    /// The file that holds its other rows; none if no file is of this shard.
    pub file: Option<&'p str>,
    /// The number of its questions; none if that is not known.
    pub questions: Option<usize>,
    /// The questions without a row; empty if no file is of this shard.
    pub missing: Vec<&'p Key>,
}

/// A row with the file that it is from.
#[derive(Clone, Copy)]
struct Found<'p> {
    file: &'p str,
    kept: &'p StoredRow,
}

/// Joins files.
///
/// # Errors
/// Why they do not belong together, and what to do about it.
pub fn merge(parts: &[Part]) -> Result<Merged<'_>, String> {
    // A shard that was killed at once has an empty file.
    let is_empty = |part: &&Part| part.record.rows.is_empty() && part.record.shard.is_none();
    let parts: Vec<&Part> = parts.iter().filter(|part| !is_empty(part)).collect();
    let headers: Vec<(&str, &ShardHeader)> =
        parts.iter().filter_map(|part| Some((part.name.as_str(), part.record.shard.as_ref()?))).collect();
    let Some(first) = parts.first() else { return Err("these files hold no rows".to_string()) };
    if let (Some(shard), Some(other)) = (headers.first(), parts.iter().find(|part| part.record.shard.is_none())) {
        return Err(format!(
            "`{}` is the file of a shard, and `{}` is not: give the files of all shards of a run, or only others",
            shard.0, other.name
        ));
    }
    for (file, header) in headers.iter().skip(1) {
        is_same_run(headers[0], (file, header))?;
    }
    let mut found = Rows::default();
    let mut order: Vec<(usize, &Key)> = Vec::new();
    for part in &parts {
        let asked = part.record.shard.as_ref().map(|header| {
            order.extend(header.part.iter().map(|question| (question.at, &question.key)));
            header.part.iter().map(|question| &question.key).collect::<BTreeSet<&Key>>()
        });
        for key in &part.record.order {
            // A shard that goes on with another plan has rows of the older one until its end.
            let is_asked = asked.as_ref().is_none_or(|asked| asked.contains(key));
            if let Some(kept) = part.record.rows.get(key).filter(|_| is_asked) {
                found.add(key, Found { file: &part.name, kept })?;
                if asked.is_none() {
                    order.push((order.len(), key));
                }
            }
        }
    }
    found.check_proofs()?;
    order.sort_unstable();
    let mut seen = BTreeSet::new();
    let keys: Vec<&Key> = order.into_iter().map(|(_, key)| key).filter(|key| seen.insert(*key)).collect();
    let rows: Vec<&StoredRow> = keys.iter().filter_map(|key| Some(found.by_key.get(key)?.kept)).collect();
    let (shards, questions) = match first.record.shard.as_ref() {
        Some(header) => (Some(header.of.count), header.questions),
        None => (None, rows.len()),
    };
    let incomplete = shards.map_or(Vec::new(), |count| incomplete(count, questions, &headers, &found.by_key));
    Ok(Merged { rows, shards, questions, incomplete })
}

/// Checks that two shards are of the same run.
fn is_same_run(one: (&str, &ShardHeader), other: (&str, &ShardHeader)) -> Result<(), String> {
    let ((a, first), (b, second)) = (one, other);
    let differs = |what: String| {
        Err(format!(
            "`{b}` is of another run than `{a}`: {what}; run the shards again that differ, each with its file: rows \
             that are still right are kept"
        ))
    };
    let not = |what: &str, now: &dyn std::fmt::Display, before: &dyn std::fmt::Display| {
        differs(format!("{what} {now}, not {before}"))
    };
    if first.of.count != second.of.count {
        return not("it is one of", &format_args!("{} shards", second.of.count), &first.of.count);
    }
    if first.file != second.file {
        return not("its program is", &format_args!("`{}`", second.file), &format_args!("`{}`", first.file));
    }
    if first.world != second.world {
        return not("its world is", &format_args!("`{}`", second.world), &format_args!("`{}`", first.world));
    }
    if first.program_sha256 != second.program_sha256 {
        return differs(format!("`{}` was another program", second.file));
    }
    if first.questions != second.questions {
        return not("it has", &format_args!("{} questions in all", second.questions), &first.questions);
    }
    if first.plan_sha256 != second.plan_sha256 {
        return differs("it has other levels or goals, or was divided by another file of `--costs`".to_string());
    }
    Ok(())
}

/// The rows that were found.
#[derive(Default)]
struct Rows<'p> {
    first: Option<Found<'p>>,
    by_key: BTreeMap<&'p Key, Found<'p>>,
    /// The first row about each level.
    by_level: BTreeMap<&'p Option<String>, Found<'p>>,
}

impl<'p> Rows<'p> {
    /// Adds a row, if it belongs to the others.
    fn add(&mut self, key: &'p Key, new: Found<'p>) -> Result<(), String> {
        let first = *self.first.get_or_insert(new);
        if let Some(what) = difference(&run_fields(&first.kept.row), &run_fields(&new.kept.row), first.file, new.file) {
            return Err(format!("rows of different settings: {what}; run with the same options, or join them apart"));
        }
        let level = *self.by_level.entry(&new.kept.row.level).or_insert(new);
        // A row with an error may have no hash.
        let differs = |one: &Option<String>, other: &Option<String>| one.is_some() && other.is_some() && one != other;
        let (row, other) = (&new.kept.row, &level.kept.row);
        let changed = match () {
            () if differs(&row.level_sha256, &other.level_sha256) => Some("the level"),
            () if differs(&row.program_sha256, &other.program_sha256) => Some("the program"),
            () => None,
        };
        if let Some(what) = changed {
            return Err(format!(
                "{what} was changed in between: of {} `{}` has another one than `{}`; run both again, rows that are \
                 still right are kept",
                key.level_name(),
                new.file,
                level.file
            ));
        }
        let Some(old) = self.by_key.get(key).copied() else {
            self.by_key.insert(key, new);
            return Ok(());
        };
        // What could not be asked was asked again.
        match (old.kept.row.error.is_some(), row.error.is_some()) {
            (true, false) => {
                self.by_key.insert(key, new);
                return Ok(());
            }
            (false, true) => return Ok(()),
            _ => {}
        }
        let Some(what) = difference(&result_fields(&old.kept.row), &result_fields(row), old.file, new.file) else {
            return Ok(());
        };
        let hint = match row.settings.seconds_limit {
            Some(_) => "searches that `--seconds` ends depend on the machine, those of `--nodes` do not",
            None => "leave out the file that is wrong",
        };
        Err(format!("two different rows for {}: {what}; {hint}", key.text()))
    }

    /// Refuses a proof that the search of another shard has shown to be wrong: in one run it would have been withdrawn.
    fn check_proofs(&self) -> Result<(), String> {
        let refuted: BTreeMap<&Option<String>, &Found<'p>> = self
            .by_key
            .values()
            .filter(|found| found.kept.row.refuted.is_some())
            .map(|found| (&found.kept.row.level, found))
            .collect();
        for (key, found) in &self.by_key {
            let row = &found.kept.row;
            if let (Some(by), None, Some("analysis")) =
                (refuted.get(&row.level), &row.refuted, row.answer.answered_by.as_deref())
            {
                return Err(format!(
                    "{} rests on the analysis, which the search for {} in `{}` has shown to be wrong, a mistake of \
                     `hypedc`; ask both in one run, without `--shard`",
                    key.text(),
                    by.kept.row.key().text(),
                    by.file
                ));
            }
        }
        Ok(())
    }
}

/// The shards of which rows are missing.
fn incomplete<'p>(
    count: u32,
    questions: usize,
    headers: &[(&'p str, &'p ShardHeader)],
    found: &BTreeMap<&'p Key, Found<'p>>,
) -> Vec<Incomplete<'p>> {
    let mut known: BTreeMap<u32, (&'p str, &'p ShardHeader)> = BTreeMap::new();
    for (file, header) in headers {
        known.entry(header.of.index).or_insert((file, header));
    }
    let planned: usize = known.values().map(|(_, header)| header.part.len()).sum();
    let unknown = (count as usize).saturating_sub(known.len());
    let mut all = Vec::new();
    for index in 1..=count {
        let shard = Shard { index, count };
        let Some((file, header)) = known.get(&index) else {
            // How many questions each of several has is not known.
            let questions = (unknown == 1).then(|| questions.saturating_sub(planned));
            all.push(Incomplete { shard, file: None, questions, missing: Vec::new() });
            continue;
        };
        let missing = header.part.iter().map(|question| &question.key).filter(|key| !found.contains_key(key));
        let missing: Vec<&Key> = missing.collect();
        if !missing.is_empty() {
            all.push(Incomplete { shard, file: Some(file), questions: Some(header.part.len()), missing });
        }
    }
    all
}

/// What all rows of a run have in common.
fn run_fields(row: &Row) -> Value {
    let mut fields = serde_json::to_value(&row.settings).unwrap_or_default();
    if let Value::Object(fields) = &mut fields {
        fields.insert("file".to_string(), row.file.clone().into());
        fields.insert("world".to_string(), row.world.clone().into());
    }
    fields
}

/// What does not depend on the machine.
fn result_fields(row: &Row) -> Value {
    let mut fields = serde_json::to_value(row).unwrap_or_default();
    if let Value::Object(fields) = &mut fields {
        fields.remove("timing");
    }
    fields
}

/// Maximum length of a value in a message, characters.
const MAX_VALUE: usize = 60;

/// The first field that differs, with both values; none if all are equal.
fn difference(one: &Value, other: &Value, first_file: &str, second_file: &str) -> Option<String> {
    let (Value::Object(one), Value::Object(other)) = (one, other) else { return None };
    let name = one.keys().chain(other.keys()).find(|name| one.get(*name) != other.get(*name))?;
    let value = |fields: &serde_json::Map<String, Value>| {
        let text = fields.get(name).map_or("left out".to_string(), Value::to_string);
        match text.char_indices().nth(MAX_VALUE) {
            Some((end, _)) => format!("{}…", &text[..end]),
            None => text,
        }
    };
    let (before, now) = (value(one), value(other));
    Some(format!("`{name}` is {before} in `{first_file}` and {now} in `{second_file}`"))
}

#[cfg(test)]
mod tests {
    use std::slice::from_ref;

    use super::*;
    use crate::corpus::row::Timing;
    use crate::corpus::row::tests::row;
    use crate::corpus::shard::{PlannedQuestion, SHARD_VERSION, shards};

    const LEVELS: [&str; 5] = ["a", "b", "c", "d", "e"];

    fn header(index: u32, of: &[u32]) -> ShardHeader {
        let part = of.iter().enumerate().filter(|(_, shard)| **shard == index);
        ShardHeader {
            shard: SHARD_VERSION,
            of: Shard { index, count: of.iter().copied().max().unwrap_or(1) },
            file: "game.hyped".into(),
            world: "Open".into(),
            program_sha256: "p".into(),
            plan_sha256: format!("{of:?}"),
            questions: of.len(),
            part: part.map(|(at, _)| PlannedQuestion { at, key: row(LEVELS[at]).key() }).collect(),
        }
    }

    fn file(name: &str, shard: Option<ShardHeader>, rows: &[Row]) -> Part {
        let lines = rows.iter().map(|row| StoredRow::new(row.clone()).unwrap().line + "\n");
        let head = shard.map(|header| serde_json::to_string(&header).unwrap() + "\n");
        let text: String = head.into_iter().chain(lines).collect();
        Part { name: name.into(), record: Record::read(text.as_bytes()).unwrap() }
    }

    /// The files of shards that are done.
    fn all(of: &[u32]) -> Vec<Part> {
        let count = of.iter().copied().max().unwrap_or(1);
        let part = |index| {
            let header = header(index, of);
            let rows: Vec<Row> = header.part.iter().map(|question| row(LEVELS[question.at])).collect();
            file(&format!("rows.{index}.jsonl"), Some(header), &rows)
        };
        (1..=count).map(part).collect()
    }

    fn levels(merged: &Merged<'_>) -> Vec<String> {
        merged.rows.iter().map(|kept| kept.row.level.clone().unwrap()).collect()
    }

    #[test]
    fn the_shards_together_are_the_whole_in_its_order() {
        for count in 1..=5 {
            let mut parts = all(&shards(&[None, Some(9.0), None, Some(2.0), Some(1.0)], count));
            parts.reverse();
            let merged = merge(&parts).unwrap();
            assert_eq!(levels(&merged), LEVELS);
            assert_eq!((merged.shards, merged.questions, merged.incomplete.len()), (Some(count), 5, 0));
        }
    }

    #[test]
    fn what_is_missing_is_told() {
        let of = [1, 2, 3, 1, 2];
        let mut parts = all(&of);
        parts[1] = file("rows.2.jsonl", Some(header(2, &of)), &[row("e")]);
        parts.pop();
        let merged = merge(&parts).unwrap();
        assert_eq!(levels(&merged), ["a", "d", "e"]);
        let key = row("b").key();
        let shard = |index| Shard { index, count: 3 };
        let second =
            Incomplete { shard: shard(2), file: Some("rows.2.jsonl"), questions: Some(2), missing: vec![&key] };
        let third = Incomplete { shard: shard(3), file: None, questions: Some(1), missing: Vec::new() };
        assert_eq!(merged.incomplete, [second, third]);
        // A shard that was killed at once has an empty file.
        parts.push(file("rows.3.jsonl", None, &[]));
        assert_eq!(merge(&parts).unwrap().incomplete.len(), 2);
        parts.remove(1);
        assert_eq!(merge(&parts).unwrap().incomplete[0].questions, None, "two of three are not known");
    }

    #[test]
    fn rows_of_different_runs_are_refused() {
        let of = [1, 2, 1, 2, 1];
        let mut other = row("b");
        other.settings.seed = 2;
        let changed = |change: fn(&mut ShardHeader)| {
            let mut header = header(2, &of);
            change(&mut header);
            file("rows.2.jsonl", Some(header), &[row("b"), row("d")])
        };
        for (second, why) in [
            (
                file("rows.2.jsonl", Some(header(2, &of)), &[other]),
                "`seed` is 1 in `rows.1.jsonl` and 2 in `rows.2.jsonl`",
            ),
            (file("other.jsonl", None, &[row("b")]), "`other.jsonl` is not"),
            (changed(|header| header.of.count = 3), "it is one of 3 shards, not 2"),
            (changed(|header| header.file = "b.hyped".into()), "its program is `b.hyped`, not `game.hyped`"),
            (changed(|header| header.world = "Shut".into()), "its world is `Shut`, not `Open`"),
            (changed(|header| header.program_sha256 = "q".into()), "`game.hyped` was another program"),
            (changed(|header| header.questions = 6), "it has 6 questions in all, not 5"),
            (changed(|header| header.plan_sha256 = "q".into()), "divided by another file of `--costs`"),
        ] {
            let parts = [all(&of).swap_remove(0), second];
            let error = merge(&parts).unwrap_err();
            assert!(error.contains(why), "{error}");
        }
        assert_eq!(merge(&[]).unwrap_err(), "these files hold no rows");
        assert_eq!(merge(&[file("empty", None, &[])]).unwrap_err(), "these files hold no rows");
    }

    #[test]
    fn a_row_may_be_there_twice_if_it_is_the_same() {
        let timed = Row { timing: Timing { seconds: 7.0, ..Timing::default() }, ..row("a") };
        let parts = [file("1", None, &[row("b"), row("a")]), file("2", None, &[timed, row("c")])];
        let merged = merge(&parts).unwrap();
        assert_eq!(levels(&merged), ["b", "a", "c"], "without shards in the order of the files");
        assert_eq!((merged.rows[1].row.timing.seconds, merged.shards), (0.25, None));
        let mut longer = row("a");
        longer.answer.steps = Some(121);
        let error = merge(&[file("1", None, &[row("a")]), file("2", None, &[longer.clone()])]).unwrap_err();
        assert_eq!(
            error,
            "two different rows for a, goal out: `steps` is 120 in `1` and 121 in `2`; leave out the file that is wrong"
        );
        let timed = |row: Row| {
            let mut row = row;
            row.settings.seconds_limit = Some(1.0);
            row
        };
        let error = merge(&[file("1", None, &[timed(row("a"))]), file("2", None, &[timed(longer)])]).unwrap_err();
        assert!(error.contains("depend on the machine"), "{error}");
        let failed = Row { error: Some("cannot read it".into()), ..row("a") };
        for parts in [
            [file("1", None, from_ref(&failed)), file("2", None, &[row("a")])],
            [file("2", None, &[row("a")]), file("1", None, from_ref(&failed))],
        ] {
            assert_eq!(merge(&parts).unwrap().rows[0].row.error, None, "what could be asked counts");
        }
    }

    #[test]
    fn levels_and_proofs_are_of_one_piece() {
        let goal = |name: &str| {
            let mut row = row("a");
            row.answer.goal = name.into();
            row
        };
        let merged = |second: Row| merge(&[file("1", None, &[goal("out")]), file("2", None, &[second])]).map(|_| ());
        assert_eq!(merged(goal("up")), Ok(()));
        let error = merged(Row { level_sha256: Some("5".into()), ..goal("up") }).unwrap_err();
        assert!(error.contains("the level was changed in between: of a `2` has another one than `1`"), "{error}");
        let error = merged(Row { program_sha256: Some("5".into()), ..goal("up") }).unwrap_err();
        assert!(error.contains("the program was changed"), "{error}");
        assert_eq!(merged(Row { program_sha256: None, error: Some("?".into()), ..goal("up") }), Ok(()));
        let mut proven = goal("up");
        proven.answer.answered_by = Some("analysis".into());
        let refuted = Row { refuted: Some("state 3".into()), ..goal("out") };
        let error = merge(&[file("1", None, &[refuted]), file("2", None, &[proven])]).map(|_| ()).unwrap_err();
        assert!(error.contains("a, goal up rests on the analysis"), "{error}");
    }
}
