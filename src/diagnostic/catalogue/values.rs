//! Facts from the analysis of the values in a running world.

use crate::diagnostic::suggestion::BlockKind;
use crate::diagnostic::{Code, Diagnostic, Fact};
use crate::source::Span;

/// The reason for the value of a guard.
pub struct Reason {
    /// The part of the guard that decides.
    pub at: Span,
    /// Its text, if it is short.
    pub text: Option<String>,
    /// The values of its operands, if they are informative.
    pub values: Option<String>,
    /// The values per mode, where they differ.
    pub notes: Vec<String>,
}

impl Reason {
    fn name(&self) -> String {
        self.text.as_ref().map_or("this guard".to_string(), |text| format!("`{text}`"))
    }
}

/// A guard that is constant for the reachable values.
pub struct GuardByValue {
    /// Whether it always holds, or never.
    pub holds: bool,
    /// The reason.
    pub reason: Reason,
}

impl Fact for GuardByValue {
    fn into_diagnostic(self) -> Diagnostic {
        let GuardByValue { holds, reason } = self;
        let (verb, help) = match holds {
            true => ("always holds", "write `true` if that is meant"),
            false => ("never holds", "compare with a value that is reached, or remove what can never happen"),
        };
        let d = Diagnostic::new(Code::GuardByValue, format!("{} {verb}", reason.name()));
        let d = d.at(reason.at, reason.values.unwrap_or_else(|| verb.to_string()));
        let d = if holds { d.or_write(reason.at, "true") } else { d.or_remove("what never happens", reason.at) };
        reason.notes.into_iter().fold(d.help(help), Diagnostic::note)
    }
}

/// A mode that is unreachable for the reachable values.
pub struct ModeByValue {
    /// Its path.
    pub path: String,
    /// Its name.
    pub at: Span,
    /// The edges that lead to it, each with the reason why it is never taken.
    pub reasons: Vec<Reason>,
    /// Modes that can only be entered from it.
    pub after: Vec<String>,
}

impl Fact for ModeByValue {
    fn into_diagnostic(self) -> Diagnostic {
        let d = Diagnostic::new(Code::ModeByValue, format!("the mode `{}` is never entered", self.path));
        let d = match self.reasons.len() {
            1 => d.at(self.at, "the edge that leads here is never taken"),
            _ => d.at(self.at, "the edges that lead here are never taken"),
        };
        let d = self.reasons.into_iter().take(4).fold(d, |d, reason| {
            let values = reason.values.map_or(String::new(), |values| format!(": {values}"));
            let d = d.and(reason.at, format!("never holds{values}"));
            reason.notes.into_iter().fold(d, Diagnostic::note)
        });
        let quoted: Vec<String> = self.after.iter().map(|path| format!("`{path}`")).collect();
        match quoted.as_slice() {
            [] => d,
            [_] => d.note(format!("so {} is never entered either", super::list(&quoted, "and"))),
            _ => d.note(format!("so {} are never entered either", super::list(&quoted, "and"))),
        }
    }
}

/// An invariant that is violated in the initial state.
pub struct Broken {
    /// The invariant.
    pub at: Span,
    /// The values of its operands, if they are informative.
    pub values: Option<String>,
    /// The instance, and where it is placed.
    pub instance: (String, Span),
}

impl Fact for Broken {
    fn into_diagnostic(self) -> Diagnostic {
        let (name, placed) = self.instance;
        let what = self.values.unwrap_or_else(|| "does not hold".to_string());
        Diagnostic::new(Code::BrokenAtStart, format!("this invariant does not hold for `{name}` at the start"))
            .at(self.at, format!("at the start {what}"))
            .and(placed, "placed here")
    }
}

/// A goal that holds in no state.
pub struct GoalByValue {
    /// Its name.
    pub name: String,
    /// Its name in the text.
    pub at: Span,
    /// The parts of its predicate that decide this, with the values that they read.
    pub reasons: Vec<(Span, String)>,
}

impl Fact for GoalByValue {
    fn into_diagnostic(self) -> Diagnostic {
        let d = Diagnostic::new(Code::GoalByValue, format!("the goal `{}` is never reached", self.name));
        let d = d.at(self.at, "proven: it holds in no state, whatever the inputs");
        let d = self.reasons.into_iter().fold(d, |d, (at, reason)| d.and(at, reason));
        d.or_remove("the goal", self.at)
            .help("`hypedc reach` tells how near the world comes to it, and what bars the way")
    }
}

/// An invariant that is not proven.
pub struct Unproven {
    /// The invariant.
    pub at: Span,
    /// The values of its operands where it may be violated, if they are informative.
    pub values: Option<String>,
    /// The modes in which it may be violated, and the places of their names.
    pub modes: Vec<(String, Span)>,
    /// The instance.
    pub instance: String,
}

