//! Arguments about people: timing errors, reaction times.

use clap::Args;

use crate::ir::World;
use crate::reach::query::TimingErrors;
use crate::reach::robust::Jitter;

use crate::cli::time::Time;

/// Number of plays by which a probability is estimated.
const TRIALS: u64 = 10_000;
/// The part of a reaction time that is the standard deviation of timing errors.
const PRECISION: f64 = 1.0 / 8.0;

/// What the layers do not go with.
const OTHER_QUESTIONS: [&str; 12] = [
    "robust",
    "reaction",
    "min_hold",
    "minimize",
    "style",
    "save_inputs",
    "html",
    "tree",
    "results",
    "csv",
    "junit",
    "baseline",
];

/// For whom a way is.
#[derive(Debug, Args)]
#[command(next_help_heading = "For whom")]
pub(in crate::cli) struct PersonArgs {
    /// Searches for a way that a person can do, who presses and releases a little too early or too late: with timing errors
    /// of this standard deviation, such as `sigma=1.5frames` or `sigma=25ms`. Says how probable success is (of 10000 plays,
    /// or `sigma=25ms,trials=100000`), and which moment is the hardest.
    #[arg(long, value_name = "sigma=TIME", value_parser = Robust::read)]
    pub robust: Option<Robust>,
    /// For a person with this reaction time, such as `200ms`: inputs are held for at least that long, as with `--min-hold`,
    /// and timing errors have an eighth of it as their standard deviation, as with `--robust`.
    #[arg(long, value_name = "TIME", value_parser = Time::read, conflicts_with = "min_hold")]
    pub reaction: Option<Time>,
    /// Shows the level in layers, by who gets where: players who hold each input for at least so many steps, and last those
    /// with all inputs. `20,12,6,2`, or times such as `200ms,6frames`.
    #[arg(
        long,
        value_name = "HOLD,…",
        value_delimiter = ',',
        value_parser = skill,
        conflicts_with_all = OTHER_QUESTIONS
    )]
    pub skill: Vec<Time>,
    /// One more layer for `--skill`: players for whom a predicate never holds, such as `held(run)`; can be given several
    /// times.
    #[arg(
        long,
        value_name = "PREDICATE",
        conflicts_with_all = OTHER_QUESTIONS
    )]
    pub skill_without: Vec<String>,
}

/// A hold: a time, or a plain number of steps.
fn skill(text: &str) -> Result<Time, String> {
    let found = text.trim().parse().map_or_else(|_| Time::read(text), |steps| Ok(Time::Steps(steps)));
    found.map_err(|_| "a number of steps such as `12`, or a time such as `12frames`, `0.2s` or `200ms`".to_string())
}

impl PersonArgs {
    /// The timing errors that were asked for, in steps of a world.
    pub fn errors(&self, world: &World) -> Option<TimingErrors> {
        let steps = |sigma: Sigma| match sigma {
            Sigma::Steps(steps) => steps,
            Sigma::Seconds(seconds) => seconds / world.step.seconds(),
        };
        let asked = match (&self.robust, self.reaction) {
            (Some(robust), _) => Some((steps(robust.sigma), robust.trials)),
            (None, Some(Time::Steps(time))) => Some((f64::from(time) * PRECISION, TRIALS)),
            (None, Some(Time::Seconds(time))) => Some((time * PRECISION / world.step.seconds(), TRIALS)),
            (None, None) => None,
        };
        asked.map(|(sigma, trials)| TimingErrors::new(sigma, trials))
    }

    /// Whether the answer has layers, by skill.
    pub fn has_layers(&self) -> bool {
        !self.skill.is_empty() || !self.skill_without.is_empty()
    }

    /// Why the errors cannot be used in a world.
    pub fn refusal(&self, world: &World) -> Option<String> {
        let sigma = self.errors(world)?.sigma;
        let is_fine = sigma > 0.0 && sigma <= Jitter::MAX_SIGMA;
        (!is_fine).then(|| format!("timing errors of {sigma} steps: above 0, at most {} steps", Jitter::MAX_SIGMA))
    }
}

/// Timing errors, as they were asked for.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::cli) struct Robust {
    sigma: Sigma,
    trials: u64,
    /// The argument.
    pub text: String,
}

/// A standard deviation of a time.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Sigma {
    Steps(f64),
    Seconds(f64),
}

impl Robust {
    /// `sigma=1.5frames`, `sigma=25ms,trials=100000`
    fn read(text: &str) -> Result<Robust, String> {
        let form = || "timing errors are written `sigma=1.5frames` or `sigma=25ms`".to_string();
        let (mut sigma, mut trials) = (None, TRIALS);
        for part in text.split(',') {
            match part.split_once('=').map(|(name, value)| (name.trim(), value.trim())) {
                Some(("sigma", value)) => sigma = Some(Sigma::read(value)?),
                Some(("trials", value)) => {
                    let read = value.parse().ok().filter(|trials| (1..=100_000_000).contains(trials));
                    trials = read.ok_or("`trials=` is a number of plays, from 1 to 100000000")?;
                }
                _ => return Err(form()),
            }
        }
        Ok(Robust { sigma: sigma.ok_or_else(form)?, trials, text: text.to_string() })
    }
}

impl Sigma {
    fn read(text: &str) -> Result<Sigma, String> {
        let number = |text: &str| text.trim_end().parse::<f64>().ok().filter(|x| x.is_finite() && *x > 0.0);
        let steps = text.strip_suffix("frames").or(text.strip_suffix("frame"));
        let found = match (steps, text.strip_suffix("ms"), text.strip_suffix('s')) {
            (Some(steps), ..) => number(steps).map(Sigma::Steps),
            (_, Some(ms), _) => number(ms).map(|ms| Sigma::Seconds(ms / 1000.0)),
            (_, _, Some(s)) => number(s).map(Sigma::Seconds),
            _ => None,
        };
        found.ok_or_else(|| match number(text) {
            Some(_) => format!("write `sigma={text}frames` or `sigma={text}ms`"),
            None => "a time above 0, such as `1.5frames`, `25ms` or `0.02s`".to_string(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_have_units() {
        let read = |text: &str| Robust::read(text).map(|robust| (robust.sigma, robust.trials));
        assert_eq!(read("sigma=1.5frames"), Ok((Sigma::Steps(1.5), TRIALS)));
        assert_eq!(read("sigma=1frame,trials=500"), Ok((Sigma::Steps(1.0), 500)));
        assert_eq!(read("trials=7,sigma=25ms"), Ok((Sigma::Seconds(0.025), 7)));
        assert_eq!(read("sigma=2"), Err("write `sigma=2frames` or `sigma=2ms`".to_string()));
        for wrong in
            ["", "1.5frames", "sigma=", "sigma=0ms", "sigma=-1frames", "sigma=nans", "trials=5", "sigma=1ms,trials=0"]
        {
            assert!(read(wrong).is_err(), "{wrong}");
        }
    }
}
