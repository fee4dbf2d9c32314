//! The result of `hypedc stuck` as text for people.

use super::result::{StatesResult, StuckResult, StuckVerdict, WayResult};
use crate::cli::reach::counted;

/// Maximum number of ways that the text shows.
pub(super) const MAX_SHOWN: usize = 8;
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

/// The line of the verdict.
fn verdict(result: &StuckResult) -> String {
    let proven = match (&result.states, result.reads_between) {
        (Some(states), false) => format!("proven: all {} were tried", number_of(states.all, "state")),
        (Some(states), true) => format!("all {} were tried with axes at -1, 0 and 1", number_of(states.all, "state")),
        (None, _) => String::new(),
    };
    match result.verdict {
        StuckVerdict::None => format!("nobody gets stuck ({proven})"),
        StuckVerdict::Stuck => format!("players can get stuck ({proven})"),
        StuckVerdict::Unreachable => format!("cannot be reached at all ({proven})"),
        StuckVerdict::Candidates => match result.places {
            1 => "1 place where players may get stuck, not proven".to_string(),
            places => format!("{places} places where players may get stuck, not proven"),
        },
        StuckVerdict::NoneFound => "no place was found where players get stuck, not proven".to_string(),
        StuckVerdict::Unknown => "nothing can be said".to_string(),
    }
}

/// How many states there are of each fate.
fn states(states: &StatesResult) -> String {
    let mut out =
        format!("    states  the goal can be reached from {} of {}", grouped(states.arriving), grouped(states.all));
    if states.stuck > 0 {
        out.push_str(&format!("; {} stuck", is_or_are(states.stuck)));
        if states.dead_ends > 0 {
            out.push_str(&format!(", in {} of them no input changes anything", grouped(states.dead_ends)));
        }
    }
    if states.doomed > 0 {
        out.push_str(&format!("; from {} all inputs end the run", grouped(states.doomed)));
    }
    out.push('\n');
    out
}

fn is_or_are(count: u64) -> String {
    format!("{} {}", grouped(count), if count == 1 { "is" } else { "are" })
}

/// One way in.
fn way(way: &WayResult) -> String {
    let pressed =
        if way.last_input == "-" { "pressing nothing".into() } else { format!("pressing {}", way.last_input) };
    let mut out = match (way.proven, way.steps) {
        (true, _) => format!("    stuck   from step {} on, {pressed}: {}\n", way.steps, way.place),
        (false, _) => format!("    stuck?  after {}: {}\n", counted(way.steps, "step"), way.place),
    };
    if !way.changes.is_empty() {
        let shown: Vec<&str> = way.changes.iter().take(MAX_CHANGES).map(String::as_str).collect();
        let rest = way.changes.len() - shown.len();
        let rest = if rest > 0 { format!(", and {rest} more") } else { String::new() };
        out.push_str(&format!("            then {}{rest}\n", shown.join(", ")));
    }
    out.push_str(&match way.nodes {
        None => format!("            {} behind it\n", number_of(way.behind, "stuck state")),
        Some(nodes) => {
            let searched = number_of(nodes, "node");
            format!("            no way found from here in {searched}; {}\n", number_of(way.behind, "place"))
        }
    });
    out.push_str(&format!("            inputs  {}\n", way.inputs));
    out
}

/// The result as text.
pub(super) fn result_text(result: &StuckResult, drawn: Option<&std::path::Path>) -> String {
    let set = if result.set.is_empty() { String::new() } else { format!(", with {}", result.set.join(", ")) };
    let mut out =
        format!("{}, world {}{set}\n  goal {}: {}\n", result.file, result.world, result.goal, verdict(result));
    out.extend(result.states.as_ref().map(states));
    out.extend(result.not_all_states.as_ref().map(|why| format!("    not all states were visited: {why}\n")));
    out.extend(result.unknown.as_ref().map(|why| format!("    {why}\n")));
    out.extend(
        result
            .rest_places
            .map(|rest| format!("    {} were found at which players can rest\n", number_of(rest, "place"))),
    );
    out.extend(result.ways.iter().take(MAX_SHOWN).map(way));
    let shown = result.ways.len().min(MAX_SHOWN) as u64;
    if result.places > shown && shown > 0 {
        out.push_str(&format!("    and {} more\n", number_of(result.places - shown, "place")));
    }
    out.extend(drawn.map(|path| format!("    drawn   {}\n", path.display())));
    out
}
