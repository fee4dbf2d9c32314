//! `hypedc reach`: searches for inputs that bring about a world's goals, one verdict for each. Of several levels
//! [`crate::cli::corpus`] makes rows.

pub(in crate::cli) mod refuted;
pub(in crate::cli) mod result;
pub(in crate::cli) mod session;

use std::io::{self, Write};

use crate::ir::{World, WorldId};

use crate::cli::Answer;
use crate::cli::args::{ReachArgs, ResultFormat};
use crate::cli::report::{Loaded, choose_world, load_barred, show_fact};
use crate::cli::watching::{CommandWatch, Interrupt};
use refuted::command_line;
use result::RunResult;
use session::{Found, Prepared, ReachSession, Refusal, barred, target_name};

pub(in crate::cli) fn run(args: &ReachArgs) -> io::Result<Answer> {
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
    // What the analysis takes is part of the time for the first goal.
    let watch = CommandWatch::new("analysis", args.seconds);
    let asking = ReachSession::new(args, &loaded, prepared, &watch);
    watch.finish();
    answer_all(args, &loaded, world, &asking)
}

/// Asks all questions, then shows the answers: a search can refute what was proven before.
fn answer_all(args: &ReachArgs, loaded: &Loaded, world: WorldId, asking: &ReachSession<'_>) -> io::Result<Answer> {
    let program = &loaded.program;
    let mut result = RunResult::new(args, program, world, asking.settings(), asking.analysis_seconds);
    result.given_up = asking.given_up();
    if args.format == ResultFormat::Human {
        write!(io::stdout(), "{}", result.head())?;
    }
    let found = match find(args, asking, &program.worlds[world]) {
        Ok(found) => found,
        Err(refusal) => {
            refusal.show(&loaded.sources)?;
            return Ok(Answer::Unasked);
        }
    };
    let mut answer = if found.len() < asking.targets().len() { Answer::No } else { Answer::Yes };
    result.refuted = asking.refuted(args.map.first().map(AsRef::as_ref), command_line());
    if result.refuted.is_some() {
        answer = answer.max(Answer::No);
    }
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
        if !answered.is_expected {
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
fn find<'q>(args: &ReachArgs, asking: &'q ReachSession<'_>, world: &World) -> Result<Vec<Found<'q>>, Refusal> {
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

#[cfg(test)]
mod tests {
    use std::fs::{create_dir_all, read_dir, read_to_string, remove_dir_all, write};

    use clap::Parser;

    use super::*;
    use crate::analysis::configuration_space;
    use crate::cli::args::{Arguments, Command};
    use crate::ir::GoalId;
    use crate::reach::{Conclusion, Target};

    fn source(speed: u32) -> String {
        format!(
            "entity Walker {{
                button go
                mode still {{ x' = 0; when held(go) -> moving }}
                mode moving {{ x' = {speed} }}
            }}
            world Field {{
                space main {{ place walker: Walker at (0, 0) }}
                player 1: walker
                goal fast: walker.x' > 50
                goal far: walker.x > 40
            }}\n"
        )
    }

    /// What the analysis says of a world is what it says of a slower one: a mistake of the analysis, as it were.
    #[test]
    fn a_wrong_analysis_is_told_kept_and_fails_the_command() {
        let folder = std::env::temp_dir().join(format!("hypedc-refuted-{}", std::process::id()));
        create_dir_all(&folder).unwrap();
        let (slow, fast) = (folder.join("slow.hyped"), folder.join("fast.hyped"));
        write(&slow, source(30)).unwrap();
        write(&fast, source(60)).unwrap();
        let answer = |file: &std::path::Path, more: &[&str]| {
            let file = file.to_str().unwrap();
            let arguments = ["hypedc", "reach", file, "--nodes", "500"].into_iter().chain(more.iter().copied());
            let Command::Reach(args) = Arguments::try_parse_from(arguments).unwrap().command else { panic!() };
            let level = || args.reading.of(None);
            let slow = load_barred(&slow, level(), None).unwrap().unwrap();
            let world = WorldId(0);
            let space = configuration_space(&slow.program, world);
            let mut loaded = load_barred(&args.file, level(), None).unwrap().unwrap();
            let prepared = Prepared::new(&args, &mut loaded, world).unwrap_or_else(|_| panic!());
            let asking = ReachSession::resting_on(&args, &loaded, prepared, space, 0.0);
            let answer = answer_all(&args, &loaded, world, &asking).unwrap();
            let first = asking.find(Target::Goal(GoalId(0)), &crate::watch::Unwatched).unwrap_or_else(|_| panic!());
            (answer, asking.answer(first).answered)
        };
        let written = || {
            let names = read_dir(&folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap());
            let mut names: Vec<String> = names.filter(|name| name.ends_with(".txt")).collect();
            names.sort();
            names
        };

        let (code, answered) = answer(&slow, &[]);
        assert_eq!((code, answered.verdict), (Answer::No, Conclusion::ProvenUnreachable));
        assert!(written().is_empty(), "of itself, it is right");

        let (code, answered) = answer(&fast, &[]);
        assert_eq!((code, answered.verdict), (Answer::No, Conclusion::NotAnswered));
        assert!(answered.human(Target::Goal(GoalId(0))).contains("the analysis is wrong about this world"));
        // What is found is as wished, what was found on the way is not.
        assert_eq!(answer(&fast, &["--goal", "far", "--seed", "7"]).0, Answer::No);
        assert_eq!(answer(&fast, &["--goal", "far", "--no-check-states"]).0, Answer::Yes);
        assert_eq!(answer(&fast, &["--goal", "far", "--format", "json"]).0, Answer::No);
        let first = "hypedc-refuted-Field-1.txt";
        assert_eq!(written(), ["hypedc-refuted-Field-1-2.txt", first, "hypedc-refuted-Field-7.txt"]);
        let text = read_to_string(folder.join(first)).unwrap();
        for part in ["walker in moving: x' is 60, allowed is 30", "inputs   go", "world    Field", "seed     1"] {
            assert!(text.contains(part), "{part} in {text}");
        }
        remove_dir_all(&folder).unwrap();
    }
}
