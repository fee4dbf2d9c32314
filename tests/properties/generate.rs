//! Random programs of the whole language. A program is drawn from a list of choices, so that a failing one shrinks: with
//! all choices used up, the first alternative is taken everywhere.

use crate::support::draw::Draw;

/// The dimension of an expression.
#[derive(Clone, Copy, PartialEq)]
pub enum Dim {
    Length,
    Speed,
    Acceleration,
    Time,
    Pure,
}

/// Draws a program.
pub struct Generator<'c> {
    draw: Draw<'c>,
    out: String,
    /// How many entities there are.
    entities: usize,
    /// Groups of the entity that is written.
    groups: usize,
    in_mode: bool,
    /// How deep an expression is.
    depth: usize,
}

/// The text of a program.
pub fn program(choices: &[u16]) -> String {
    let mut g =
        Generator { draw: Draw::new(choices), out: String::new(), entities: 0, groups: 0, in_mode: false, depth: 0 };
    g.entities = 1 + g.draw.pick(3);
    g.line("behavior Drift(pace) { continuous drift = 0; drift' = pace }");
    g.line("behavior Blink(t) { mode on { when timer >= t -> off } mode off { when timer >= t -> on } }");
    for entity in 0..g.entities {
        g.entity(entity);
    }
    g.world();
    g.out
}

