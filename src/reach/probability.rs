//! How probable it is that nature draws what a path needs: the product over its steps of the probability of the draws that
//! have the same effect there. What a step does not read does not count.

use serde::{Deserialize, Serialize};

use crate::sim::{DrawId, Draws, Input, Scratch, Script, State};
use crate::watch::{Meter, PollLimit, Unwatched};

use super::problem::{Problem, StateStatus};

/// Maximum number of draws that are tried for one step.
const MAX_RUNS: usize = 4_096;

/// Number of polls after which the draws of further steps are not tried: a few seconds.
const POLLS: u32 = 1_000;

/// The luck that a path needs.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct Luck {
    /// How probable it is that nature draws so that the inputs lead along this path: uniform draws, independent of each
    /// other.
    pub probability: f64,
    /// Whether the probability is exact; otherwise it is at least so large, as there are too many draws to try.
    pub is_exact: bool,
    /// The probability as a fraction in lowest terms, where its parts are below 2^53.
    pub fraction: Option<(u64, u64)>,
}

impl Luck {
    /// None is needed.
    const NONE: Luck = Luck { probability: 1.0, is_exact: true, fraction: Some((1, 1)) };

    /// The luck that a script needs after its first `kept` steps where nature draws and the search chose what; `None` if
    /// it did not.
    pub fn chosen(problem: &Problem<'_>, script: &Script, kept: u64) -> Option<Luck> {
        let is_chosen = !problem.sim.draws().is_empty() && !problem.is_foretold();
        is_chosen.then(|| Luck::of(problem, script, kept)).flatten()
    }

    /// The luck that a script needs after its first `kept` steps; `None` if it cannot be run. After the last step, what
    /// counts is that the target holds.
    pub fn of(problem: &Problem<'_>, script: &Script, kept: u64) -> Option<Luck> {
        let (watch, steps) = (PollLimit::new(POLLS), script.len());
        let (meter, whole) = (Meter::new(&watch), Meter::new(&Unwatched));
        let mut scratch = problem.sim.scratch();
        let mut state = problem.sim.initial(&mut scratch).ok()?;
        let mut luck = Luck::NONE;
        for (step, input) in (1..).zip(script.inputs()) {
            let input = problem.draw(step, input);
            let before = state.clone();
            problem.sim.metered_step(&mut state, &input, &mut scratch, &whole).ok()?;
            let read = problem.sim.drawn(&input, &scratch).1;
            if step <= kept || read.is_empty() {
                continue;
            }
            let wanted = if step == steps { None } else { Some(&state) };
            let mut trial = Trial { problem, before: &before, wanted, input: &input, scratch: &mut scratch, runs: 0 };
            let exact = trial.count(Draws::default(), &meter);
            luck = luck.and(match exact {
                Some(share) => (share, true),
                // What was drawn is enough.
                None => (single(problem, &read), false),
            });
        }
        Some(luck)
    }

    fn and(self, (share, is_exact): (Share, bool)) -> Luck {
        let fraction = self.fraction.zip(share.fraction).and_then(|(a, b)| {
            let product = lowest((u128::from(a.0) * u128::from(b.0), u128::from(a.1) * u128::from(b.1)));
            let fits = |part: u128| u64::try_from(part).ok().filter(|part| *part < 1 << f64::MANTISSA_DIGITS);
            Some((fits(product.0)?, fits(product.1)?))
        });
        let probability = match fraction {
            Some((above, below)) => above as f64 / below as f64,
            None => self.probability * share.value,
        };
        Luck { probability, is_exact: self.is_exact && is_exact, fraction }
    }

    /// `1 in 36`, `at least 5 in 18`, `1 in about 2.18e9`
    pub fn words(&self) -> String {
        let least = if self.is_exact { "" } else { "at least " };
        match self.fraction {
            Some((above, below)) if above == 1 && below < 1_000_000 || below < 1_000 => {
                format!("{least}{above} in {below}")
            }
            _ if self.probability > 0.0 => {
                let one_in = 1.0 / self.probability;
                let number = if one_in < 1e6 { format!("{one_in:.0}") } else { format!("{one_in:.2e}") };
                format!("{least}1 in about {number}")
            }
            _ => "less than 1 in 1e300".to_string(),
        }
    }

    /// Whether the path is sure.
    pub fn is_none(&self) -> bool {
        self.probability >= 1.0
    }
}

/// A part of all draws of a step.
#[derive(Debug, Clone, Copy)]
struct Share {
    value: f64,
    /// Numerator and denominator, if they are small.
    fraction: Option<(u64, u64)>,
}

