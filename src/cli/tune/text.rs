//! The result of `hypedc tune` as text for people.

use crate::reach::{Conclusion, Luck};
use crate::tabular::{Cell, Column, Table};
use crate::tune::{Axis, Change, Part, Trial};

use crate::cli::reach::{ScriptDetail, with_luck};

use super::args::TuneArgs;
use super::result::TuneResult;

/// What paths must keep to, as it follows in the first line.
pub(super) fn limits(args: &TuneArgs) -> String {
    let without = args.without.as_ref().map_or(String::new(), |predicate| format!(", without {predicate}"));
    let within = args.within.map_or(String::new(), |time| format!(", within {time}"));
    let after = match args.after.as_slice() {
        [] => String::new(),
        [only] => format!(", after {only}"),
        several => format!(", after {} scripts", several.len()),
    };
    let hold = args.min_hold.map_or(String::new(), |time| format!(", inputs held for at least {time}"));
    format!("{without}{within}{after}{hold}")
}

pub(super) fn result_text(result: &TuneResult, args: &TuneArgs) -> String {
    let TuneResult { file, world, seed, goal, .. } = result;
    let set: String = result.set.iter().map(|set| format!(", {set}")).collect();
    let axes: Vec<String> = result.numbers.iter().map(range).collect();
    let mut out = format!("{file}, world {world}, seed {seed}{set}{}: {}\n", limits(args), axes.join(", "));
    match (&result.change, result.trials.first()) {
        (Some(change), _) => out.push_str(&change_text(result, change, args.verbose)),
        (None, Some(base)) if result.is_wanted_already => {
            out.push_str(&format!("  goal {goal}: {} as it is, with {}\n", verdict(base), settings(result, base)));
            out.push_str(match result.prevent {
                true => "    nothing needs to change\n",
                false => "    nothing needs to change; `--prevent` seeks a change with which it cannot be reached\n",
            });
        }
        (None, Some(base)) => {
            out.push_str(&format!("  goal {goal}: {} as it is, with {}\n", verdict(base), settings(result, base)));
            out.push_str(&format!("    no change was found with which it is {}\n", wanted(result)));
            out.push_str(&parts_text(result));
        }
        (None, None) => {}
    }
    if result.trials.len() > 1 {
        out.push_str(&table(result));
        out.push_str("  of values between these nothing is known, except in a part that is proven\n");
    }
    out.extend(errors(result));
    if let Some(refuted) = &result.refuted {
        out.push_str(&refuted.human());
    }
    let inputs = result.change.is_some();
    let files = [(&args.csv, "table", true), (&args.svg, "drawn", true), (&args.save_inputs, "saved", inputs)];
    for (path, what, _) in files.into_iter().filter(|(.., is_written)| *is_written) {
        out.extend(path.as_ref().map(|path| format!("  {what}  {}\n", path.display())));
    }
    if result.stopped {
        out.push_str(&format!("  stopped after {} values\n", result.trials.len()));
    }
    out
}

/// `Hero.jump_speed 100 to 400`
fn range(axis: &Axis) -> String {
    format!("{} {} to {}{}", axis.name, Axis::text(axis.low), Axis::text(axis.high), axis.unit)
}

/// What is sought.
fn wanted(result: &TuneResult) -> &'static str {
    if result.prevent { "proven unreachable" } else { "reached" }
}

/// The values of a trial: `Hero.jump_speed = 240`.
fn settings(result: &TuneResult, trial: &Trial) -> String {
    let values = result.numbers.iter().zip(&trial.values);
    let one = |(axis, value): (&Axis, &f64)| format!("{} = {}{}", axis.name, Axis::text(*value), axis.unit);
    values.map(one).collect::<Vec<_>>().join(", ")
}

/// A verdict, with the time and the luck of its path.
pub(super) fn timed_verdict(verdict: Conclusion, path: (Option<f64>, Option<u64>), luck: Option<&Luck>) -> String {
    match path {
        (Some(seconds), Some(steps)) => {
            format!("{} in {seconds:.2} s, step {steps}{}", verdict.words(), with_luck(luck))
        }
        _ => verdict.words().to_string(),
    }
}

/// The verdict of a trial.
fn verdict(trial: &Trial) -> String {
    timed_verdict(trial.verdict, (trial.seconds_of_play, trial.steps), trial.luck.as_ref())
}

/// The values of a trial of the numbers that a change concerns: `251`, `gravity = -900, Hero.jump = 251`.
fn values(result: &TuneResult, of: &Trial, changed: &[usize]) -> String {
    let value = |at: &usize| {
        let (axis, value) = (&result.numbers[*at], of.values[*at]);
        match changed.len() {
            1 => format!("{}{}", Axis::text(value), axis.unit),
            _ => format!("{} = {}{}", axis.name, Axis::text(value), axis.unit),
        }
    };
    changed.iter().map(value).collect::<Vec<_>>().join(", ")
}