impl Generator<'_> {
    fn line(&mut self, text: impl AsRef<str>) {
        self.out.push_str(text.as_ref());
        self.out.push('\n');
    }

    fn number(&mut self) -> String {
        let value = [0, 1, 2, 5, 10, 16, 32, 50, 100, 200][self.draw.pick(10)];
        if self.draw.chance(20) { format!("{value}.5") } else { value.to_string() }
    }

    /// A value of a dimension.
    fn value(&mut self, dim: Dim) -> String {
        self.depth += 1;
        let leaf = self.depth > 3 || self.draw.chance(50);
        let out = if leaf { self.leaf(dim) } else { self.node(dim) };
        self.depth -= 1;
        out
    }

    fn leaf(&mut self, dim: Dim) -> String {
        let known: &[&str] = match dim {
            Dim::Length => &["x", "y", "size"],
            Dim::Speed => &["x'", "y'", "speed"],
            Dim::Acceleration => &["x''", "gravity"],
            Dim::Time => &["delay", "0.25s", "3frames"],
            Dim::Pure => &["count", "factor", "horizontal"],
        };
        if self.draw.chance(40) || (dim == Dim::Time && !self.in_mode) {
            let n = self.number();
            return if self.draw.chance(20) { format!("-{n}") } else { n };
        }
        if dim == Dim::Time && self.draw.chance(40) {
            return "timer".into();
        }
        self.draw.one(known).to_string()
    }

    fn node(&mut self, dim: Dim) -> String {
        let a = self.value(dim);
        match self.draw.pick(9) {
            0 => format!("{a} + {}", self.value(dim)),
            1 => format!("({a} - {})", self.value(dim)),
            2 => format!("min({a}, {})", self.value(dim)),
            3 => format!("max({a}, {})", self.value(dim)),
            4 => format!("abs({a})"),
            5 => format!("clamp({a}, {}, {})", self.leaf(dim), self.leaf(dim)),
            6 => format!("({a}) * factor"),
            7 => format!("if({}, {a}, {})", self.guard(), self.value(dim)),
            _ => match dim {
                Dim::Pure => format!("{}({a})", self.draw.one(&["sin", "cos", "sign", "floor"])),
                Dim::Speed => format!("({}) / delay", self.leaf(Dim::Length)),
                _ => format!("({a}) / 2"),
            },
        }
    }

    fn dim(&mut self) -> Dim {
        [Dim::Length, Dim::Speed, Dim::Acceleration, Dim::Time, Dim::Pure][self.draw.pick(5)]
    }

    /// A truth value.
    fn guard(&mut self) -> String {
        self.depth += 1;
        let out = match self.draw.pick(if self.depth > 3 { 8 } else { 11 }) {
            0 => {
                let dim = self.dim();
                let op = self.draw.one(&["<", "<=", ">", ">=", "!="]);
                format!("{} {op} {}", self.value(dim), self.value(dim))
            }
            1 => format!("{}({})", self.draw.one(&["pressed", "held", "released"]), self.draw.one(&["jump", "run"])),
            2 => format!("touching({}, {})", self.draw.one(&["t0", "t1"]), self.draw.one(&["wall", "t0", "t1", "t2"])),
            3 => format!("touching(wall, {})", self.draw.one(&["below", "above", "left", "right"])),
            4 => "horizontal < 0".into(),
            5 => "flag".into(),
            6 => format!("colour == {}", self.draw.one(&["red", "green"])),
            7 => format!("target is {}", self.draw.one(&["none", "E0"])),
            8 => format!("({} and {})", self.guard(), self.guard()),
            9 => format!("({} or {})", self.guard(), self.guard()),
            _ => format!("not {}", self.guard()),
        };
        self.depth -= 1;
        out
    }

    fn update(&mut self, used: &mut Vec<&'static str>) -> Option<String> {
        let all = ["x'", "y'", "y", "count", "flag", "colour", "target", "spawn", "destroy"];
        let what = all[self.draw.pick(all.len())];
        if used.contains(&what) {
            return None;
        }
        used.push(what);
        Some(match what {
            "x'" | "y'" => format!("{what} := {}", self.value(Dim::Speed)),
            "y" => format!("y := {}", self.value(Dim::Length)),
            "count" => format!("count := {}", self.draw.one(&["min(count + 1, 5)", "0", "count + 1"])),
            "flag" => format!("flag := {}", self.guard()),
            "colour" => format!("colour := {}", self.draw.one(&["red", "green"])),
            "target" => format!("target := {}", self.draw.one(&["none", "self"])),
            "spawn" => {
                let entity = self.draw.pick(self.entities);
                let into = if used.contains(&"target") || self.draw.chance(50) { "" } else { "target := " };
                used.push("target");
                format!("{into}spawn E{entity}(size = {}, target = self)", self.leaf(Dim::Length))
            }
            _ => format!("destroy {}", self.draw.one(&["self", "target"])),
        })
    }

    fn updates(&mut self) -> String {
        let mut used = Vec::new();
        let count = self.draw.pick(4);
        let list: Vec<String> = (0..count).filter_map(|_| self.update(&mut used)).collect();
        if list.is_empty() { String::new() } else { format!("{{ {} }}", list.join("; ")) }
    }

    fn flow(&mut self, variable: &str) -> String {
        match self.draw.pick(4) {
            0 => format!("{variable}'' = {}", self.value(Dim::Acceleration)),
            1 => format!("{variable}' = {}", self.value(Dim::Speed)),
            2 => format!("{variable} = {}", self.value(Dim::Length)),
            _ => self.envelope(variable),
        }
    }

    fn envelope(&mut self, variable: &str) -> String {
        if self.in_mode && self.draw.chance(20) {
            return format!(
                "envelope {variable} fixed {{ attack over 0.2s to 16; sustain for 0.1s; release over 0.2s to 0 }}"
            );
        }
        let by = self.draw.one(&["horizontal", "held(run)", "vertical"]);
        let attack = self.draw.one(&[
            "attack accel 500",
            "attack over 0.2s",
            "attack instant",
            "attack accel 900 to 150; decay accel 300",
        ]);
        let release =
            self.draw.one(&["", "release accel 500", "release hold", "release over 0.1s to 10", "release instant"]);
        let guard = if self.draw.chance(30) { format!("while {}", self.guard()) } else { String::new() };
        format!("envelope {variable}' by {by} {{ {attack}; sustain 100; {release}\n {guard}\n }}")
    }

    fn mode(&mut self, name: &str, siblings: &[String], group: usize, deep: usize) {
        let initial = if self.draw.chance(15) { "initial " } else { "" };
        self.line(format!("{initial}mode {name} {{"));
        self.in_mode = true;
        if self.draw.chance(30) {
            self.line("when lost(target) -> m0");
        }
        // Each group drives one variable.
        if self.draw.chance(60) {
            let flow = self.flow(["x", "y", "charge"][group % 3]);
            self.line(flow);
        }
        if self.draw.chance(20) {
            self.line("count := 1");
        }
        for _ in 0..self.draw.pick(4) {
            let guard = if self.draw.chance(15) && self.groups > 1 {
                let other = (group + 1) % self.groups;
                let later = other > group;
                format!("{}(g{other}.m0)", if later { "entering" } else { "exiting" })
            } else {
                self.guard()
            };
            let target = if self.draw.chance(75) {
                format!(" -> {}", siblings[self.draw.pick(siblings.len())])
            } else {
                String::new()
            };
            let updates = self.updates();
            if !target.is_empty() || !updates.is_empty() {
                self.line(format!("when {guard}{target} {updates}"));
            }
        }
        if self.draw.chance(15) {
            self.line("follow links when held(run)");
        }
        if deep < 2 && self.draw.chance(30) {
            let inner: Vec<String> = (0..1 + self.draw.pick(2)).map(|i| format!("{name}_{i}")).collect();
            for child in &inner {
                self.mode(child, &inner, group, deep + 1);
            }
        }
        self.line("}");
        self.in_mode = false;
    }

    fn entity(&mut self, index: usize) {
        self.line(format!("entity E{index} {{"));
        self.line("param size = 16\nparam speed = 60\nparam gravity = -300\nparam delay = 0.5s\nparam factor = 0.5");
        self.line("continuous charge = 0");
        self.line("discrete count: int 0..5 = 0\ndiscrete flag: bool = false\ndiscrete colour: {red, green} = red");
        let target = if self.draw.chance(50) { "any" } else { "E0" };
        self.line(format!("ref target: {target}"));
        self.line("button jump, run\naxis horizontal, vertical");
        for tag in 0..1 + self.draw.pick(2) {
            let kinematic = if self.draw.chance(20) { "kinematic " } else { "" };
            let shape = self.draw.one(&["rect(0, 0, 16, 16)", "rect(-4, 0, size, 24)", "circle(8, 8, 8)"]);
            let guard = if self.draw.chance(20) { " when count < 3" } else { "" };
            self.line(format!("{kinematic}collider t{tag}: {shape}{guard}"));
        }
        if self.draw.chance(30) {
            self.line("clamp y' in -400..400");
        }
        if self.draw.chance(10) {
            self.line("invariant count <= 5");
        }
        if self.draw.chance(20) {
            self.line("use Drift(pace = 2)");
        }
        if self.draw.chance(40) {
            let flow = self.flow("y");
            self.line(flow);
        }
        self.groups = 1 + self.draw.pick(3);
        for group in 0..self.groups {
            self.line(format!("group g{group} {{"));
            let names: Vec<String> = (0..1 + self.draw.pick(3)).map(|i| format!("m{i}")).collect();
            for name in &names {
                self.mode(name, &names, group, 0);
            }
            self.line("}");
        }
        if self.draw.chance(20) {
            self.line("group blink { use Blink(t = 0.2) }");
        }
        self.line("}");
    }

    fn world(&mut self) {
        self.line("world W {\nstep 1/60");
        let solid = self.draw.one(&["block", "block, keep velocity", "sense", "block from above", "block, carry"]);
        self.line(format!("collide t0, t1 with wall: {solid}"));
        let others = self.draw.one(&["sense", "block", "block, carry", "block from above"]);
        self.line(format!("collide t0 with t1, t0: {others}"));
        for entity in 0..self.entities {
            let limit = 12 + self.draw.pick(8);
            self.line(format!("limit E{entity} {limit}"));
        }
        self.line("tiles t 32 x 32 { '.': empty\n '#': wall\n 'e': spawn E0 }");
        self.line("space main { map t \"\n ##########\n #...e....#\n #..#.....#\n #......#.#\n ##########\n \"");
        for i in 0..1 + self.draw.pick(3) {
            let entity = self.draw.pick(self.entities);
            let (x, y) = (40 + 20 * self.draw.pick(10), 32 + 10 * self.draw.pick(6));
            let size = 8 + self.draw.pick(20);
            let y = if self.draw.chance(20) { "above wall".to_string() } else { y.to_string() };
            self.line(format!("place p{i}: E{entity} at ({x}, {y}) {{ size = {size} }}"));
        }
        if self.draw.chance(20) {
            self.line("rect wall (-32, main.height, main.width + 64, 32)");
        }
        self.line("link rect(0, 0, 200, 200) -> other at rect(0, 0, 100, 100) when p0.count >= 1\n}");
        self.line(
            "space other { rect wall (-100, -32, 500, 32)\n link rect(50, 0, 10, 10) -> main at rect(64, 64, 10, 10) }",
        );
        self.line("player 1: p0");
        self.line("goal far: p0.x > 200 and not inside(p0, other)\nnever out: any E0 in g0.m0 and p0.count == 5\n}");
    }
}
