//! `hypedc test --record GOAL`: searches for a goal and writes the inputs that are found as a test into the program. The new
//! text is compiled and its test is run before the file is replaced.

use std::collections::BTreeMap;
use std::io::{self, Write};
use std::path::Path;

use crate::compile::{Asked, Changes, Compilation, ExtraQuestion, NumberSetting, compile_changed, question_name};
use crate::diagnostic::catalogue::file::Unreadable;
use crate::diagnostic::catalogue::run::NoQuestion;
use crate::reach::query::{Query, Session};
use crate::reach::{Limits, Settings, Style, Target};
use crate::source::Files;
use crate::suite::{NoWays, Recorded, Subject, TestOptions, insert_test, run_test};

use super::args::TestArgs;
use crate::cli::Exit;
use crate::cli::disk::{Changed, Disk, replace};
use crate::cli::report::{choose_world, load_changed, plain_error, show, show_fact};
use crate::cli::watches::CommandWatch;

pub(super) fn run(args: &TestArgs, goal: &str, numbers: &[NumberSetting<'_>]) -> io::Result<Exit> {
    let [file] = args.files.as_slice() else {
        plain_error("`--record` writes into one program")?;
        return Ok(Exit::Refused);
    };
    if !numbers.is_empty() {
        plain_error("`--record` writes a test of the program as it is: leave out `--set`")?;
        return Ok(Exit::Refused);
    }
    let question = [ExtraQuestion { asked: Asked::Goal, world: args.world.as_deref(), text: goal, origin: "--record" }];
    let changes = Changes { questions: &question, ..Changes::default() };
    let Some(loaded) = load_changed(file, args.level.file(), &changes)? else { return Ok(Exit::Refused) };
    let Some(world) = choose_world(&loaded, file, args.world.as_deref())? else { return Ok(Exit::Refused) };
    let (table, name) = (&loaded.program.worlds[world], question_name(goal));
    let Some(target) = table.goal_named(&name).map(Target::Goal) else {
        let why = format!("no goal `{name}` in `{}`", table.name);
        show_fact(&loaded.sources, NoQuestion { why, near: None, help: None })?;
        return Ok(Exit::Refused);
    };
    let test = args.name.clone().unwrap_or_else(|| name.clone());
    let written = compile_changed(file, args.level.file(), &Changes::default(), &Disk);
    if written.tests.iter().any(|case| (&case.world_name, &case.name) == (&table.name, &test)) {
        let why = format!("`{}` has a test `{test}` already", table.name);
        let help = Some("give the new one another name with `--name`".to_string());
        show_fact(&loaded.sources, NoQuestion { why, near: None, help })?;
        return Ok(Exit::Refused);
    }
    let query = Query {
        settings: Settings { seed: args.seed, ..Settings::default() },
        limits: Limits { nodes: args.nodes, ..Limits::default() },
        style: Some(Style::Fast),
        ..Query::new(vec![target])
    };
    let watch = CommandWatch::new(&name, args.seconds);
    let session = Session::new(&loaded.program, world, query, &watch);
    let found = session.find(target, &watch);
    watch.finish();
    let Ok(mut found) = found else {
        plain_error("the question cannot be asked; `hypedc reach` tells why")?;
        return Ok(Exit::Refused);
    };
    let answer = session.answer(&mut found, &loaded.sources);
    let Some(inputs) = answer.inputs else {
        let words = answer.verdict.words();
        plain_error(&format!("goal {name}: {words}, so there is nothing to record; `hypedc reach` tells more"))?;
        return Ok(Exit::No);
    };
    let recorded = Recorded { world: &table.name, test: &test, inputs: &inputs, seed: None, predicate: goal.trim() };
    let text = match Disk.read(file) {
        Ok(text) => text,
        Err(error) => {
            show_fact(&loaded.sources, Unreadable { path: file.clone(), import: None, error })?;
            return Ok(Exit::Refused);
        }
    };
    let Some(text) = insert_test(&text, &recorded) else {
        plain_error(&format!(
            "`{}` does not hold the world `{}`, or no test can be named `{test}`",
            file.display(),
            table.name
        ))?;
        return Ok(Exit::Refused);
    };
    if !passes(args, file, (&table.name, &test), &text, &watch)? {
        return Ok(Exit::Refused);
    }
    if let Err(why) = replace(file, &text) {
        plain_error(&format!("cannot write `{}`: {why}", file.display()))?;
        return Ok(Exit::Refused);
    }
    let (steps, seconds) = (answer.steps.unwrap_or_default(), answer.seconds_of_play.unwrap_or_default());
    writeln!(
        io::stdout(),
        "{}: test `{test}` added to {}: {name} in {seconds:.2} s, step {steps}",
        file.display(),
        table.name
    )?;
    Ok(Exit::Yes)
}

/// Whether the new text compiles and its new test passes; reports why not.
fn passes(
    args: &TestArgs,
    file: &Path,
    (world, test): (&str, &str),
    text: &str,
    watch: &CommandWatch,
) -> io::Result<bool> {
    let files = Changed { texts: BTreeMap::from([(file.to_path_buf(), text.to_string())]) };
    let Compilation { sources, program, diagnostics, tests } =
        compile_changed(file, args.level.file(), &Changes::default(), &files);
    let Some(program) = program else {
        show(&sources, &diagnostics)?;
        return Ok(false);
    };
    let case = tests.iter().find(|case| (case.world_name.as_str(), case.name.as_str()) == (world, test));
    let subject = Subject { file, level: args.level.file(), numbers: &[], files: &files };
    let options = TestOptions { nodes: args.nodes, seed: args.seed, covers: false, ways: &NoWays };
    let tested = case.map(|case| run_test(&subject, (&program, &sources), case, &options, watch));
    if tested.as_ref().is_some_and(|tested| tested.result.passed) {
        return Ok(true);
    }
    let problem = tested.and_then(|tested| tested.result.problems.into_iter().next()).unwrap_or_default();
    plain_error(&format!("the recorded test does not pass, nothing is written: {problem}"))?;
    Ok(false)
}