impl Share {
    const NONE: Share = Share { value: 0.0, fraction: Some((0, 1)) };
    const ALL: Share = Share { value: 1.0, fraction: Some((1, 1)) };

    /// The sum with another part, divided by a number.
    fn plus(self, other: Share, divided: u64) -> Share {
        let fraction = self.fraction.zip(other.fraction).and_then(|(a, b)| {
            let below = u128::from(b.1).checked_mul(u128::from(divided))?;
            let over = |(above, below): (u64, u64)| (u128::from(above), u128::from(below));
            let (a, b) = (over(a), (u128::from(b.0), below));
            let sum = (a.0.checked_mul(b.1)?.checked_add(b.0.checked_mul(a.1)?)?, a.1.checked_mul(b.1)?);
            let (above, below) = lowest(sum);
            Some((u64::try_from(above).ok()?, u64::try_from(below).ok()?))
        });
        Share { value: self.value + other.value / divided as f64, fraction }
    }
}

/// A fraction in lowest terms.
fn lowest((above, below): (u128, u128)) -> (u128, u128) {
    let (mut a, mut b) = (above, below);
    while b > 0 {
        (a, b) = (b, a % b);
    }
    (above / a.max(1), below / a.max(1))
}

/// The share of the draws of a step that were read, and no others.
fn single(problem: &Problem<'_>, read: &Draws) -> Share {
    let values = |(id, _): (DrawId, i32)| problem.sim.draws().get(id.0 as usize).map_or(1, |draw| draw.values());
    read.iter().map(values).fold(Share::ALL, |share, values| Share::NONE.plus(share, values))
}

/// Tries the draws of a step.
struct Trial<'t, 'p> {
    problem: &'t Problem<'p>,
    before: &'t State,
    /// The state that the step is to lead to; `None`: any in which the target holds.
    wanted: Option<&'t State>,
    input: &'t Input,
    scratch: &'t mut Scratch,
    runs: usize,
}

impl Trial<'_, '_> {
    /// The share of the draws with the same effect among those that agree with what is fixed; `None` if there are too
    /// many. A run is determined by the draws that it reads, so only these are varied, in the order of their numbers.
    fn count(&mut self, fixed: Draws, meter: &Meter<'_>) -> Option<Share> {
        self.runs += 1;
        if self.runs > MAX_RUNS {
            return None;
        }
        let mut input = Input(self.input.0.clone(), self.input.1.clone());
        fixed.iter().for_each(|(id, value)| input.1.set(id, Some(value)));
        let (sim, mut state) = (self.problem.sim, self.before.clone());
        let stepped = sim.metered_step(&mut state, &input, self.scratch, meter);
        if meter.is_stopped() {
            return None;
        }
        let read = sim.drawn(&input, self.scratch).1;
        let Some((id, _)) = read.iter().find(|(id, _)| fixed.get(*id).is_none()) else {
            let same = stepped.is_ok()
                && match self.wanted {
                    Some(wanted) => state == *wanted,
                    None => self.problem.judge(&state) == Ok(StateStatus::Goal),
                };
            return Some(if same { Share::ALL } else { Share::NONE });
        };
        let draw = *sim.draws().get(id.0 as usize)?;
        if draw.values() > MAX_RUNS as u64 {
            return None;
        }
        let mut share = Share::NONE;
        for number in 0..draw.values() {
            let mut fixed = fixed.clone();
            fixed.set(id, Some(draw.value(number)));
            share = share.plus(self.count(fixed, meter)?, draw.values());
        }
        Some(share)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn probabilities_are_written_as_fractions() {
        let sixth = Share::NONE.plus(Share::ALL, 6);
        let luck = Luck::NONE.and((sixth, true)).and((sixth, true));
        assert_eq!((luck.words().as_str(), luck.fraction), ("1 in 36", Some((1, 36))));
        let third = sixth.plus(Share::ALL, 6);
        assert_eq!(Luck::NONE.and((third, false)).words(), "at least 1 in 3");
        assert_eq!(Luck::NONE.and((third.plus(sixth, 1), true)).words(), "1 in 2");
        let rare = (0..20).fold(luck, |luck, _| luck.and((sixth, true)));
        assert_eq!((rare.words().as_str(), rare.fraction), ("1 in about 1.32e17", None));
        assert!((rare.probability * 6_f64.powi(22) - 1.0).abs() < 1e-9);
        let five = (0..5).fold(Share::NONE, |share, _| share.plus(Share::ALL, 6));
        assert_eq!(Luck::NONE.and((five, true)).words(), "5 in 6");
        assert!(Luck::NONE.is_none() && !luck.is_none());
    }
}
