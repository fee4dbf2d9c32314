//! `hypedc reach --skill`: the level in layers, by who gets where. [`crate::reach::query::layers`] searches; this part reads
//! the layers from the arguments, and shows and draws what was found.

mod picture;
mod result;
mod text;

#[cfg(feature = "testing")]
pub(in crate::cli) use result::json_schema;

use std::fs::write;
use std::io::{self, Write};
use std::sync::atomic::Ordering;
use std::time::Instant;

use crate::analysis::{ConfigurationSpace, watched_space};
use crate::ask::Without;
use crate::compile::{added_nevers, question_name};
use crate::ir::{ExprId, NeverId, World, WorldId};
use crate::json::{self, Layout};
use crate::reach::Target;
use crate::reach::query::layers::{Layer, LayerSession, Skill, share_proofs};
use crate::reach::query::{Query, Session};

use super::question::{SKILL_WITHOUT, refusal};
use super::refuted::{Refuted, RunInfo, command_line};
use crate::cli::Exit;
use crate::cli::args::{ReachArgs, ResultFormat};
use crate::cli::pictures::images;
use crate::cli::refusal::Refusal;
use crate::cli::report::{Loaded, plain_error};
use crate::cli::watches::{CommandWatch, interrupted};
use result::SkillResult;

/// Who plays, from the least skill to the most.
struct Players {
    skills: Vec<(Skill, String)>,
}

impl Players {
    /// The longest holds first, then those without something, then everybody.
    fn new(args: &ReachArgs, loaded: &Loaded, world: WorldId) -> Result<Players, Refusal> {
        let table = &loaded.program.worlds[world];
        let mut holds = Vec::new();
        for time in &args.person.skill {
            let steps = time.steps(table);
            let steps = u16::try_from(steps);
            holds.push(steps.map_err(|_| Refusal::Plain(format!("`--skill` is at most {} steps", u16::MAX)))?);
        }
        holds.sort_unstable_by(|a, b| b.cmp(a));
        holds.dedup();
        // Who holds an input for one step has all inputs.
        holds.retain(|steps| *steps > 1);
        let hold = |steps: &u16| (Skill::Hold(*steps), format!("holds of {steps} steps"));
        let mut skills: Vec<(Skill, String)> = holds.iter().map(hold).collect();
        let nevers: Vec<NeverId> = added_nevers(&loaded.program, &loaded.sources, world, SKILL_WITHOUT);
        // A predicate that is the name of a `never` of the world adds none.
        for text in &args.person.skill_without {
            let without = Without::read(text);
            if let Without::Button(name) = without {
                let buttons = without.buttons(&loaded.program, table).map_err(Refusal::of)?;
                skills.push((Skill::Unpressed(buttons), format!("without held({name})")));
                continue;
            }
            let name = question_name(text);
            let known = table.nevers.pairs().find(|(id, never)| nevers.contains(id) && never.name == name);
            let (id, _) = known.ok_or_else(|| {
                let takes = "`--skill-without` takes a predicate, such as `hero.keys > 0`, or a button, `held(run)`";
                Refusal::Plain(format!("{takes}; `{name}` is a `never` of the world"))
            })?;
            skills.push((Skill::Without(id), format!("without {name}")));
        }
        skills.push((Skill::Any, "any inputs".to_string()));
        Ok(Players { skills })
    }
}

pub(super) fn run(args: &ReachArgs, loaded: &Loaded, (world, query): (WorldId, Query)) -> io::Result<Exit> {
    let (program, started) = (&loaded.program, Instant::now());
    let table: &World = &program.worlds[world];
    let players = match Players::new(args, loaded, world) {
        Ok(players) => players,
        Err(why) => {
            why.show(&loaded.sources)?;
            return Ok(Exit::Refused);
        }
    };
    let images = match args.svg.as_ref().map(|_| images(program, &args.file)).transpose() {
        Ok(images) => images.unwrap_or_default(),
        Err(why) => {
            plain_error(&why)?;
            return Ok(Exit::Refused);
        }
    };
    // The compiler appends it.
    let Some(nowhere) = table.goals.ids().next_back().map(Target::Goal) else { return Ok(Exit::Refused) };
    let (mut layers, mut refuted): (Vec<Layer>, Option<Refuted>) = (Vec::new(), None);
    let mut spaces: Vec<(Vec<ExprId>, ConfigurationSpace)> = Vec::new();
    let is_stopped = || interrupted().load(Ordering::SeqCst);
    for (skill, name) in &players.skills {
        let watch = CommandWatch::new(&format!("{name}: analysis"), args.seconds);
        let asked = skill.query(&query);
        let rules = asked.rules(table);
        // The analysis does not depend on how long inputs are held.
        let known = spaces.iter().find(|(known, _)| *known == rules).map(|(_, space)| space.clone());
        let space = known.unwrap_or_else(|| {
            let space = watched_space(program, world, &rules, &watch);
            spaces.push((rules, space.clone()));
            space
        });
        let session = Session::with_space(program, world, asked, space);
        watch.finish();
        let of = LayerSession { session: &session, skill: skill.clone(), nowhere };
        let layer = of.layer(&layers, &loaded.sources, &mut |target, work| {
            let what = target.map_or("exploring", |target| target.name(table));
            let watch = CommandWatch::new(&format!("{name}: {what}"), args.seconds);
            work(&watch);
            watch.finish();
        });
        match layer {
            Ok(layer) => layers.push(layer),
            Err(error) => {
                refusal(args, loaded, world, &error).show(&loaded.sources)?;
                return Ok(Exit::Refused);
            }
        }
        if let Some(refutation) = session.refutation().filter(|_| refuted.is_none()) {
            let level = args.map.first().map(AsRef::as_ref);
            let info = RunInfo { file: &args.file, level, seed: args.seed, command: command_line() };
            refuted = Some(Refuted::saved(program, world, &refutation, &info));
        }
        if is_stopped() {
            break;
        }
    }
    // A mistake of the analysis may be in any of the proofs.
    if refuted.is_none() {
        share_proofs(&mut layers);
    }
    let names: Vec<&str> = players.skills.iter().map(|(_, name)| name.as_str()).collect();
    let refuted = refuted.map(|refuted| refuted.line());
    let found = (layers.as_slice(), names.as_slice());
    let result = SkillResult::new(args, (loaded, world, &query), found, (started.elapsed(), is_stopped(), refuted));
    if let Some(path) = &args.svg {
        let svg = picture::svg((program, world), &query, found, &result, &images);
        if let Err(error) = write(path, svg) {
            plain_error(&format!("cannot write `{}`: {error}", path.display()))?;
            return Ok(Exit::Refused);
        }
    }
    let mut out = io::stdout().lock();
    match args.format {
        ResultFormat::Human => write!(out, "{}", text::result_text(&result, args))?,
        ResultFormat::Json => {
            json::write(&result, Layout::Indented, &mut out)?;
            writeln!(out)?;
        }
    }
    Ok(if result.is_yes() { Exit::Yes } else { Exit::No })
}
