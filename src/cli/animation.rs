//! `hypedc sim --gif`: the run as an animation. The run is simulated twice: to see where the players go, and to paint. One
//! table of colours serves all pictures; where it has no room for all, the run is painted once more to count them.

mod pictures;

use std::fs;
use std::io;
use std::ops::ControlFlow;
use std::path::Path;

use crate::sim::{Script, Simulator};
use crate::view::{ColorTable, Colors, Film, FilmOptions, Images, PlayerArea};
use crate::watch::Watch;

use super::args::GifArgs;
use super::sim::drive;
use pictures::{file, packed};

/// The shortest time of a picture that browsers keep to, in hundredths of a second.
const SHORTEST: f64 = 3.0;
/// How long the last picture stays, in hundredths of a second.
const LAST: u16 = 150;

/// Why there is no animation.
pub(super) enum NoAnimation {
    /// Its file would be too large: the limit in bytes, and the step at which it is reached.
    TooLarge(u64, u64),
    /// It was stopped.
    Stopped,
    /// Its file cannot be written.
    Io(io::Error),
}

impl NoAnimation {
    /// The message.
    pub fn words(&self, path: &Path) -> String {
        match self {
            NoAnimation::TooLarge(limit, step) => format!(
                "`{}` would have more than {} MiB at step {step}: `--every`, `--scale`, `--size` or `--frames` make it \
                 smaller, `--max-size` allows more",
                path.display(),
                limit >> 20
            ),
            NoAnimation::Stopped => format!("stopped before `{}` was written", path.display()),
            NoAnimation::Io(error) => format!("cannot write `{}`: {error}", path.display()),
        }
    }
}

/// Writes the animation of a run.
pub(super) fn save(
    path: &Path,
    (args, images): (&GifArgs, &Images),
    sim: &Simulator,
    (script, chance): (&Script, Option<u64>),
    frames: u64,
    watch: &dyn Watch,
) -> Result<(), NoAnimation> {
    let options = FilmOptions { scale: args.scale, size: args.size, is_dark: args.dark };
    let (mut players, mut last) = (PlayerArea::new(sim), 0);
    each(sim, (script, chance), frames, watch, &mut |step, state| {
        last = step;
        players.observe(sim, state);
        ControlFlow::Continue(())
    })?;
    let mut film = Film::new(sim, options, images, &players);
    let step = 100.0 * sim.world().step.seconds();
    let every = args.every.unwrap_or_else(|| libm::ceil(SHORTEST / step - 1e-9).max(1.0) as u64).max(1);
    let animation = Animation { sim, run: (script, chance), frames, every, last, limit: args.max_size * (1 << 20) };
    let bytes = match animation.paint(&mut film, &mut ColorTable::default(), watch)? {
        Some(bytes) => bytes,
        // More colours than the table has room for: the most frequent ones are chosen first.
        None => {
            film.restart();
            let mut table = animation.colors(&mut film, watch)?.table();
            film.restart();
            animation.paint(&mut film, &mut table, watch)?.unwrap_or_default()
        }
    };
    fs::write(path, bytes).map_err(NoAnimation::Io)
}

/// What is painted.
struct Animation<'a> {
    sim: &'a Simulator,
    run: (&'a Script, Option<u64>),
    /// Maximum number of steps, and that of the run.
    frames: u64,
    last: u64,
    /// Number of steps between two pictures.
    every: u64,
    /// Maximum size of the file, bytes.
    limit: u64,
}

impl Animation<'_> {
    /// Whether a state has a picture. The last one has one even if it falls between two.
    fn is_shown(&self, step: u64) -> bool {
        step.is_multiple_of(self.every) || step == self.last
    }

    /// How long a picture stays, in hundredths of a second. Rounded times add up to the time of the run.
    fn delay(&self, step: u64) -> u16 {
        let until = |step: u64| (100.0 * self.sim.world().step.times(u32::try_from(step).unwrap_or(u32::MAX))).round();
        match step == self.last {
            true => LAST,
            false => (until((step + self.every).min(self.last)) - until(step)).clamp(1.0, f64::from(u16::MAX)) as u16,
        }
    }

    /// Counts the colours of all pictures.
    fn colors(&self, film: &mut Film<'_>, watch: &dyn Watch) -> Result<Colors, NoAnimation> {
        let mut colors = Colors::default();
        each(self.sim, self.run, self.frames, watch, &mut |step, state| {
            if self.is_shown(step) {
                colors.count(film.paint(state));
            }
            ControlFlow::Continue(())
        })?;
        Ok(colors)
    }

    /// Paints and packs all pictures; nothing if the table has no room for a colour.
    fn paint(
        &self,
        film: &mut Film<'_>,
        table: &mut ColorTable,
        watch: &dyn Watch,
    ) -> Result<Option<Vec<u8>>, NoAnimation> {
        let size = film.size();
        let mut has_room = true;
        let (ended, frames) = packed(size, |pictures| {
            each(self.sim, self.run, self.frames, watch, &mut |step, state| {
                if !self.is_shown(step) {
                    return ControlFlow::Continue(());
                }
                let Some(indices) = table.indices(film.paint(state)) else {
                    has_room = false;
                    return ControlFlow::Break(());
                };
                pictures.add(indices, self.delay(step));
                // More is not worth the work, wherever it is found.
                if pictures.bytes() > self.limit { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
            })
        });
        ended?;
        if !has_room {
            return Ok(None);
        }
        let mut bytes = 0;
        let mut time = 0.0;
        for frame in &frames {
            bytes += frame.buffer.len() as u64;
            if bytes > self.limit {
                let step = (time / (100.0 * self.sim.world().step.seconds())).round() as u64;
                return Err(NoAnimation::TooLarge(self.limit, step));
            }
            time += f64::from(frame.delay);
        }
        file(size, table.colors().as_flattened(), &frames).map(Some).map_err(NoAnimation::Io)
    }
}

/// Calls a function with each state of a run.
fn each(
    sim: &Simulator,
    script: (&Script, Option<u64>),
    frames: u64,
    watch: &dyn Watch,
    on_state: &mut dyn FnMut(u64, &[u8]) -> ControlFlow<()>,
) -> Result<(), NoAnimation> {
    let ended = drive(sim, script, frames, watch, &mut |step, _, state, _| Ok(on_state(step, state)));
    match ended {
        Ok(super::sim::RunEnd::Stopped(_)) => Err(NoAnimation::Stopped),
        Ok(_) => Ok(()),
        Err(error) => Err(NoAnimation::Io(error)),
    }
}
