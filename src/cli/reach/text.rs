//! An answer of `hypedc reach` as text for people.

use crate::reach::Conclusion;
use crate::reach::query::{Answer, Kind, ProofMethod, Query, SearchWindow};
use crate::reach::{End, Luck};

use super::files::Saved;

/// `1 step`, `2 steps`
pub(in crate::cli) fn counted(count: u64, what: &str) -> String {
    format!("{count} {what}{}", if count == 1 { "" } else { "s" })
}

/// The statistics, as lines under a picture.
pub(super) fn notes(answer: &Answer) -> Vec<String> {
    let mut notes = Vec::new();
    if let (Some(steps), Some(seconds)) = (answer.steps, answer.seconds_of_play) {
        notes.push(format!("path of {steps} steps, {seconds:.2} s of play"));
    }
    if !answer.reasons.is_empty() {
        notes.push(answer.reasons.join("; "));
    }
    if let (Some(planner), 1..) = (&answer.answered_by, answer.nodes) {
        let c = &answer.coverage;
        notes.push(format!(
            "{} nodes, {} places of {} px, {} combinations of modes ({planner})",
            answer.nodes, c.places, c.place, c.mode_combinations
        ));
    }
    notes
}

/// `, with luck: 1 in 36`; nothing if none is needed.
pub(super) fn with_luck(luck: Option<&Luck>) -> String {
    luck.filter(|luck| !luck.is_none()).map_or(String::new(), |luck| format!(", with luck: {}", luck.words()))
}

/// The verdict and what it assumes: the first line of an answer.
fn verdict(answer: &Answer, query: &Query) -> String {
    let within = query.within.map(|steps| format!(" within {}", counted(u64::from(steps), "step")));
    let hold = match query.min_hold {
        1 => String::new(),
        steps => format!(" by inputs that are held for at least {steps} steps"),
    };
    let asked = format!("{}{hold}", within.unwrap_or_default());
    let is_never = answer.kind == Kind::Never;
    match answer.verdict {
        // The analysis proves it for all inputs.
        Conclusion::ProvenUnreachable if answer.proven_by == Some(ProofMethod::Analysis) => match is_never {
            true => "proven, it holds in no reachable state".to_string(),
            false => "proven unreachable, it holds in no reachable state".to_string(),
        },
        Conclusion::ProvenUnreachable if is_never => format!("proven, it cannot be violated{asked}"),
        Conclusion::ProvenUnreachable => format!("proven unreachable{asked}"),
        Conclusion::Exhausted if is_never => {
            format!("not answered, no way to break it with axes at -1, 0 and 1{asked}")
        }
        Conclusion::Exhausted => format!("no way with axes at -1, 0 and 1{asked}"),
        Conclusion::NotAnswered if !is_never => "not answered".to_string(),
        Conclusion::NotAnswered => "not answered, no way to break it was found".to_string(),
        Conclusion::Reached | Conclusion::Violated | Conclusion::NotFound | Conclusion::Error => {
            format!("{}{}", answer.verdict.words(), with_luck(answer.luck.as_ref()))
        }
    }
}

/// The class of inputs in which the path is shortest.
fn shortest(answer: &Answer, query: &Query) -> String {
    if answer.is_shortest != Some(true) {
        return "not proven shortest".to_string();
    }
    let axes = if answer.reads_between { " with axes at -1, 0 and 1" } else { "" };
    let hold = match query.min_hold {
        1 => String::new(),
        steps => format!(" by inputs that are held for at least {steps} steps"),
    };
    format!("shortest{axes}{hold}")
}

fn window(SearchWindow { space, left, right, bottom, branches }: &SearchWindow) -> String {
    let branches = if *branches == 1 { "1 branch".to_string() } else { format!("{branches} branches") };
    format!(
        "    {branches} left the search window of `{space}` (x in {left}..{right}, y >= {bottom}), beyond which \
         nothing was searched; add `bounds` to end runs there\n"
    )
}

/// An answer as text. `seconds` is the duration of the search.
pub(super) fn answer_text(answer: &Answer, query: &Query, saved: &Saved, seconds: f64) -> String {
    let mut out = format!("  {} {}: {}\n", answer.kind.name(), answer.goal, verdict(answer, query));
    for reason in answer.reasons.iter().chain(&answer.assumptions) {
        out.push_str(&format!("    {reason}\n"));
    }
    if answer.is_withdrawn {
        out.push_str("    the analysis is wrong about this world, as shown below: its proof is withdrawn\n");
    }
    if let (Some(steps), Some(seconds)) = (answer.steps, answer.seconds_of_play) {
        let (steps, shortest) = (counted(steps, "step"), shortest(answer, query));
        out.push_str(&format!("    path    {steps} ({seconds:.2} s of play), {shortest}\n"));
    }
    if let Some(inputs) = answer.inputs.as_ref().filter(|i| !i.is_empty()) {
        out.push_str(&format!("    inputs  {inputs}\n"));
    }
    if let Some(path) = &saved.inputs {
        out.push_str(&format!("    saved   {}\n", path.display()));
    }
    if let Some(path) = &saved.picture {
        out.push_str(&format!("    drawn   {}\n", path.display()));
    }
    if answer.nodes > 0 {
        out.push_str(&search_text(answer, seconds));
    }
    out
}

/// The statistics of the search, and what a missing answer means.
fn search_text(answer: &Answer, seconds: f64) -> String {
    let (nodes, trees) = (counted(answer.nodes, "node"), counted(answer.trees, "tree"));
    let planner = answer.answered_by.as_deref().unwrap_or_default();
    let mut out = format!(
        "    search  {nodes} in {trees}, {seconds:.3} s; {} of {} extensions failed ({planner})\n",
        answer.failures, answer.extensions
    );
    let is_open = answer.verdict.is_open();
    if is_open {
        let c = &answer.coverage;
        out.push_str(&format!(
            "    covered {} places of {} px, {} combinations of modes, {} of both; in the second half {}, {} and {} of \
             them new\n",
            c.places,
            c.place,
            c.mode_combinations,
            c.places_with_modes,
            c.new_places,
            c.new_mode_combinations,
            c.new_places_with_modes
        ));
    }
    match answer.end {
        End::Stopped => out.push_str("    stopped before the budget of nodes was spent\n"),
        End::Memory => out.push_str("    stopped because the memory is full; `--memory MIB` gives more\n"),
        End::Answered | End::Nodes => {}
    }
    if answer.inputs_left_out {
        out.push_str("    some combinations of buttons were left out: there are too many\n");
    }
    if answer.draws_left_out && is_open {
        out.push_str("    not all that nature can draw was tried\n");
    }
    if !is_open {
        return out;
    }
    if let Some(tried) = answer.exhausted {
        out.push_str(&format!(
            "    inputs that change only every {} steps (axes at -1, 0 and 1) lead to {}, not there; others may\n",
            tried.hold,
            counted(tried.states, "state")
        ));
    }
    answer.windows.iter().for_each(|left| out.push_str(&window(left)));
    out.push_str(&match answer.end {
        // All planners stop at the search window.
        End::Answered if !answer.windows.is_empty() => "    this proves nothing\n".to_string(),
        End::Answered => format!(
            "    this proves nothing; `{planner}` has nothing more to try, another `--planner` may find a way\n"
        ),
        End::Nodes => {
            "    this proves nothing: a longer search (`--nodes N`, `--seconds S`) may find a way\n".to_string()
        }
        End::Memory | End::Stopped => "    this proves nothing: a longer search may find a way\n".to_string(),
    });
    out
}
