//! `hypedc reach`: searches for inputs that bring about a world's goals, one verdict for each. Of several levels
//! [`super::corpus`] makes rows.

use std::io::{self, Write};

use super::Answer;
use super::args::{ReachArgs, ResultFormat};
use super::asking::{Asking, Prepared, barred, target_name};
use super::corpus;
use super::reach_result::RunResult;
use super::refuted::command_line;
use super::report::{choose_world, load_barred, show_fact};
use super::watching::CommandWatch;

pub(super) fn run(args: &ReachArgs) -> io::Result<Answer> {
    if corpus::is_asked(args) {
        return corpus::run(args);
    }
    let level = args.reading.of(args.map.first().map(AsRef::as_ref));
    let Some(mut loaded) = load_barred(&args.file, level, barred(args))? else {
        return Ok(Answer::Unasked);
    };
    let Some(world) = choose_world(&loaded, &args.file, args.world.as_deref())? else {
        return Ok(Answer::Unasked);
    };
    let prepared = match Prepared::new(args, &mut loaded, world) {
        Ok(prepared) => prepared,
        Err(refusal) => {
            refusal.show(&loaded.sources)?;
            return Ok(Answer::Unasked);
        }
    };
    let program = &loaded.program;
    // What the analysis takes is part of the time for the first goal.
    let watch = CommandWatch::new("analysis", args.seconds);
    let asking = Asking::new(args, &loaded, prepared, &watch);
    watch.finish();
    let mut seconds = args.seconds.map(|seconds| seconds - asking.analysis_seconds);
    let mut result = RunResult::new(args, program, world, asking.settings(), asking.analysis_seconds);
    result.given_up = asking.given_up();
    if args.format == ResultFormat::Human {
        write!(io::stdout(), "{}", result.head())?;
    }
    let mut answer = Answer::Yes;
    let mut all = Vec::new();
    for &target in asking.targets() {
        let watch = CommandWatch::new(target_name(&program.worlds[world], target), seconds);
        seconds = args.seconds;
        let found = asking.find(target, &watch);
        watch.finish();
        match found {
            Ok(found) => all.push(found),
            Err(refusal) => {
                refusal.show(&loaded.sources)?;
                return Ok(Answer::Unasked);
            }
        }
        if watch.is_interrupted() {
            answer = answer.max(Answer::No);
            break;
        }
    }
    result.refuted = asking.refuted(args.map.first().map(AsRef::as_ref), command_line());
    if result.refuted.is_some() {
        answer = answer.max(Answer::No);
    }
    for found in all {
        let target = found.target;
        let mut asked = asking.answer(found);
        if let Err(refusal) = asking.save(&mut asked, None) {
            refusal.show(&loaded.sources)?;
            return Ok(Answer::Unasked);
        }
        if let Some((fault, step)) = asked.outcome.fault {
            show_fact(&loaded.sources, fault.fact(program, world, step))?;
        }
        let answered = asked.answered;
        if args.format == ResultFormat::Human {
            write!(io::stdout(), "{}", answered.human(target))?;
        }
        if !answered.is_as_wished {
            answer = answer.max(Answer::No);
        }
        result.add(answered);
    }
    match args.format {
        ResultFormat::Human => write!(io::stdout(), "{}", result.tail())?,
        ResultFormat::Json => {
            let mut out = io::stdout().lock();
            serde_json::to_writer_pretty(&mut out, &result)?;
            writeln!(out)?;
        }
    }
    Ok(answer)
}
