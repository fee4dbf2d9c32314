//! The sentences about figures that text and Markdown share: how players move.

use crate::diff::{FigureChange, Figures, Jump, PlayerChange, Press, Speed};

use crate::cli::reach::counted;

use super::result::{DiffResult, WorldFigures};
use super::words::px;

/// Maximum number of modes that a line names.
const MAX_MODES: usize = 4;

fn seconds(number: f64) -> String {
    format!("{number:.2}")
}

/// `a → b`, or one of them if they read the same.
fn arrow(old: &str, new: &str) -> String {
    if old == new { new.to_string() } else { format!("{old} → {new}") }
}

/// What differs of the players: a heading each, and lines in two columns.
pub(super) fn figure_changes(result: &DiffResult) -> Vec<(String, Vec<(String, String)>)> {
    let has_worlds = result.figures.len() > 1;
    let of_world = |of: &WorldFigures| {
        let world = if has_worlds { format!(", world {}", of.world) } else { String::new() };
        let figures = if of.new.is_empty() { &of.old } else { &of.new };
        let player = |change: &PlayerChange| {
            let lines = jump_lines(change).into_iter().chain(speed_lines(change)).collect();
            (format!("{}{world}", player_words(change, figures)), lines)
        };
        of.changes.iter().map(player).collect::<Vec<_>>()
    };
    result.figures.iter().flat_map(of_world).collect()
}

/// `hero on flat ground (rock): 4 of 12 jumps differ`
fn player_words(change: &PlayerChange, figures: &[Figures]) -> String {
    let name = &change.instance;
    match change.stands {
        [true, false] => {
            return format!("{name} does not stand or jump on flat ground any more: nothing was measured");
        }
        [false, true] => return format!("{name} stands or jumps on flat ground now, and did not: nothing to compare"),
        _ => {}
    }
    let ground = figures.iter().find(|figures| figures.player == change.player).map(|of| of.ground.join(", "));
    let jumps = match change.jumps.len() {
        0 => "no jump differs".to_string(),
        1 => format!("1 of {} differs", counted(change.compared as u64, "jump")),
        count => format!("{count} of {} differ", counted(change.compared as u64, "jump")),
    };
    format!("{name} on flat ground ({}): {jumps}", ground.unwrap_or_default())
}

/// What differs of a jump.
fn jump_words(old: &Jump, new: &Jump) -> String {
    let mut parts = vec![format!("rises {} px", arrow(&px(old.rise), &px(new.rise)))];
    let landing = |jump: &Jump| jump.length.zip(jump.seconds);
    match (landing(old), landing(new)) {
        (Some((far, long)), Some((far_now, long_now))) => {
            if far > 0.05 || far_now > 0.05 {
                parts.push(format!("lands {} px away", arrow(&px(far), &px(far_now))));
            }
            parts.push(format!("{} s in the air", arrow(&seconds(long), &seconds(long_now))));
        }
        (Some(_), None) => parts.push("does not land any more within 20 s".to_string()),
        (None, Some((far, long))) => {
            parts.push(format!("lands {} px away after {} s, and did not", px(far), seconds(long)));
        }
        (None, None) => parts.push("does not land within 20 s".to_string()),
    }
    if new.running && px(old.speed) != px(new.speed) {
        parts.push(format!("from {} px/s", arrow(&px(old.speed), &px(new.speed))));
    }
    parts.join(", ")
}

/// Jumps by one input that have something in common.
#[derive(Clone, PartialEq)]
struct JumpNames<'j> {
    input: &'j str,
    presses: Vec<&'static str>,
    /// From standing, or running.
    starts: Vec<&'static str>,
    with: Vec<&'j str>,
}

impl<'j> JumpNames<'j> {
    fn of(jump: &'j Jump) -> Self {
        let press = match jump.press {
            Press::Held => "held",
            Press::Tapped => "tapped",
            Press::Released => "let go after 1 s",
        };
        let start = if jump.running { "running" } else { "from standing" };
        let with = if jump.with.is_empty() { Vec::new() } else { vec![jump.with.as_str()] };
        JumpNames { input: &jump.input, presses: vec![press], starts: vec![start], with }
    }

    /// `jump held or tapped, from standing or running, with left or right`
    fn text(&self) -> String {
        let mut text = format!("{} {}, {}", self.input, self.presses.join(" or "), self.starts.join(" or "));
        if !self.with.is_empty() {
            let comma = if self.starts == ["running"] { "" } else { "," };
            text.push_str(&format!("{comma} with {}", self.with.join(" or ")));
        }
        text
    }
}

