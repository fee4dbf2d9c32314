//! An answer of `hypedc reach` as text for people.

use std::io::{self, IsTerminal};

use crate::reach::Conclusion;
use crate::reach::query::{Answer, Kind, ProofMethod, Query, SearchWindow};
use crate::reach::{End, Luck};

use super::files::Saved;
use super::robust::robust_text;
use super::why_not::why_not_text;
use crate::cli::args::ReachArgs;

/// `1 step`, `2 steps`
pub(in crate::cli) fn counted(count: u64, what: &str) -> String {
    format!("{count} {what}{}", if count == 1 { "" } else { "s" })
}

/// How much of an answer is shown.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::cli) enum Detail {
    /// The verdict only.
    Quiet,
    /// All, with scripts cut to so many characters.
    Cut(usize),
    /// All.
    Full,
}

/// The width of a line on a terminal that does not tell its own.
const WIDTH: usize = 100;
/// The indentation of an answer's lines with their first word.
const INDENT: usize = 12;

impl Detail {
    /// What the options ask for, on this standard output.
    pub fn of(args: &ReachArgs) -> Detail {
        if args.quiet {
            return Detail::Quiet;
        }
        Detail::on_terminal(args.verbose)
    }

    /// Whole scripts if they are asked for, else what fits into a line of this standard output.
    pub fn on_terminal(verbose: bool) -> Detail {
        if verbose || !io::stdout().is_terminal() {
            return Detail::Full;
        }
        let told = std::env::var("COLUMNS").ok().and_then(|columns| columns.parse().ok());
        Detail::Cut(told.unwrap_or(WIDTH).max(40) - INDENT)
    }

    /// A script on one line.
    pub fn script(self, inputs: &str) -> String {
        const REST: &str = " … (`--verbose` shows all)";
        let Detail::Cut(width) = self else { return inputs.to_string() };
        if inputs.chars().count() <= width {
            return inputs.to_string();
        }
        let room = width.saturating_sub(REST.chars().count());
        let mut cut = String::new();
        for word in inputs.split(' ') {
            if cut.chars().count() + 1 + word.chars().count() > room {
                break;
            }
            cut.push_str(if cut.is_empty() { "" } else { " " });
            cut.push_str(word);
        }
        cut + REST
    }
}

/// `, with luck: 1 in 36`; nothing if none is needed.
pub(in crate::cli) fn with_luck(luck: Option<&Luck>) -> String {
    luck.filter(|luck| !luck.is_none()).map_or(String::new(), |luck| format!(", with luck: {}", luck.words()))
}

/// When and where a path ends: ` in 2.4 s, step 144, in `cave``; the place only if there are several.
fn when(answer: &Answer, has_rooms: bool) -> String {
    let (Some(steps), Some(seconds)) = (answer.steps, answer.seconds_of_play) else { return String::new() };
    let spaces: Vec<String> = answer.spaces.iter().map(|space| format!("`{space}`")).collect();
    let place = if has_rooms && !spaces.is_empty() { format!(", in {}", spaces.join(" and ")) } else { String::new() };
    format!(" in {seconds:.2} s, step {steps}{place}")
}

/// The class of inputs that were asked about; nothing for all.
fn inputs_words(Shown { query, unpressed, .. }: &Shown<'_>) -> String {
    let hold = match query.min_hold {
        1 => String::new(),
        steps => format!(" by inputs that are held for at least {steps} steps"),
    };
    let without = unpressed.as_ref().map(|buttons| format!(" without {buttons}")).unwrap_or_default();
    hold + &without
}

/// The verdict and what it assumes: the first line of an answer.
fn verdict(answer: &Answer, shown: &Shown<'_>) -> String {
    let &Shown { query, has_rooms, .. } = shown;
    let within = query.within.map(|steps| format!(" within {}", counted(u64::from(steps), "step")));
    let asked = format!("{}{}", within.unwrap_or_default(), inputs_words(shown));
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
            let when = when(answer, has_rooms);
            format!("{}{when}{}", answer.verdict.words(), with_luck(answer.luck.as_ref()))
        }
    }
}