fn change_text(result: &TuneResult, change: &Change, is_verbose: bool) -> String {
    let (base, trial) = (&result.trials[0], &result.trials[change.trial]);
    let changed: Vec<usize> = (0..base.values.len()).filter(|at| base.values[*at] != trial.values[*at]).collect();
    let mut out = String::new();
    for at in &changed {
        let axis = &result.numbers[*at];
        let (from, to) = (base.values[*at], trial.values[*at]);
        let relative = match from {
            0.0 => String::new(),
            _ => format!(" ({:+.1} %)", 100.0 * (to - from) / from.abs()),
        };
        out.push_str(&format!("  {}  {} -> {}{}{relative}\n", axis.name, Axis::text(from), Axis::text(to), axis.unit));
    }
    out.push_str(&format!("  goal {}: {}\n", result.goal, verdict(trial)));
    for never in &trial.nevers {
        let what = match never.verdict {
            Conclusion::ProvenUnreachable => "proven: it never holds",
            _ => "no way to break it was found, which proves nothing",
        };
        out.push_str(&format!("    never {}: {what}\n", never.name));
    }
    let script = |inputs: &String| format!("    inputs    {}\n", ScriptDetail::on_terminal(is_verbose).script(inputs));
    out.extend(trial.inputs.as_ref().map(script));
    out.extend(trial.reasons.iter().map(|reason| format!("    why       {reason}\n")));
    out.push_str(&format!("    as it is  {}\n", verdict(base)));
    if change.before != 0 {
        let before = &result.trials[change.before];
        out.push_str(&format!("    next      at {}: {}\n", values(result, before, &changed), not_wanted(before)));
    }
    out.push_str(&smallest(result, change, &changed));
    out.push_str(&parts_text(result));
    let set: Vec<String> = result.change_set.iter().map(|set| format!("--set {set}")).collect();
    out.push_str(&format!("    go on     {}\n", set.join(" ")));
    out
}

/// What is known of smaller changes.
fn smallest(result: &TuneResult, change: &Change, changed: &[usize]) -> String {
    let (Some(at), true) = (changed.first(), change.is_proven_smallest) else {
        return "    smallest  of what was tried; it is not proven that no smaller change is enough\n".to_string();
    };
    let axis = &result.numbers[*at];
    let far = axis.size(result.trials[change.before].values[*at]);
    let of = if result.numbers.len() > 1 { " of one of the numbers" } else { "" };
    match axis.base {
        0.0 => format!("    smallest  proven: no smaller change{of} is enough, up to the value before\n"),
        _ => format!("    smallest  proven: a change{of} of up to {:.1} % is not enough\n", 100.0 * far),
    }
}

/// Why a trial is not the wanted answer.
fn not_wanted(trial: &Trial) -> String {
    let broken = trial.nevers.iter().find(|never| never.verdict == Conclusion::Violated);
    match broken {
        Some(never) => format!("{}, but never {} is violated", verdict(trial), never.name),
        None => verdict(trial),
    }
}

fn parts_text(result: &TuneResult) -> String {
    result.parts.iter().filter(|part| part.from < part.to).map(|part| part_text(result, part)).collect()
}

fn part_text(result: &TuneResult, part: &Part) -> String {
    let axis = &result.numbers[part.number];
    let others = match result.numbers.len() {
        1 => String::new(),
        _ => format!(" of {}, the others as they are,", axis.name),
    };
    let (from, to) = (Axis::text(part.from), Axis::text(part.to));
    format!("    proven    unreachable for all values{others} from {from} to {to}{}\n", axis.unit)
}

/// A row for each value, in order of the numbers.
fn table(result: &TuneResult) -> String {
    let mut columns: Vec<Column> = result.numbers.iter().map(|axis| Column::right("", axis.name.clone())).collect();
    columns.extend([Column::left("", "verdict"), Column::right("", "steps"), Column::right("", "seconds of play")]);
    columns.extend([Column::right("", "nodes"), Column::left("", "how")]);
    let mut table = Table::new(columns);
    let mut order: Vec<&Trial> = result.trials.iter().collect();
    order.sort_by(|a, b| {
        let pairs = a.values.iter().zip(&b.values).map(|(a, b)| a.total_cmp(b));
        pairs.fold(std::cmp::Ordering::Equal, std::cmp::Ordering::then)
    });
    for trial in order {
        let mut cells: Vec<Cell> = trial.values.iter().map(|value| Axis::text(*value).into()).collect();
        let all: Vec<usize> = (0..trial.values.len()).collect();
        let how = match (trial.path_of, &trial.proven_by, trial.verdict) {
            (Some(of), ..) => format!("the way of {}", values(result, &result.trials[of], &all)),
            (_, Some(by), _) => by.name().to_string(),
            (.., Conclusion::Reached | Conclusion::Violated) => "search".to_string(),
            _ => String::new(),
        };
        cells.extend([
            trial.verdict.words().into(),
            Cell::of(trial.steps.map(|steps| steps as f64), |steps| format!("{steps:.0}")),
            Cell::of(trial.seconds_of_play, |seconds| format!("{seconds:.2}")),
            Cell::of(Some(trial.nodes as f64), |nodes| format!("{nodes:.0}")),
            how.into(),
        ]);
        table.push(cells);
    }
    table.text()
}

/// What is wrong with the program with some values, each once.
fn errors(result: &TuneResult) -> Vec<String> {
    let mut errors: Vec<String> = Vec::new();
    for error in result.trials.iter().filter_map(|trial| trial.error.as_ref()) {
        let line = format!("error: {error}\n");
        if !errors.contains(&line) {
            errors.push(line);
        }
    }
    errors
}
