//! Times in the world as arguments: in seconds or in steps, always with a unit.

use std::fmt;

use crate::ir::World;

/// Rounding tolerance for a number of steps.
const ROUNDED: f64 = 1e-6;

/// A time, as steps or as seconds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Time {
    /// `12frames`
    Steps(u32),
    /// `0.2s`, `200ms`
    Seconds(f64),
}

impl fmt::Display for Time {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Time::Steps(steps) => write!(f, "{steps}frames"),
            Time::Seconds(seconds) => write!(f, "{seconds}s"),
        }
    }
}

impl Time {
    /// Parses a number with its unit.
    pub fn read(text: &str) -> Result<Time, String> {
        let number = |text: &str| text.trim_end().parse::<f64>().ok().filter(|x| x.is_finite() && *x >= 0.0);
        let steps = text.strip_suffix("frames").or(text.strip_suffix("frame"));
        let found = match (steps, text.strip_suffix("ms"), text.strip_suffix('s')) {
            (Some(steps), ..) => steps.trim_end().parse().ok().map(Time::Steps),
            (_, Some(ms), _) => number(ms).map(|ms| Time::Seconds(ms / 1000.0)),
            (_, _, Some(s)) => number(s).map(Time::Seconds),
            _ => None,
        };
        found.ok_or_else(|| match number(text) {
            // Without a unit it is ambiguous.
            Some(_) => format!("write `{text}s` or `{text}frames`"),
            None => "a time such as `12frames`, `0.2s` or `200ms`".to_string(),
        })
    }

    /// Number of whole steps of a world that fit into it.
    pub fn room(self, world: &World) -> u32 {
        match self {
            Time::Steps(steps) => steps,
            Time::Seconds(seconds) => (seconds / world.step.seconds() + ROUNDED).floor() as u32,
        }
    }

    /// Minimum number of steps of a world that last at least as long, at least one.
    pub fn steps(self, world: &World) -> u32 {
        match self {
            Time::Steps(steps) => steps.max(1),
            Time::Seconds(seconds) => (seconds / world.step.seconds() - ROUNDED).ceil().max(1.0) as u32,
        }
    }
}

/// A range of times, or one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Hold {
    least: Time,
    most: Time,
}

impl Hold {
    /// `10frames`, `10frames..60frames`, `10..60frames`
    pub fn read(text: &str) -> Result<Hold, String> {
        let Some((low, high)) = text.split_once("..") else {
            let time = Time::read(text)?;
            return Ok(Hold { least: time, most: time });
        };
        let most = Time::read(high)?;
        // The unit may follow the second number only.
        let unit = high.trim_start_matches(|c: char| !c.is_alphabetic());
        let least = Time::read(low)
            .or_else(|why| if unit.is_empty() { Err(why) } else { Time::read(&format!("{low}{unit}")) })?;
        Ok(Hold { least, most })
    }

    /// The range in steps; `None` if it is given in seconds.
    pub fn frames(self) -> Option<(u32, u32)> {
        match (self.least, self.most) {
            (Time::Steps(least), Time::Steps(most)) => Some((least, most)),
            _ => None,
        }
    }

    /// The range in steps of a world.
    pub fn steps(self, world: &World) -> (u32, u32) {
        (self.least.steps(world), self.most.steps(world))
    }
}

/// A range of steps, checked for planners.
pub(super) fn held((least, most): (u32, u32)) -> Result<(u16, u16), String> {
    match (u16::try_from(least.max(1)), u16::try_from(most)) {
        (Ok(least), Ok(most)) if least <= most => Ok((least, most)),
        (Ok(_), Ok(_)) => Err("the first time of a range is the shorter one, as in `10..60frames`".to_string()),
        _ => Err(format!("at most {} steps can be held", u16::MAX)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_have_units() {
        assert_eq!(Time::read("30frames"), Ok(Time::Steps(30)));
        assert_eq!(Time::read("1frame"), Ok(Time::Steps(1)));
        assert_eq!(Time::read("100000frames"), Ok(Time::Steps(100_000)));
        assert_eq!(Time::read("500ms"), Ok(Time::Seconds(0.5)));
        assert_eq!(Time::read("2.5s"), Ok(Time::Seconds(2.5)));
        assert_eq!(Time::read("30"), Err("write `30s` or `30frames`".to_string()));
        for wrong in ["", "s", "-1s", "infs", "nans", "1.5frames", "soon", "3m"] {
            assert!(Time::read(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn holds_are_ranges_of_times() {
        let steps = |text: &str| Hold::read(text).map(Hold::frames);
        assert_eq!(steps("10frames"), Ok(Some((10, 10))));
        assert_eq!(steps("10..60frames"), Ok(Some((10, 60))));
        assert_eq!(steps("10frames..60frames"), Ok(Some((10, 60))));
        assert_eq!(steps("0.1s..60frames"), Ok(None));
        assert_eq!(steps("10"), Err("write `10s` or `10frames`".to_string()));
        assert_eq!(steps("10..60"), Err("write `60s` or `60frames`".to_string()));
        assert!(held((9, 3)).is_err() && held((1, 70_000)).is_err() && held((0, 3)) == Ok((1, 3)));
    }
}
