//! A plain RRT written by hand over the worlds written by hand: the baseline of searches.
//!
//! LaValle, *Rapidly-Exploring Random Trees: A New Tool for Path Planning*, 1998, as in the 2017 system: positions in
//! px, velocities in px/s, timers in s, each different mode adds 10 squared; an input is held for ten steps; each input
//! of a node is tried once. The nearest node is found by brute force, in blocks that the compiler vectorises.

use super::{ByHand, Jump, Platform, Test1, Test2};

/// Number of nodes in a block.
const LANES: usize = 16;
/// Maximum number of coordinates of a point, modes included.
const MAX_ROWS: usize = 22;
/// Number of modes at the end of a point.
const MODES: usize = 3;
/// The squared distance that a different mode adds.
const PENALTY: f32 = 100.0;
/// The coordinate of removed nodes, all of whose inputs were tried; its square is finite.
const REMOVED: f32 = 1e18;
/// Number of steps that an input is held.
const HOLD: u32 = 10;
/// One of this number of samples has the position of the goal.
const GOAL_EVERY: u32 = 20;

/// A state as a point: the player's x, x', y and y', all other variables, then the modes.
pub type Point = [f32; MAX_ROWS];

/// A world that an RRT can be grown in.
pub trait Planned: ByHand + Send {
    /// Number of coordinates of its points, modes included.
    const ROWS: usize;
    /// The target of the goal bias.
    const GOAL: (f32, f32);
    /// The width of the map, px.
    const WIDTH: u32;
    /// A bit for each of the inputs that the active mode reads.
    fn available(&self) -> u8;
    /// The state as a point.
    fn point(&self) -> Point;
    /// A random point within the bounds of each mode.
    fn sample(random: &mut Random) -> Point;
}

/// A tree that grows.
pub struct Tree<W> {
    random: Random,
    states: Vec<W>,
    parents: Vec<u32>,
    /// The input that led to a node, as an index into the world's.
    inputs: Vec<u8>,
    /// A bit for each untried input.
    untried: Vec<u8>,
    /// A block has a row for each coordinate.
    blocks: Vec<[f32; LANES]>,
    /// Number of inputs tried.
    pub extensions: usize,
}

impl<W: Planned> Tree<W> {
    /// A tree of one node.
    pub fn new(seed: u64) -> Self {
        let mut tree = Tree {
            random: Random::new(seed),
            states: Vec::new(),
            parents: Vec::new(),
            inputs: Vec::new(),
            untried: Vec::new(),
            blocks: Vec::new(),
            extensions: 0,
        };
        tree.push(W::start(), 0, 0);
        tree
    }

    /// The number of nodes.
    pub fn len(&self) -> usize {
        self.states.len()
    }

    /// Grows up to a number of nodes. Panics if all inputs of all nodes were tried.
    pub fn grow_to(&mut self, nodes: usize) {
        while self.len() < nodes {
            let toward = self.sample();
            let node = self.nearest(&toward).expect("there is more to try");
            self.extend(node);
        }
    }

    /// The next sample.
    pub fn sample(&mut self) -> Point {
        let mut toward = W::sample(&mut self.random);
        if self.random.below(GOAL_EVERY) == 0 {
            (toward[0], toward[2]) = W::GOAL;
        }
        toward
    }

    /// Tries one of the untried inputs of a node.
    fn extend(&mut self, node: usize) {
        let mut left = self.untried[node];
        for _ in 0..self.random.below(left.count_ones()) {
            left &= left - 1;
        }
        let input = left.trailing_zeros() as u8;
        self.untried[node] &= !(1 << input);
        if self.untried[node] == 0 {
            self.blocks[node / LANES * W::ROWS][node % LANES] = REMOVED;
        }
        self.extensions += 1;
        let mut state = self.states[node];
        for _ in 0..HOLD {
            state.step(W::INPUTS[usize::from(input)]);
            let [x, _, y, _] = state.player();
            if !(0.0..=f64::from(W::WIDTH)).contains(&x) || y < 0.0 {
                return;
            }
        }
        self.push(state, node as u32, input);
    }

