//! Text of values in tables and proofs: `= 32`, `{-30, 30}`, `[0, 640]`, `>= 0`.

use crate::analysis::domain::values::{Interval, Values};

/// Maximum length of a text in characters; a longer one is shortened to its hull.
const MAX_LENGTH: usize = 26;

/// A number with at most three digits after the point.
pub fn number(x: f64) -> String {
    Interval::point(x).to_string()
}

fn interval(i: &Interval) -> String {
    let (low, high) = (number(i.low), number(i.high));
    match (i.low == f64::NEG_INFINITY, i.high == f64::INFINITY) {
        (true, true) => "any".to_string(),
        (true, false) => format!("<= {high}"),
        (false, true) => format!(">= {low}"),
        // Two ends that differ by less than a thousandth print the same.
        _ if low == high => low,
        _ => format!("[{low}, {high}]"),
    }
}

/// The right side of a relation.
pub fn values(values: &Values) -> String {
    let texts: Vec<String> = values.intervals().iter().map(interval).collect();
    let points = texts.iter().all(|t| !t.contains(['[', '=', 'y']));
    let all = match texts.as_slice() {
        [] => "none".to_string(),
        [only] if points => format!("= {only}"),
        [only] => only.clone(),
        _ if points => format!("{{{}}}", texts.join(", ")),
        _ => texts.join(" or "),
    };
    match values.hull() {
        Some(hull) if all.len() > MAX_LENGTH => format!("{} with gaps", interval(&hull)),
        _ => all,
    }
}

/// A relation between a named number and its values: `ball.y in [0, 64]`.
pub fn relation(name: &str, of: &Values) -> String {
    match values(of) {
        all if all.starts_with(['[', '{']) => format!("{name} in {all}"),
        all if all.starts_with(|c: char| c == '-' || c.is_ascii_digit()) => format!("{name} is {all}"),
        all => format!("{name} {all}"),
    }
}
