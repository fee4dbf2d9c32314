//! Random programs with much activity: a hero and foes in groups of modes, lifts that carry and push, shots, walls and
//! clouds, two rooms with links between them. Generated from a list of choices, so that a failing program shrinks.

use crate::support::draw::Draw;

/// The dimension of an expression.
#[derive(Clone, Copy, PartialEq)]
enum Dim {
    Length,
    Speed,
    Acceleration,
    Time,
}

/// The role of an entity.
#[derive(Clone, Copy, PartialEq)]
enum Role {
    Hero,
    Foe,
    Lift,
    Shot,
}

const ROLES: [(Role, &str, &str); 4] = [
    (Role::Hero, "Hero", "body"),
    (Role::Foe, "Foe", "foe"),
    (Role::Lift, "Lift", "lift"),
    (Role::Shot, "Shot", "shot"),
];

struct Generator<'c> {
    draw: Draw<'c>,
    out: String,
    role: Role,
    /// The modes of each group so far, with their paths.
    modes: Vec<Vec<String>>,
    in_mode: bool,
    /// Whether the current expression may read inputs and contacts.
    may_ask: bool,
    depth: usize,
}

/// The text of a program.
pub fn program(choices: &[u16]) -> String {
    let mut g = Generator {
        draw: Draw::new(choices),
        out: String::new(),
        role: Role::Hero,
        modes: Vec::new(),
        in_mode: false,
        may_ask: true,
        depth: 0,
    };
    // The world is generated first, so that few choices make a small program in a complete world.
    g.world();
    let world = std::mem::take(&mut g.out);
    for (role, name, tag) in ROLES {
        g.role = role;
        g.entity(name, tag);
    }
    g.line("behavior Blink(t) { mode on { when timer >= t -> off } mode off { when timer >= t -> on { flag := not flag } } }");
    g.out + &world
}

