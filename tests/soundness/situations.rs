//! Typical situations in games, with random numbers: a lift and its rider, a door that closes again, a jump that ends
//! under a ledge. In a random world they rarely occur.

use super::arena::STEPS;
use super::frame::number;
use super::generate::{Generator, NAMES, Palette, Plan};
use crate::support::draw::Draw;

/// The subject of a world.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Situation {
    /// An instance that touches something is moved away, and continues as if it still touched it.
    Stale,
    /// Others read an instance while it is destroyed.
    Dying,
    /// An instance that never moves is present in some modes and absent in others.
    Door,
    /// Riders on a moving instance, or on other riders.
    Lift,
    /// A body of several sizes between narrow walls.
    Growing,
    /// Walls, bodies and steps of about the same size.
    Thin,
    /// A jump that updates change, and a ledge of similar height.
    Jump,
    /// Rooms apart from each other, and links into them.
    Rooms,
    /// A body that moves along one axis, and the edge of a block that it almost misses.
    Graze,
}

impl Situation {
    const ALL: [Situation; 9] = [
        Situation::Jump,
        Situation::Stale,
        Situation::Dying,
        Situation::Door,
        Situation::Lift,
        Situation::Growing,
        Situation::Thin,
        Situation::Rooms,
        Situation::Graze,
    ];

    pub fn draw(draw: &mut Draw<'_>) -> Option<Situation> {
        draw.chance(35).then(|| Situation::ALL[draw.pick(Situation::ALL.len())])
    }

    /// Other features that such a world can use.
    pub fn palette(self, mut palette: Palette) -> Palette {
        palette.extremes = false;
        palette.inputs = true;
        palette.others &= self == Situation::Dying;
        (palette.spawns, palette.ends, palette.signals, palette.is_small) = (false, false, false, true);
        palette
    }

    /// The entities: the player's, and those that it touches.
    pub fn plans(self, draw: &mut Draw<'_>) -> Vec<Plan> {
        let modes: &[&[&str]] = match self {
            Situation::Stale | Situation::Growing | Situation::Jump => &[&["m00", "m01"]],
            Situation::Dying | Situation::Door => &[&["m00"], &["m00", "m01"]],
            Situation::Lift if draw.chance(50) => &[&["m00"], &["m00", "m01"], &[]],
            Situation::Lift => &[&["m00"], &["m00", "m01"]],
            Situation::Thin | Situation::Rooms | Situation::Graze => &[&["m00"]],
        };
        let plan = |(index, modes): (usize, &&[&str])| Plan {
            name: NAMES[index].0.into(),
            tag: NAMES[index].1,
            nameless: None,
            modes: if modes.is_empty() { Vec::new() } else { vec![modes.iter().map(|m| (*m).to_string()).collect()] },
            is_kinematic: index == 1,
            is_played: index == 0,
            is_spawned: false,
        };
        modes.iter().enumerate().map(plan).collect()
    }
}

/// Sizes of bodies along an axis, px.
const SIZES: [f64; 6] = [16.0, 16.0, 8.0, 24.0, 12.0, 30.0];
const TIMES: [&str; 6] = ["0.5", "0.2", "1", "3frames", "1frames", "0.1"];

/// The contents of a world of a situation.
struct Stage {
    /// The inside of its walls, px.
    width: f64,
    height: f64,
    thick: f64,
    collides: Vec<String>,
    /// Lines of the first space.
    main: Vec<String>,
}

