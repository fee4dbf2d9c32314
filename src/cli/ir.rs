//! `hypedc ir`: the flat intermediate representation, as text or as JSON, and the schema of the latter.

use std::io::{self, Write};

use crate::compile::Changes;
use crate::ir::text;

use super::Exit;
use super::args::{IrArgs, ResultFormat};
use super::report::{has_maps, load_changed, plain_error};

/// The schema of a program; the tests compare it with the types.
const SCHEMA: &str = include_str!("../../docs/schemas/program.json");

pub(super) fn run(args: &IrArgs) -> io::Result<Exit> {
    let mut out = io::stdout().lock();
    let Some(file) = &args.file else {
        out.write_all(SCHEMA.as_bytes())?;
        return Ok(Exit::Yes);
    };
    if let Some(why) = args.numbers.refusal() {
        plain_error(&why)?;
        return Ok(Exit::Refused);
    }
    let numbers = args.numbers.fixed();
    let changes = Changes { numbers: &numbers, ..Changes::default() };
    let Some(loaded) = load_changed(file, args.level.file(), &changes)? else {
        return Ok(Exit::Refused);
    };
    if !has_maps(&loaded, loaded.program.worlds.iter())? {
        return Ok(Exit::Refused);
    }
    match args.format {
        ResultFormat::Human => write!(out, "{}", text(&loaded.program))?,
        ResultFormat::Json => loaded.program.write_json(&loaded.sources, &mut out)?,
    }
    Ok(Exit::Yes)
}
