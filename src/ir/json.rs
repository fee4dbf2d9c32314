//! A compiled program as JSON, and read back. What is read is looked at as a whole before anybody runs it. Where things
//! stood in the text is told, and forgotten on the way back: the text may be gone.

use std::fmt;
use std::io::{self, Write};

use serde::{Deserialize, Serialize};

use super::{Invalid, Program, Spans, verify};

/// The version of the format; another one is not read.
pub const JSON_VERSION: u32 = 1;

/// The whole of a file.
#[derive(Serialize)]
struct Written<'p> {
    hypedc_program: u32,
    program: &'p Program,
}

/// The whole of a file, read back.
#[derive(Deserialize)]
struct Read {
    program: Program,
}

/// Which version a file is of.
#[derive(Deserialize)]
struct Version {
    hypedc_program: u32,
}

/// Why a file is not a program.
#[derive(Debug)]
pub enum NotAProgram {
    /// It is not JSON, or lacks something.
    Json(serde_json::Error),
    /// It is of another version of the format.
    Version(u32),
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
            NotAProgram::Invalid(invalid) => write!(f, "it cannot be run: {invalid}"),
        }
    }
}

impl std::error::Error for NotAProgram {}

impl Program {
    /// Writes it as JSON, indented.
    ///
    /// # Errors
    /// Those of the writer.
    pub fn write_json(&self, out: &mut dyn Write) -> io::Result<()> {
        serde_json::to_writer_pretty(&mut *out, &Written { hypedc_program: JSON_VERSION, program: self })?;
        writeln!(out)
    }

    /// Reads what [`Program::write_json`] has written.
    ///
    /// # Errors
    /// [`NotAProgram`] if it is something else, or anything in it could not be run.
    pub fn from_json(text: &str) -> Result<Program, NotAProgram> {
        let Version { hypedc_program: version } = serde_json::from_str(text).map_err(NotAProgram::Json)?;
        if version != JSON_VERSION {
            return Err(NotAProgram::Version(version));
        }
        let Read { mut program } = serde_json::from_str(text).map_err(NotAProgram::Json)?;
        program.spans = Spans::nowhere(&program);
        verify(&program).map_err(NotAProgram::Invalid)?;
        Ok(program)
    }
}