    fn push(&mut self, state: W, parent: u32, input: u8) {
        let lane = self.len() % LANES;
        if lane == 0 {
            self.blocks.resize(self.blocks.len() + W::ROWS, [0.0; LANES]);
            // Lanes without a node are never the nearest.
            let first = self.blocks.len() - W::ROWS;
            self.blocks[first] = [REMOVED; LANES];
        }
        let first = self.blocks.len() - W::ROWS;
        for (row, value) in self.blocks[first..].iter_mut().zip(state.point()) {
            row[lane] = value;
        }
        self.states.push(state);
        self.parents.push(parent);
        self.inputs.push(input);
        self.untried.push(state.available());
    }

    /// The nearest node that has an untried input, the first of equals.
    pub fn nearest(&self, to: &Point) -> Option<usize> {
        let (mut nearest, mut least) = (None, REMOVED);
        for (number, block) in self.blocks.chunks_exact(W::ROWS).enumerate() {
            let (reals, modes) = block.split_at(W::ROWS - MODES);
            let mut sums = [0.0f32; LANES];
            for (row, value) in reals.iter().zip(to) {
                for lane in 0..LANES {
                    let d = row[lane] - value;
                    sums[lane] += d * d;
                }
            }
            for (row, value) in modes.iter().zip(&to[reals.len()..]) {
                for lane in 0..LANES {
                    sums[lane] += if row[lane] == *value { 0.0 } else { PENALTY };
                }
            }
            let mut lowest = sums[0];
            for sum in sums {
                lowest = if sum < lowest { sum } else { lowest };
            }
            if lowest < least {
                least = lowest;
                nearest = sums.iter().position(|sum| *sum == lowest).map(|lane| number * LANES + lane);
            }
        }
        nearest
    }

    /// As [`Tree::nearest`], one node after the other.
    pub fn nearest_one_by_one(&self, to: &Point) -> Option<usize> {
        let distance = |node: usize| {
            let point = self.states[node].point();
            let mut pairs = point[..W::ROWS].iter().zip(to);
            let reals: f32 = pairs.by_ref().take(W::ROWS - MODES).map(|(a, b)| (a - b) * (a - b)).sum();
            pairs.fold(reals, |sum, (a, b)| if a == b { sum } else { sum + PENALTY })
        };
        let open = (0..self.len()).filter(|node| self.untried[*node] != 0);
        open.min_by(|a, b| distance(*a).total_cmp(&distance(*b)))
    }

    /// Whether the inputs of a node's path lead from the start to its state.
    pub fn replays(&self, node: usize) -> bool {
        let mut mode = Vec::new();
        let mut at = node;
        while at != 0 {
            mode.push(self.inputs[at]);
            at = self.parents[at] as usize;
        }
        let mut state = W::start();
        for input in mode.into_iter().rev() {
            for _ in 0..HOLD {
                state.step(W::INPUTS[usize::from(input)]);
            }
        }
        state.player() == self.states[node].player() && state.platforms() == self.states[node].platforms()
    }
}

impl Platform {
    /// Its position, its velocity, and a timer for each of its modes; a platform that never waits has two.
    fn point(&self, waits: bool, out: &mut [f32]) {
        out[0] = self.x as f32;
        out[1] = [30.0, 0.0, -30.0][self.mode as usize];
        out[2 + timer(self.mode as usize, waits)] = self.time as f32;
    }

    /// Writes a random platform; returns its mode.
    fn sample(random: &mut Random, waits: bool, width: u32, out: &mut [f32]) -> f32 {
        let mode = if waits { random.below(3) } else { 2 * random.below(2) } as usize;
        out[0] = random.up_to(width);
        out[1] = [30.0, 0.0, -30.0][mode];
        out[2 + timer(mode, waits)] = random.up_to(10);
        mode as f32
    }
}

/// The timer of a platform's mode.
fn timer(mode: usize, waits: bool) -> usize {
    if waits { mode } else { mode / 2 }
}

impl Planned for Test1 {
    // The player has four and a timer for each of three modes, the platforms five and four.
    const ROWS: usize = 4 + 3 + 5 + 4 + MODES;
    const GOAL: (f32, f32) = (416.0, 48.0);
    const WIDTH: u32 = 448;

    fn available(&self) -> u8 {
        // A walking player does not read the other button.
        [0b101, 0b111, 0b011][self.walk as usize]
    }

