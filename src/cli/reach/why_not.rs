//! Why a goal was not reached, as lines of an answer of `hypedc reach`, and what to try.

use crate::reach::query::{Answer, Query};
use crate::reach::why_not::{Barrier, ClosedMode, ClosedRoom, PartState, Point, WhyNot};
use crate::reach::{Conclusion, End, Planner};
use crate::sim::Script;

use super::text::Detail;

/// Maximum number of rooms, modes and parts of a goal that a line lists.
const MAX_LISTED: usize = 3;
/// Maximum number of hints.
const MAX_HINTS: usize = 2;

/// The lines of an answer.
pub(super) fn why_not_text(
    answer: &Answer,
    query: &Query,
    detail: Detail,
    is_verbose: bool,
    has_rooms: bool,
) -> String {
    let Some(why) = &answer.why_not else { return String::new() };
    let mut out = String::new();
    let mut line = |word: &str, text: &str| out.push_str(&format!("    {word:7} {text}\n"));
    if let Some(nearest) = &why.nearest {
        let parts: Vec<String> = nearest.parts.iter().map(PartState::phrase).collect();
        let sample = if why.is_sample { format!(" (in a search of {} nodes)", why.nodes) } else { String::new() };
        let place = match nearest.at.step {
            0 => "no state is nearer than the start".to_string(),
            _ => place(&nearest.at, has_rooms),
        };
        line("nearest", &format!("{place}: {}{sample}", parts.join("; ")));
        if is_verbose && !nearest.at.inputs.is_empty() {
            line("inputs", &detail.script(&nearest.at.inputs));
        }
    }
    let alone = alone(why, has_rooms, is_verbose);
    if !alone.is_empty() {
        line("alone", &alone.join("; "));
    }
    if let Some(way) = why.way.as_ref().filter(|way| is_verbose || way.barrier != Barrier::Unknown) {
        line("way", &way.words);
    }
    let closed = closed(why, is_verbose);
    if !closed.is_empty() {
        line("unseen", &closed.join("; "));
    }
    let hints = hints(answer, query);
    if !hints.is_empty() {
        line("try", &hints.join("; "));
    }
    out
}

/// Where and when a state is: `step 212 at (304, 96)`.
fn place(at: &Point, has_rooms: bool) -> String {
    let number = |at: f64| format!("{}", (at * 10.0).round() / 10.0 + 0.0);
    match &at.space {
        None => format!("step {}", at.step),
        Some(space) => {
            let room = if has_rooms { format!(" in `{space}`") } else { String::new() };
            format!("step {} at ({}, {}){room}", at.step, number(at.x), number(at.y))
        }
    }
}

/// The parts of the goal that came nearer by themselves than in the nearest state.
fn alone(why: &WhyNot, has_rooms: bool, is_verbose: bool) -> Vec<String> {
    let Some(nearest) = &why.nearest else { return Vec::new() };
    let mut all = Vec::new();
    for (by_itself, there) in why.parts.iter().zip(&nearest.parts) {
        let is_nearer = match (by_itself.part.holds, there.holds) {
            (_, true) => false,
            (true, false) => true,
            (false, false) => match (by_itself.part.distance, there.distance) {
                (Some(by_itself), Some(there)) => by_itself < there,
                (Some(_), None) => true,
                _ => by_itself.part.words != there.words,
            },
        };
        let Some(at) = by_itself.at.as_ref().filter(|_| is_nearer) else { continue };
        all.push(format!("{} in {}", by_itself.part.phrase(), place(at, has_rooms)));
    }
    shorten(&mut all, is_verbose);
    all
}

/// The rooms and modes that the search never entered.
fn closed(why: &WhyNot, is_verbose: bool) -> Vec<String> {
    let room = |closed: &ClosedRoom| {
        let barred = match (&closed.place, &closed.guard) {
            (None, _) => String::new(),
            (Some(place), None) => format!(" (link at {place})"),
            (Some(place), Some(guard)) if guard.holds => format!(" (link at {place} if `{}`)", guard.text),
            (Some(place), Some(guard)) => format!(" (link at {place}: {})", guard.phrase()),
        };
        format!("in room `{}`{barred}", closed.room)
    };
    let mode = |closed: &ClosedMode| {
        let place = closed.place.as_ref().map_or(String::new(), |place| format!(" at {place}"));
        let when = closed.step.map_or(String::new(), |step| format!(" in step {step}"));
        let why = match closed.missing.is_empty() {
            true => "not tried on the way to the nearest state".to_string(),
            false => format!("{}{when}", closed.missing.join(" and ")),
        };
        format!("{} in `{}` (edge{place}: {why})", closed.instance, closed.mode)
    };
    // A link is the border; what is behind closed rooms is not.
    let mut rooms: Vec<String> = why.rooms.iter().filter(|room| is_verbose || room.from.is_some()).map(room).collect();
    shorten(&mut rooms, is_verbose);
    let mut modes: Vec<String> = why.modes.iter().filter(|mode| is_verbose || mode.is_asked).map(mode).collect();
    shorten(&mut modes, is_verbose);
    rooms.append(&mut modes);
    rooms
}

fn shorten(all: &mut Vec<String>, is_verbose: bool) {
    let more = if is_verbose { 0 } else { all.len().saturating_sub(MAX_LISTED) };
    if more > 0 {
        all.truncate(MAX_LISTED);
        all.push(format!("{more} more"));
    }
}

/// What follows from the case.
fn hints(answer: &Answer, query: &Query) -> Vec<String> {
    if !answer.verdict.is_open() && answer.verdict != Conclusion::Exhausted {
        return Vec::new();
    }
    let mut hints = Vec::new();
    let nearest = answer.why_not.as_ref().and_then(|why| why.nearest.as_ref());
    let given = query.after.iter().map(Script::len).max().unwrap_or(0);
    if let (Some(limit), Some(nearest)) = (query.within, nearest)
        && nearest.at.step.saturating_sub(given) * 20 >= u64::from(limit) * 19
    {
        hints.push("a longer `--within`: the nearest state is at the end of the time".to_string());
    }
    if query.min_hold > 1 {
        hints.push("quicker inputs: a shorter `--min-hold` or `--reaction`".to_string());
    }
    if answer.verdict.is_open() && query.settings.planner != Planner::Auto {
        hints.push("`--planner auto`, which alternates several".to_string());
    }
    let c = &answer.coverage;
    if answer.end == End::Nodes {
        hints.push(if c.new_places * 20 >= c.places {
            format!("more `--nodes`: {} of {} places were new in the second half", c.new_places, c.places)
        } else {
            let new = if c.new_places == 0 { "none".to_string() } else { format!("only {}", c.new_places) };
            format!(
                "another `--seed`, then the level: more `--nodes` may help little, {new} of {} places were new in the \
                 second half",
                c.places
            )
        });
    }
    if !query.settings.records {
        hints.push("`--svg FILE`, which draws where the search was".to_string());
    }
    hints.truncate(MAX_HINTS);
    hints
}
