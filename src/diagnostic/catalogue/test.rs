//! Facts about tests of worlds.

use crate::diagnostic::suggestion::BlockKind;
use crate::diagnostic::{Code, Diagnostic, Fact};
use crate::source::Span;

/// A test that cannot be run.
pub struct BadTest {
    /// The wrong part.
    pub at: Span,
    /// The reason.
    pub why: WhyBadTest,
}

/// Why a test cannot be run.
pub enum WhyBadTest {
    /// Its name is empty.
    NoName,
    /// It claims nothing.
    NoClaim,
    /// It has no inputs and no time, so its run has no end.
    NoEnd,
    /// A time lies between two steps.
    OffStep {
        /// The length of a step as a fraction of seconds.
        step: (u64, u64),
        /// The step before the time.
        before: u32,
    },
    /// A time is negative or too long.
    NoTime,
    /// A seed is no whole number.
    BadSeed,
    /// `not without` after a word that it does not fit.
    NeededBy(&'static str),
    /// A `goal` where a `never` is asked for, or the other way round.
    OtherQuestion {
        /// Its name.
        name: String,
        /// Whether it is a goal.
        is_goal: bool,
        /// Its declaration.
        declared: Span,
    },
}

impl Fact for BadTest {
    fn into_diagnostic(self) -> Diagnostic {
        let BadTest { at, why } = self;
        let new = |message: String, label: &str| Diagnostic::new(Code::BadTest, message).at(at, label);
        match why {
            WhyBadTest::NoName => {
                new("a test has no name".into(), "this is empty").help("say in a few words what is tested")
            }
            WhyBadTest::NoClaim => new("a test claims nothing".into(), "it can only pass")
                .help("add a claim, such as `expect hero.x > 100 at end` or `reachable exit within 20s`"),
            WhyBadTest::NoEnd => new("the run of a test has no end".into(), "there are no inputs and no times")
                .help("add `inputs \"right*40\"`, or a time such as `at 2s`")
                .or_add(BlockKind::Test, at, "inputs \"-*60\""),
            WhyBadTest::OffStep { step: (numerator, denominator), before } => {
                let seconds = |steps: u32| f64::from(steps) * numerator as f64 / denominator as f64;
                let time = |steps: u32| format!("`{steps}frames` ({:.4} s)", seconds(steps));
                new(
                    format!("a time lies between two steps of {numerator}/{denominator} s"),
                    "there is no state at this time",
                )
                .help(format!("the steps beside it are at {} and {}", time(before), time(before.saturating_add(1))))
                .or_write(at, format!("{before}frames"))
                .or_write(at, format!("{}frames", before.saturating_add(1)))
            }
            WhyBadTest::NoTime => new("a time of a test is out of range".into(), "0 s to 100,000,000 steps"),
            WhyBadTest::BadSeed => new("a seed is no whole number".into(), "from 0 to 18446744073709551615")
                .help("write `chance seed 7`")
                .or_write(at, "7"),
            WhyBadTest::NeededBy(word) => {
                new(format!("`not without` does not fit `{word}`"), "only `reachable` has it")
                    .help("`reachable exit not without key` claims that there is a way, and none without the key")
            }
            WhyBadTest::OtherQuestion { name, is_goal, declared } => {
                let (is, other) = if is_goal { ("goal", "never") } else { ("never", "goal") };
                let help = match is_goal {
                    true => format!("write `unreachable {name}`, `reachable {name}`, or give its predicate"),
                    false => format!("write `never {name}`, `unfound {name}`, or give its predicate"),
                };
                new(format!("`{name}` is a `{is}`, not a `{other}`"), "asked for here")
                    .and(declared, "declared here")
                    .help(help)
            }
        }
    }
}

/// A part of a test that makes no difference.
pub struct IdleTest {
    /// The part.
    pub at: Span,
    /// The reason, in a few words.
    pub what: &'static str,
}

impl Fact for IdleTest {
    fn into_diagnostic(self) -> Diagnostic {
        Diagnostic::new(Code::IdleTest, "a part of a test makes no difference")
            .at(self.at, self.what)
            .or_remove("it", self.at)
    }
}

/// A claim of a test that is not so, or a run that is no good run.
pub struct TestFailed {
    /// The claim, or the name of the test.
    pub at: Span,
    /// The name of the test.
    pub test: String,
    /// What is not so.
    pub what: String,
    /// What is known.
    pub notes: Vec<String>,
}

impl Fact for TestFailed {
    fn into_diagnostic(self) -> Diagnostic {
        let TestFailed { at, test, what, notes } = self;
        let failed = Diagnostic::new(Code::TestFailed, format!("test \"{test}\" failed")).at(at, what);
        notes.into_iter().fold(failed, Diagnostic::note)
    }
}