impl Fact for Unproven {
    fn into_diagnostic(self) -> Diagnostic {
        let Unproven { at, values, modes, instance } = self;
        let quoted: Vec<String> = modes.iter().map(|(path, _)| format!("`{path}`")).collect();
        let place = if quoted.is_empty() { String::new() } else { format!("in {}, ", super::list(&quoted, "and")) };
        let what = values.map_or("it may not hold".to_string(), |values| format!("it may break where {values}"));
        let d = Diagnostic::new(Code::UnprovenInvariant, format!("this invariant is not proven for `{instance}`"))
            .at(at, format!("{place}{what}"));
        let d = modes.into_iter().fold(d, |d, (_, span)| d.and(span, "in this mode"));
        d.help("bound what it reads, by a `clamp` or in a guard, so that the values show that it holds")
            .note("a run in which it breaks is reported, too (E0604)")
    }
}

/// An invariant without a verdict: there is no instance, or the analysis gave up.
pub struct Unknown {
    /// The invariant.
    pub at: Span,
    /// The instance, if there is one.
    pub instance: Option<String>,
    /// The reason.
    pub why: String,
    /// A way out.
    pub help: String,
}

impl Fact for Unknown {
    fn into_diagnostic(self) -> Diagnostic {
        let whose = self.instance.map_or(String::new(), |name| format!(" for `{name}`"));
        Diagnostic::new(Code::UnprovenInvariant, format!("this invariant is not proven{whose}"))
            .at(self.at, self.why)
            .help(self.help)
            .note("a run in which it breaks is reported, too (E0604)")
    }
}

/// A discrete variable that an update can push out of its range, by the values of the operands.
pub struct LeavesRange {
    /// The variable.
    pub name: String,
    /// Its range.
    pub range: (i32, i32),
    /// Where it is declared.
    pub declared: Span,
    /// The new value.
    pub at: Span,
    /// The new value: `is from 3 to 12`.
    pub value: String,
    /// Whether it is always outside the range.
    pub always: bool,
    /// The mode in which it happens.
    pub mode: String,
    /// The values of its operands, if they are informative.
    pub reads: Option<String>,
}

impl Fact for LeavesRange {
    fn into_diagnostic(self) -> Diagnostic {
        let LeavesRange { name, range: (low, high), declared, at, value, always, mode, reads } = self;
        let verb = if always { "leaves" } else { "may leave" };
        let d = Diagnostic::new(Code::LeavesRange, format!("`{name}` {verb} its range, {low} to {high}"))
            .at(at, format!("in `{mode}` this {value}"))
            .and(declared, "declared here")
            .help(format!("write `clamp(…, {low}, {high})`, or a wider range"))
            .or_wrap(format!("write `clamp(…, {low}, {high})`"), at, "clamp(", &format!(", {low}, {high})"))
            .note("a value out of its range stops the run");
        reads.into_iter().fold(d, Diagnostic::note)
    }
}

/// A body so fast that it can pass through an obstacle in one step.
pub struct Tunnels {
    /// The entity's collider.
    pub at: Span,
    /// The velocity: `y'`.
    pub velocity: String,
    /// The maximum closing speed, px/s, signed.
    pub speed: f64,
    /// The mode with that speed, if modes drive the velocity.
    pub mode: Option<Span>,
    /// The step, s.
    pub step: f64,
    /// The obstacle: in words, and its place.
    pub over: (String, Span),
    /// Whether the obstacle moves.
    pub moves: bool,
    /// The thickness of the obstacle, px.
    pub thickness: f64,
    /// The extent of the body along this axis, px.
    pub extent: f64,
}

impl Fact for Tunnels {
    fn into_diagnostic(self) -> Diagnostic {
        let short = |x: f64| {
            let text = format!("{x:.3}");
            text.trim_end_matches('0').trim_end_matches('.').to_string()
        };
        let Tunnels { at, velocity, speed, mode, step, over: (over, place), moves, thickness, extent } = self;
        let together = thickness + extent;
        // Slightly less than the exact limit, so that rounding does not matter.
        let most = short((together / step).ceil() - 1.0);
        let (far, speed) = (short(speed.abs() * step), short(speed));
        let d =
            Diagnostic::new(Code::Tunnels, format!("`{velocity}` may be so high that a step passes through {over}"));
        let d = match moves {
            false => d
                .at(at, format!("up to {far} px in a step, at {speed} px/s"))
                .and(place, format!("{} px thick", short(thickness)))
                .help(format!("bound it: `clamp {velocity} in -{most}..{most}`"))
                .or_add(BlockKind::Entity, at, format!("clamp {velocity} in -{most}..{most}")),
            true => d
                .at(at, format!("up to {far} px in a step nearer to it, at {speed} px/s from both"))
                .and(place, format!("{} px thick, and moves", short(thickness)))
                .help(format!("bound both, by `clamp {velocity} in …`, to {most} px/s together")),
        };
        let d = mode.into_iter().fold(d, |d, mode| d.and(mode, "in this mode"));
        d.note(format!("a step of more than both are long, {} px, ends behind it without a contact", short(together)))
    }
}