    #[inline(always)]
    fn point(&self) -> Point {
        let mut out = [0.0; MAX_ROWS];
        out[..4].copy_from_slice(&self.player().map(|value| value as f32));
        out[4 + self.walk as usize] = self.time as f32;
        self.brown.point(true, &mut out[7..]);
        self.blue.point(false, &mut out[12..]);
        out[16..Self::ROWS]
            .copy_from_slice(&[self.walk as u8, self.brown.mode as u8, self.blue.mode as u8].map(f32::from));
        out
    }

    fn sample(random: &mut Random) -> Point {
        let mut out = [0.0; MAX_ROWS];
        let walk = random.below(3) as usize;
        let speed = [60.0, 0.0, -60.0][walk];
        out[0] = random.up_to(Self::WIDTH);
        // A wall stops it.
        out[1] = if random.below(2) == 0 { 0.0 } else { speed };
        out[2] = random.up_to(64);
        out[3] = -random.up_to(1000);
        out[4 + walk] = random.up_to(10);
        let brown = Platform::sample(random, true, Self::WIDTH, &mut out[7..]);
        let blue = Platform::sample(random, false, Self::WIDTH, &mut out[12..]);
        out[16..Self::ROWS].copy_from_slice(&[walk as f32, brown, blue]);
        out
    }
}

impl Planned for Test2 {
    // The player has five and a timer for each of five modes.
    const ROWS: usize = 5 + 5 + 5 + 4 + MODES;
    const GOAL: (f32, f32) = (32.0, 288.0);
    const WIDTH: u32 = 384;

    fn available(&self) -> u8 {
        // The button tells whether a jump begins, and how long it goes on.
        if matches!(self.jump, Jump::Ground | Jump::Control) { 0b11_1111 } else { 0b00_0111 }
    }

    #[inline(always)]
    fn point(&self) -> Point {
        let mut out = [0.0; MAX_ROWS];
        out[..4].copy_from_slice(&self.player().map(|value| value as f32));
        out[4] = [-400.0, -250.0, -250.0, 0.0][self.jump as usize];
        out[if self.jump == Jump::Ground { 9 } else { 5 }] = self.outer_time as f32;
        out[6 + self.inner as usize] = self.inner_time as f32;
        self.brown.point(true, &mut out[10..]);
        self.green.point(false, &mut out[15..]);
        out[19..Self::ROWS]
            .copy_from_slice(&[self.jump as u8, self.brown.mode as u8, self.green.mode as u8].map(f32::from));
        out
    }

    fn sample(random: &mut Random) -> Point {
        let mut out = [0.0; MAX_ROWS];
        let jump = random.below(4) as usize;
        out[0] = random.up_to(Self::WIDTH);
        out[1] = random.up_to(200) - 100.0;
        out[2] = random.up_to(320);
        if jump == Jump::Ground as usize {
            out[3] = [-30.0, 0.0, 200.0][random.below(3) as usize];
            out[9] = random.up_to(10);
        } else {
            out[3] = random.up_to(1200) - 1000.0;
            out[4] = [-400.0, -250.0, -250.0][jump];
            out[5] = random.up_to(10);
            out[6 + jump] = random.up_to(10);
        }
        let brown = Platform::sample(random, true, Self::WIDTH, &mut out[10..]);
        let green = Platform::sample(random, false, Self::WIDTH, &mut out[15..]);
        out[19..Self::ROWS].copy_from_slice(&[jump as f32, brown, green]);
        out
    }
}

/// Random numbers (xorshift64*).
pub struct Random(u64);

impl Random {
    fn new(seed: u64) -> Self {
        Random(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) ^ 0xD1B5_4A32_D192_ED03)
    }

    #[inline(always)]
    fn below(&mut self, many: u32) -> u32 {
        let mut x = self.0;
        x ^= x >> 12;
        x ^= x << 25;
        x ^= x >> 27;
        self.0 = x;
        let drawn = x.wrapping_mul(0x2545_F491_4F6C_DD1D);
        (((drawn >> 32) * u64::from(many)) >> 32) as u32
    }

    /// A whole number from 0 on, the last included.
    #[inline(always)]
    fn up_to(&mut self, last: u32) -> f32 {
        self.below(last + 1) as f32
    }
}
