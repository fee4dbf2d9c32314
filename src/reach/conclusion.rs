//! What came of a question, in a word: answers, rows, tables and results all share this one enumeration.

use serde::{Deserialize, Serialize};

use super::outcome::{Outcome, Verdict};
use super::problem::Target;
use super::query::Kind;

/// What came of a question.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Conclusion {
    /// There is a way to the goal.
    Reached,
    /// There is a way to break the `never`.
    Violated,
    /// No way to the goal was found; this proves nothing.
    NotFound,
    /// No way to break the `never` was found, or a proof was withdrawn; this proves nothing.
    NotAnswered,
    /// No inputs with axes at -1, 0 and 1 do it; values between, which can make a difference, were not tried.
    Exhausted,
    /// There is no way.
    ProvenUnreachable,
    /// The question could not be asked.
    Error,
}

impl Conclusion {
    /// What a path to a target shows.
    pub fn of_path(target: Target) -> Conclusion {
        match target {
            Target::Goal(_) => Conclusion::Reached,
            Target::Never(_) => Conclusion::Violated,
        }
    }

    /// All of them, best first where a goal is asked for.
    pub const ALL: [Conclusion; 7] = [
        Conclusion::Reached,
        Conclusion::Violated,
        Conclusion::NotFound,
        Conclusion::NotAnswered,
        Conclusion::Exhausted,
        Conclusion::ProvenUnreachable,
        Conclusion::Error,
    ];

    /// Its name in results: JSON, CSV, JUnit.
    pub fn name(self) -> &'static str {
        match self {
            Conclusion::Reached => "reached",
            Conclusion::Violated => "violated",
            Conclusion::NotFound => "not-found",
            Conclusion::NotAnswered => "not-answered",
            Conclusion::Exhausted => "exhausted",
            Conclusion::ProvenUnreachable => "proven-unreachable",
            Conclusion::Error => "error",
        }
    }

    /// Its name in text for people.
    pub fn words(self) -> &'static str {
        match self {
            Conclusion::NotFound => "not found",
            Conclusion::NotAnswered => "not answered",
            Conclusion::ProvenUnreachable => "proven unreachable",
            Conclusion::Reached | Conclusion::Violated | Conclusion::Exhausted | Conclusion::Error => self.name(),
        }
    }

    /// Whether the question is still open.
    pub fn is_open(self) -> bool {
        matches!(self, Conclusion::NotFound | Conclusion::NotAnswered)
    }

    /// Whether the author wants it: a goal is reached, a `never` is proven.
    pub fn is_expected(self, target: Target) -> bool {
        match target {
            Target::Goal(_) => self == Conclusion::Reached,
            Target::Never(_) => self == Conclusion::ProvenUnreachable,
        }
    }
}

/// What became of an answer. What a search does not find is lost, not worse: only a fact makes it so.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
#[serde(rename_all = "lowercase")]
pub enum Shift {
    /// A goal that was reached is proven unreachable, a `never` that was proven is violated, or what was answered as
    /// expected cannot be asked any more.
    Worse,
    /// The expected answer is not found any more; it may still be so.
    Lost,
    /// Another answer, neither better nor worse as far as is known.
    Other,
    /// The expected answer is found now; it may have been so before.
    Found,
    /// A goal that was proven unreachable is reached, a `never` that was violated is proven, or what could not be asked
    /// is answered as expected.
    Better,
    /// The same answer.
    Same,
}

impl Shift {
    /// Compares two conclusions about the same question.
    pub fn of(kind: Kind, old: Conclusion, new: Conclusion) -> Shift {
        use Conclusion::{Error, ProvenUnreachable, Reached, Violated};
        let (expected, opposite) = match kind {
            Kind::Goal => (Reached, ProvenUnreachable),
            Kind::Never => (ProvenUnreachable, Violated),
        };
        let is_bad = |conclusion| conclusion == opposite || conclusion == Error;
        match (old == expected, new == expected) {
            _ if old == new => Shift::Same,
            (true, _) if is_bad(new) => Shift::Worse,
            (true, _) => Shift::Lost,
            (_, true) if is_bad(old) => Shift::Better,
            (_, true) => Shift::Found,
            (false, false) => Shift::Other,
        }
    }

    /// Its name in text for people, and in JSON.
    pub fn name(self) -> &'static str {
        match self {
            Shift::Worse => "worse",
            Shift::Lost => "lost",
            Shift::Other => "other",
            Shift::Found => "found",
            Shift::Better => "better",
            Shift::Same => "same",
        }
    }
}

impl Outcome {
    /// The conclusion of this outcome.
    pub fn conclusion(&self, target: Target) -> Conclusion {
        match (&self.verdict, target) {
            (Verdict::Reached(_), _) => Conclusion::of_path(target),
            (Verdict::NotFound, Target::Goal(_)) if !self.is_withdrawn => Conclusion::NotFound,
            (Verdict::NotFound, _) => Conclusion::NotAnswered,
            (Verdict::Unreachable(_), _) => Conclusion::ProvenUnreachable,
            (Verdict::Exhausted(_), _) => Conclusion::Exhausted,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn conclusions_are_written_as_they_are_called() {
        for conclusion in Conclusion::ALL {
            assert_eq!(serde_json::to_value(conclusion).unwrap(), conclusion.name());
        }
    }

    #[test]
    fn only_what_is_known_is_worse() {
        use Conclusion::{Error, Exhausted, NotAnswered, NotFound, ProvenUnreachable, Reached, Violated};
        let goal = |old, new| Shift::of(Kind::Goal, old, new);
        assert_eq!([goal(Reached, ProvenUnreachable), goal(Reached, Error)], [Shift::Worse; 2]);
        assert_eq!([NotFound, NotAnswered, Exhausted].map(|new| goal(Reached, new)), [Shift::Lost; 3]);
        assert_eq!([goal(ProvenUnreachable, Reached), goal(Error, Reached)], [Shift::Better; 2]);
        assert_eq!(goal(NotFound, Reached), Shift::Found);
        assert_eq!([goal(NotFound, ProvenUnreachable), goal(Error, NotFound)], [Shift::Other; 2]);
        let never = |old, new| Shift::of(Kind::Never, old, new);
        assert_eq!(never(ProvenUnreachable, Violated), Shift::Worse);
        assert_eq!(never(ProvenUnreachable, NotAnswered), Shift::Lost);
        assert_eq!(never(NotAnswered, ProvenUnreachable), Shift::Found);
        assert_eq!(never(Violated, ProvenUnreachable), Shift::Better);
        assert_eq!([never(Violated, NotAnswered), never(NotAnswered, Violated)], [Shift::Other; 2]);
        for kind in [Kind::Goal, Kind::Never] {
            assert!(Conclusion::ALL.iter().all(|same| Shift::of(kind, *same, *same) == Shift::Same));
        }
    }
}