/// Joins names that differ in one respect only.
fn join_by<'j, T: Clone + PartialEq>(
    names: Vec<JumpNames<'j>>,
    part: impl for<'n> Fn(&'n mut JumpNames<'j>) -> &'n mut Vec<T>,
) -> Vec<JumpNames<'j>> {
    let mut joined: Vec<JumpNames<'j>> = Vec::new();
    for mut name in names {
        let more = std::mem::take(part(&mut name));
        let rest = name;
        let found = joined.iter_mut().find(|known| {
            let mut known = (*known).clone();
            let is_empty = std::mem::take(part(&mut known)).is_empty();
            known == rest && !is_empty && !more.is_empty()
        });
        match found {
            Some(known) => part(known).extend(more),
            None => {
                let mut name = rest;
                *part(&mut name) = more;
                joined.push(name);
            }
        }
    }
    joined
}

/// The jumps that differ, a line each; those with the same change share one.
fn jump_lines(change: &PlayerChange) -> Vec<(String, String)> {
    let mut lines: Vec<(Vec<JumpNames<'_>>, String)> = Vec::new();
    for FigureChange { old, new } in &change.jumps {
        let (jump, what) = match (old, new) {
            (Some(old), Some(new)) => (new, jump_words(old, new)),
            (Some(old), None) => (old, "does not lead off the ground any more".to_string()),
            (None, Some(new)) => (new, format!("leads off the ground now, and did not: {}", jump_words(new, new))),
            (None, None) => continue,
        };
        match lines.iter_mut().find(|(_, known)| *known == what) {
            Some((names, _)) => names.push(JumpNames::of(jump)),
            None => lines.push((vec![JumpNames::of(jump)], what)),
        }
    }
    let line = |(names, what)| {
        let names = join_by(names, |name| &mut name.presses);
        let names = join_by(names, |name| &mut name.starts);
        let names = join_by(names, |name| &mut name.with);
        (names.iter().map(JumpNames::text).collect::<Vec<_>>().join("; "), what)
    };
    lines.into_iter().map(line).collect()
}

/// The speeds that differ, a line each; modes with the same change share one.
fn speed_lines(change: &PlayerChange) -> Vec<(String, String)> {
    let mut lines: Vec<(Vec<&str>, String)> = Vec::new();
    for FigureChange { old, new } in &change.speeds {
        let (Some(old), Some(new)): (&Option<Speed>, &Option<Speed>) = (old, new) else { continue };
        let axes = [("sideways", old.sideways, new.sideways), ("up", old.up, new.up), ("down", old.down, new.down)];
        let other = axes.iter().map(|(word, old, new)| (word, px(*old), px(*new))).filter(|(_, old, new)| old != new);
        let parts: Vec<String> = other.map(|(word, old, new)| format!("{word} {old} → {new}")).collect();
        if parts.is_empty() {
            continue;
        }
        let what = format!("{} px/s", parts.join(", "));
        match lines.iter_mut().find(|(_, known)| *known == what) {
            Some((modes, _)) => modes.push(&new.mode),
            None => lines.push((vec![&new.mode], what)),
        }
    }
    let line = |(modes, what): (Vec<&str>, String)| {
        let more = match modes.len().saturating_sub(MAX_MODES) {
            0 => String::new(),
            more => format!(" and {}", counted(more as u64, "more mode")),
        };
        let shown: Vec<&str> = modes.into_iter().take(MAX_MODES).collect();
        (format!("top speed in {}{more}", shown.join(", ")), what)
    };
    lines.into_iter().map(line).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn change(press: Press, with: &str, running: bool, rise: f64) -> FigureChange<Jump> {
        let jump = |rise| Jump {
            input: "jump".into(),
            press,
            with: with.into(),
            running,
            speed: 0.0,
            rise,
            length: Some(0.0),
            seconds: Some(0.5),
        };
        FigureChange { old: Some(jump(10.0)), new: Some(jump(rise)) }
    }

    #[test]
    fn jumps_with_the_same_change_share_a_line() {
        let mut jumps = Vec::new();
        for press in [Press::Held, Press::Tapped] {
            jumps.push(change(press, "", false, 12.0));
            for with in ["left", "right"] {
                jumps.extend([false, true].map(|running| change(press, with, running, 12.0)));
            }
        }
        jumps.push(change(Press::Held, "dash", true, 14.0));
        let change = PlayerChange {
            player: 1,
            instance: "hero".into(),
            stands: [true; 2],
            compared: 9,
            jumps,
            speeds: Vec::new(),
        };
        let names: Vec<String> = jump_lines(&change).into_iter().map(|(name, _)| name).collect();
        let all = "jump held or tapped, from standing; \
                   jump held or tapped, from standing or running, with left or right";
        assert_eq!(names, [all, "jump held, running with dash"]);
    }
}
