//! The paper's Test 1 and Test 2 written by hand: the baseline of the interpreter.
//!
//! The dynamics are hard-coded, in the order of steps of the 2017 system, whose recorded runs they reproduce bit for
//! bit. Positions are upper-left corners and y points up, as in `examples/paper`. Nothing is general, on purpose.

#![allow(dead_code, reason = "not every bench uses all of it")]

pub mod rrt;

/// The length of a step, s.
const DT: f64 = 1.0 / 60.0;

/// The buttons held during a step: any combination of these.
pub const LEFT: u8 = 1;
/// See [`LEFT`].
pub const RIGHT: u8 = 2;
/// See [`LEFT`].
pub const JUMP: u8 = 4;

/// A world written by hand; the value is its whole state.
pub trait ByHand: Copy {
    /// The possible inputs of a player.
    const INPUTS: &'static [u8];
    /// The state before the first step.
    fn start() -> Self;
    /// One step of time.
    fn step(&mut self, input: u8);
    /// Position and velocity of the player: x, x', y, y'.
    fn player(&self) -> [f64; 4];
    /// The x of both platforms.
    fn platforms(&self) -> [f64; 2];
}

/// The pushes of the player's contacts, and the contacts that its guards read.
struct Contacts {
    push_x: f64,
    push_y: f64,
    below: bool,
    above: bool,
}

impl Contacts {
    fn none() -> Self {
        Contacts { push_x: 0.0, push_y: 0.0, below: false, above: false }
    }

    /// The player against one box, by the distance of their centres and half their sizes.
    /// None if they are apart; otherwise whether the box is below.
    #[inline(always)]
    fn touch(&mut self, (dx, dy): (f64, f64), half: (f64, f64), other: (f64, f64)) -> Option<bool> {
        let apart_x = dx.abs() - half.0 - other.0;
        let apart_y = dy.abs() - half.1 - other.1;
        if apart_x > 0.0 || apart_y > 0.0 {
            return None;
        }
        if apart_x > apart_y {
            let push = if dx < 0.0 { -apart_x } else { apart_x };
            if push.abs() > self.push_x.abs() {
                self.push_x = push;
            }
            Some(false)
        } else if dy < 0.0 {
            if apart_y.abs() > self.push_y.abs() {
                self.push_y = -apart_y;
            }
            self.below = true;
            Some(true)
        } else {
            if apart_y.abs() > self.push_y.abs() {
                self.push_y = apart_y;
            }
            self.above = true;
            Some(false)
        }
    }

    /// The player against the tiles that it overlaps, at most two by two of them: column by column from below, a column
    /// being left at the first solid tile that is apart. `rows` holds a bit for each solid column, the lowest row
    /// first; a tile is `1 << size.0` wide and `1 << size.1` high.
    #[inline(always)]
    fn tiles(&mut self, rows: &[u32], size: (u32, u32), (x, y): (f64, f64), (w, h): (i32, i32)) {
        let (width, height) = (f64::from(1 << size.0), f64::from(1 << size.1));
        let (left, top) = (x as i32, y as i32);
        let (first, last) = (left >> size.0, (left + w) >> size.0);
        let (low, high) = ((top - h) >> size.1, top >> size.1);
        let lower = row(rows, low);
        let upper = if high != low { row(rows, high) } else { 0 };
        if lower | upper == 0 {
            return;
        }
        let half = (f64::from(w) / 2.0, f64::from(h) / 2.0);
        let centre = (x + half.0, y - half.1);
        let tile = (width / 2.0, height / 2.0);
        let to_lower = f64::from(low) * height + tile.1 - centre.1;
        let mut column = |at: i32| {
            if (at as u32) < 32 {
                let dx = f64::from(at) * width + tile.0 - centre.0;
                if lower >> at & 1 != 0 && self.touch((dx, to_lower), half, tile).is_none() {
                    return;
                }
                if upper >> at & 1 != 0 {
                    let to_upper = f64::from(high) * height + tile.1 - centre.1;
                    self.touch((dx, to_upper), half, tile);
                }
            }
        };
        column(first);
        if last != first {
            column(last);
        }
    }

    /// Pushes the player out along the axis of the smaller push.
    #[inline(always)]
    fn push(&self, x: &mut f64, vx: &mut f64, y: &mut f64, vy: &mut f64) {
        if self.push_x != 0.0 || self.push_y != 0.0 {
            if self.push_x.abs() < self.push_y.abs() {
                *y += self.push_y;
                *vy = 0.0;
            } else {
                *x += self.push_x;
                *vx = 0.0;
            }
        }
    }
}

