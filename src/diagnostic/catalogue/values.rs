//! Facts about what values can be while a world runs.

use crate::diagnostic::{Code, Diagnostic, Fact};
use crate::source::Span;

/// Why a guard turns out as it does.
pub struct Reason {
    /// The part of the guard that decides.
    pub at: Span,
    /// Its text, if it is short.
    pub text: Option<String>,
    /// What it reads can be, if there is anything to say.
    pub values: Option<String>,
    /// The same, mode by mode, where that differs.
    pub notes: Vec<String>,
}

impl Reason {
    fn name(&self) -> String {
        self.text.as_ref().map_or("this guard".to_string(), |text| format!("`{text}`"))
    }
}

/// A guard that values decide.
pub struct GuardByValue {
    /// Whether it always holds, or never.
    pub holds: bool,
    /// Why.
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
        reason.notes.into_iter().fold(d.help(help), Diagnostic::note)
    }
}

/// A mode that values never let an instance enter.
pub struct ModeByValue {
    /// Its path.
    pub path: String,
    /// Its name.
    pub at: Span,
    /// The edges that lead to it, each with why it is never taken.
    pub reasons: Vec<Reason>,
    /// Modes that could only be entered from it.
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

/// An invariant that does not hold in the first state.
pub struct Broken {
    /// The invariant.
    pub at: Span,
    /// What it reads is, if there is anything to say.
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

/// An invariant that is not proven.
pub struct Unproven {
    /// The invariant.
    pub at: Span,
    /// What it reads can be where it may break, if there is anything to say.
    pub values: Option<String>,
    /// The modes in which it may break, and their names' places.
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

/// An invariant of which nothing is known: there was nothing to look at, or too much.
pub struct Unknown {
    /// The invariant.
    pub at: Span,
    /// The instance, if there is one.
    pub instance: Option<String>,
    /// Why.
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

/// A discrete variable that an update can take out of its range, by the values of what the update reads.
pub struct LeavesRange {
    /// The variable.
    pub name: String,
    /// Its range.
    pub range: (i32, i32),
    /// Where it is declared.
    pub declared: Span,
    /// The new value.
    pub at: Span,
    /// What it can be: `is from 3 to 12`.
    pub value: String,
    /// Whether all of it is outside.
    pub always: bool,
    /// The mode in which it happens.
    pub mode: String,
    /// What it reads can be, if there is anything to say.
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
            .note("a value out of its range stops the run");
        reads.into_iter().fold(d, Diagnostic::note)
    }
}

/// A body that moves so far in a step that it can be on the other side of what blocks it.
pub struct Tunnels {
    /// The entity's collider.
    pub at: Span,
    /// The velocity: `y'`.
    pub velocity: String,
    /// How fast it can come nearer, px/s, signed.
    pub speed: f64,
    /// The mode in which it is that fast, if modes drive it.
    pub mode: Option<Span>,
    /// How long a step is, s.
    pub step: f64,
    /// What it can jump over: in words, and where.
    pub over: (String, Span),
    /// Whether that moves, too.
    pub moves: bool,
    /// How thick it is, px.
    pub thickness: f64,
    /// How long the body is along this axis, px.
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
        // A little less than what just does not pass, so that rounding plays no part.
        let most = short((together / step).ceil() - 1.0);
        let (far, speed) = (short(speed.abs() * step), short(speed));
        let d =
            Diagnostic::new(Code::Tunnels, format!("`{velocity}` may be so high that a step passes through {over}"));
        let d = match moves {
            false => d
                .at(at, format!("up to {far} px in a step, at {speed} px/s"))
                .and(place, format!("{} px thick", short(thickness)))
                .help(format!("bound it: `clamp {velocity} in -{most}..{most}`")),
            true => d
                .at(at, format!("up to {far} px in a step nearer to it, at {speed} px/s from both"))
                .and(place, format!("{} px thick, and moves", short(thickness)))
                .help(format!("bound both, by `clamp {velocity} in …`, to {most} px/s together")),
        };
        let d = mode.into_iter().fold(d, |d, mode| d.and(mode, "in this mode"));
        d.note(format!("a step of more than both are long, {} px, ends behind it without a contact", short(together)))
    }
}
