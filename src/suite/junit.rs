//! Results of tests as a JUnit report in the form that Jenkins and GitLab read: a suite for each world of a file, in it a
//! case for each test.

use std::io;

use quick_xml::Writer;
use quick_xml::events::{BytesDecl, BytesText, Event};

use crate::corpus::{class_name, printable, seconds};

use super::record::TestResult;

/// The report, as XML that is valid for the schema `junit-10.xsd` of Jenkins' xUnit plugin.
///
/// # Errors
/// Infallible: writes to memory.
pub fn junit(results: &[&TestResult]) -> io::Result<String> {
    let mut out = Writer::new_with_indent(Vec::new(), b' ', 2);
    out.write_event(Event::Decl(BytesDecl::new("1.0", Some("UTF-8"), None)))?;
    let suites = out.create_element("testsuites").with_attribute(("name", "hypedc test"));
    suites.with_attributes(attributes(&counts(results))).write_inner_content(|out| {
        let same = |a: &&TestResult, b: &&TestResult| (&a.file, &a.world) == (&b.file, &b.world);
        results.chunk_by(same).try_for_each(|results| suite(out, results))
    })?;
    let mut text = String::from_utf8_lossy(&out.into_inner()).into_owned();
    text.push('\n');
    Ok(text)
}

fn counts(results: &[&TestResult]) -> [(&'static str, String); 4] {
    [
        ("tests", results.len().to_string()),
        ("failures", results.iter().filter(|result| !result.passed).count().to_string()),
        ("errors", "0".to_string()),
        ("time", seconds(results.iter().map(|result| result.seconds).sum())),
    ]
}

fn attributes<'a>(list: &'a [(&'a str, String)]) -> impl Iterator<Item = (&'a str, &'a str)> {
    list.iter().map(|(name, value)| (*name, value.as_str()))
}

fn suite(out: &mut Writer<Vec<u8>>, results: &[&TestResult]) -> io::Result<()> {
    let Some(first) = results.first() else { return Ok(()) };
    let (name, file) = (printable(&format!("{}, {}", first.file, first.world)), printable(&first.file));
    let suite = out.create_element("testsuite").with_attributes([("name", name.as_str()), ("file", &file)]);
    let suite = suite.with_attributes(attributes(&counts(results))).with_attribute(("skipped", "0"));
    suite.write_inner_content(|out| results.iter().try_for_each(|result| case(out, result)))?;
    Ok(())
}

fn case(out: &mut Writer<Vec<u8>>, result: &TestResult) -> io::Result<()> {
    let class = class_name(&result.file, &result.world);
    let (name, time) = (printable(&result.test), seconds(result.seconds));
    let case = out.create_element("testcase").with_attributes([("name", name.as_str()), ("classname", &class)]);
    let case = case.with_attribute(("time", time.as_str()));
    if result.passed {
        case.write_empty()?;
        return Ok(());
    }
    case.write_inner_content(|out| {
        let mut failed = result.problems.clone();
        let claims = result.claims.iter().filter(|claim| !claim.passed);
        failed.extend(claims.map(|claim| format!("{}: `{}`: {}", claim.place, claim.claim, claim.answer)));
        let message = failed.first().map(|first| printable(first)).unwrap_or_default();
        let element = out.create_element("failure").with_attribute(("message", message.as_str()));
        let text = printable(&failed.join("\n"));
        element.with_attribute(("type", "failed")).write_text_content(BytesText::new(&text))?;
        Ok(())
    })?;
    Ok(())
}
