//! Writer of JUnit reports in the form that Jenkins and GitLab read: a suite for each level with the settings as
//! properties, in it a case for each goal. Written with an XML library: `quick-junit` puts `skipped` on
//! `testsuites`, which the schema refuses.

use std::io;
use std::path::Path;

use quick_xml::Writer;
use quick_xml::events::{BytesDecl, BytesText, Event};

use crate::reach::Conclusion;

use super::row::Row;

/// The report, as XML that is valid for the schema `junit-10.xsd` of Jenkins' xUnit plugin.
///
/// A case fails if its verdict is not the expected one, and has an error if the question is invalid. Its class is the
/// program and the world, its name the level and the goal, its output the inputs of the path.
///
/// # Errors
/// Infallible: writes to memory.
pub fn junit(rows: &[&Row]) -> io::Result<String> {
    let mut out = Writer::new_with_indent(Vec::new(), b' ', 2);
    out.write_event(Event::Decl(BytesDecl::new("1.0", Some("UTF-8"), None)))?;
    let suites = out.create_element("testsuites").with_attribute(("name", "hypedc reach"));
    suites.with_attributes(attributes(&counts(rows))).write_inner_content(|out| {
        // The rows of a level are adjacent.
        rows.chunk_by(|a, b| a.level == b.level).try_for_each(|rows| suite(out, rows))
    })?;
    let mut text = String::from_utf8_lossy(&out.into_inner()).into_owned();
    text.push('\n');
    Ok(text)
}

/// The counts of cases as attributes of a report or suite.
fn counts(rows: &[&Row]) -> [(&'static str, String); 4] {
    let errors = rows.iter().filter(|r| r.answer.verdict == Conclusion::Error).count();
    let failures = rows.iter().filter(|r| !r.answer.is_expected).count() - errors;
    [
        ("tests", rows.len().to_string()),
        ("failures", failures.to_string()),
        ("errors", errors.to_string()),
        ("time", seconds(rows.iter().map(|r| r.timing.seconds).sum())),
    ]
}

fn attributes<'a>(list: &'a [(&'a str, String)]) -> impl Iterator<Item = (&'a str, &'a str)> {
    list.iter().map(|(name, value)| (*name, value.as_str()))
}

/// The rows of a level.
fn suite(out: &mut Writer<Vec<u8>>, rows: &[&Row]) -> io::Result<()> {
    let Some(row) = rows.first() else { return Ok(()) };
    let level = printable(row.level.as_ref().unwrap_or(&row.file));
    let suite = out.create_element("testsuite").with_attributes([("name", level.as_str()), ("file", &level)]);
    suite.with_attributes(attributes(&counts(rows))).with_attribute(("skipped", "0")).write_inner_content(|out| {
        properties(out, row)?;
        rows.iter().try_for_each(|row| case(out, row))
    })?;
    Ok(())
}

/// The properties that the rows of a level share.
fn properties(out: &mut Writer<Vec<u8>>, row: &Row) -> io::Result<()> {
    let settings = serde_json::to_value(&row.settings)?;
    let hashes = [("level_sha256", &row.level_sha256), ("program_sha256", &row.program_sha256)];
    out.create_element("properties").write_inner_content(|out| {
        let mut put = |name: &str, value: &str| -> io::Result<()> {
            let property = out.create_element("property").with_attribute(("name", name));
            property.with_attribute(("value", printable(value).as_str())).write_empty()?;
            Ok(())
        };
        put("file", &row.file)?;
        put("world", &row.world)?;
        for (name, hash) in hashes {
            hash.as_ref().map_or(Ok(()), |hash| put(name, hash))?;
        }
        for (name, value) in settings.as_object().into_iter().flatten() {
            match value {
                serde_json::Value::Null => {}
                serde_json::Value::String(text) => put(name, text)?,
                value => put(name, &value.to_string())?,
            }
        }
        Ok(())
    })?;
    Ok(())
}

fn case(out: &mut Writer<Vec<u8>>, row: &Row) -> io::Result<()> {
    let name = printable(&format!("{}, {} {}", row.key().level_name(), row.answer.kind.name(), row.answer.goal));
    let class = class_name(&row.file, &row.world);
    let time = seconds(row.timing.seconds);
    let case = out.create_element("testcase").with_attributes([("name", name.as_str()), ("classname", &class)]);
    let case = case.with_attribute(("time", time.as_str()));
    let output = row.answer.inputs.as_ref().map(|inputs| printable(inputs));
    if row.answer.is_expected && output.is_none() {
        case.write_empty()?;
        return Ok(());
    }
    case.write_inner_content(|out| {
        if !row.answer.is_expected {
            let what = if row.answer.verdict == Conclusion::Error { "error" } else { "failure" };
            let message = match row.reason() {
                reason if reason.is_empty() => row.answer.verdict.words().to_string(),
                reason => format!("{}: {reason}", row.answer.verdict.words()),
            };
            let element = out.create_element(what).with_attribute(("message", printable(&message).as_str()));
            let element = element.with_attribute(("type", row.answer.verdict.name()));
            let more = row.error.as_ref().map_or_else(|| printable(&row.answer.reasons.join("; ")), |e| printable(e));
            element.write_text_content(BytesText::new(&more))?;
        }
        if let Some(inputs) = &output {
            out.create_element("system-out").write_text_content(BytesText::new(inputs))?;
        }
        Ok(())
    })?;
    Ok(())
}

/// The class of the cases of a world of a file.
pub(crate) fn class_name(file: &str, world: &str) -> String {
    let stem = Path::new(file).file_stem().unwrap_or_default().to_string_lossy();
    // Readers interpret the text before the last dot as a folder.
    printable(&format!("{}.{world}", stem.replace('.', "_")))
}

/// Seconds as an attribute.
pub(crate) fn seconds(seconds: f64) -> String {
    format!("{seconds:.3}")
}

/// The text without characters that XML does not have.
pub(crate) fn printable(text: &str) -> String {
    let is_fine =
        |c: char| matches!(c, '\t' | '\n' | '\r' | ' '..='\u{d7ff}' | '\u{e000}'..='\u{fffd}' | '\u{10000}'..);
    text.chars().map(|c| if is_fine(c) { c } else { '\u{fffd}' }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::corpus::row::tests::row;
    use crate::reach::query::{Answer, Kind};

    #[test]
    fn odd_names_are_text_all_the_same() {
        let odd = "levels/<a> & \"b\"\u{1}.txt";
        let failed = Answer::failed(Kind::Goal, "out".into());
        let bad = Row { answer: failed, error: Some("]]> & <x>\u{0}".into()), ..row(odd) };
        let text = junit(&[&bad]).unwrap();
        let read = roxmltree::Document::parse(&text).unwrap();
        let suite = read.descendants().find(|n| n.has_tag_name("testsuite")).unwrap();
        assert_eq!(suite.attribute("file"), Some("levels/<a> & \"b\"\u{fffd}.txt"));
        let case = read.descendants().find(|n| n.has_tag_name("testcase")).unwrap();
        let error = case.first_element_child().unwrap();
        assert_eq!((error.tag_name().name(), error.text()), ("error", Some("]]> & <x>\u{fffd}")));
        assert_eq!(read.root_element().attribute("errors"), Some("1"));
        assert_eq!(read.root_element().attribute("failures"), Some("0"));
    }

    #[test]
    fn nothing_is_a_report_too() {
        let text = junit(&[]).unwrap();
        assert_eq!(roxmltree::Document::parse(&text).unwrap().root_element().attribute("tests"), Some("0"));
    }
}
