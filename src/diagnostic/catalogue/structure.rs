//! Facts about the structure of entities.

use crate::diagnostic::{Code, Diagnostic, Fact};
use crate::source::Span;

/// An edge into another group.
pub struct EdgeOutOfGroup {
    /// The target as written.
    pub target: Span,
    /// Its full path.
    pub path: String,
    /// Where the target is declared.
    pub declared: Span,
    /// The modes of the edge's own group.
    pub own: Vec<String>,
    /// Whether the edge is in `always`.
    pub is_always: bool,
}

impl Fact for EdgeOutOfGroup {
    fn into_diagnostic(self) -> Diagnostic {
        let own: Vec<String> = self.own.iter().map(|m| format!("`{m}`")).collect();
        let d = Diagnostic::new(
            Code::EdgeOutOfGroup,
            format!("an edge cannot lead to `{}`, which is in another group", self.path),
        )
        .at(self.target, "leads out of the group")
        .and(self.declared, "declared here");
        if self.is_always {
            return d
                .note("what `always` holds stays active: its edges lead nowhere")
                .help("put the modes that it leaves into a mode around them, and the edge there");
        }
        if own.is_empty() || own.len() > 8 {
            return d;
        }
        let d = d.help(format!("it can lead to {}", super::list(&own, "or")));
        self.own.into_iter().fold(d, |d, mode| d.or_write(self.target, mode))
    }
}

/// A variable driven by two flows or envelopes at once.
pub struct FlowConflict {
    /// The variable.
    pub variable: String,
    /// The one flow.
    pub first: Span,
    /// The other.
    pub second: Span,
    /// Whether they are in two groups, not in one mode.
    pub across_groups: bool,
}

impl Fact for FlowConflict {
    fn into_diagnostic(self) -> Diagnostic {
        let d = Diagnostic::new(Code::FlowConflict, format!("`{}` is driven twice at once", self.variable))
            .at(self.second, "driven again here")
            .and(self.first, "driven here")
            .or_remove("the second one", self.second)
            .or_remove("the first one", self.first);
        if self.across_groups {
            d.note("modes of two groups can be active together; only one group may drive a variable")
        } else {
            d.note("one mode drives a variable with one flow or envelope; an inner mode may override it")
        }
    }
}

/// A variable updated twice by one edge or entry.
pub struct UpdateConflict {
    /// The variable.
    pub variable: String,
    /// The one update.
    pub first: Span,
    /// The other.
    pub second: Span,
}

impl Fact for UpdateConflict {
    fn into_diagnostic(self) -> Diagnostic {
        Diagnostic::new(Code::UpdateConflict, format!("`{}` is updated twice", self.variable))
            .at(self.second, "updated again here")
            .and(self.first, "updated here")
            .or_remove("the second update", self.second)
            .or_remove("the first update", self.first)
            .note("all updates of one edge happen at once")
    }
}

/// An invalid envelope.
pub struct BadEnvelope {
    /// Where.
    pub at: Span,
    /// The reason.
    pub why: String,
    /// A related place.
    pub other: Option<Span>,
    /// A suggestion.
    pub help: Option<String>,
}

impl Fact for BadEnvelope {
    fn into_diagnostic(self) -> Diagnostic {
        let mut d = Diagnostic::new(Code::BadEnvelope, self.why).at(self.at, "this envelope");
        if let Some(other) = self.other {
            d = d.and(other, "first given here");
        }
        match self.help {
            Some(help) => d.help(help),
            None => d,
        }
    }
}

/// A collider without a positive size.
pub struct BadCollider {
    /// The number.
    pub at: Span,
    /// The property: `width`.
    pub what: &'static str,
    /// Its value.
    pub value: f64,
    /// The instance with this value, if it is not the entity's default.
    pub instance: Option<(String, Span)>,
}

impl Fact for BadCollider {
    fn into_diagnostic(self) -> Diagnostic {
        let d = Diagnostic::new(Code::BadCollider, format!("a collider's {} is {}", self.what, self.value))
            .at(self.at, "must be more than 0 px");
        let d = if self.value < 0.0 { d.or_write(self.at, (-self.value).to_string()) } else { d };
        let d = d.or_remove("the collider", self.at);
        match self.instance {
            Some((name, span)) => d.and(span, format!("for the instance `{name}`")),
            None => d,
        }
    }
}

