//! `hypedc sim --replay`: runs a trace again by what its header says, and tells where the first difference is.

use std::fs::File;
use std::io::{self, BufRead, BufReader, Write};
use std::path::Path;

use crate::compile::LevelFile;
use crate::sim::{Simulator, TraceFormat, TraceHeader, TraceLines, first_difference, parse_script};

use super::Answer;
use super::args::SimArgs;
use super::report::{choose_world, load, plain_error, show, show_fact};
use super::sim::{RunEnd, drive, header};

pub(super) fn run(path: &Path, args: &SimArgs) -> io::Result<Answer> {
    let mut trace = match Trace::open(path) {
        Ok(trace) => trace,
        Err(why) => {
            plain_error(&format!("cannot replay `{}`: {why}", path.display()))?;
            return Ok(Answer::Unasked);
        }
    };
    let old = trace.header.clone();
    let file = args.file.as_deref().unwrap_or(Path::new(&old.file));
    let given = args.level.file();
    let level = LevelFile {
        map: given.map.or(old.level.as_deref().map(Path::new)),
        legend: given.legend.or(old.legend.as_deref().map(Path::new)),
        tile: given.tile.or(old.tile),
    };
    let Some(mut loaded) = load(file, level)? else { return Ok(Answer::Unasked) };
    let Some(world) = choose_world(&loaded, file, Some(&old.world))? else { return Ok(Answer::Unasked) };
    let id = loaded.sources.add(path, old.inputs.clone());
    let (script, found) = parse_script(&loaded.program, world, id, &old.inputs);
    if found.has_errors() {
        show(&loaded.sources, &found)?;
        return Ok(Answer::Unasked);
    }
    let sim = Simulator::new(&loaded.program, world);
    let now = header(&sim, file, level, &script, old.steps);
    let lines = TraceLines::new(&sim, trace.format);
    let columns = lines.columns();
    let mut difference = match trace.format {
        TraceFormat::Jsonl => None,
        TraceFormat::Csv => trace.compare("the columns", &columns, &crate::tabular::csv::line(&columns))?,
    };
    let mut steps = 0;
    let end = drive(&sim, &script, old.steps, &mut |step, input, state, _| {
        steps = step;
        if difference.is_none() {
            let line = lines.state(step, input, state)?;
            difference = trace.compare(&format!("step {step}"), &columns, line.trim_end_matches('\n'))?;
        }
        Ok(())
    })?;
    if difference.is_none()
        && let Some(line) = trace.line()?
    {
        difference = Some(format!("the trace goes on where the run is over: {line}"));
    }
    let mut out = io::stdout().lock();
    let is_same = now.program_sha256 == old.program_sha256;
    if !is_same {
        let what = if now.level_sha256 == old.level_sha256 { "program" } else { "program or level" };
        writeln!(out, "{}: made from another {what} than {}", path.display(), file.display())?;
        writeln!(
            out,
            "  SHA-256 of the trace  {}\n  SHA-256 now           {}",
            old.program_sha256, now.program_sha256
        )?;
    }
    if old.hypedc != now.hypedc {
        writeln!(out, "{}: made by hypedc {}, this is {}", path.display(), old.hypedc, now.hypedc)?;
    }
    match &difference {
        Some(difference) => writeln!(out, "{}: {difference}", path.display())?,
        None => writeln!(out, "{}: all {steps} steps are the same", path.display())?,
    }
    drop(out);
    if let (RunEnd::Fault(fault, step), None) = (end, &difference) {
        // It stopped there when the trace was made, too.
        show_fact(&loaded.sources, fault.fact(&loaded.program, world, step))?;
    }
    Ok(if is_same && difference.is_none() { Answer::Yes } else { Answer::No })
}

/// A trace that is read line by line.
struct Trace {
    header: TraceHeader,
    format: TraceFormat,
    lines: BufReader<File>,
}

impl Trace {
    fn open(path: &Path) -> Result<Self, String> {
        let mut lines = BufReader::new(File::open(path).map_err(|error| error.to_string())?);
        let mut first = String::new();
        lines.read_line(&mut first).map_err(|error| error.to_string())?;
        let (header, format) = TraceHeader::read(first.trim_end_matches(['\n', '\r']))?;
        Ok(Trace { header, format, lines })
    }

    /// The next line.
    fn line(&mut self) -> io::Result<Option<String>> {
        let mut line = String::new();
        let count = self.lines.read_line(&mut line)?;
        line.truncate(line.trim_end_matches(['\n', '\r']).len());
        Ok((count > 0).then_some(line))
    }

    /// Compares the next line with what it should be; tells where it differs first.
    fn compare(&mut self, place: &str, columns: &[String], expected: &str) -> io::Result<Option<String>> {
        let Some(line) = self.line()? else { return Ok(Some(format!("the trace ends before {place}"))) };
        if line == expected {
            return Ok(None);
        }
        let (what, old, new) = first_difference(self.format, columns, &line, expected);
        Ok(Some(format!("{place} is the first that differs, in {what}: {old} in the trace, {new} now")))
    }
}
