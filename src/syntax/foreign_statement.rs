//! Statements that other languages write differently: instances outside of `place`, edges that end in removal. Also what
//! a world or a space consists of, for a statement that resembles nothing.

use super::Rule;
use super::foreign::{begins_with_capital, with_first};
use super::likely_fix::{Failure, LikelyFix, word};

/// The most likely fix of a statement in an unknown form.
pub(super) fn foreign_statement(failed: &Failure<'_>) -> Option<LikelyFix> {
    instance(failed).or_else(|| removal(failed))
}

/// `hero: Hero(…)`, `hero = Hero`, `Hero at (0, 0)`, `spawn Hero(…)`: an instance without `place`.
fn instance(failed: &Failure<'_>) -> Option<LikelyFix> {
    let is_space = failed.rule == Rule::only_space_item;
    if !(is_space || failed.rule == Rule::only_world_item) || failed.at > 0 {
        return None;
    }
    let first = failed.first_word();
    let verbs = ["spawn", "instance", "new", "add", "put", "create", "object", "entity"];
    let written = match failed.slice.strip_prefix(first).map(str::trim_start) {
        Some(rest) if verbs.contains(&first) => rest,
        _ => failed.slice,
    };
    let name = word(written);
    let rest = written.strip_prefix(name)?.trim_start();
    let named =
        rest.strip_prefix([':', '=']).map(|rest| word(rest.trim_start())).filter(|entity| begins_with_capital(entity));
    let (name, entity) = match named {
        Some(entity) if !name.is_empty() => (name.to_string(), entity),
        _ if begins_with_capital(name) && (rest.is_empty() || rest.starts_with(['(', '{']) || word(rest) == "at") => {
            (with_first(name, |c| c.to_lowercase().collect()), name)
        }
        _ => return None,
    };
    let point = written.split_once('(').and_then(|(_, rest)| rest.split_once(')')).map(|(point, _)| point.trim());
    let is_number = |number: &str| number.trim().parse::<f64>().is_ok();
    let is_point = |point: &&str| point.split_once(',').is_some_and(|(x, y)| is_number(x) && is_number(y));
    let placed = format!("place {name}: {entity} at ({})", point.filter(is_point).unwrap_or("0, 0"));
    Some(LikelyFix::new(match is_space {
        true => format!("an instance is placed: `{placed}`"),
        false => format!("an instance is placed in a space: `space main {{ {placed} }}`"),
    }))
}

/// `-> destroy`, `-> { … }`, or `destroy` that does not say what.
fn removal(failed: &Failure<'_>) -> Option<LikelyFix> {
    let before = failed.before().trim_end();
    if failed.rule == Rule::only_update && failed.first_word() == "destroy" && failed.found.is_empty() {
        let end = before.len();
        return Some(LikelyFix::replacement("what is removed is named: `destroy self`", end..end, " self"));
    }
    let without_arrow = before.strip_suffix("->").filter(|_| failed.rule == Rule::only_member)?;
    let arrow = without_arrow.trim_end().len();
    match failed.found {
        "destroy" => Some(LikelyFix::replacement(
            "an edge that removes its instance has no target: `when GUARD { destroy self }`",
            arrow..failed.slice.len(),
            " { destroy self }",
        )),
        "{" => {
            let help = "an edge that stays in its mode has no `->`: `when GUARD { UPDATES }`";
            Some(LikelyFix::replacement(help, arrow..failed.at, " "))
        }
        _ => None,
    }
}

/// What a world or a space consists of.
pub(super) fn statements(failed: &Failure<'_>, opening: &[&'static str]) -> Option<LikelyFix> {
    let whole = match failed.rule {
        Rule::only_world_item => "a world",
        Rule::only_space_item => "a space",
        _ => return None,
    };
    if failed.at > 0 || failed.slice.is_empty() {
        return None;
    }
    let mut words = opening.iter().map(|word| format!("`{word}`")).collect::<Vec<_>>();
    let last = words.pop()?;
    Some(LikelyFix::new(format!("{whole} consists of {} and {last}", words.join(", "))))
}
