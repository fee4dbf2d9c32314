//! `hypedc fmt`: rewrites programs in canonical layout. Errors go to standard error; standard output is for
//! differences, or for the text itself.

use std::io::{self, Write};
use std::path::Path;

use crate::diagnostic::catalogue::file::Unreadable;
use crate::format::format;
use crate::source::{ReadError, SourceMap, decode};

use super::Exit;
use super::args::FmtArgs;
use super::disk::{all, bytes, replace};
use super::report::{plain_error, show, show_fact};

/// Maximum number of characters shown per line.
const SHOWN: usize = 160;

pub(super) fn run(args: &FmtArgs) -> io::Result<Exit> {
    let mut answer = Exit::Yes;
    for path in &args.files {
        answer = answer.max(one(path, args.check)?);
    }
    Ok(answer)
}

fn one(path: &Path, check: bool) -> io::Result<Exit> {
    let stream = path == Path::new("-");
    let shown = if stream { Path::new("<stdin>") } else { path };
    let mut sources = SourceMap::new();
    let read = if stream { all(io::stdin().lock()) } else { bytes(path) };
    let (before, text) = match read.and_then(|before| Ok((before.clone(), decode(before)?))) {
        Ok(read) => read,
        Err(error) => return unreadable(shown, error),
    };
    let file = sources.add(shown, text);
    let after = match format(file, sources.file(file).text()) {
        Ok(after) => after,
        Err(found) => {
            show(&sources, &found)?;
            return Ok(Exit::No);
        }
    };
    let changes = after.as_bytes() != before;
    if check {
        if changes {
            write!(io::stdout(), "{}", first_difference(shown, &before, &after))?;
        }
        return Ok(if changes { Exit::No } else { Exit::Yes });
    }
    if stream {
        io::stdout().write_all(after.as_bytes())?;
    } else if changes && let Err(why) = replace(path, &after) {
        plain_error(&format!("cannot write `{}`: {why}", path.display()))?;
        return Ok(Exit::Refused);
    }
    Ok(Exit::Yes)
}

fn unreadable(path: &Path, error: ReadError) -> io::Result<Exit> {
    show_fact(&SourceMap::new(), Unreadable { path: path.to_path_buf(), import: None, error })?;
    Ok(Exit::Refused)
}

/// Describes the first difference between a text and its canonical layout.
fn first_difference(path: &Path, before: &[u8], after: &str) -> String {
    let before = String::from_utf8_lossy(before);
    let (mut olds, mut news) = (before.split_inclusive('\n'), after.split_inclusive('\n'));
    let mut line = 1;
    loop {
        let (old, new) = (olds.next(), news.next());
        if old != new || old.is_none() {
            let shown = |sign: char, text: Option<&str>| {
                text.map_or(String::new(), |t| format!("{}\n", format!("  {sign} {}", plain(t)).trim_end()))
            };
            return format!("{}:{line}: not formatted\n{}{}", path.display(), shown('-', old), shown('+', new));
        }
        line += 1;
    }
}

/// A line for a terminal: invisible characters are escaped, long lines are cut.
fn plain(line: &str) -> String {
    let (line, end) = line.strip_suffix('\n').map_or((line, " (no line end)"), |line| (line, ""));
    let seen = line.trim_end_matches(' ').len();
    let mut out = String::new();
    for (at, c) in line.char_indices().take(SHOWN) {
        match c {
            ' ' if at >= seen => out.push('·'),
            '\u{feff}' => out.push_str("\\u{feff}"),
            c if c.is_control() => out.extend(c.escape_debug()),
            c => out.push(c),
        }
    }
    if line.chars().nth(SHOWN).is_some() {
        out.push('…');
    }
    out.push_str(end);
    out
}