/// The class of inputs in which the path is shortest; if that is not known, how short it could be.
fn shortest(answer: &Answer, shown: &Shown<'_>) -> String {
    if answer.is_shortest != Some(true) {
        // Little is said by a bound that is far away.
        let least = answer.least_steps.filter(|least| answer.steps.is_some_and(|steps| 2 * least >= steps));
        return format!(
            "not proven shortest{}",
            least.map(|of| format!(": it takes at least {of}")).unwrap_or_default()
        );
    }
    let axes = if answer.reads_between { " with axes at -1, 0 and 1" } else { "" };
    format!("shortest{axes}{}", inputs_words(shown))
}

fn window(SearchWindow { space, left, right, bottom, branches }: &SearchWindow) -> String {
    let branches = if *branches == 1 { "1 branch".to_string() } else { format!("{branches} branches") };
    format!(
        "    {branches} left the search window of `{space}` (x in {left}..{right}, y >= {bottom}), beyond which \
         nothing was searched; add `bounds` to end runs there\n"
    )
}

/// What an answer is shown with.
pub(super) struct Shown<'s> {
    pub query: &'s Query,
    /// Buttons that no input may hold, in words.
    pub unpressed: Option<String>,
    pub saved: &'s Saved,
    /// The duration of the search, s.
    pub seconds: f64,
    /// The duration of a step, s.
    pub step: f64,
    /// Whether the world has several spaces.
    pub has_rooms: bool,
    pub detail: Detail,
    /// Whether all is shown that is known.
    pub is_verbose: bool,
}

/// An answer as text.
pub(super) fn answer_text(answer: &Answer, shown: &Shown<'_>) -> String {
    let Shown { query, saved, seconds, step, has_rooms, detail, is_verbose, .. } = *shown;
    let mut out = format!("  {} {}: {}\n", answer.kind.name(), answer.goal, verdict(answer, shown));
    if detail == Detail::Quiet {
        return out;
    }
    for reason in answer.reasons.iter().chain(&answer.assumptions) {
        out.push_str(&format!("    {reason}\n"));
    }
    if answer.is_withdrawn {
        out.push_str("    the analysis is wrong about this world, as shown below: its proof is withdrawn\n");
    }
    if let Some(steps) = answer.steps {
        out.push_str(&format!("    path    {}, {}\n", counted(steps, "step"), shortest(answer, shown)));
    }
    if let Some(inputs) = answer.inputs.as_ref().filter(|i| !i.is_empty()) {
        out.push_str(&format!("    inputs  {}\n", detail.script(inputs)));
    }
    out.push_str(&why_not_text(answer, query, detail, is_verbose, has_rooms));
    match &answer.robust {
        Some(robust) => out.push_str(&robust_text(robust, step, has_rooms, is_verbose)),
        None if query.errors.is_some() && answer.inputs.is_some() => {
            out.push_str("    success not measured: it was stopped before\n");
        }
        None => {}
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
            "    covered {} of {} px, {} of modes, {} of both; in the second half {}, {} and {} of them new\n",
            counted(c.places, "place"),
            c.place,
            counted(c.mode_combinations, "combination"),
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
    if let Some(visit) = answer.unfinished {
        let without = match visit.left_out {
            0 => String::new(),
            1 => ", without 1 instance that can act only by contacts".to_string(),
            more => format!(", without {more} instances that can act only by contacts"),
        };
        out.push_str(&format!(
            "    all states within {} were visited{without}: {}\n",
            counted(u64::from(visit.steps), "step"),
            counted(visit.states, "state")
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scripts_are_cut_between_words() {
        let long = "right*40 jump*12 ".repeat(20);
        let long = long.trim_end();
        assert_eq!(Detail::Full.script(long), long);
        assert_eq!(Detail::Cut(60).script("right*40 jump*12"), "right*40 jump*12");
        let cut = Detail::Cut(60).script(long);
        assert_eq!(cut, "right*40 jump*12 right*40 jump*12 … (`--verbose` shows all)");
        assert!(cut.chars().count() <= 60);
    }
}