/// The solid columns of a row; none outside of the map.
#[inline(always)]
fn row(rows: &[u32], at: i32) -> u32 {
    if (at as u32) < rows.len() as u32 { rows[at as usize] } else { 0 }
}

/// The modes of both kinds of platform.
#[derive(Clone, Copy, PartialEq)]
enum PlatformMode {
    Right,
    Wait,
    Left,
}

/// A platform: its mode, the time in it, its position.
#[derive(Clone, Copy)]
struct Platform {
    x: f64,
    time: f64,
    mode: PlatformMode,
}

impl Platform {
    /// One step between two positions; a platform with `WAITS` waits until it is touched.
    #[inline(always)]
    fn step<const WAITS: bool>(&mut self, touched: bool, left: f64, right: f64) {
        let next = match self.mode {
            PlatformMode::Wait if WAITS => {
                if touched {
                    PlatformMode::Right
                } else {
                    PlatformMode::Wait
                }
            }
            PlatformMode::Right => {
                if self.x >= right {
                    PlatformMode::Left
                } else {
                    PlatformMode::Right
                }
            }
            PlatformMode::Wait | PlatformMode::Left => {
                if self.x <= left {
                    PlatformMode::Right
                } else {
                    PlatformMode::Left
                }
            }
        };
        if next != self.mode {
            self.time = 0.0;
        }
        self.time += DT;
        self.mode = next;
        const SPEED: [f64; 3] = [30.0, 0.0, -30.0];
        self.x += SPEED[next as usize] * DT;
    }
}

/// The modes of Test 1's player.
#[derive(Clone, Copy, PartialEq)]
enum Walk {
    Right,
    Stop,
    Left,
}

/// Test 1.
#[derive(Clone, Copy)]
pub struct Test1 {
    x: f64,
    vx: f64,
    y: f64,
    vy: f64,
    time: f64,
    brown: Platform,
    blue: Platform,
    walk: Walk,
    on_brown: bool,
}

impl ByHand for Test1 {
    const INPUTS: &'static [u8] = &[0, LEFT, RIGHT];

    fn start() -> Self {
        Test1 {
            x: 0.0,
            vx: 0.0,
            y: 64.0,
            vy: 0.0,
            time: 0.0,
            brown: Platform { x: 96.0, time: 0.0, mode: PlatformMode::Wait },
            blue: Platform { x: 224.0, time: 0.0, mode: PlatformMode::Right },
            walk: Walk::Stop,
            on_brown: false,
        }
    }

    #[inline(always)]
    fn step(&mut self, input: u8) {
        let (left, right) = (input & LEFT != 0, input & RIGHT != 0);
        let next = match self.walk {
            Walk::Stop if right => Walk::Right,
            Walk::Stop if left => Walk::Left,
            Walk::Right if right => Walk::Right,
            Walk::Left if left => Walk::Left,
            _ => Walk::Stop,
        };
        if next != self.walk {
            self.time = 0.0;
        }
        self.time += DT;
        self.walk = next;
        const SPEED: [f64; 3] = [60.0, 0.0, -60.0];
        self.vx = SPEED[next as usize];
        self.x += self.vx * DT;
        self.vy += -1000.0 * DT;
        self.y += self.vy * DT;
        self.brown.step::<true>(self.on_brown, 96.0, 160.0);
        self.blue.step::<false>(false, 224.0, 288.0);

        const ROWS: [u32; 2] = [0b11_1000_0000_0111, 0];
        let mut contacts = Contacts::none();
        let (x, y) = (self.x + 8.0, self.y - 8.0);
        let (half, platform) = ((8.0, 8.0), (32.0, 8.0));
        let dy = (32.0 - 8.0) - y;
        self.on_brown = contacts.touch((self.brown.x + 32.0 - x, dy), half, platform) == Some(true);
        contacts.touch((self.blue.x + 32.0 - x, dy), half, platform);
        contacts.tiles(&ROWS, (5, 5), (self.x, self.y), (16, 16));
        contacts.push(&mut self.x, &mut self.vx, &mut self.y, &mut self.vy);
    }

    fn player(&self) -> [f64; 4] {
        [self.x, self.vx, self.y, self.vy]
    }

    fn platforms(&self) -> [f64; 2] {
        [self.brown.x, self.blue.x]
    }
}

