//! What came of a question, in a word: answers, rows, tables and results all share this one enumeration.

use serde::{Deserialize, Serialize};

use super::outcome::{Outcome, Verdict};
use super::problem::Target;

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

impl Outcome {
    /// The conclusion of this outcome.
    pub fn conclusion(&self, target: Target) -> Conclusion {
        match (&self.verdict, target) {
            (Verdict::Reached(_), Target::Goal(_)) => Conclusion::Reached,
            (Verdict::Reached(_), Target::Never(_)) => Conclusion::Violated,
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
}
