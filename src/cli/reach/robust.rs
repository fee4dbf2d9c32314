//! How robust a path is, as text for people.

use crate::reach::query::{ChangeRecord, RobustRecord, SuccessRecord};

/// Maximum number of moments that are listed, unless all are.
const MAX_MOMENTS: usize = 5;

/// The lines under a path. `step` is the duration of a step, s.
pub(super) fn robust_text(robust: &RobustRecord, step: f64, has_rooms: bool, lists_all: bool) -> String {
    let errors = format!("{:.3}", robust.sigma);
    let errors = errors.trim_end_matches('0').trim_end_matches('.');
    let steps = if errors == "1" { "step" } else { "steps" };
    let success = &robust.success;
    let mut out = format!(
        "    success {} with timing errors of {errors} {steps} ({:.1} ms)\n",
        success_words(success),
        robust.sigma * step * 1000.0
    );
    out.push_str(&format!(
        "            estimated from {} plays; the goal may hold up to {} s late\n",
        success.trials, robust.slack
    ));
    if let Some(first) = &robust.first {
        out.push_str(&format!(
            "            the way found first, {} steps, has {}; {} ways compared\n",
            first.steps,
            success_words(&first.success),
            robust.compared
        ));
    }
    let Some(hardest) = robust.hardest.and_then(|index| robust.changes.get(index)) else {
        out.push_str("    timing  no single moment needs timing\n");
        return out;
    };
    out.push_str(&format!(
        "    hardest {}: {}; with errors of it alone {} succeed\n",
        moment(hardest, has_rooms),
        hardest.window(),
        percent(hardest.alone)
    ));
    let mut others: Vec<&ChangeRecord> = robust.changes.iter().filter(|change| change.needs_timing()).collect();
    let (all, count) = (robust.changes.len(), others.len());
    let shown = if lists_all { count } else { MAX_MOMENTS };
    others.sort_by(|a, b| a.alone.total_cmp(&b.alone).then(a.step.cmp(&b.step)));
    others.truncate(shown);
    others.sort_by_key(|change| change.step);
    let rest =
        if shown < count { format!(", the hardest {shown} of them (`--verbose` shows all)") } else { String::new() };
    out.push_str(&format!("    windows {count} of {all} changes need timing, in steps{rest}\n"));
    for change in others {
        out.push_str(&format!("            {}: {}\n", moment(change, has_rooms), change.window()));
    }
    out
}

/// `83.1 % (82.3 to 83.8 %)`
pub(super) fn success_words(success: &SuccessRecord) -> String {
    let [low, high] = success.success_95.map(|share| format!("{:.1}", 100.0 * share));
    format!("{} ({low} to {high} %)", percent(success.success))
}

fn percent(share: f64) -> String {
    format!("{:.1} %", 100.0 * share)
}

/// `jump pressed at 1.20 s, x = 310, y = 32`
fn moment(change: &ChangeRecord, has_rooms: bool) -> String {
    let room = change.space.as_ref().filter(|_| has_rooms).map_or(String::new(), |space| format!(" in `{space}`"));
    let at = change.at.map_or(String::new(), |[x, y]| format!(", x = {x:.0}, y = {y:.0}{room}"));
    format!("{} at {:.2} s{at}", change.what, change.seconds)
}
