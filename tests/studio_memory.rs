//! An hour of play takes bounded memory: the history is kept as inputs, with a bounded number of states.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::path::PathBuf;

use hypedc::studio::{Held, Level, Request, Session};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

use crate::studio::shown;
use crate::support::Disk;

/// Steps of a minute and of an hour.
const MINUTE: u64 = 3_600;
const HOUR: u64 = 60 * MINUTE;
/// Maximum number of bytes that an hour takes: states that are kept, and inputs that change five times a second.
const MAX_BYTES: i64 = 6 << 20;

/// Plays random inputs, each held for 12 steps, up to a number of steps. Returns the steps that there are then.
fn played(session: &mut Session, rng: &mut Pcg64, until: u64) -> u64 {
    let mut length = 0;
    while length < until {
        let mut inputs: Vec<Vec<Held>> = Vec::new();
        while (inputs.len() as u64) < MINUTE {
            let held = vec![Held { buttons: vec![], axes: vec![axis(rng), axis(rng)] }];
            inputs.extend(std::iter::repeat_n(held, 12));
        }
        let now = shown(session.answer(Request::Play { inputs }));
        assert_eq!(now.ended, None, "at {length}");
        length = now.length;
    }
    length
}

fn axis(rng: &mut Pcg64) -> f64 {
    f64::from(rng.random_range(-1..=1))
}

/// The bytes that stay allocated after some work, on this thread.
fn kept(work: impl FnOnce()) -> i64 {
    allocation_counter::measure(work).bytes_current
}

#[test]
fn an_hour_of_play_takes_bounded_memory() {
    // A maze with ghosts that never ends a run.
    let path = PathBuf::from("examples/pac_man.hyped");
    let mut session = Session::new(Box::new(Disk), path, Level::default(), Box::new(|task| task()));
    session.answer(Request::Open { world: None });
    let mut rng = Pcg64::seed_from_u64(1);
    let first = kept(|| assert_eq!(played(&mut session, &mut rng, HOUR / 2), HOUR / 2));
    let second = kept(|| assert_eq!(played(&mut session, &mut rng, HOUR), HOUR));
    println!("{first} bytes for the first half, {second} for the second");
    assert!(first + second < MAX_BYTES, "{first} and {second} bytes");
    // By then all states are kept that ever are: only inputs are added.
    assert!(second < first, "{first} bytes for the first half, {second} for the second");
    // Looking around and taking over adds nothing.
    let looked = kept(|| {
        for frame in [0, HOUR, 1_000, HOUR / 2, HOUR - 1] {
            assert_eq!(shown(session.answer(Request::Seek { frame })).frame.at, frame);
        }
    });
    assert!(looked < 1 << 16, "{looked} bytes");
    let taken_over = kept(|| {
        session.answer(Request::Seek { frame: MINUTE });
        assert_eq!(played(&mut session, &mut rng, MINUTE), 2 * MINUTE);
    });
    assert!(taken_over < 0, "the inputs after that frame are dropped: {taken_over} bytes");
}