impl Generator<'_> {
    /// A length in a range, in steps of 8 px, sometimes slightly changed.
    fn length(&mut self, low: f64, high: f64) -> f64 {
        let by = [0.0, 0.0, 0.0, 1.0, -0.5, 3.0, -1.5, 0.5][self.draw.pick(8)];
        low + 8.0 * self.draw.pick(((high - low) / 8.0) as usize + 1) as f64 + by
    }

    fn wall(&mut self, stage: &mut Stage, rect: [f64; 4]) {
        stage.main.push(format!("rect wall {}", self.axes.rect(rect)));
    }

    /// Four walls around a room, closed.
    fn chamber(&mut self, stage: &mut Stage, [x, y, width, height]: [f64; 4]) {
        let thick = stage.thick;
        for wall in [
            [x - thick, y - thick, width + 2.0 * thick, thick],
            [x - thick, y, thick, height],
            [x + width, y, thick, height],
            [x - thick, y + height, width + 2.0 * thick, thick],
        ] {
            self.wall(stage, wall);
        }
    }

    fn put(&mut self, stage: &mut Stage, plan: usize, (x, y): (f64, f64), settings: &str) {
        let number = self.arena.places.len();
        let settings = if plan == 0 && settings.is_empty() { self.arena.settings } else { settings };
        let line = format!("place p{number}: {} at {}{settings}", self.plans[plan].name, self.axes.point(x, y));
        stage.main.push(line);
        self.arena.places.push(plan);
        self.arena.last = (x, y);
    }

    /// The world of a situation.
    pub fn stage(&mut self, about: Situation) -> String {
        self.out.clear();
        let mut stage = Stage {
            width: self.length(96.0, 240.0).round(),
            height: self.length(64.0, 128.0).round(),
            thick: [16.0, 8.0, 32.0, 2.0, 16.0][self.draw.pick(5)],
            collides: vec!["a with wall: block".into()],
            main: Vec::new(),
        };
        self.arena.clear(about == Situation::Rooms);
        let is_tiny = about == Situation::Thin && self.draw.chance(75);
        let widths: &[f64] = if is_tiny { &[1.0, 2.0, 1.0, 4.0] } else { &SIZES };
        let heights: &[f64] = if is_tiny { &[3.0, 1.0, 16.0, 8.0] } else { &SIZES };
        self.arena.body = [widths, heights].map(|sizes| sizes[self.draw.pick(sizes.len())]);
        let paces = ["", "", " { speed = 120 }", " { speed = 30 }", " { speed = 200 }", " { speed = -60 }"];
        self.arena.settings = paces[self.draw.pick(paces.len())];
        let room = [0.0, 0.0, stage.width, stage.height];
        if !self.draw.chance(if about == Situation::Dying { 70 } else { 10 }) {
            self.chamber(&mut stage, room);
        }
        let mut cellar = None;
        match about {
            Situation::Dying => self.set_reader(&mut stage),
            Situation::Door => self.set_door(&mut stage),
            Situation::Lift => self.set_lift(&mut stage),
            Situation::Rooms => cellar = Some(self.set_rooms(&mut stage)),
            Situation::Graze => {
                let at = (self.length(24.0, 80.0), stage.height - self.length(32.0, 40.0));
                let by = [2.0, 0.5, 1.0, -0.5, 4.0, 3.0][self.draw.pick(6)];
                let side = if self.draw.chance(50) { at.0 + by - 48.0 } else { at.0 + 16.0 - by };
                let bottom = self.length(0.0, 16.0);
                self.wall(&mut stage, [side, bottom, 48.0, 24.0]);
                self.put(&mut stage, 0, at, "");
            }
            _ => {
                // The free part is below a ceiling, beside a step, or between two of them.
                for _ in 0..self.draw.pick(3) {
                    let (x, wide) = (self.length(40.0, 72.0), self.length(16.0, 48.0));
                    let high = match about {
                        Situation::Jump => self.length(0.0, 32.0).max(1.0),
                        _ => self.length(8.0, 40.0),
                    };
                    let [_, body] = self.arena.body;
                    let slit = body - [0.5, 1.0, 0.25, 3.0, -0.5][self.draw.pick(5)];
                    let rect = match self.draw.chance(if about == Situation::Growing { 70 } else { 30 }) {
                        true if self.draw.chance(30) => [x, slit, wide, stage.height - slit],
                        true => [x, high + 8.0, wide, stage.height - high],
                        false => [x, 0.0, wide, high],
                    };
                    self.wall(&mut stage, rect);
                }
                let at = (self.length(0.0, 32.0).max(8.0), [0.0, 0.0, 8.0, 1.0, 30.0][self.draw.pick(5)]);
                self.put(&mut stage, 0, at, "");
            }
        }
        self.staged(about, stage, cellar)
    }

    fn staged(&mut self, about: Situation, stage: Stage, cellar: Option<String>) -> String {
        self.line("world W {");
        let step = match about == Situation::Lift && self.draw.chance(40) {
            true => self.draw.one(&["1/4", "1/8", "1/10"]),
            false => self.draw.one(&STEPS),
        };
        self.line(format!("step {step}"));
        for collide in stage.collides {
            self.line(format!("collide {collide}"));
        }
        self.line("LIMITS");
        self.line("space main {");
        stage.main.iter().for_each(|line| self.line(line));
        self.line("}");
        self.line(cellar.unwrap_or_default());
        let players = self.arena.places.iter().position(|plan| *plan == 0);
        if let Some(place) = players {
            self.line(format!("player 1: p{place}"));
        }
        self.questions();
        // It must never be beyond the obstacle on which it stands or against which it leans.
        if self.draw.chance(20) {
            let coordinate = self.draw.one(&["y", "y", "x"]);
            let beyond = self.axes.read("p0.", coordinate);
            self.line(format!("never n1: {beyond} < 0"));
        }
        self.line("}");
        std::mem::take(&mut self.out)
    }

    fn set_reader(&mut self, stage: &mut Stage) {
        let at = (self.length(0.0, 64.0), 0.0);
        self.put(stage, 1, at, "");
        let at = (self.length(24.0, 64.0), self.length(0.0, 24.0).max(0.0));
        self.put(stage, 0, at, " { foe_b = p0; friend = p0 }");
        if self.draw.chance(30) {
            stage.collides.push("a with b: sense".into());
        }
    }

    fn set_door(&mut self, stage: &mut Stage) {
        stage.collides.push("a with b: block".into());
        let x = self.length(32.0, 64.0);
        let high = self.length(16.0, 48.0);
        let above = self.draw.chance(50);
        if above {
            // The door is the only way.
            let rest = (stage.height - high).max(1.0);
            self.wall(stage, [x, high, 16.0, rest]);
        }
        let there = (x, 0.0);
        let before = match self.draw.chance(60) {
            // It walks in while the door is absent.
            true => (x - self.arena.body[0] - [0.0, 1.0, 4.0, 8.0][self.draw.pick(4)], 0.0),
            false => (self.length(0.0, 16.0).max(0.0), 0.0),
        };
        if self.draw.chance(25) {
            // Somewhere else, or on someone.
            let to = (self.length(0.0, 80.0), self.length(0.0, 24.0));
            self.put(stage, 1, to, "");
        }
        self.put(stage, 1, there, "");
        self.put(stage, 0, before, "");
        if self.draw.chance(35) {
            let by = [1.5, 8.0, -8.0, 0.5, -14.5, 24.0][self.draw.pick(6)];
            self.put(stage, 0, (x + by, 0.0), "");
        }
    }

    fn set_lift(&mut self, stage: &mut Stage) {
        let responses = [
            "block, carry",
            "block from above, carry",
            "block from above, carry",
            "block",
            "block, keep velocity, carry",
        ];
        let response = self.draw.one(&responses);
        let has_crate = self.plans.len() > 2;
        let top = if has_crate { "c" } else { "a" };
        stage.collides.push(format!("{top} with b: {response}"));
        let at = (self.length(0.0, 40.0), [0.0, 0.0, 16.0, -8.0][self.draw.pick(4)]);
        self.put(stage, 1, at, "");
        let (mut x, mut y) = (at.0 + self.length(0.0, 16.0), at.1 + 8.0);
        if has_crate {
            let response = self.draw.one(&responses);
            stage.collides.push(format!("a with c: {response}"));
            self.put(stage, 2, (x, y), "");
            if self.draw.chance(70) {
                // The obstacle against which it is pressed.
                stage.collides.push("c with wall: block".into());
                let beyond = self.length(32.0, 72.0);
                let wide = [16.0, 200.0][self.draw.pick(2)];
                self.wall(stage, [x + beyond, y, wide, 16.0]);
            }
            (x, y) = (x + self.length(0.0, 8.0), y + 16.0);
        }
        self.put(stage, 0, (x, y), "");
    }

    /// Two rooms side by side, and another space with two more; links lead from the first one.
    fn set_rooms(&mut self, stage: &mut Stage) -> String {
        let (width, height) = (stage.width, stage.height);
        let apart = width + 2.0 * stage.thick + [0.0, 40.0][self.draw.pick(2)];
        self.chamber(stage, [apart, 0.0, 96.0, height]);
        let start = (self.length(0.0, 32.0).max(0.0), 0.0);
        self.put(stage, 0, start, "");
        let mut links = Vec::new();
        for _ in 0..1 + self.draw.pick(2) {
            let from = [self.length(24.0, 56.0), self.length(0.0, 16.0), 24.0, [30.0, 4.0][self.draw.pick(2)]];
            let room = if self.draw.chance(70) { apart } else { 0.0 };
            let size = [[24.0, 30.0], [24.0, 4.0], [1.0, 1.0], [40.0, 30.0]][self.draw.pick(4)];
            // Sometimes into a wall.
            let at = [room + self.length(-8.0, 40.0), self.length(-8.0, 24.0), size[0], size[1]];
            let to = if self.draw.chance(60) { "main" } else { "cellar" };
            links.push(format!("link rect{} -> {to} at rect{}", self.axes.rect(from), self.axes.rect(at)));
        }
        stage.main.extend(links);
        let mut below = Stage { main: Vec::new(), collides: Vec::new(), ..*stage };
        self.chamber(&mut below, [0.0, 0.0, width, height]);
        self.chamber(&mut below, [apart, 0.0, 96.0, height]);
        if self.draw.chance(40) {
            let at = (8.0, self.length(0.0, 16.0).max(0.0));
            self.put(&mut below, 0, at, "");
        }
        format!("space cellar {{\n{}\n}}", below.main.join("\n"))
    }

    /// The members of an entity of a situation except its declarations.
    pub fn actor(&mut self, about: Situation) -> String {
        self.out.clear();
        self.group = None;
        match (about, self.me) {
            (Situation::Dying, 1) => self.mortal(),
            (Situation::Dying, _) => self.onlooker(),
            (Situation::Door, 1) => self.door(),
            (Situation::Lift, 1) => self.lift(),
            (Situation::Lift, 2) => {
                let gravity = self.draw.one(&["", "y'' = -400"]);
                self.line(format!("collider c: rect({}, 0, 16, 16)", self.axes.beside("0", "16")));
                self.line(gravity);
            }
            (Situation::Stale, _) => self.stale(),
            (Situation::Growing, _) => self.growing(),
            (Situation::Jump, _) => self.jumper(),
            (Situation::Graze, _) => {
                self.body();
                let flow = self.draw.one(&["y' = -speed", "y'' = -400", "y'' = -force", "y' = -speed * 4"]);
                self.line(flow);
                self.line("mode m00 { }");
            }
            _ => {
                self.body();
                let paces: &[&str] = match about {
                    Situation::Thin if self.arena.body[0] < 8.0 => &["speed", "-speed", "speed * 2", "-speed * 4"],
                    Situation::Thin => &["speed", "speed * 4", "speed * 8", "speed * 40"],
                    _ => &["speed"],
                };
                let pace = self.draw.one(paces);
                // A rider may do nothing by itself.
                if about != Situation::Lift || self.draw.chance(60) {
                    self.walk(pace);
                }
                self.line("mode m00 {");
                if about == Situation::Rooms {
                    let updates = self.draw.one(&["", "", "", " { count := 1 }", " { y' := 0 }"]);
                    self.line(format!("follow links{updates}"));
                }
                if self.draw.chance(50) {
                    self.leap("");
                }
                self.line("}");
            }
        }
        std::mem::take(&mut self.out)
    }

    fn body(&mut self) {
        let [width, height] = self.arena.body.map(number);
        self.line(format!("collider a: rect({}, 0, {width}, {height})", self.axes.beside("0", &width)));
    }

    /// Moves by the player's inputs, and usually falls.
    fn walk(&mut self, pace: &str) {
        let speed = match self.draw.chance(30) {
            true => pace.to_string(),
            false => format!("{pace} * {}", self.axes.axis("horizontal")),
        };
        let speed = self.axes.write("x'", &speed);
        self.line(format!("x' = {speed}"));
        let up = self.draw.one(&[
            "y'' = -400",
            "y'' = -400",
            "y'' = -force",
            "y' = speed * vertical",
            "y' = speed * vertical",
            "y' = 0",
            "y'' = -900",
            "y' = -speed",
        ]);
        self.line(up);
    }

    fn leap(&mut self, to: &str) {
        let asked = self.draw.one(&["pressed(jump)", "held(jump)"]);
        let floor = self.draw.one(&[" and touching(wall, below)", " and touching(a, wall, below)", ""]);
        let leap = self.draw.one(&["200", "120", "100", "140", "speed * 2", "60", "300"]);
        self.line(format!("when {asked}{floor}{to} {{ y' := {leap} }}"));
    }

    fn stale(&mut self) {
        self.body();
        let vertical = self.draw.one(&["y'' = -400", "y'' = -400", "y' = -60"]);
        let asked = self.touching();
        let put = match self.draw.pick(3) {
            0 => format!(
                "y := {}",
                self.axes.write(
                    "y",
                    &format!("{} + {}", self.axes.read("", "y"), number(self.draw.pick(8) as f64 * 8.0 + 1.0))
                )
            ),
            1 => format!("y := {}", self.axes.write("y", "200")),
            _ => format!("x := {}", self.axes.write("x", &format!("{} + 40", self.axes.read("", "x")))),
        };
        let back = self.draw.one(&[
            "when timer >= 0.2s -> m00",
            "when timer >= 1frames -> m00",
            "",
            "when pressed(jump) -> m00",
        ]);
        self.line("mode m00 {");
        self.line(vertical);
        if self.draw.chance(50) {
            let speed = self.axes.write("x'", &format!("speed * {}", self.axes.axis("horizontal")));
            self.line(format!("x' = {speed}"));
        }
        let asked = if self.draw.chance(60) { "touching(a, wall)".to_string() } else { asked };
        self.line(format!("when {asked} -> m01 {{ {put} }}\n}}\nmode m01 {{"));
        let again = if self.draw.chance(70) { "touching(a, wall)".to_string() } else { self.touching() };
        let flow = match self.draw.pick(4) {
            0 => format!("x' = {}", self.axes.write("x'", &format!("if({again}, speed, 0)"))),
            1 => format!("q' = if({again}, speed, 0)"),
            2 => format!("envelope q' by horizontal {{ sustain 60; while {again} }}"),
            _ => format!("heat = if({again}, 1, 0)"),
        };
        let still = self.draw.one(&["y' = 0", "y' = 0", ""]);
        self.line(format!("{still}\n{flow}\n{back}\n}}"));
    }

    /// An instance that is read while it is destroyed.
    fn mortal(&mut self) {
        let last = match self.draw.pick(5) {
            0 => "x := 500".to_string(),
            1 => "count := 2".into(),
            2 => "y' := 90".into(),
            3 => "q := 64".into(),
            _ => "y'' := 50".into(),
        };
        let time = self.draw.one(&TIMES);
        let flow = self.draw.one(&["", "x' = speed", "y'' = 16", "q' = 30"]);
        self.line(format!(
            "mode m00 {{\n{flow}\nwhen timer >= {time} -> m01 {{ {last}; destroy self }}\n}}\nmode m01 {{ }}"
        ));
    }

    fn onlooker(&mut self) {
        let (read, scale) = match self.draw.pick(5) {
            0 => ("if(foe_b in m01, 99, 0)", "q"),
            1 => ("if(foe_b is none, 0, foe_b.x)", "q"),
            2 => ("if(foe_b is none, 0, foe_b.q)", "q"),
            3 => ("if(foe_b is none, 0, foe_b.y')", "q'"),
            _ => ("if(foe_b is none, 0, foe_b.y'')", "q''"),
        };
        let count = self.draw.chance(20);
        self.line("mode m00 {");
        self.line(if count {
            "heat = if(foe_b is none, 0, foe_b.count)".to_string()
        } else {
            format!("{scale} = {read}")
        });
        if self.draw.chance(30) {
            self.line("when lost(foe_b) { foe_b := spawn B }");
            self.plans[1].is_spawned = true;
        }
        self.line("}");
    }

    /// Never moves; its colliders appear and disappear.
    fn door(&mut self) {
        let (width, height) =
            (self.draw.one(&["16", "8", "32", "48", "3"]), self.draw.one(&["48", "16", "32", "64", "8"]));
        let guard = self.draw.one(&[
            "when in m00",
            "when in m01",
            "when in m01",
            "when not in m00",
            "",
            "when in m00 or in m01",
        ]);
        self.line(format!(
            "kinematic collider b: rect({}, 0, {width}, {height}) {guard}",
            self.axes.beside("0", width)
        ));
        let back = self.draw.chance(60);
        let asked = |g: &mut Self| match g.draw.pick(5) {
            0 => "touching(a)".to_string(),
            _ => format!("timer >= {}", g.draw.one(&TIMES)),
        };
        let (there, again) = (asked(self), asked(self));
        let again = if back { format!("when {again} -> m00") } else { String::new() };
        let ends = if self.draw.chance(10) { "when timer >= 1 { destroy self }" } else { "" };
        self.line(format!("mode m00 {{ when {there} -> m01 }}\nmode m01 {{\n{again}\n{ends}\n}}"));
    }

    /// From one end to the other, once or back and forth.
    fn lift(&mut self) {
        let width = self.draw.one(&["48", "24", "16", "400"]);
        self.line(format!("kinematic collider b: rect({}, 0, {width}, 8)", self.axes.beside("0", width)));
        let variable = self.draw.one(&["x", "x", "x", "y"]);
        let pace = self.draw.one(&["60", "30", "200", "300", "7.5", "1200"]);
        let (there, back) = match self.draw.chance(50) {
            true => {
                let time = self.draw.one(&["0.5", "0.3s", "2frames", "3frames", "1"]);
                (format!("timer >= {time}"), format!("timer >= {time}"))
            }
            false => {
                let (read, far) = (self.axes.read("", variable), self.draw.one(&["100", "64", "40"]));
                (format!("{read} > {far}"), format!("{read} < 0"))
            }
        };
        let name = format!("{variable}'");
        let (to, fro) = (self.axes.write(&name, pace), self.axes.write(&name, &format!("-{pace}")));
        let second = match self.draw.chance(25) {
            true => format!("mode m01 {{ {name} = 0 }}"),
            false => format!("mode m01 {{\n{name} = {fro}\nwhen {back} -> m00\n}}"),
        };
        self.line(format!("mode m00 {{\n{name} = {to}\nwhen {there} -> m01\n}}\n{second}"));
    }

    fn growing(&mut self) {
        let mut extents = Vec::new();
        for mode in ["m00", "m01"] {
            let (left, width) = (self.draw.one(&["0", "0", "-4"]), self.draw.one(&["16", "16", "8", "24"]));
            let height = self.draw.one(&["16", "32", "24", "8", "17"]);
            extents.push(format!("rect({}, 0, {width}, {height}) when in {mode}", self.axes.beside(left, width)));
        }
        let bare = self.draw.pick(12);
        // A collider that shrinks once stays outside of all walls.
        let is_once = self.draw.chance(35);
        if is_once && self.draw.chance(70) {
            extents[0] = format!("rect({}, 0, 24, 32) when in m00", self.axes.beside("-4", "24"));
        }
        for (index, extent) in extents.into_iter().enumerate() {
            if index != bare {
                self.line(format!("collider a: {extent}"));
            }
        }
        self.walk("speed");
        let change = self.draw.one(&["pressed(jump)", "held(run)", "timer >= 0.5"]);
        let back = self.draw.one(&["released(jump)", "pressed(jump)", "timer >= 0.2s", ""]);
        let back = if back.is_empty() || is_once { String::new() } else { format!("when {back} -> m00") };
        // The lump is far from all walls when it changes.
        let rests = if is_once && self.draw.chance(60) { "x' = 0\ny' = 0\n" } else { "" };
        self.line(format!("mode m00 {{\n{rests}when {change} -> m01\n}}\nmode m01 {{ {back} }}"));
    }

    fn jumper(&mut self) {
        self.body();
        let speed = self.axes.write("x'", &format!("speed * {}", self.axes.axis("horizontal")));
        let pull = self.draw.one(&["-400", "-400", "-900", "-force"]);
        if self.draw.chance(60) {
            self.line(format!("x' = {speed}"));
        }
        self.line(format!("y'' = {pull}"));
        // Its energy is known after it has fallen for one step.
        self.line("mode m00 { when timer >= 1frames -> m01 }\nmode m01 {");
        self.leap("");
        let cut = self.draw.one(&[
            "min(y', 60)",
            "y' * 0.5",
            "0.5 * y'",
            "y' / 2",
            "2 * y'",
            "max(y', -60)",
            "clamp(y', -60, 100)",
            "min(y', -20)",
            "0",
            "y' * n",
            "if(held(run), y', 0)",
            "max(y', 40)",
            "y' / n",
            "y' + 30",
            "-0.5 * y'",
            "min(y' * 3, 100)",
        ]);
        let when =
            self.draw.one(&["released(jump)", "pressed(run)", "released(jump) and y' > 0", "touching(wall, left)"]);
        self.line(format!("when {when} {{ y' := {cut} }}\n}}"));
    }
}
