//! `hypedc merge`: joins the files that shards of `hypedc reach` wrote on several machines, and says what is missing.

pub(in crate::cli) mod args;

use std::io::{self, Write};
use std::path::Path;

use crate::corpus::{Incomplete, Merged, Part, Row, StoredRow, merge, summary};
use crate::source::SourceMap;

use crate::cli::Exit;
use crate::cli::corpus::files::{RecordFile, read};
use crate::cli::refusal::Refusal;
use args::MergeArgs;

/// Maximum number of missing questions that are listed for a shard.
const MAX_LISTED: usize = 10;

pub(in crate::cli) fn run(args: &MergeArgs) -> io::Result<Exit> {
    let refused = |why: Refusal| why.show(&SourceMap::new()).map(|()| Exit::Refused);
    let same = |a: &Path, b: &Path| a.canonicalize().ok().is_some_and(|a| Some(a) == b.canonicalize().ok());
    if let Some(path) = args.files.iter().find(|path| same(path, &args.output)) {
        return refused(Refusal::Plain(format!(
            "`{}` is both read and written: give the output a name that the pattern of the inputs does not include",
            path.display()
        )));
    }
    let part = |path: &std::path::PathBuf| {
        let record = read(path, "a `--results` file of `hypedc reach`")?;
        Ok(Part { name: path.display().to_string(), record })
    };
    let parts = match args.files.iter().map(part).collect::<Result<Vec<Part>, Refusal>>() {
        Ok(parts) => parts,
        Err(why) => return refused(why),
    };
    let merged = match merge(&parts) {
        Ok(merged) => merged,
        Err(why) => return refused(Refusal::Plain(why)),
    };
    if let Err(why) = RecordFile::open(&args.output, None).and_then(|file| file.finish(&merged.rows)) {
        return refused(Refusal::Plain(why));
    }
    write!(io::stdout(), "{}", text(&merged, args))?;
    Ok(if merged.incomplete.is_empty() { Exit::Yes } else { Exit::No })
}

/// What was joined, and what is missing.
fn text(merged: &Merged<'_>, args: &MergeArgs) -> String {
    let rows: Vec<&Row> = merged.rows.iter().map(|kept: &&StoredRow| &kept.row).collect();
    let from = match merged.shards {
        Some(shards) => counted(shards as usize, "shard"),
        None => counted(args.files.len(), "file"),
    };
    let mut out = format!("{} of {from}: {}\n", args.output.display(), summary(&rows));
    if merged.incomplete.is_empty() {
        return out;
    }
    let missing = merged.questions.saturating_sub(rows.len());
    let are = if missing == 1 { "is" } else { "are" };
    out.push_str(&format!("{missing} of {} {are} missing\n", counted(merged.questions, "question")));
    merged.incomplete.iter().for_each(|shard| out.push_str(&shard_text(shard)));
    let mut shards: Vec<String> = merged.incomplete.iter().map(|of| format!("`--shard {}`", of.shard)).collect();
    if shards.len() > MAX_LISTED {
        shards.truncate(MAX_LISTED);
        shards.push("…".to_string());
    }
    out.push_str(&format!(
        "{} and the same options go on; so does `--results {}` without `--shard`, for all of it\n",
        shards.join(", "),
        args.output.display()
    ));
    out
}

fn shard_text(of: &Incomplete<'_>) -> String {
    let Incomplete { shard, file, questions, missing } = of;
    let Some(file) = file else {
        let questions = questions.map_or(String::new(), |count| format!(", {}", counted(count, "question")));
        return format!("  shard {shard}: no file of it is given{questions}\n");
    };
    let all = counted(questions.unwrap_or_default(), "question");
    let mut out = format!("  shard {shard}, `{file}`: {} of {all}\n", missing.len());
    missing.iter().take(MAX_LISTED).for_each(|key| out.push_str(&format!("    {}\n", key.text())));
    if let more @ 1.. = missing.len().saturating_sub(MAX_LISTED) {
        out.push_str(&format!("    and {more} more\n"));
    }
    out
}

fn counted(count: usize, what: &str) -> String {
    format!("{count} {what}{}", if count == 1 { "" } else { "s" })
}
