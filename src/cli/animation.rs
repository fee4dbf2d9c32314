//! `hypedc sim --gif`: the run as an animation. The run is simulated three times: to see where the players go, to count the
//! colours, and to paint. So one table of colours serves all pictures, and no picture is kept. A picture holds only the rectangle that has changed.

use std::borrow::Cow;
use std::fs;
use std::io;
use std::ops::ControlFlow;
use std::path::Path;

use gif::{DisposalMethod, Encoder, Frame, Repeat};

use crate::sim::{Script, Simulator};
use crate::view::{Canvas, Colors, Film, FilmOptions, Images, PlayerArea};
use crate::watch::Watch;

use super::args::GifArgs;
use super::sim::drive;

/// The shortest time of a picture that browsers keep to, in hundredths of a second.
const SHORTEST: f64 = 3.0;
/// How long the last picture stays, in hundredths of a second.
const LAST: u16 = 150;
/// The number that stands for what does not change.
const UNCHANGED: u8 = 255;

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
    let mut players = PlayerArea::new(sim);
    each(sim, (script, chance), frames, watch, &mut |_, state| {
        players.observe(sim, state);
        ControlFlow::Continue(())
    })?;
    let mut film = Film::new(sim, options, images, &players);
    let step = 100.0 * sim.world().step.seconds();
    let every = args.every.unwrap_or_else(|| libm::ceil(SHORTEST / step - 1e-9).max(1.0) as u64).max(1);
    let mut steps = 0;
    let mut colors = Colors::default();
    each(sim, (script, chance), frames, watch, &mut |step, state| {
        steps = step;
        if step.is_multiple_of(every) {
            colors.count(film.paint(state));
        }
        ControlFlow::Continue(())
    })?;
    let last = steps;
    // The last state is shown even if it falls between two pictures.
    let is_shown = |step: u64| step.is_multiple_of(every) || step == last;
    let table = colors.table();
    film.restart();
    let (width, height) = film.size();
    let limit = args.max_size * (1 << 20);
    let mut file = Pictures::new((width, height), table.colors().as_flattened()).map_err(NoAnimation::Io)?;
    let mut broken: Option<NoAnimation> = None;
    each(sim, (script, chance), frames, watch, &mut |step, state| {
        if !is_shown(step) {
            return ControlFlow::Continue(());
        }
        let canvas: &Canvas = film.paint(state);
        // Rounded times add up to the time of the run.
        let until = |step: u64| (100.0 * sim.world().step.times(u32::try_from(step).unwrap_or(u32::MAX))).round();
        let delay = if step == last { f64::from(LAST) } else { until((step + every).min(last)) - until(step) };
        let added = file.add(table.indices(canvas), delay.clamp(1.0, f64::from(u16::MAX)) as u16);
        broken = match added {
            Err(error) => Some(NoAnimation::Io(error)),
            Ok(size) if size > limit => Some(NoAnimation::TooLarge(limit, step)),
            Ok(_) => return ControlFlow::Continue(()),
        };
        ControlFlow::Break(())
    })?;
    match broken {
        Some(why) => Err(why),
        None => fs::write(path, file.finish().map_err(NoAnimation::Io)?).map_err(NoAnimation::Io),
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

/// A GIF file in memory.
struct Pictures {
    encoder: Encoder<Vec<u8>>,
    size: (usize, usize),
    /// The picture before, and the one that is not written yet, with its time.
    before: Vec<u8>,
    waiting: Option<(Vec<u8>, u16)>,
}

impl Pictures {
    fn new(size: (usize, usize), colors: &[u8]) -> io::Result<Pictures> {
        let side = |side: usize| u16::try_from(side).unwrap_or(u16::MAX);
        let mut encoder = Encoder::new(Vec::new(), side(size.0), side(size.1), colors).map_err(io::Error::other)?;
        encoder.set_repeat(Repeat::Infinite).map_err(io::Error::other)?;
        Ok(Pictures { encoder, size, before: Vec::new(), waiting: None })
    }

    /// Adds a picture that is shown for a time; one like the last only prolongs it. Returns the size of the file so far.
    fn add(&mut self, indices: Vec<u8>, delay: u16) -> io::Result<u64> {
        if let Some((waiting, time)) = &mut self.waiting
            && *waiting == indices
            && let Some(both) = time.checked_add(delay)
        {
            *time = both;
        } else {
            self.write_waiting()?;
            self.waiting = Some((indices, delay));
        }
        Ok(self.encoder.get_ref().len() as u64)
    }

    fn write_waiting(&mut self) -> io::Result<()> {
        let Some((indices, delay)) = self.waiting.take() else { return Ok(()) };
        let (width, _) = self.size;
        let [left, top, right, bottom] = changed(&self.before, &indices, self.size);
        let mut buffer = Vec::with_capacity((right - left) * (bottom - top));
        for row in top..bottom {
            let (from, to) = (row * width + left, row * width + right);
            let before = self.before.get(from..to).unwrap_or_default();
            buffer.extend(
                indices[from..to]
                    .iter()
                    .enumerate()
                    .map(|(at, index)| if before.get(at) == Some(index) { UNCHANGED } else { *index }),
            );
        }
        let side = |side: usize| u16::try_from(side).unwrap_or(u16::MAX);
        let frame = Frame {
            delay,
            dispose: DisposalMethod::Keep,
            transparent: (!self.before.is_empty()).then_some(UNCHANGED),
            left: side(left),
            top: side(top),
            width: side(right - left),
            height: side(bottom - top),
            buffer: Cow::Owned(buffer),
            ..Frame::default()
        };
        self.encoder.write_frame(&frame).map_err(io::Error::other)?;
        self.before = indices;
        Ok(())
    }

    fn finish(mut self) -> io::Result<Vec<u8>> {
        self.write_waiting()?;
        self.encoder.into_inner().map_err(io::Error::other)
    }
}

/// The rectangle in which two pictures differ: left, top, right, bottom; one pixel if they are the same.
fn changed(before: &[u8], after: &[u8], (width, height): (usize, usize)) -> [usize; 4] {
    if before.is_empty() {
        return [0, 0, width, height];
    }
    let rows = before.chunks(width).zip(after.chunks(width)).enumerate();
    let differing: Vec<(usize, &[u8], &[u8])> =
        rows.filter(|(_, (a, b))| a != b).map(|(row, (a, b))| (row, a, b)).collect();
    let (Some((top, ..)), Some((bottom, ..))) = (differing.first(), differing.last()) else { return [0, 0, 1, 1] };
    let first = |(_, a, b): &(usize, &[u8], &[u8])| a.iter().zip(*b).position(|(a, b)| a != b);
    let last = |(_, a, b): &(usize, &[u8], &[u8])| a.iter().zip(*b).rposition(|(a, b)| a != b);
    let left = differing.iter().filter_map(first).min().unwrap_or(0);
    let right = differing.iter().filter_map(last).max().map_or(width, |column| column + 1);
    [left, *top, right, bottom + 1]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_changes_is_written() {
        let mut after = vec![0; 20];
        after[7] = 1;
        after[13] = 2;
        assert_eq!(changed(&[0; 20], &after, (5, 4)), [2, 1, 4, 3]);
        assert_eq!(changed(&after, &after, (5, 4)), [0, 0, 1, 1]);
        assert_eq!(changed(&[], &after, (5, 4)), [0, 0, 5, 4]);
    }
}
