//! `hypedc reach`: searches for inputs that bring about a world's goals, one verdict for each. Of several levels
//! [`super::corpus`] makes rows.

use std::io::{self, Write};

use crate::ir::World;

use super::Answer;
use super::args::{ReachArgs, ResultFormat};
use super::asking::{Asking, Found, Prepared, Refusal, barred, target_name};
use super::corpus;
use super::reach_result::RunResult;
use super::report::{choose_world, load_barred, show_fact};
use super::watching::{CommandWatch, Interrupt};

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
    let mut result = RunResult::new(args, program, world, asking.settings(), asking.analysis_seconds);
    result.given_up = asking.given_up();
    if args.format == ResultFormat::Human {
        write!(io::stdout(), "{}", result.head())?;
    }
    let found = match find(args, &asking, &program.worlds[world]) {
        Ok(found) => found,
        Err(refusal) => {
            refusal.show(&loaded.sources)?;
            return Ok(Answer::Unasked);
        }
    };
    let mut answer = if found.len() < asking.targets().len() { Answer::No } else { Answer::Yes };
    for (found, &target) in found.into_iter().zip(asking.targets()) {
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

/// What is found about each question, until it is interrupted. A way that is found for one may answer others.
fn find<'q>(args: &ReachArgs, asking: &'q Asking<'_>, world: &World) -> Result<Vec<Found<'q>>, Refusal> {
    let targets = asking.targets();
    let mut all: Vec<Found<'q>> = Vec::new();
    let mut is_interrupted = false;
    let mut left: Vec<Option<f64>> = Vec::new();
    let mut seconds = args.seconds.map(|seconds| seconds - asking.analysis_seconds);
    for &target in targets {
        let watch = CommandWatch::new(target_name(world, target), seconds);
        let found = asking.find(target, &watch);
        watch.finish();
        is_interrupted |= watch.is_interrupted();
        left.push(seconds.map(|limit| (limit - watch.seconds()).max(0.0)));
        seconds = args.seconds;
        all.push(found?);
        if is_interrupted {
            return Ok(all);
        }
    }
    // These replay ways that were found, which are short.
    let watch = Interrupt::new();
    asking.exchange(&mut all, &watch);
    for ((found, &target), seconds) in all.iter_mut().zip(targets).zip(left) {
        let watch = CommandWatch::new(target_name(world, target), seconds);
        asking.minimize(found, &watch);
        watch.finish();
    }
    // Each round makes a way shorter.
    while asking.exchange(&mut all, &watch) {
        all.iter_mut().for_each(|found| asking.simplify(found, &watch));
    }
    Ok(all)
}
