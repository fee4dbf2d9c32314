//! The result of `hypedc stuck` as text for people.

use std::path::Path;

use crate::ask::{StuckResult, StuckVerdict, StuckWay};
use crate::cli::reach::{ScriptDetail, counted};
use crate::reach::stuck::StateCounts;

/// Maximum number of ways that the text shows.
const MAX_SHOWN: usize = 8;
/// Maximum number of changes that a way shows.
const MAX_CHANGES: usize = 4;

/// A large number with its thousands apart: `12,345`.
fn grouped(number: u64) -> String {
    let digits = number.to_string();
    let mut out = String::new();
    for (at, digit) in digits.chars().enumerate() {
        if at > 0 && (digits.len() - at).is_multiple_of(3) {
            out.push(',');
        }
        out.push(digit);
    }
    out
}

/// `1 state`, `12,345 states`
fn number_of(count: u64, what: &str) -> String {
    if count == 1 { format!("1 {what}") } else { format!("{} {what}s", grouped(count)) }
}

/// The verdict in a few words.
pub(super) fn verdict(verdict: StuckVerdict) -> &'static str {
    match verdict {
        StuckVerdict::None => "nobody gets stuck",
        StuckVerdict::Stuck => "players can get stuck",
        StuckVerdict::Candidates => "players may get stuck",
        StuckVerdict::NoneFound => "no stuck places found",
        StuckVerdict::Unreachable => "cannot be reached",
        StuckVerdict::Unknown => "nothing can be said",
    }
}

/// What the verdict rests on.
pub(super) fn summary(result: &StuckResult) -> String {
    match (&result.states, result.verdict) {
        (Some(states), _) if !result.reads_between => {
            format!("proven: all {} were tried", number_of(states.all, "state"))
        }
        (Some(states), _) => {
            format!("all {} were tried with axes at -1, 0 and 1; not proven", number_of(states.all, "state"))
        }
        (None, StuckVerdict::Candidates) => format!("not proven, {} to look at", number_of(result.places, "place")),
        (None, StuckVerdict::NoneFound) => "not proven".to_string(),
        (None, _) => "not proven".to_string(),
    }
}

/// How many states there are of each fate.
fn states(states: &StateCounts) -> String {
    let mut parts = vec![format!("goal can be reached from {} of {}", grouped(states.arriving), grouped(states.all))];
    if states.stuck > 0 {
        let mut stuck = format!("{} {} stuck", grouped(states.stuck), if states.stuck == 1 { "is" } else { "are" });
        if states.dead_ends > 0 {
            stuck.push_str(&format!(" (in {} of them no input changes anything)", grouped(states.dead_ends)));
        }
        parts.push(stuck);
    }
    if states.doomed > 0 {
        parts.push(format!("from {} all inputs end the run or leave no player", grouped(states.doomed)));
    }
    format!("    states  {}\n", parts.join("; "))
}

/// One way in.
fn way(way: &StuckWay, detail: ScriptDetail) -> String {
    let mut out = match (&way.from, way.last_input.as_deref()) {
        (None, input) => {
            let input = input.filter(|input| *input != "-").unwrap_or("nothing");
            format!("    stuck   by pressing {input} at step {}, at {}\n", way.steps, way.place)
        }
        (Some(from), _) => {
            let (word, steps) = (if way.proven { "stuck  " } else { "stuck? " }, counted(way.steps, "step"));
            format!("    {word} at {}, after {steps}\n            coming from {from}\n", way.place)
        }
    };
    if !way.changes.is_empty() {
        let shown: Vec<&str> = way.changes.iter().take(MAX_CHANGES).map(String::as_str).collect();
        let rest = way.changes.len() - shown.len();
        let rest = if rest > 0 { format!(", and {rest} more") } else { String::new() };
        out.push_str(&format!("            then {}{rest}\n", shown.join(", ")));
    }
    out.push_str(&match (way.nodes, way.proven) {
        (None, _) => format!("            {} behind it\n", number_of(way.behind, "stuck state")),
        (Some(_), true) => {
            format!("            proven: no inputs lead from here to the goal; {}\n", number_of(way.behind, "place"))
        }
        (Some(nodes), false) => {
            let searched = number_of(nodes, "node");
            format!("            no way found from here in {searched}; {}\n", number_of(way.behind, "place"))
        }
    });
    out.push_str(&format!("            inputs  {}\n", detail.script(&way.inputs)));
    out
}

/// The result as text.
pub(super) fn result_text(result: &StuckResult, drawn: Option<&Path>, detail: ScriptDetail) -> String {
    let set = if result.set.is_empty() { String::new() } else { format!(", with {}", result.set.join(", ")) };
    let StuckResult { file, world, goal, .. } = result;
    let mut out =
        format!("{file}, world {world}{set}\n  goal {goal}: {} ({})\n", verdict(result.verdict), summary(result));
    out.extend(result.states.as_ref().map(states));
    out.extend(result.not_all_states.as_ref().map(|why| format!("    not all states were visited: {why}\n")));
    out.extend(result.unknown.as_ref().map(|why| format!("    {why}\n")));
    if let Some(rest) = result.rest_places {
        out.push_str(&format!("    players rest at {} that were found", number_of(rest, "place")));
        out.push_str(&match result.open_places {
            0 => "\n".to_string(),
            open => format!("; of {} of them nothing is known, `--nodes N` tries more\n", grouped(open)),
        });
    }
    out.extend(result.ways.iter().take(MAX_SHOWN).map(|found| way(found, detail)));
    let shown = result.ways.len().min(MAX_SHOWN) as u64;
    if result.places > shown && shown > 0 {
        out.push_str(&format!(
            "    and {} more, `--format json` has up to 100\n",
            number_of(result.places - shown, "place")
        ));
    }
    out.extend(drawn.map(|path| format!("    drawn   {}\n", path.display())));
    out
}
