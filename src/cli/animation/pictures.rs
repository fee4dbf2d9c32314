//! The pictures of an animation: each holds only the rectangle that has changed, and they are packed on several threads,
//! beside the painting. The file is the same for any number of threads.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::io;
use std::sync::mpsc::{Receiver, Sender, SyncSender, channel, sync_channel};
use std::sync::{Mutex, PoisonError};
use std::thread;

use gif::{DisposalMethod, Encoder, Frame, Repeat};

use crate::parallel;

/// The number that stands for what does not change.
const UNCHANGED: u8 = 255;
/// Maximum number of threads that pack; more would wait for the painting.
const MAX_THREADS: usize = 4;
/// Maximum number of pictures that wait to be packed.
const MAX_WAITING: usize = 16;

/// A picture with its number.
type Numbered = (usize, Frame<'static>);

/// Pictures that are packed.
pub(super) struct Pictures {
    size: (usize, usize),
    /// The picture before, and the one that is not sent yet, with its time.
    before: Vec<u8>,
    waiting: Option<(Vec<u8>, u16)>,
    to_pack: Option<SyncSender<Numbered>>,
    packed: Receiver<Numbered>,
    sent: usize,
    /// Packed pictures; those after a gap are not counted yet.
    done: BTreeMap<usize, Frame<'static>>,
    counted: usize,
    bytes: u64,
}

/// Calls a function that adds pictures. Returns what it returns, and the packed pictures in order.
pub(super) fn packed<R>(size: (usize, usize), add: impl FnOnce(&mut Pictures) -> R) -> (R, Vec<Frame<'static>>) {
    let (to_pack, jobs) = sync_channel::<Numbered>(MAX_WAITING);
    let (result, packed) = channel::<Numbered>();
    let jobs = Mutex::new(jobs);
    let threads = parallel::threads(None).min(MAX_THREADS);
    thread::scope(|scope| {
        for _ in 0..threads {
            let (jobs, result) = (&jobs, result.clone());
            scope.spawn(move || pack(jobs, &result));
        }
        drop(result);
        let mut pictures = Pictures {
            size,
            before: Vec::new(),
            waiting: None,
            to_pack: Some(to_pack),
            packed,
            sent: 0,
            done: BTreeMap::new(),
            counted: 0,
            bytes: 0,
        };
        let returned = add(&mut pictures);
        pictures.send();
        pictures.to_pack = None;
        while let Ok((number, frame)) = pictures.packed.recv() {
            pictures.done.insert(number, frame);
        }
        (returned, pictures.done.into_values().collect())
    })
}

/// Packs pictures until there are no more.
fn pack(jobs: &Mutex<Receiver<Numbered>>, result: &Sender<Numbered>) {
    loop {
        let job = jobs.lock().unwrap_or_else(PoisonError::into_inner).recv();
        let Ok((number, mut frame)) = job else { return };
        frame.make_lzw_pre_encoded();
        // It has reserved much more than it needs.
        let mut bytes = frame.buffer.into_owned();
        bytes.shrink_to_fit();
        frame.buffer = Cow::Owned(bytes);
        if result.send((number, frame)).is_err() {
            return;
        }
    }
}

/// The file of packed pictures.
pub(super) fn file(size: (usize, usize), colors: &[u8], frames: &[Frame<'_>]) -> io::Result<Vec<u8>> {
    let mut encoder = Encoder::new(Vec::new(), side(size.0), side(size.1), colors).map_err(io::Error::other)?;
    encoder.set_repeat(Repeat::Infinite).map_err(io::Error::other)?;
    for frame in frames {
        encoder.write_lzw_pre_encoded_frame(frame).map_err(io::Error::other)?;
    }
    encoder.into_inner().map_err(io::Error::other)
}

impl Pictures {
    /// Adds a picture that is shown for a time; one like the last only prolongs it.
    pub fn add(&mut self, indices: Vec<u8>, delay: u16) {
        if let Some((waiting, time)) = &mut self.waiting
            && *waiting == indices
            && let Some(both) = time.checked_add(delay)
        {
            *time = both;
        } else {
            self.send();
            self.waiting = Some((indices, delay));
        }
    }

    /// The size of the pictures that are packed by now, bytes.
    pub fn bytes(&mut self) -> u64 {
        while let Ok((number, frame)) = self.packed.try_recv() {
            self.done.insert(number, frame);
        }
        while let Some(frame) = self.done.get(&self.counted) {
            self.bytes += frame.buffer.len() as u64;
            self.counted += 1;
        }
        self.bytes
    }

    fn send(&mut self) {
        let Some((indices, delay)) = self.waiting.take() else { return };
        let (width, _) = self.size;
        let [left, top, right, bottom] = changed(&self.before, &indices, self.size);
        let mut buffer = Vec::with_capacity((right - left) * (bottom - top));
        for row in top..bottom {
            let (from, to) = (row * width + left, row * width + right);
            let now = indices.get(from..to).unwrap_or_default();
            match self.before.get(from..to) {
                Some(before) => {
                    let pairs = now.iter().zip(before);
                    buffer.extend(pairs.map(|(now, before)| if now == before { UNCHANGED } else { *now }));
                }
                None => buffer.extend_from_slice(now),
            }
        }
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
        if let Some(to_pack) = &self.to_pack {
            // Infallible: the threads take pictures until this end is dropped.
            let _ = to_pack.send((self.sent, frame));
        }
        self.sent += 1;
        self.before = indices;
    }
}

fn side(side: usize) -> u16 {
    u16::try_from(side).unwrap_or(u16::MAX)
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

    #[test]
    fn pictures_keep_their_order() {
        let (size, picture) = ((64, 64), |number: usize| vec![(number % 7) as u8; 64 * 64]);
        let ((), frames) = packed(size, |pictures| {
            for number in 0..200 {
                pictures.add(picture(number), 2);
                // The same again only prolongs it.
                pictures.add(picture(number), number as u16);
            }
        });
        let delays: Vec<u16> = frames.iter().map(|frame| frame.delay).collect();
        assert_eq!(delays, (2..202).collect::<Vec<u16>>());
        assert!(file(size, &[0; 21], &frames).is_ok());
    }
}
