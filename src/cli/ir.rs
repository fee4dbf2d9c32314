//! `hypedc ir`: the flat intermediate representation, as text or as JSON.

use std::io::{self, Write};

use crate::ir::text;

use super::Answer;
use super::args::{IrArgs, ResultFormat};
use super::report::{has_maps, load};

pub(super) fn run(args: &IrArgs) -> io::Result<Answer> {
    let Some(loaded) = load(&args.file, args.level.file())? else {
        return Ok(Answer::Unasked);
    };
    if !has_maps(&loaded, loaded.program.worlds.iter())? {
        return Ok(Answer::Unasked);
    }
    let mut out = io::stdout().lock();
    match args.format {
        ResultFormat::Human => write!(out, "{}", text(&loaded.program))?,
        ResultFormat::Json => loaded.program.write_json(&loaded.sources, &mut out)?,
    }
    Ok(Answer::Yes)
}