/// The modes of Test 2's player.
#[derive(Clone, Copy, PartialEq)]
enum Jump {
    Falling,
    Control,
    Fixed,
    Ground,
}

/// Test 2.
#[derive(Clone, Copy)]
pub struct Test2 {
    x: f64,
    vx: f64,
    y: f64,
    vy: f64,
    /// The time in the air or on the ground.
    outer_time: f64,
    /// The time in the last mode in the air; constant on the ground.
    inner_time: f64,
    brown: Platform,
    green: Platform,
    jump: Jump,
    /// The last mode in the air.
    inner: Jump,
    on_brown: bool,
    below: bool,
    above: bool,
    held: bool,
}

impl ByHand for Test2 {
    const INPUTS: &'static [u8] = &[0, LEFT, RIGHT, JUMP, JUMP | LEFT, JUMP | RIGHT];

    fn start() -> Self {
        Test2 {
            x: 32.0,
            vx: 0.0,
            y: 96.0,
            vy: 0.0,
            outer_time: 0.0,
            inner_time: 0.0,
            brown: Platform { x: 96.0, time: 0.0, mode: PlatformMode::Wait },
            green: Platform { x: 96.0, time: 0.0, mode: PlatformMode::Right },
            jump: Jump::Falling,
            inner: Jump::Falling,
            on_brown: false,
            below: false,
            above: false,
            held: false,
        }
    }

    #[inline(always)]
    fn step(&mut self, input: u8) {
        let held = input & JUMP != 0;
        let pressed = held && !self.held;
        self.held = held;
        let last = self.jump;
        let next = if last == Jump::Ground {
            if !self.below {
                self.vy = 0.0;
                Jump::Falling
            } else if pressed {
                self.vy = 200.0;
                Jump::Control
            } else {
                Jump::Ground
            }
        } else if self.below {
            Jump::Ground
        } else if self.above {
            Jump::Falling
        } else {
            match last {
                Jump::Control if self.inner_time >= 0.7 || !held => Jump::Fixed,
                Jump::Fixed if self.vy <= 0.0 => Jump::Falling,
                _ => last,
            }
        };
        if (next == Jump::Ground) != (last == Jump::Ground) {
            self.outer_time = 0.0;
        }
        self.outer_time += DT;
        self.jump = next;

        let mode = if input & LEFT != 0 {
            -1.0
        } else if input & RIGHT != 0 {
            1.0
        } else {
            0.0
        };
        let (target, reach);
        if next == Jump::Ground {
            target = mode * 100.0;
            reach = 500.0 * DT;
            self.vy = -30.0;
        } else {
            if next != self.inner {
                self.inner_time = 0.0;
                self.inner = next;
            }
            self.inner_time += DT;
            target = if mode != 0.0 { mode * 100.0 } else { self.vx };
            reach = 200.0 * DT;
            const GRAVITY: [f64; 4] = [-400.0, -250.0, -250.0, 0.0];
            self.vy += GRAVITY[next as usize] * DT;
        }
        let missing = target - self.vx;
        self.vx = if missing > 0.1 {
            let faster = self.vx + reach;
            if faster > target { target } else { faster }
        } else if missing < -0.1 {
            let slower = self.vx - reach;
            if slower < target { target } else { slower }
        } else {
            target
        };
        self.x += self.vx * DT;
        self.y += self.vy * DT;
        self.brown.step::<true>(self.on_brown, 96.0, 160.0);
        self.green.step::<false>(false, 96.0, 160.0);

        const ROWS: [u32; 5] = [0b111, 0, 0, 0b111, 0];
        let mut contacts = Contacts::none();
        let (x, y) = (self.x + 16.0, self.y - 16.0);
        let (half, platform) = ((16.0, 16.0), (32.0, 8.0));
        self.on_brown = contacts.touch((self.brown.x + 32.0 - x, 128.0 - 8.0 - y), half, platform) == Some(true);
        contacts.touch((self.green.x + 32.0 - x, 192.0 - 8.0 - y), half, platform);
        contacts.tiles(&ROWS, (5, 6), (self.x, self.y), (32, 32));
        self.below = contacts.below;
        self.above = contacts.above;
        contacts.push(&mut self.x, &mut self.vx, &mut self.y, &mut self.vy);
    }

    fn player(&self) -> [f64; 4] {
        [self.x, self.vx, self.y, self.vy]
    }

    fn platforms(&self) -> [f64; 2] {
        [self.brown.x, self.green.x]
    }
}
