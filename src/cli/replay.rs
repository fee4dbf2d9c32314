//! `hypedc sim --replay`: repeats the run of a trace from its header, and reports the first difference.

use std::fs::File;
use std::io::{self, BufReader, Write};
use std::ops::ControlFlow;
use std::path::Path;

use crate::compile::{Changes, LevelFile, NumberSetting};
use crate::diagnostic::catalogue::file::Unreadable;
use crate::sim::{Simulator, TraceFormat, TraceHeader, TraceLines, first_difference, parse_script};
use crate::source::SourceMap;

use super::Exit;
use super::args::SimArgs;
use super::disk::{line, open};
use super::report::{choose_world, load_changed, plain_error, show, show_fact};
use super::sim::{RunEnd, drive, header};
use super::watches::Interrupt;

pub(super) fn run(path: &Path, args: &SimArgs) -> io::Result<Exit> {
    let file = match open(path) {
        Ok(file) => file,
        Err(error) => {
            show_fact(&SourceMap::new(), Unreadable::named(path, error))?;
            return Ok(Exit::Refused);
        }
    };
    let cannot = |why: &str| plain_error(&format!("cannot replay `{}`: {why}", path.display()));
    let mut trace = match Trace::open(file) {
        Ok(trace) => trace,
        Err(why) => {
            cannot(&why)?;
            return Ok(Exit::Refused);
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
    let set = old.set.iter().filter_map(|set| set.split_once('='));
    let numbers: Vec<NumberSetting<'_>> = set.map(|(path, value)| NumberSetting { path, value }).collect();
    let changes = Changes { numbers: &numbers, ..Changes::default() };
    let Some(mut loaded) = load_changed(file, level, &changes)? else { return Ok(Exit::Refused) };
    let Some(world) = choose_world(&loaded, file, Some(&old.world))? else { return Ok(Exit::Refused) };
    let id = loaded.sources.add(path, old.inputs.clone());
    let (script, found) = parse_script(&loaded.program, world, id, &old.inputs);
    if found.has_errors() {
        show(&loaded.sources, &found)?;
        return Ok(Exit::Refused);
    }
    let sim = Simulator::new(&loaded.program, world);
    let now = header(&sim, file, (level, &old.set), (&script, old.chance), old.steps);
    let lines = TraceLines::new(&sim, trace.format);
    let columns = lines.columns();
    let mut difference = match trace.format {
        TraceFormat::Jsonl => None,
        TraceFormat::Csv => trace.compare("the columns", &columns, &crate::tabular::csv::line(&columns)),
    };
    let mut steps = 0;
    let ended = drive(&sim, (&script, old.chance), old.steps, &Interrupt::new(), &mut |step, input, state, _| {
        steps = step;
        if difference.is_none() {
            let line = lines.state(step, input, state)?;
            difference = trace.compare(&format!("step {step}"), &columns, line.trim_end_matches('\n'));
        }
        Ok(if difference.is_some() || trace.broken.is_some() {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        })
    })?;
    if let RunEnd::Stopped(step) = ended {
        plain_error(&format!("stopped after step {step} of {}", old.steps))?;
        return Ok(Exit::No);
    }
    if difference.is_none()
        && let Some(line) = trace.line()
    {
        difference = Some(format!("the trace goes on where the run is over: {line}"));
    }
    if let Some(why) = &trace.broken {
        cannot(why)?;
        return Ok(Exit::Refused);
    }
    let mut out = io::stdout().lock();
    let is_same = now.program_sha256 == old.program_sha256;
    if !is_same {
        let what = if now.level_sha256 == old.level_sha256 { "program" } else { "program or level" };
        writeln!(out, "{}: recorded with a different {what} than {}", path.display(), file.display())?;
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
    if let (RunEnd::Fault(fault, step), None) = (ended, &difference) {
        // The original run stopped there, too.
        show_fact(&loaded.sources, fault.fact(&loaded.program, world, step))?;
    }
    Ok(if is_same && difference.is_none() { Exit::Yes } else { Exit::No })
}

/// A trace, read line by line.
struct Trace {
    header: TraceHeader,
    format: TraceFormat,
    lines: BufReader<File>,
    /// Why it cannot be read further.
    broken: Option<String>,
}

impl Trace {
    fn open(file: File) -> Result<Self, String> {
        let mut lines = BufReader::new(file);
        let first = line(&mut lines)?.unwrap_or_default();
        let (header, format) = TraceHeader::read(&first)?;
        Ok(Trace { header, format, lines, broken: None })
    }

    /// The next line; `None` at the end or on an error.
    fn line(&mut self) -> Option<String> {
        line(&mut self.lines).unwrap_or_else(|why| {
            self.broken = Some(why);
            None
        })
    }

    /// Compares the next line with the expected one; describes the first difference.
    fn compare(&mut self, place: &str, columns: &[String], expected: &str) -> Option<String> {
        let Some(line) = self.line() else { return Some(format!("the trace ends before {place}")) };
        if line == expected {
            return None;
        }
        let (what, old, new) = first_difference(self.format, columns, &line, expected);
        Some(format!("{place} is the first to differ, in {what}: {old} in the trace, {new} now"))
    }
}