/// An edge without a target and without updates.
pub struct IdleEdge {
    /// The edge.
    pub at: Span,
}

impl Fact for IdleEdge {
    fn into_diagnostic(self) -> Diagnostic {
        Diagnostic::new(Code::IdleEdge, "this edge does nothing: it has neither a target nor updates")
            .at(self.at, "leads nowhere")
            .help("add `-> MODE`, or updates in `{ }`")
            .or_remove("the edge", self.at)
    }
}

/// A read of a reference that may be empty.
pub struct LostRead {
    /// The read.
    pub at: Span,
    /// The reference.
    pub name: String,
    /// The entity that it refers to, if it is known.
    pub entity: Option<String>,
    /// Whether an edge on `lost` in the mode would fix it.
    pub in_mode: bool,
    /// Where it becomes none, if a place is known.
    pub why: Option<(Span, &'static str)>,
    /// Whether it only has to be set where the instance is made.
    pub is_unset: bool,
}

impl Fact for LostRead {
    fn into_diagnostic(self) -> Diagnostic {
        let LostRead { at, name, entity, in_mode, why, is_unset } = self;
        let test = test(&name, entity);
        let mut d = Diagnostic::new(Code::LostReference, format!("`{name}` is read, but it may be none"))
            .at(at, "stops the step where there is nothing to read");
        if let Some((place, how)) = why {
            d = d.and(place, how);
        }
        if is_unset {
            d.help(format!("set it where the instance is made: `{name} = INSTANCE`; or test `{test}` before"))
        } else if in_mode {
            d.help(format!("add `when lost({name}) -> MODE` to this mode or one around it, or test `{test}` before"))
        } else {
            d.help(format!("test it before: `if({name} is none, …, {name}.x)`, or `{test} and …` in a guard"))
        }
    }
}

/// An edge into a mode that reads a reference, whose guard does not exclude an empty one.
pub struct LostEntry {
    /// The edge.
    pub at: Span,
    /// The reference.
    pub name: String,
    /// The entity that it refers to, if it is known.
    pub entity: Option<String>,
    /// The mode.
    pub mode: String,
    /// Where the mode reads it.
    pub read: Span,
}

impl Fact for LostEntry {
    fn into_diagnostic(self) -> Diagnostic {
        let LostEntry { at, name, entity, mode, read } = self;
        let test = test(&name, entity);
        Diagnostic::new(
            Code::LostReference,
            format!("this edge enters `{mode}`, which reads `{name}`, without setting it"),
        )
        .at(at, format!("`{name}` may be none here"))
        .and(read, "read here")
        .help(format!("set it (`{name} := …`) in the edge's updates, or test `{test}` in its guard"))
    }
}

/// The guard that a reference is not none.
fn test(name: &str, entity: Option<String>) -> String {
    entity.map_or_else(|| format!("not lost({name})"), |entity| format!("{name} is {entity}"))
}

/// Groups whose transitions depend on each other cyclically.
pub struct JointCycle {
    /// The dependent groups, and the place of each dependency.
    pub steps: Vec<(String, Span)>,
}

impl Fact for JointCycle {
    fn into_diagnostic(self) -> Diagnostic {
        let mut names: Vec<&str> = self.steps.iter().map(|(name, _)| name.as_str()).collect();
        names.extend(self.steps.first().map(|(name, _)| name.as_str()));
        let message = match names.as_slice() {
            // A group that depends on itself.
            [only, _] => format!("{only} cannot wait for a transition of the same group"),
            _ => format!("groups wait for each other's transitions: {}", names.join(" → ")),
        };
        let mut steps = self.steps.iter();
        let mut d = Diagnostic::new(Code::JointCycle, message);
        if let Some((name, span)) = steps.next() {
            d = d.at(*span, format!("{name} waits here"));
        }
        for (name, span) in steps {
            d = d.and(*span, format!("{name} waits here"));
        }
        d.note("`entering` and `exiting` ask what another group does in the same step, so that group is decided first")
    }
}
