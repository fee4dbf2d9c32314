//! A compiled program as JSON, written and read. A program that is read is verified completely before it can run. The
//! file includes the source text for excerpts and run-time diagnostics; tools that write such a file may omit it.

use std::fmt;
use std::io::{self, Write};
use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::{Invalid, Program, Spans, verify};
use crate::json::{self, Layout};
use crate::source::{SourceMap, Texts};

/// The version of the format; other versions are rejected.
pub const JSON_VERSION: u32 = 1;

/// The contents of a file.
#[derive(Serialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
struct ProgramFile<'p> {
    hypedc_program: u32,
    program: &'p Program,
    sources: Texts,
}

/// The parsed contents of a file.
#[derive(Deserialize)]
struct ParsedFile {
    program: Program,
    sources: Option<Texts>,
}

/// The version field of a file.
#[derive(Deserialize)]
struct VersionField {
    hypedc_program: u32,
}

/// Why a file is not a program.
#[derive(Debug)]
pub enum NotAProgram {
    /// It is not JSON, or lacks something.
    Json(serde_json::Error),
    /// It is of another version of the format.
    Version(u32),
    /// The text is not the one that it was compiled from.
    Sources,
    /// It could not be run.
    Invalid(Invalid),
}

impl fmt::Display for NotAProgram {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            NotAProgram::Json(error) => write!(f, "it is not a compiled program: {error}"),
            NotAProgram::Version(version) => {
                write!(f, "it is of version {version} of the format, and this is version {JSON_VERSION}")
            }
            NotAProgram::Sources => write!(f, "its `spans` lie outside of its `sources`, which may be left out"),
            NotAProgram::Invalid(invalid) => write!(f, "it cannot be run: {invalid}"),
        }
    }
}

impl std::error::Error for NotAProgram {}

impl Program {
    /// Writes it as JSON, indented, with the text that it was compiled from.
    ///
    /// # Errors
    /// Those of the writer.
    pub fn write_json(&self, sources: &SourceMap, out: &mut dyn Write) -> io::Result<()> {
        let written = ProgramFile { hypedc_program: JSON_VERSION, program: self, sources: sources.texts() };
        json::write(&written, Layout::Indented, out)?;
        writeln!(out)
    }

    /// What [`Program::write_json`] writes, as a schema (JSON Schema, draft 2020-12).
    #[cfg(feature = "testing")]
    pub fn json_schema() -> serde_json::Value {
        use schemars::transform::{RecursiveTransform, Transform};

        let mut schema = schemars::schema_for!(ProgramFile<'_>);
        schema.insert("title".into(), "A program that was compiled by hypedc".into());
        let closed = |schema: &mut schemars::Schema| {
            if schema.get("properties").is_some() {
                schema.insert("additionalProperties".into(), false.into());
            }
        };
        RecursiveTransform(closed).transform(&mut schema);
        schema.to_value()
    }

    /// Reads what [`Program::write_json`] has written. Without `sources` everything comes from nowhere.
    ///
    /// # Errors
    /// [`NotAProgram`] if it is something else, or anything in it could not be run.
    pub fn from_json(text: &str) -> Result<(Arc<Program>, SourceMap), NotAProgram> {
        let VersionField { hypedc_program: version } = serde_json::from_str(text).map_err(NotAProgram::Json)?;
        if version != JSON_VERSION {
            return Err(NotAProgram::Version(version));
        }
        let ParsedFile { mut program, sources } = serde_json::from_str(text).map_err(NotAProgram::Json)?;
        let sources = match sources {
            Some(texts) => SourceMap::of(texts).ok_or(NotAProgram::Sources)?,
            None => {
                program.spans = Spans::nowhere(&program);
                let mut blank = SourceMap::new();
                blank.add("", "");
                blank
            }
        };
        verify(&program).map_err(NotAProgram::Invalid)?;
        if !program.spans.all().all(|span| sources.holds(span)) {
            return Err(NotAProgram::Sources);
        }
        Ok((program.into(), sources))
    }
}
