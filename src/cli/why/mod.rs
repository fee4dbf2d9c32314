//! `hypedc why`: why an instance did what it did in a step of a run, or why it never entered a mode.
//! [`crate::ask`] reads the question and [`crate::why`] finds out; this part shows the answer.

mod text;

use std::io::{self, IsTerminal, Write};

use crate::ask::{Asked, WhyQuestion, answer_why};
use crate::compile::Changes;
use crate::ir::{SlotId, WorldId};
use crate::json::{self, Layout};

use super::Exit;
use super::args::{ResultFormat, WhyArgs};
use super::report::{Loaded, choose_world, colored, load_changed, plain_error};
use super::sim::script_of;
use text::{Paint, nearly_text, why_text};

pub(super) fn run(args: &WhyArgs) -> io::Result<Exit> {
    if let Some(why) = args.numbers.refusal() {
        plain_error(&why)?;
        return Ok(Exit::Refused);
    }
    let numbers = args.numbers.fixed();
    let changes = Changes { numbers: &numbers, ..Changes::default() };
    let Some(mut loaded) = load_changed(&args.file, args.level.file(), &changes)? else { return Ok(Exit::Refused) };
    let Some(world) = choose_world(&loaded, &args.file, args.world.as_deref())? else { return Ok(Exit::Refused) };
    let steps = (args.at.is_some(), "--at STEP");
    let Some(script) = script_of(&args.script, steps, &mut loaded, world)? else {
        return Ok(Exit::Refused);
    };
    let question = WhyQuestion {
        instance: args.instance.clone(),
        mode: args.mode.clone(),
        edge: args.edge.clone(),
        not: args.not,
        at: args.at,
    };
    let answer = answer_why(&loaded, world, &args.file, (&script, args.chance.unwrap_or_default()), &question);
    let (result, slot, asked) = match answer {
        Ok(answer) => answer,
        Err(refusal) => {
            refusal.show(&loaded.sources)?;
            return Ok(Exit::Refused);
        }
    };
    let was_entered = result.nearly.as_ref().is_some_and(|found| found.entered.is_some());
    let mut out = io::stdout().lock();
    match args.format {
        ResultFormat::Json => {
            json::write(&result, Layout::Indented, &mut out)?;
            writeln!(out)?;
        }
        ResultFormat::Human => {
            let paint = Paint(colored(io::stdout().is_terminal()));
            let head = format!("{}, world {}", result.file, result.world);
            if let Some(why) = &result.why {
                let others = asked.as_ref().map(|asked| starts(&loaded, world, slot, asked));
                write!(
                    out,
                    "{}",
                    why_text(&head, why, others.as_deref(), loaded.program.worlds[world].spaces.len() > 1, paint)
                )?;
            }
            if let Some(nearly) = &result.nearly {
                write!(out, "{}", nearly_text(&head, nearly, paint))?;
            }
        }
    }
    Ok(if was_entered { Exit::No } else { Exit::Yes })
}

/// The modes whose edges are asked about, for an answer about a step in which none of them was active.
fn starts(loaded: &Loaded, world: WorldId, slot: SlotId, asked: &Asked) -> Vec<String> {
    let entity = &loaded.program.entities[loaded.program.worlds[world].slots[slot].entity];
    let mut from: Vec<String> =
        asked.edges.iter().map(|edge| entity.modes[entity.edges[*edge].source].path.clone()).collect();
    from.dedup();
    from
}
