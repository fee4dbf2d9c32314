//! Test 1 of the paper written by hand in Rust: the measure for the batches of `peers.py`, which compiles and runs it.
//! Each line that it reads asks for a round; it prints the frames a second of one run after the other, and of a batch.

#[path = "../../../benches/yardstick/mod.rs"]
mod yardstick;

use std::fs;
use std::hint::black_box;
use std::io::BufRead;
use std::sync::OnceLock;
use std::time::Instant;

use yardstick::{ByHand, Test1};

/// Steps of a round, and rows of the batch.
const STEPS: u64 = 2_000_000;
const ROWS: usize = 1024;
/// The most steps of an episode.
const LONGEST: u32 = 600;

/// Random numbers (xorshift64*).
struct Draws(u64);

impl Draws {
    fn next(&mut self) -> u64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        self.0.wrapping_mul(0x2545_F491_4F6C_DD1D)
    }

    fn input(&mut self) -> u8 {
        let all = Test1::INPUTS;
        all[((self.next() >> 40) as usize * all.len()) >> 24]
    }
}

/// Seconds of processor time; on systems that do not tell, of the clock.
fn seconds() -> f64 {
    static START: OnceLock<Instant> = OnceLock::new();
    let on_processor = fs::read_to_string("/proc/self/schedstat").ok();
    let nanoseconds = on_processor.and_then(|text| text.split(' ').next()?.parse::<f64>().ok());
    nanoseconds.map_or_else(|| START.get_or_init(Instant::now).elapsed().as_secs_f64(), |of| of / 1e9)
}

/// Whether the screen of the paper was left, or the ground.
fn is_over(world: &Test1) -> bool {
    let [x, _, y, _] = world.player();
    !(0.0..=448.0).contains(&x) || y < 0.0
}

/// One run after the other, with inputs that are held for 1 to 32 steps and the state copied at each step, as a search
/// does.
fn one_by_one(draws: &mut Draws) -> f64 {
    let before = seconds();
    let (mut world, mut episode, mut done) = (Test1::start(), 0, 0);
    while done < STEPS {
        let (input, hold) = (draws.input(), (draws.next() & 31) as u32 + 1);
        for _ in 0..hold {
            let mut copy = black_box(world);
            copy.step(input);
            world = copy;
        }
        (done, episode) = (done + u64::from(hold), episode + hold);
        if is_over(&world) || episode >= LONGEST {
            (world, episode) = (Test1::start(), 0);
        }
    }
    black_box(world);
    done as f64 / (seconds() - before)
}

/// A batch: one step of all rows after the other, with an input for each row, what is over begins anew.
fn batch(draws: &mut Draws) -> f64 {
    let inputs: Vec<Vec<u8>> = (0..16).map(|_| (0..ROWS).map(|_| draws.input()).collect()).collect();
    let mut rows = vec![(Test1::start(), false); ROWS];
    let steps = STEPS as usize / ROWS;
    let before = seconds();
    for step in 0..steps {
        let inputs = black_box(&inputs[step / 8 % 16]);
        for ((world, is_done), &input) in rows.iter_mut().zip(inputs) {
            if *is_done {
                (*world, *is_done) = (Test1::start(), false);
                continue;
            }
            world.step(input);
            *is_done = is_over(world);
        }
        black_box(&mut rows);
    }
    (steps * ROWS) as f64 / (seconds() - before)
}

fn main() {
    let mut draws = Draws(7);
    for _ in std::io::stdin().lock().lines() {
        println!("{:.0} {:.0}", one_by_one(&mut draws), batch(&mut draws));
    }
}