impl Generator<'_> {
    fn line(&mut self, text: impl AsRef<str>) {
        self.out.push_str(text.as_ref());
        self.out.push('\n');
    }

    fn number(&mut self, dim: Dim) -> &'static str {
        match dim {
            Dim::Length => self.draw.one(&["0", "16", "48", "100", "7.5", "200", "-20", "64"]),
            Dim::Speed => self.draw.one(&["0", "60", "-60", "30", "150", "-200", "400", "-33.3", "2500"]),
            Dim::Acceleration => self.draw.one(&["-300", "0", "-600", "200", "50", "-50.5", "-3000"]),
            Dim::Time => self.draw.one(&["0.1", "3frames", "0.25s", "0.5", "1s", "delay"]),
        }
    }

    fn value(&mut self, dim: Dim) -> String {
        self.depth += 1;
        let is_leaf = self.depth > 3 || self.draw.chance(65);
        let out = if is_leaf { self.leaf(dim) } else { self.node(dim) };
        self.depth -= 1;
        out
    }

    fn leaf(&mut self, dim: Dim) -> String {
        if self.draw.chance(45) {
            return self.number(dim).into();
        }
        let played = self.role == Role::Hero && self.may_ask;
        match dim {
            Dim::Length => {
                self.draw.one(&["x", "y", "size", "charge", "if(target is Foe, target.x, size)", "size * count"])
            }
            Dim::Speed if played && self.draw.chance(50) => self.draw.one(&["speed * horizontal", "speed * vertical"]),
            Dim::Speed => self.draw.one(&[
                "speed",
                "x'",
                "y'",
                "charge'",
                "if(target is Foe, target.x', speed)",
                "speed * count",
                "size / delay",
            ]),
            Dim::Acceleration => self.draw.one(&["gravity", "gravity / 2", "x''", "-gravity"]),
            Dim::Time if self.in_mode => self.draw.one(&["timer", "delay", "timer(g0.m0)"]),
            Dim::Time => "delay",
        }
        .into()
    }

    fn node(&mut self, dim: Dim) -> String {
        let a = self.value(dim);
        match self.draw.pick(12) {
            0 => format!("({a} + {})", self.value(dim)),
            1 => format!("({a} - {})", self.value(dim)),
            2 => format!("min({a}, {})", self.value(dim)),
            3 => format!("max({a}, {})", self.value(dim)),
            4 => format!("abs({a})"),
            5 => {
                let known = ["size", "speed", "gravity", "delay"][dim as usize];
                format!("({a} + {known}) * factor")
            }
            6 => format!("if({}, {a}, {})", self.guard(), self.value(dim)),
            7 => format!("-({a})"),
            8 => format!("clamp({a}, {}, {})", self.value(dim), self.value(dim)),
            9 => {
                let turn = self.draw.one(&[
                    "atan2(y, x)",
                    "sqrt(abs(x / size))",
                    "sign(y' - x')",
                    "round(x / size)",
                    "sin(y / size)",
                ]);
                let known = ["size", "speed", "gravity", "delay"][dim as usize];
                format!("({a} - {known} * {turn})")
            }
            _ => match dim {
                Dim::Length => format!("(100 + size * {}(charge / size))", self.draw.one(&["sin", "cos", "floor"])),
                Dim::Speed => {
                    format!("speed * {}", self.draw.one(&["sign(x - 100)", "cos(y / size)"]))
                }
                _ => format!("({a}) / 2"),
            },
        }
    }

    /// A tag that the entity can touch.
    fn other(&mut self) -> &'static str {
        match self.role {
            Role::Hero => self.draw.one(&["wall", "lift", "cloud", "foe", "shot"]),
            Role::Foe => self.draw.one(&["wall", "body", "lift", "foe", "shot"]),
            Role::Lift => self.draw.one(&["body", "foe"]),
            Role::Shot => self.draw.one(&["wall", "foe", "body"]),
        }
    }

    fn guard(&mut self) -> String {
        self.depth += 1;
        let deep = self.depth > 3;
        let out = match self.draw.pick(if deep { 8 } else { 13 }) {
            0 | 12 => format!("{} >= {}", if self.in_mode { "timer" } else { "delay" }, self.number(Dim::Time)),
            1 => {
                let dim = [Dim::Length, Dim::Speed][self.draw.pick(2)];
                let op = self.draw.one(&["<", ">=", "<=", ">", "!=", "=="]);
                let known: &[&str] = if dim == Dim::Length { &["x", "y", "charge"] } else { &["x'", "y'"] };
                format!("{} {op} {}", self.draw.one(known), self.value(dim))
            }
            2 if self.may_ask => {
                format!("{}({})", self.draw.one(&["pressed", "held", "released"]), self.draw.one(&["jump", "run"]))
            }
            3 | 4 if self.may_ask => {
                let other = self.other();
                let side = self.draw.one(&["", ", below", ", left", ", right", ", above"]);
                format!("touching({other}{side})")
            }
            5 => format!("count {} {}", self.draw.one(&["<", "==", ">="]), 1 + self.draw.pick(4)),
            6 => self.draw.one(&["flag", "colour == red", "colour != blue", "target is none", "target is Foe"]).into(),
            7 if !self.modes.is_empty() => {
                let all: Vec<String> = self.modes.iter().flatten().cloned().collect();
                format!("in {}", all[self.draw.pick(all.len())])
            }
            8 => format!("({} and {})", self.guard(), self.guard()),
            9 => format!("({} or {})", self.guard(), self.guard()),
            10 => format!("not {}", self.guard()),
            11 => format!("{} < x <= {}", self.number(Dim::Length), self.number(Dim::Length)),
            _ => self.draw.one(&["x < 120", "y < 80", "count > 2"]).into(),
        };
        self.depth -= 1;
        out
    }

    /// Updates of different targets; `named` is the name that the guard binds.
    fn updates(&mut self, named: bool) -> String {
        let mut list: Vec<String> = Vec::new();
        let mut used: Vec<&str> = Vec::new();
        for _ in 0..self.draw.pick(4) {
            let places =
                ["count", "x'", "y'", "x", "y", "flag", "colour", "target", "charge", "y''", "spawn", "destroy"];
            let place = self.draw.one(&places);
            if used.contains(&place) {
                continue;
            }
            used.push(place);
            let update = match place {
                "count" => {
                    format!("count := {}", self.draw.one(&["min(count + 1, 5)", "max(count - 1, 0)", "0", "5 - count"]))
                }
                "x'" | "y'" => {
                    let fixed = format!("{place} := -0.8 * {place}");
                    if self.draw.chance(30) { fixed } else { format!("{place} := {}", self.value(Dim::Speed)) }
                }
                "x" | "y" if self.draw.chance(50) => format!("{place} := {place} + {}", self.number(Dim::Length)),
                "x" | "y" | "charge" => {
                    let seen = named && self.draw.chance(40);
                    let value = if seen { "seen.x".to_string() } else { self.value(Dim::Length) };
                    format!("{place} := {value}")
                }
                "flag" => format!("flag := {}", self.guard()),
                "colour" => format!("colour := {}", self.draw.one(&["green", "blue", "red"])),
                "y''" => format!("y'' := {}", self.value(Dim::Acceleration)),
                "target" => match self.draw.pick(4) {
                    0 if named => "target := seen".into(),
                    1 => "target := none".into(),
                    2 => "target := self".into(),
                    _ => format!("target := {}", self.spawn()),
                },
                "spawn" => self.spawn(),
                _ if named && self.draw.chance(50) => "destroy seen".into(),
                _ => {
                    let stays = matches!(self.role, Role::Hero | Role::Lift) && self.draw.chance(85);
                    if stays { "destroy target".into() } else { "destroy self".into() }
                }
            };
            list.push(update);
        }
        if list.is_empty() { String::new() } else { format!("{{ {} }}", list.join("; ")) }
    }

    fn spawn(&mut self) -> String {
        let what = self.draw.one(&["Shot", "Shot", "Foe"]);
        let mut given = Vec::new();
        for (name, dim) in [("x", Dim::Length), ("y", Dim::Length), ("speed", Dim::Speed), ("x'", Dim::Speed)] {
            if self.draw.chance(35) {
                let value = self.value(dim);
                given.push(format!("{name} = {}", if name == "x" { format!("x + {value}") } else { value }));
            }
        }
        if self.draw.chance(30) {
            given.push("target = self".into());
        }
        if self.draw.chance(20) {
            given.push(format!("count = {}", self.draw.pick(6)));
        }
        format!("spawn {what}({})", given.join(", "))
    }

    fn flow(&mut self, variable: &str) -> String {
        match self.draw.pick(7) {
            0 | 1 => format!("{variable}' = {}", self.value(Dim::Speed)),
            2 | 3 => format!("{variable}'' = {}", self.value(Dim::Acceleration)),
            4 if self.role != Role::Hero || variable == "charge" => format!("{variable} = {}", self.value(Dim::Length)),
            _ => self.envelope(variable),
        }
    }

    fn envelope(&mut self, variable: &str) -> String {
        if self.in_mode && self.draw.chance(20) {
            let peak = self.number(Dim::Length);
            return format!(
                "envelope {variable} fixed {{ attack over 0.2s to {peak}; sustain for 0.1s; release over 0.2s to 8 }}"
            );
        }
        let by = self.draw.one(&["horizontal", "held(run)", "vertical"]);
        let attack = self.draw.one(&[
            "attack accel 500",
            "attack over 0.2s",
            "attack instant",
            "attack accel 900 to 150; decay accel 300",
            "attack over delay to -50",
        ]);
        let sustain = self.draw.one(&["100", "speed", "-60", "0", "abs(x')"]);
        let release =
            self.draw.one(&["", "release accel 500", "release hold", "release over 0.1s to 10", "release instant"]);
        let guard = if self.draw.chance(30) { format!("while {}", self.guard()) } else { String::new() };
        format!("envelope {variable}' by {by} {{ {attack}; sustain {sustain}; {release}\n {guard}\n }}")
    }

    fn vector(&mut self) -> String {
        let directions = self.draw.one(&["any", "4", "8", "3"]);
        let attack = self.draw.one(&["attack accel 500", "attack instant", "attack over 0.1s to 200; decay accel 100"]);
        let release = self.draw.one(&["release accel 300", "release hold", "release over 0.2s to 20", ""]);
        format!(
            "envelope (x', y') by (horizontal, vertical) directions {directions} {{ {attack}; sustain 90; {release} }}"
        )
    }

    /// A mode of a group that drives some variables.
    fn mode(&mut self, path: &str, name: &str, siblings: &[String], driven: &[&str], deep: usize) {
        let initial = if self.draw.chance(10) { "initial when size > 12 " } else { "" };
        self.line(format!("{initial}mode {name} {{"));
        self.in_mode = true;
        if driven.len() == 2 && self.draw.chance(20) {
            let vector = self.vector();
            self.line(vector);
        } else {
            for variable in driven {
                if self.draw.chance(70) {
                    let flow = self.flow(variable);
                    self.line(flow);
                }
            }
        }
        if self.draw.chance(15) {
            let entry = self.draw.one(&["count := 1", "y' := 120", "charge := 4", "flag := not flag", "x := x + 3"]);
            self.line(entry);
        }
        if self.role != Role::Lift && self.draw.chance(40) {
            let guard = if self.draw.chance(30) { " when count < 4" } else { "" };
            let updates = if self.draw.chance(20) { "{ flag := true }" } else { "" };
            self.line(format!("follow links{guard} {updates}"));
        }
        for _ in 0..self.draw.pick(4) {
            self.edge(siblings);
        }
        if self.role != Role::Shot && self.draw.chance(20) {
            let guard = self.draw.one(&[
                "timer >= 0.5",
                "pressed(jump)",
                "touching(foe)",
                "count < 2",
                "touching(body, below)",
            ]);
            let spawn = self.spawn();
            self.line(format!("when {guard} {{ {spawn} }}"));
        }
        if self.draw.chance(10) {
            let lost = siblings[self.draw.pick(siblings.len())].clone();
            self.line(format!("when lost(target) -> {lost}"));
        }
        if deep < 2 && self.draw.chance(25) {
            let inner: Vec<String> = (0..1 + self.draw.pick(2)).map(|i| format!("{name}_{i}")).collect();
            for child in &inner {
                let path = format!("{path}.{child}");
                self.modes.last_mut().unwrap().push(path.clone());
                self.mode(&path, child, &inner, driven, deep + 1);
            }
        }
        self.line("}");
        self.in_mode = false;
    }

    fn edge(&mut self, siblings: &[String]) {
        let earlier = self.modes.len() - 1;
        let joint = earlier > 0 && self.draw.chance(15);
        let named = !joint && self.draw.chance(20);
        let guard = if joint {
            let group = self.draw.pick(earlier);
            let of = self.modes[group].clone();
            format!("{}({})", self.draw.one(&["entering", "exiting"]), of[self.draw.pick(of.len())])
        } else if named {
            let other = if self.role == Role::Foe { "body" } else { "foe" };
            let more = self.draw.one(&["", " and seen.x > x", " and seen is Foe and seen.count < 3"]);
            format!("touching({other}) as seen{more}")
        } else {
            self.guard()
        };
        let target = if self.draw.chance(70) {
            format!(" -> {}", siblings[self.draw.pick(siblings.len())])
        } else {
            String::new()
        };
        let updates = self.updates(named);
        if !target.is_empty() || !updates.is_empty() {
            self.line(format!("when {guard}{target} {updates}"));
        }
    }

    fn entity(&mut self, name: &str, tag: &str) {
        self.modes.clear();
        self.line(format!("entity {name} {{"));
        self.line("param size: px = 16\nparam speed: px/s = 60\nparam gravity: px/s^2 = -300");
        self.line("param delay: s = 0.4\nparam factor: 1 = 0.5\ncontinuous charge: px = 0\nref target: any");
        self.line("button jump, run\naxis horizontal, vertical");
        self.line(
            "discrete count: int 0..5 = 0\ndiscrete flag: bool = false\ndiscrete colour: {red, green, blue} = red",
        );
        let groups = if self.role == Role::Shot { 1 } else { 1 + self.draw.pick(3) };
        let kinematic = self.role == Role::Lift || self.draw.chance(4);
        let kinematic = if kinematic { "kinematic " } else { "" };
        let shape = match self.role {
            Role::Lift => self.draw.one(&["rect(0, 0, 48, 8)", "rect(-8, -8, 16 + size, 16)", "rect(0, 0, 4, 60)"]),
            Role::Shot => self.draw.one(&["circle(4, 4, 4)", "rect(0, 0, 6, 3)"]),
            _ => {
                self.draw.one(&["rect(0, 0, 16, 16)", "rect(-4, 0, size, 24)", "circle(8, 8, 8)", "rect(1, 0, 14, 30)"])
            }
        };
        self.may_ask = false;
        let guard = match self.draw.chance(15) {
            true => format!(" when {}", self.draw.one(&["count < 3", "y > 40", "not flag", "charge < 30", "in g0.m0"])),
            false => String::new(),
        };
        self.line(format!("{kinematic}collider {tag}: {shape}{guard}"));
        if self.draw.chance(25) {
            let shape = self.draw.one(&["circle(20, 8, 5)", "rect(-12, 4, 8, 4)", "rect(0, 0, max(1, charge), 12)"]);
            let guard = self.draw.one(&["", " when in g0.m0", " when timer(g0.m0) >= 0.2", " when count > 0"]);
            let tag = self.draw.one(&[tag, "shot"]);
            self.line(format!("collider {tag}: {shape}{guard}"));
        }
        if self.draw.chance(50) {
            let clamp =
                self.draw.one(&["y' in -400..400", "y' >= -300", "x' in -speed..speed", "charge in 0..50", "y <= 150"]);
            self.line(format!("clamp {clamp}"));
        }
        self.may_ask = true;
        for variable in ["x", "y", "charge"] {
            if self.draw.chance(50) {
                let flow = self.flow(variable);
                self.line(flow);
            }
        }
        let driven: &[&[&str]] = match groups {
            1 => &[&["x", "y"]],
            2 => &[&["x", "y"], &["charge"]],
            _ => &[&["x"], &["y"], &["charge"]],
        };
        for (group, driven) in driven.iter().enumerate() {
            self.line(format!("group g{group} {{"));
            let names: Vec<String> = (0..1 + self.draw.pick(3)).map(|i| format!("m{i}")).collect();
            self.modes.push(names.iter().map(|n| format!("g{group}.{n}")).collect());
            for name in &names {
                self.mode(&format!("g{group}.{name}"), name, &names, driven, 0);
            }
            self.line("}");
        }
        if self.draw.chance(15) {
            self.line("group blink { use Blink(t = delay / 2) }");
        }
        if self.role == Role::Shot {
            self.line("group life { mode only { when timer >= 0.8 { destroy self } } }");
        }
        self.line("}");
    }

    fn world(&mut self) {
        self.line("world W {");
        let step = self.draw.one(&["1/60", "1/30", "1/50"]);
        self.line(format!("step {step}"));
        let response = self.draw.one(&["block", "block, keep velocity", "block", "block"]);
        self.line(format!("collide body, foe with wall: {response}"));
        let response =
            self.draw.one(&["block, carry", "block", "block from above", "block from above, carry", "sense"]);
        self.line(format!("collide body, foe with lift: {response}"));
        let response = self.draw.one(&["sense", "block", "block from above", "block, carry", "block, keep velocity"]);
        self.line(format!("collide body with foe: {response}"));
        let response = self.draw.one(&["sense", "sense", "block", "block, carry"]);
        self.line(format!("collide foe with foe: {response}"));
        let response = self.draw.one(&["block, keep velocity", "sense", "block"]);
        self.line(format!("collide shot with wall: {response}"));
        self.line("collide shot with body, foe: sense\ncollide body, foe with cloud: block from above");
        self.line("limit Foe 8\nlimit Shot 3\nlimit Hero 2\nlimit Lift 4");
        let tile = [32, 16, 24][self.draw.pick(3)];
        self.line(format!("tiles t {tile} x {tile} {{"));
        self.line("'.': empty\n'#': wall\n'-': cloud\n'e': spawn Foe\n'l': spawn Lift\n}");
        self.line("space main {\nmap t \"");
        let (columns, rows) = (14, 9);
        let (open, mut foes, mut lifts) = (self.draw.chance(15), 0, 0);
        for row in 0..rows {
            let mut line = String::new();
            for column in 0..columns {
                let border = column == 0 || column + 1 == columns || row == 0 || row + 1 == rows;
                let inside = !border && self.draw.chance(18);
                let what = match () {
                    () if border => {
                        if open && row + 1 == rows && column % 3 == 1 {
                            '.'
                        } else {
                            '#'
                        }
                    }
                    () if inside => ['#', '-', '#', '-', 'e', 'l'][self.draw.pick(6)],
                    () => '.',
                };
                foes += usize::from(what == 'e');
                lifts += usize::from(what == 'l');
                let refused = (what == 'e' && foes > 3) || (what == 'l' && lifts > 2);
                line.push(if refused { '.' } else { what });
            }
            self.line(line);
        }
        self.line("\"");
        for (name, entity, count) in [("hero", "Hero", 1), ("foe", "Foe", 1), ("lift", "Lift", 1)] {
            for _ in 0..count {
                let (x, y) = (tile * (2 + self.draw.pick(10)), tile * (1 + self.draw.pick(6)));
                let more = if self.draw.chance(15) { 3 } else { 0 };
                let mut set = vec![format!("size = {}", 10 + self.draw.pick(14))];
                if self.draw.chance(30) {
                    set.push(format!("speed = {}", self.number(Dim::Speed)));
                }
                if self.draw.chance(30) {
                    set.push(format!("gravity = {}", self.number(Dim::Acceleration)));
                }
                if self.draw.chance(20) {
                    set.push(
                        self.draw.one(&["count = 3", "y' = 100", "x' = -90", "charge = 12", "flag = true"]).into(),
                    );
                }
                if entity == "Hero" && self.draw.chance(50) {
                    set.push("target = foe".into());
                }
                self.line(format!("place {name}: {entity} at ({x}, {}) {{ {} }}", y + more, set.join("; ")));
            }
        }
        let when = self.draw.one(&["", " when hero.count >= 1", " when not foe in g0.m0", " when hero.x' > 0"]);
        let (x, y) = (tile * self.draw.pick(8), tile * self.draw.pick(5));
        self.line(format!("link rect({x}, {y}, 150, 90) -> other at rect(20, 40, 60, 60){when}\n}}"));
        self.line(
            "space other {\nrect wall (-100, -32, 500, 32)\nrect cloud (30, 50, 100, 6)\nrect wall (200, 0, 20, 90)",
        );
        if self.draw.chance(30) {
            self.line("bounds rect(-90, -30, 400, 300)");
        }
        if self.draw.chance(40) {
            self.line("place second: Lift at (60, 10) { speed = -30 }");
        }
        self.line("link rect(100, 0, 80, 80) -> main at rect(64, 64, 60, 40)\n}\nplayer 1: hero");
        if self.draw.chance(20) {
            self.line("player 2: foe");
        }
        for (name, goal) in [
            ("wall", "hero touching wall or any Foe touching wall"),
            ("lift", "hero touching lift or any Foe touching lift"),
            ("cloud", "hero touching cloud or any Foe touching cloud"),
            ("foe", "hero touching foe"),
            ("shot", "any Foe touching shot or any Shot touching wall"),
            ("far", "hero.x > 300"),
            ("away", "inside(hero, other)"),
        ] {
            self.line(format!("goal {name}: {goal}"));
        }
        self.line("}");
    }
}
