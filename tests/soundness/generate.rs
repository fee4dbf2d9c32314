//! Random small worlds in which much happens, with every construct of the grammar. What an entity's text uses of a fixed
//! vocabulary is declared, so that programs are short.

use super::arena::Arena;
use super::choices::Draw;
use super::frame::{Axes, Frame};

/// The dimension of an expression.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Dim {
    Length,
    Speed,
    Force,
    Time,
    Pure,
}

/// What is decided of an entity before any text is written, as others speak of it.
#[derive(Debug, Clone, Default)]
pub struct Plan {
    pub name: String,
    pub tag: &'static str,
    /// The paths of the modes of each group, outer modes first.
    pub modes: Vec<Vec<String>>,
    pub is_kinematic: bool,
    pub is_played: bool,
    /// Whether anything makes new ones.
    pub is_spawned: bool,
}

/// Draws a program.
pub struct Generator<'c> {
    pub draw: Draw<'c>,
    pub axes: Axes,
    pub palette: Palette,
    pub out: String,
    pub plans: Vec<Plan>,
    pub arena: Arena,
    /// The entity that is written.
    me: usize,
    /// The group whose modes are written, and the path of the mode.
    group: Option<usize>,
    mode: String,
    /// What the expression that is written may ask: inputs, contacts, others.
    may: May,
    depth: usize,
}

/// What a program may use: each world does without most of it, so that what it does use shows, and much can be proven
/// of it (Groce, Zhang, Eide, Chen, Regehr, *Swarm testing*, ISSTA 2012).
#[derive(Clone, Copy)]
pub struct Palette {
    /// Numbers that are tiny or huge, and a little off.
    pub extremes: bool,
    /// Expressions of several parts.
    nodes: bool,
    /// References, and what others have.
    others: bool,
    /// Envelopes.
    envelopes: bool,
    /// Updates of positions.
    jumps: bool,
    /// Updates of speeds and accelerations.
    kicks: bool,
    /// Variables beside the position.
    charges: bool,
    /// Spawning.
    spawns: bool,
    /// Destroying.
    ends: bool,
    clamps: bool,
    /// Colliders that come and go, or change.
    shapes: bool,
    /// Guards that read positions and speeds.
    senses: bool,
    /// Accelerations.
    forces: bool,
    /// Inputs in values and guards.
    inputs: bool,
    /// Contacts in guards.
    contacts: bool,
}

impl Palette {
    fn draw(draw: &mut Draw<'_>) -> Self {
        let mut on = |percent: usize| draw.chance(percent);
        Palette {
            extremes: on(25),
            nodes: on(40),
            others: on(40),
            envelopes: on(30),
            jumps: on(40),
            kicks: on(40),
            charges: on(45),
            spawns: on(35),
            ends: on(35),
            clamps: on(30),
            shapes: on(30),
            senses: on(50),
            forces: on(50),
            inputs: on(60),
            contacts: on(70),
        }
    }
}

/// What an expression may read.
#[derive(Clone, Copy, PartialEq, Eq)]
enum May {
    /// Anything.
    All,
    /// No inputs and no contacts: colliders.
    Own,
    /// Its own variables, parameters and modes: invariants.
    State,
    /// Variables and parameters: clamps.
    Values,
    /// Parameters: initial choices.
    Params,
}

const NAMES: [(&str, &str); 3] = [("A", "a"), ("B", "b"), ("C", "c")];

/// The text of a program.
pub fn program(choices: &[u16], frame: Frame) -> String {
    let mut draw = Draw::new(choices);
    let palette = Palette::draw(&mut draw);
    let arena = Arena::draw(&mut draw);
    let axes = Axes::new(frame, arena.width(), arena.tile);
    let count = [1, 2, 1, 2, 3][draw.pick(5)];
    let mut plans: Vec<Plan> = (0..count).map(|index| plan(&mut draw, index)).collect();
    plans[0].is_played = draw.chance(75) && palette.inputs;
    let mut g = Generator {
        draw,
        axes,
        palette,
        out: String::new(),
        plans,
        arena,
        me: 0,
        group: None,
        mode: String::new(),
        may: May::All,
        depth: 0,
    };
    let world = g.world(frame);
    let mut entities = Vec::new();
    for index in 0..count {
        g.me = index;
        entities.push(g.entity());
    }
    let limits = g.limits();
    g.assembled(&entities, &world.replace("LIMITS\n", &limits))
}

fn plan(draw: &mut Draw<'_>, index: usize) -> Plan {
    let (name, tag) = NAMES[index];
    let groups = [1, 1, 1, 0, 2, 1, 0, 1, 3][draw.pick(9)];
    let mut modes = Vec::new();
    for group in 0..groups {
        let count = [2, 1, 2, 3, 2][draw.pick(5)];
        let prefix = if groups > 1 { format!("g{group}.") } else { String::new() };
        let mut paths = Vec::new();
        for mode in 0..count {
            let path = format!("{prefix}m{group}{mode}");
            paths.push(path.clone());
            if draw.chance(20) {
                let inner = 1 + draw.pick(2);
                paths.extend((0..inner).map(|i| format!("{path}.i{group}{mode}{i}")));
            }
        }
        modes.push(paths);
    }
    let is_kinematic = index > 0 && draw.chance(35);
    Plan { name: name.into(), tag, modes, is_kinematic, is_played: draw.chance(25), is_spawned: false }
}

impl Generator<'_> {
    fn line(&mut self, text: impl AsRef<str>) {
        self.out.push_str(text.as_ref());
        self.out.push('\n');
    }

    fn plan(&self) -> &Plan {
        &self.plans[self.me]
    }

    /// What others are called.
    pub fn any_plan(&mut self) -> usize {
        self.draw.pick(self.plans.len())
    }

    pub fn number(&mut self, dim: Dim) -> String {
        let rare = self.palette.extremes && self.draw.chance(15);
        let of: &[&str] = match (dim, rare) {
            (Dim::Length, false) => &["16", "0", "8", "40", "64", "-8", "3", "24", "100", "7.5", "1"],
            (Dim::Length, true) => &["0.0005", "15.9995", "1000000000", "0.000000001", "-0.000000001", "-0", "-1000"],
            (Dim::Speed, false) => &["60", "0", "-60", "30", "-30", "120", "200", "-100", "7.3", "480"],
            (Dim::Speed, true) => &["0.0005", "2500", "-2500", "1000000000", "0.000000001", "-0", "-0.1"],
            (Dim::Force, false) => &["-400", "0", "200", "-100", "50.5", "400"],
            (Dim::Force, true) => &["-3000", "1000000000", "0.0005", "-0"],
            (Dim::Time, false) => &["0.1", "3frames", "0.2s", "1frames", "100ms", "0.05", "0.5", "0"],
            (Dim::Time, true) => &["0.000000001", "100s", "-0.1"],
            (Dim::Pure, false) => &["1", "0", "2", "-1", "0.5", "3", "-0.8"],
            (Dim::Pure, true) => &["1000000000", "0.000000001", "-0"],
        };
        self.draw.one(of).into()
    }

    /// An expression of a dimension.
    pub fn value(&mut self, dim: Dim) -> String {
        self.depth += 1;
        let is_leaf = self.depth > 3 || !self.palette.nodes || self.draw.chance(60);
        let out = if is_leaf { self.leaf(dim) } else { self.node(dim) };
        self.depth -= 1;
        out
    }

    fn leaf(&mut self, dim: Dim) -> String {
        if self.draw.chance(40) {
            return self.number(dim);
        }
        let param = match dim {
            Dim::Length => "size",
            Dim::Speed => "speed",
            Dim::Force => "force",
            Dim::Time => "delay",
            Dim::Pure => "n",
        };
        if self.may == May::Params || self.draw.chance(25) {
            return param.into();
        }
        if self.may == May::All && self.plan().is_played && self.draw.chance(30) {
            let axis = self.draw.one(&["horizontal", "horizontal", "vertical"]);
            let axis = self.axes.axis(axis);
            return match dim {
                Dim::Length => format!("size * {axis}"),
                Dim::Speed => format!("speed * {axis}"),
                Dim::Force => format!("force * {axis}"),
                Dim::Time => format!("delay * {axis}"),
                Dim::Pure => axis,
            };
        }
        if self.may == May::All && self.palette.others && self.draw.chance(25) {
            return self.read_other(dim);
        }
        let timed = matches!(self.may, May::All) && self.group.is_some() && self.draw.chance(25);
        let own = |g: &mut Self, of: &[&str]| {
            let name = g.draw.one(of).to_string();
            g.axes.read("", &name)
        };
        if !self.palette.senses && self.draw.chance(80) {
            return param.into();
        }
        match dim {
            Dim::Length if timed => self.draw.one(&["speed * timer", "speed * timer / 2"]).into(),
            Dim::Length if self.draw.chance(15) => "size * count".into(),
            Dim::Length if self.draw.chance(6) => self.draw.one(&["tile", "wide", "width"]).into(),
            Dim::Length if self.palette.charges => own(self, &["x", "y", "q", "q"]),
            Dim::Length => own(self, &["x", "y"]),
            Dim::Speed if timed => "force * timer".into(),
            Dim::Speed if self.draw.chance(15) => "speed * count".into(),
            Dim::Speed => own(self, &["x'", "y'", "q'"]),
            Dim::Force if self.draw.chance(10) => "pull".into(),
            Dim::Force => own(self, &["force * n", "x''", "y''", "q''"]),
            Dim::Time if timed => "timer".into(),
            Dim::Time => "delay".into(),
            Dim::Pure if self.palette.charges => self.draw.one(&["count", "heat", "count"]).into(),
            Dim::Pure => "count".into(),
        }
    }

    /// What is read of another instance, where there is one.
    fn read_other(&mut self, dim: Dim) -> String {
        let param = match dim {
            Dim::Length => "size",
            Dim::Speed => "speed",
            Dim::Force => "force",
            Dim::Time => "delay",
            Dim::Pure => "n",
        };
        let of = self.any_plan();
        let name = self.plans[of].name.clone();
        let variable = match dim {
            Dim::Length => self.draw.one(&["x", "y", "q", "size"]),
            Dim::Speed => self.draw.one(&["x'", "y'", "speed"]),
            Dim::Force => self.draw.one(&["y''", "force"]),
            Dim::Time => "delay",
            Dim::Pure => self.draw.one(&["count", "n"]),
        };
        let number = self.number(dim);
        match self.draw.pick(4) {
            0 => {
                let read = self.axes.read("friend.", variable);
                format!("if(friend is {name}, {read}, {param})")
            }
            1 if dim == Dim::Length => {
                let read = self.axes.read("friend.", if variable == "y" { "y" } else { "x" });
                format!("if(friend is none, {number}, {read})")
            }
            2 => {
                let mode = self.mode_of(of).unwrap_or_default();
                match mode.is_empty() {
                    true => number,
                    false => format!("if(foe_{} in {mode}, {number}, {param})", name.to_lowercase()),
                }
            }
            _ => {
                let lower = name.to_lowercase();
                let read = self.axes.read(&format!("foe_{lower}."), variable);
                format!("if(foe_{lower} is none, {number}, {read})")
            }
        }
    }

    pub fn mode_of(&mut self, plan: usize) -> Option<String> {
        let all: Vec<String> = self.plans[plan].modes.iter().flatten().cloned().collect();
        (!all.is_empty()).then(|| all[self.draw.pick(all.len())].clone())
    }

    fn node(&mut self, dim: Dim) -> String {
        let a = self.value(dim);
        let known = match dim {
            Dim::Length => "size",
            Dim::Speed => "speed",
            Dim::Force => "force",
            Dim::Time => "delay",
            Dim::Pure => "1",
        };
        match self.draw.pick(14) {
            0 => format!("({a} + {})", self.value(dim)),
            1 => format!("({a} - {})", self.value(dim)),
            2 => format!("min({a}, {})", self.value(dim)),
            3 => format!("max({a}, {})", self.value(dim)),
            4 => format!("abs({a})"),
            5 => format!("clamp({a}, {}, {})", self.value(dim), self.value(dim)),
            6 | 7 => format!("if({}, {a}, {})", self.guard(), self.value(dim)),
            8 => format!("-({a})"),
            9 => {
                let angle = self.ratio();
                let turn = self.draw.one(&["sin", "cos", "sign", "floor", "ceil", "round"]);
                format!("({a} + {known} * {turn}({angle}))")
            }
            10 => {
                let angle = self.ratio();
                format!("({known} * sqrt(abs({angle})))")
            }
            11 => {
                let (y, x) = (self.axes.read("", "y"), self.axes.read("", "x"));
                match self.may {
                    May::Params => format!("({a}) / 2"),
                    _ => format!("({known} * atan2({y}, {x}))"),
                }
            }
            // Numbers alone would be pure ones.
            12 => format!("({a} + {known}) * {}", self.draw.one(&["n", "0.5", "2"])),
            _ => format!("({a} - {known}) / {}", self.draw.one(&["2", "(1 + abs(n))", "max(n, 1)", "n"])),
        }
    }

    /// A pure number from a length or a count.
    fn ratio(&mut self) -> String {
        match self.may {
            May::Params => "n".into(),
            _ => match self.draw.pick(4) {
                0 => format!("{} / size", self.axes.read("", "x")),
                1 => "q / size".into(),
                2 => "heat".into(),
                _ => format!("{} / speed", self.axes.read("", "y'")),
            },
        }
    }

    /// What one of mine can touch.
    fn other_tag(&mut self) -> String {
        let mut tags = vec!["wall", "wall", "wall", "cloud", "\"thin ice\""];
        tags.extend(self.plans.iter().map(|p| p.tag));
        tags.extend(self.plans.iter().map(|p| p.tag));
        self.draw.one(&tags).into()
    }

    fn touching(&mut self) -> String {
        let other = self.other_tag();
        let side = self.draw.one(&["", "below", "left", "right", "above"]);
        let side = match side {
            "left" => self.axes.side("left"),
            "right" => self.axes.side("right"),
            "above" => "above",
            "below" => "below",
            _ => "",
        };
        let mine = self.plan().tag;
        match (self.draw.chance(25), side) {
            (false, "") => format!("touching({other})"),
            (true, "") => format!("touching({mine}, {other})"),
            (false, side) => format!("touching({other}, {side})"),
            (true, side) => format!("touching({mine}, {other}, {side})"),
        }
    }

    /// A guard.
    pub fn guard(&mut self) -> String {
        self.depth += 1;
        let out = self.any_guard();
        self.depth -= 1;
        out
    }

    fn any_guard(&mut self) -> String {
        if self.depth <= 3 && self.draw.chance(if self.palette.nodes { 30 } else { 8 }) {
            let a = self.guard();
            return match self.draw.pick(4) {
                0 | 1 => format!("({a} and {})", self.guard()),
                2 => format!("({a} or {})", self.guard()),
                _ => format!("not ({a})"),
            };
        }
        let op = self.draw.one(&[">=", "<", ">", "<=", "==", "!="]);
        if self.may == May::Params {
            let dim = [Dim::Length, Dim::Speed, Dim::Pure][self.draw.pick(3)];
            let param = ["size", "speed", "", "", "n"][dim as usize];
            return format!("{param} {op} {}", self.number(dim));
        }
        let asks = self.may == May::All;
        let mut kind = self.draw.pick(17);
        let p = self.palette;
        let is_off = match kind {
            3..=5 => !p.senses,
            8..=10 => !p.contacts,
            14 => !p.others,
            15 | 16 => !p.charges,
            _ => false,
        };
        if is_off {
            kind = self.draw.pick(2);
        }
        match kind {
            0 | 1 if asks && self.group.is_some() => format!("timer {op} {}", self.number(Dim::Time)),
            2 if matches!(self.may, May::All | May::Own) && !self.plan().modes.is_empty() => {
                let mode = self.mode_of(self.me).unwrap_or_default();
                format!("timer({mode}) {op} {}", self.number(Dim::Time))
            }
            3 => {
                let (x, value) = (self.axes.read("", "x"), self.value(Dim::Length));
                format!("{x} {op} {value}")
            }
            4 => {
                let (y, value) = (self.axes.read("", "y"), self.value(Dim::Length));
                format!("{y} {op} {value}")
            }
            5 => {
                let variable = self.draw.one(&["x'", "y'", "q'"]);
                let (speed, value) = (self.axes.read("", variable), self.value(Dim::Speed));
                format!("{speed} {op} {value}")
            }
            6 if asks && self.plan().is_played => {
                format!("{}({})", self.draw.one(&["pressed", "held", "released"]), self.draw.one(&["jump", "run"]))
            }
            7 if asks && self.plan().is_played => {
                let axis = self.draw.one(&["horizontal", "vertical"]);
                format!("{} {op} {}", self.axes.axis(axis), self.draw.one(&["0", "0.5", "-1"]))
            }
            8..=10 if asks => self.touching(),
            12 => self.draw.one(&["flag", "colour == red", "colour != blue", "flag == true", "not flag"]).into(),
            13 if !self.plan().modes.is_empty() && self.may != May::Values => {
                let mode = self.mode_of(self.me).unwrap_or_default();
                format!("in {mode}")
            }
            14 if asks => self.about_other(),
            11 | 0 | 1 => format!("count {op} {}", self.draw.pick(4)),
            15 => format!("{} < q <= {}", self.number(Dim::Length), self.number(Dim::Length)),
            16 => format!("heat {op} {}", self.value(Dim::Pure)),
            _ => self.draw.one(&["not flag", "flag", "count < 3", "true"]).into(),
        }
    }

    /// A guard about an instance that a reference refers to.
    fn about_other(&mut self) -> String {
        let of = self.any_plan();
        let name = self.plans[of].name.clone();
        let lower = name.to_lowercase();
        match self.draw.pick(6) {
            0 => "friend is none".into(),
            1 => format!("friend is {name}"),
            2 => format!("lost(foe_{lower})"),
            3 => match self.mode_of(of) {
                Some(mode) => format!("foe_{lower} in {mode}"),
                None => format!("foe_{lower} is none"),
            },
            4 => {
                let read = self.axes.read(&format!("foe_{lower}."), "x");
                let x = self.axes.read("", "x");
                format!("(foe_{lower} is {name} and {read} > {x})")
            }
            _ => format!("(friend is {name} and friend.count > {})", self.draw.pick(3)),
        }
    }

    // ---- updates ---------------------------------------------------------------------------------------------

    /// Updates of different places; `named` is what the guard names, and of which entity it is, if that is known.
    fn updates(&mut self, named: Option<Option<usize>>, most: usize) -> String {
        let mut list: Vec<String> = Vec::new();
        let mut used: Vec<String> = Vec::new();
        for _ in 0..self.draw.pick(most + 1) {
            let (place, update) = self.update(named);
            if !used.contains(&place) {
                used.push(place);
                list.push(update);
            }
        }
        if list.is_empty() { String::new() } else { format!("{{ {} }}", list.join("; ")) }
    }

    /// An update, and the place that it is of.
    fn update(&mut self, named: Option<Option<usize>>) -> (String, String) {
        let places = [
            "count", "x'", "y'", "x", "y", "flag", "colour", "q", "q'", "heat", "y''", "friend", "foe", "spawn",
            "spawn", "destroy",
        ];
        let p = self.palette;
        let is_on = |place: &str| match place {
            "x" | "y" => p.jumps,
            "x'" | "y'" | "y''" => p.kicks,
            "q" | "q'" | "heat" => p.charges,
            "friend" | "foe" => p.others,
            "spawn" => p.spawns,
            "destroy" => p.ends,
            _ => true,
        };
        let mut place = self.draw.one(&places);
        if !is_on(place) {
            place = self.draw.one(&places);
        }
        if !is_on(place) {
            place = self.draw.one(&["count", "flag", "colour"]);
        }
        let set = |g: &Self, value: String| format!("{place} := {}", g.axes.write(place, &value));
        let update = match place {
            "count" => {
                let value = self.draw.one(&["min(count + 1, 3)", "max(count - 1, 0)", "0", "3 - count", "count + 1"]);
                format!("count := {value}")
            }
            "x'" | "y'" | "q'" => {
                let value = match self.draw.chance(25) {
                    true => format!("-0.8 * {}", self.axes.read("", place)),
                    false => self.value(Dim::Speed),
                };
                set(self, value)
            }
            "x" | "y" if self.draw.chance(60) => {
                let by = self.number(Dim::Length);
                let value = format!("{} + {by}", self.axes.read("", place));
                set(self, value)
            }
            "x" | "y" | "q" => {
                let value = match named {
                    Some(_) if self.draw.chance(50) => self.axes.read("seen.", if place == "y" { "y" } else { "x" }),
                    _ => self.value(Dim::Length),
                };
                set(self, value)
            }
            "heat" if p.extremes && self.draw.chance(15) => "heat := (heat + 1) * 1000000000 * 1000000000".into(),
            "heat" => format!("heat := {}", self.value(Dim::Pure)),
            "y''" => format!("y'' := {}", self.value(Dim::Force)),
            "flag" => format!("flag := {}", self.guard()),
            "colour" => format!("colour := {}", self.draw.one(&["green", "blue", "red"])),
            "friend" => {
                let value = match self.draw.pick(5) {
                    _ if named.is_some() && self.draw.chance(60) => "seen".into(),
                    1 => "none".into(),
                    2 => self.spawn(),
                    3 => format!("foe_{}", NAMES[self.any_plan()].1),
                    _ => "self".into(),
                };
                format!("friend := {value}")
            }
            "foe" => {
                let of = self.any_plan();
                let foe = format!("foe_{}", self.plans[of].name.to_lowercase());
                let value = match (named, self.draw.pick(3)) {
                    (Some(Some(seen)), 0) if seen == of => "seen".into(),
                    (_, 1) if of == self.me => "self".into(),
                    (_, 2) => self.spawn_of(of),
                    _ => "none".into(),
                };
                return (foe.clone(), format!("{foe} := {value}"));
            }
            "spawn" => self.spawn(),
            _ => match self.draw.pick(4) {
                _ if named.is_some() && self.draw.chance(60) => "destroy seen".into(),
                1 => "destroy friend".into(),
                2 => format!("destroy foe_{}", NAMES[self.any_plan()].1),
                _ => "destroy self".into(),
            },
        };
        (place.into(), update)
    }

    fn spawn(&mut self) -> String {
        let of = self.any_plan();
        self.spawn_of(of)
    }

    fn spawn_of(&mut self, of: usize) -> String {
        self.plans[of].is_spawned = true;
        let mut given = Vec::new();
        if self.draw.chance(50) {
            let read = self.axes.read("", "x");
            let by = self.number(Dim::Length);
            let value = self.axes.write("x", &format!("{read} + {by}"));
            given.push(format!("x = {value}"));
        }
        if self.draw.chance(25) {
            let value = self.value(Dim::Length);
            given.push(format!("y = {}", self.axes.write("y", &value)));
        }
        if self.draw.chance(30) {
            let value = self.draw.one(&["speed", "-speed", "speed * 2", "speed + 10"]).to_string();
            let value = if self.draw.chance(30) { self.value(Dim::Speed) } else { value };
            given.push(format!("speed = {value}"));
        }
        if self.draw.chance(15) {
            // Around, from one to the next.
            given.retain(|g| !g.starts_with("speed"));
            given.push("speed = -turn".into());
            given.push("turn = speed".into());
        }
        if self.draw.chance(30) {
            given.push(format!("n = {}", self.draw.one(&["n - 1", "n + 1", "-n", "n", "count"])));
        }
        if self.draw.chance(20) {
            given.push(format!("size = {}", self.draw.one(&["size - 4", "size + 4", "size / 2", "abs(q)"])));
        }
        if self.draw.chance(15) {
            let value = self.value(Dim::Speed);
            given.push(format!("y' = {value}"));
        }
        if self.draw.chance(15) {
            given.push(self.draw.one(&["count = 2", "count = count", "flag = true", "colour = blue"]).into());
        }
        if self.draw.chance(30) {
            given.push(self.draw.one(&["friend = self", "friend = friend"]).into());
        }
        let name = &self.plans[of].name;
        if given.is_empty() { format!("spawn {name}") } else { format!("spawn {name}({})", given.join(", ")) }
    }

    // ---- flows -----------------------------------------------------------------------------------------------

    /// What drives a variable.
    fn flow(&mut self, variable: &str) -> String {
        let played = self.plan().is_played;
        if self.draw.chance(60) || !self.palette.nodes && self.draw.chance(50) {
            // What games do.
            let text = match (variable, self.draw.pick(6)) {
                ("x", 0..=2) if played => format!("speed * {}", self.axes.axis("horizontal")),
                ("x", _) => self.draw.one(&["speed", "-speed", "speed * n", "60", "-60"]).into(),
                ("y", 0 | 5) if played => "speed * vertical".into(),
                ("y", 1) => {
                    let speed = self.draw.one(&["speed", "0", "-30"]);
                    return format!("y' = {speed}");
                }
                ("y", _) if self.palette.forces => {
                    let force = self.draw.one(&["-400", "force", "-force", "-100"]);
                    return format!("y'' = {force}");
                }
                ("y", _) => self.draw.one(&["0", "speed", "-speed", "-60", "turn"]).into(),
                _ => self.draw.one(&["speed", "30", "-60"]).into(),
            };
            return format!("{variable}' = {}", self.axes.write(&format!("{variable}'"), &text));
        }
        match self.draw.pick(6) {
            0 => {
                let value = self.value(Dim::Speed);
                format!("{variable}' = {}", self.axes.write(&format!("{variable}'"), &value))
            }
            1 if self.palette.forces => {
                let value = self.value(Dim::Force);
                format!("{variable}'' = {}", self.axes.write(&format!("{variable}''"), &value))
            }
            2 => {
                let value = self.value(Dim::Length);
                format!("{variable} = {}", self.axes.write(variable, &value))
            }
            3 => {
                let turn = self.draw.one(&["sin", "cos"]);
                let value = format!("40 + size * {turn}(q / size)");
                format!("{variable} = {}", self.axes.write(variable, &value))
            }
            _ if self.palette.envelopes => self.envelope(variable),
            _ => format!("{variable}' = {}", self.draw.one(&["0", "30", "-30"])),
        }
    }

    fn envelope(&mut self, variable: &str) -> String {
        let dim = if self.draw.chance(25) && variable != "x" { Dim::Length } else { Dim::Speed };
        let controlled = if dim == Dim::Speed { format!("{variable}'") } else { variable.to_string() };
        let level = |g: &mut Self, controlled: &str| {
            let value = match g.draw.chance(60) {
                true => g.number(dim),
                false => g.value(dim),
            };
            g.axes.level(controlled, &value)
        };
        if self.group.is_some() && self.draw.chance(25) {
            let peak = level(self, &controlled);
            let to = level(self, &controlled);
            let attack = self.draw.one(&["attack over 0.1s", "attack instant", "attack over delay"]);
            let hold = self.draw.one(&["sustain for 0.1s; ", ""]);
            let release = match self.draw.one(&["over 0.1s", "", "over delay"]) {
                "" => format!("release to {to}"),
                rate => format!("release {rate} to {to}"),
            };
            return format!("envelope {controlled} fixed {{ {attack} to {peak}; {hold}{release} }}");
        }
        let by = self.draw.one(&["horizontal", "held(run)", "vertical", "held(jump)"]);
        // An axis already has the sign.
        let own = if by.starts_with("held") { controlled.as_str() } else { "" };
        let rate = |g: &mut Self, dim: Dim| match (g.draw.pick(4), dim) {
            (0, Dim::Speed) => "accel 500".to_string(),
            (0, _) => "accel 60".into(),
            (1, _) => "over 0.1s".into(),
            (2, Dim::Speed) => "accel force".into(),
            (2, _) => "accel speed".into(),
            _ => "instant".into(),
        };
        let mut parts = Vec::new();
        if self.draw.chance(70) {
            let attack = rate(self, dim);
            if self.draw.chance(35) {
                let peak = level(self, own);
                parts.push(format!("attack {attack} to {peak}"));
                if self.draw.chance(60) {
                    parts.push(format!("decay {}", rate(self, dim)));
                }
            } else {
                parts.push(format!("attack {attack}"));
            }
        }
        parts.push(format!("sustain {}", level(self, own)));
        if self.draw.chance(70) {
            let to = level(self, "");
            let release = rate(self, dim);
            parts.push(match self.draw.pick(4) {
                0 => "release hold".into(),
                1 => format!("release {release}"),
                2 => format!("release {release} to {to}"),
                _ => format!("release to {to}"),
            });
        }
        if self.draw.chance(25) {
            parts.push(format!("while {}", self.guard()));
        }
        format!("envelope {controlled} by {by} {{ {} }}", parts.join("; "))
    }

    fn vector(&mut self) -> String {
        let directions = self.draw.one(&["", " directions 4", " directions 8", " directions 3", " directions any"]);
        let attack = self.draw.one(&[
            "",
            "attack accel 500; ",
            "attack instant; ",
            "attack over 0.1s to 200; decay accel 100; ",
        ]);
        let release = self.draw.one(&["", "; release accel 300", "; release hold", "; release over 0.2s to 20"]);
        let guard = if self.draw.chance(20) { format!("; while {}", self.guard()) } else { String::new() };
        let sustain = self.draw.one(&["90", "speed", "0", "-60"]);
        format!(
            "envelope (x', y') by (horizontal, vertical){directions} {{ {attack}sustain {sustain}{release}{guard} }}"
        )
    }

    // ---- entities --------------------------------------------------------------------------------------------

    /// The members of an entity but for its declarations.
    fn entity(&mut self) -> String {
        self.out.clear();
        let plan = self.plan().clone();
        self.group = None;
        self.may = May::Own;
        let (kinematic, tag) = (if plan.is_kinematic { "kinematic " } else { "" }, plan.tag);
        if self.draw.chance(90) {
            let shape = self.shape();
            let guard = match self.palette.shapes && self.draw.chance(40) {
                true => format!(" when {}", self.guard()),
                false => String::new(),
            };
            let more = self.draw.one(&["", "", "", "", ", \"thin ice\"", ", cloud"]);
            self.line(format!("{kinematic}collider {tag}{more}: {shape}{guard}"));
        }
        if self.draw.chance(15) {
            let shape = self.shape();
            let guard = if self.draw.chance(60) { format!(" when {}", self.guard()) } else { String::new() };
            let kinematic = if self.draw.chance(20) { "kinematic " } else { kinematic };
            self.line(format!("{kinematic}collider {tag}: {shape}{guard}"));
        }
        self.may = May::Values;
        for _ in 0..if self.palette.clamps { self.draw.pick(3) } else { 0 } {
            let clamp = self.clamp();
            self.line(clamp);
        }
        self.may = May::State;
        if self.draw.chance(20) {
            let invariant = self.guard();
            self.line(format!("invariant {invariant}"));
        }
        self.may = May::All;
        let drift = self.draw.chance(6);
        if drift {
            self.line("use Drift(pace = speed)");
        }
        for variable in ["x", "y", "q"] {
            if self.draw.chance(if variable == "q" { 15 } else { 45 }) && (variable != "q" || self.palette.charges) {
                let flow = self.flow(variable);
                self.line(flow);
            }
        }
        let driven: &[&[&str]] = match plan.modes.len() {
            0 => &[],
            1 => &[&["x", "y", "q"]],
            2 => &[&["x", "y"], &["q"]],
            _ => &[&["x"], &["y"], &["q"]],
        };
        for (group, driven) in driven.iter().enumerate() {
            self.group = Some(group);
            let is_named = plan.modes.len() > 1;
            if is_named {
                self.line(format!("group g{group} {{"));
            }
            let prefix = if is_named { format!("g{group}.") } else { String::new() };
            let paths = plan.modes[group].clone();
            self.siblings(&prefix, &paths, driven);
            if is_named {
                self.line("}");
            }
        }
        self.group = None;
        if plan.modes.len() > 1 && self.draw.chance(15) {
            self.line("group blink { use Blink(t = delay) }");
        }
        std::mem::take(&mut self.out)
    }

    fn shape(&mut self) -> String {
        let is_plain = self.draw.chance(60);
        let (x, y) = (self.draw.one(&["0", "-4", "8"]), self.draw.one(&["0", "-8", "4"]));
        let (x, y) = if is_plain { ("0", "0") } else { (x, y) };
        let width = self.draw.one(&["16", "16", "8", "24", "size", "48", "4"]);
        let height = self.draw.one(&["16", "8", "size", "30", "4"]);
        let changes = self.palette.shapes;
        match self.draw.pick(if changes { 9 } else { 7 }) {
            0..=4 => format!("rect({}, {y}, {width}, {height})", self.axes.beside(x, width)),
            5 | 6 => {
                let radius = self.draw.one(&["8", "4", "size", "12"]);
                format!("circle({}, {y}, {radius})", self.axes.beside(x, ""))
            }
            7 => {
                let width = self.side();
                format!("rect({}, 0, {width}, {height})", self.axes.beside("0", &width))
            }
            _ => {
                let height = self.side();
                format!("rect({}, {y}, {width}, {height})", self.axes.beside(x, width))
            }
        }
    }

    /// The side of a collider that changes.
    fn side(&mut self) -> String {
        let value = self.value(Dim::Length);
        let own = self.draw.one(&["q", "size", "size * count"]);
        format!("{own} + abs({value})")
    }

    fn clamp(&mut self) -> String {
        let variable = self.draw.one(&["y'", "x'", "q", "y", "x", "q'"]);
        let dim = if variable.contains('\'') { Dim::Speed } else { Dim::Length };
        let bound = |g: &mut Self| match g.draw.chance(60) {
            true => g.number(dim),
            false => g.value(dim),
        };
        let a = bound(self);
        let flipped = self.axes.is_flipped(variable);
        match self.draw.pick(4) {
            0 | 1 => {
                let low = match dim {
                    Dim::Speed => format!("-abs({a})"),
                    _ => format!("min({a}, 0)"),
                };
                let high = match dim {
                    Dim::Speed => format!("abs({a})"),
                    _ => format!("max({a}, 60)"),
                };
                let (low, high) = (self.axes.write(variable, &low), self.axes.write(variable, &high));
                let (low, high) = if flipped { (high, low) } else { (low, high) };
                format!("clamp {variable} in {low}..{high}")
            }
            2 => format!("clamp {variable} {} {}", if flipped { ">=" } else { "<=" }, self.axes.write(variable, &a)),
            _ => format!("clamp {variable} {} {}", if flipped { "<=" } else { ">=" }, self.axes.write(variable, &a)),
        }
    }

    /// Modes beside each other, with what is inside of them.
    fn siblings(&mut self, prefix: &str, paths: &[String], driven: &[&str]) {
        let own: Vec<String> =
            paths.iter().filter(|p| !p[prefix.len()..].contains('.')).map(|p| p[prefix.len()..].to_string()).collect();
        let initial = self.draw.chance(15).then(|| self.draw.pick(own.len()));
        for (index, name) in own.iter().enumerate() {
            let initial = match initial == Some(index) {
                true if self.draw.chance(50) => {
                    self.may = May::Params;
                    let guard = self.guard();
                    self.may = May::All;
                    format!("initial when {guard} ")
                }
                true => "initial ".into(),
                false => String::new(),
            };
            self.line(format!("{initial}mode {name} {{"));
            let outer = std::mem::replace(&mut self.mode, format!("{prefix}{name}"));
            self.mode_body(&own, index, driven);
            let inner_prefix = format!("{prefix}{name}.");
            let inner: Vec<String> = paths.iter().filter(|p| p.starts_with(&inner_prefix)).cloned().collect();
            if !inner.is_empty() {
                self.siblings(&inner_prefix, &inner, driven);
            }
            self.mode = outer;
            self.line("}");
        }
    }

    fn mode_body(&mut self, siblings: &[String], own: usize, driven: &[&str]) {
        if driven.len() >= 2 && self.plan().is_played && self.palette.envelopes && self.draw.chance(25) {
            let vector = self.vector();
            self.line(vector);
        } else {
            for variable in driven {
                if self.draw.chance(if *variable == "q" { 30 } else { 70 })
                    && (*variable != "q" || self.palette.charges)
                {
                    let flow = self.flow(variable);
                    self.line(flow);
                }
            }
        }
        if self.draw.chance(12) {
            let entry =
                self.draw.one(&["count := 1", "heat := heat + 1", "flag := not flag", "colour := green", "y' := 120"]);
            self.line(entry);
        }
        if self.draw.chance(if self.arena.links { 60 } else { 5 }) {
            self.may = May::All;
            let guard = if self.draw.chance(25) { format!(" when {}", self.guard()) } else { String::new() };
            let updates = if self.draw.chance(30) { self.updates(None, 2) } else { String::new() };
            self.line(format!("follow links{guard} {updates}"));
        }
        if self.palette.others && self.draw.chance(15) {
            let foe = NAMES[self.any_plan()].1;
            let target = siblings[self.draw.pick(siblings.len())].clone();
            self.line(format!("when lost(foe_{foe}) -> {target}"));
        }
        if siblings.len() > 1 && self.palette.contacts && self.draw.chance(25) {
            let target = &siblings[(own + 1) % siblings.len()];
            let touching = self.touching();
            self.line(format!("when {touching} -> {target}"));
        }
        // Without this most worlds stay in their first mode.
        if siblings.len() > 1 && self.draw.chance(60) {
            let target = &siblings[(own + 1) % siblings.len()];
            let time = self.draw.one(&["0.1", "3frames", "0.3s", "delay"]);
            let updates = if self.draw.chance(50) { self.updates(None, 2) } else { String::new() };
            self.line(format!("when timer >= {time} -> {target} {updates}"));
        }
        if self.palette.spawns && self.draw.chance(30) {
            let generation = self.spawn();
            let guard = self.draw.one(&["timer >= 0.2s", "timer >= delay", "count < 2", "touching(wall)", "n > 0"]);
            let after = self.draw.one(&["; destroy self", "", "; count := min(count + 1, 3)"]);
            self.line(format!("when {guard} {{ {generation}{after} }}"));
        }
        for _ in 0..self.draw.pick(3) {
            self.edge(siblings);
        }
    }

    fn edge(&mut self, siblings: &[String]) {
        let group = self.group.unwrap_or(0);
        let is_named = self.palette.contacts && self.draw.chance(20);
        let (guard, named) = if group > 0 && self.draw.chance(15) {
            let earlier = self.draw.pick(group);
            let all = self.plan().modes[earlier].clone();
            let mode = &all[self.draw.pick(all.len())];
            (format!("{}({mode})", self.draw.one(&["entering", "exiting"])), None)
        } else if is_named {
            let of = self.any_plan();
            let (tag, name) = (self.plans[of].tag, self.plans[of].name.clone());
            match self.draw.pick(3) {
                0 => (format!("touching({tag}) as seen"), Some(None)),
                1 => {
                    let (there, here) = (self.axes.read("seen.", "x"), self.axes.read("", "x"));
                    (format!("touching({tag}) as seen and {there} > {here}"), Some(None))
                }
                _ => (format!("touching({tag}) as seen and seen is {name} and seen.count < 3"), Some(Some(of))),
            }
        } else {
            (self.guard(), None)
        };
        let target = match self.draw.chance(65) {
            true => format!(" -> {}", siblings[self.draw.pick(siblings.len())]),
            false => String::new(),
        };
        let updates = self.updates(named, 3);
        if !target.is_empty() || !updates.is_empty() {
            self.line(format!("when {guard}{target} {updates}"));
        }
    }

    // ---- the whole -------------------------------------------------------------------------------------------

    /// All items, with declarations of what is used.
    fn assembled(&mut self, entities: &[String], world: &str) -> String {
        let all = entities.concat() + world;
        let uses = |text: &str, word: &str| words(text).any(|w| w == word);
        let mut out = String::new();
        let items: [(&str, &str); 6] = [
            ("tile", "const tile = 16\n"),
            ("wide", "const wide: px = 3 * 8\n"),
            ("pull", "const pull: px*s^-2 = -150\n"),
            (
                "Blink",
                "behavior Blink(t) {\nmode on { when timer >= t -> off }\nmode off { when timer >= t -> on }\n}\n",
            ),
            ("Drift", "behavior Drift(pace) {\ncontinuous drift = 0\ndrift' = pace\n}\n"),
            ("width", "import \"parts.hyped\"\n"),
        ];
        for (word, item) in items {
            if uses(&all, word) {
                out.push_str(item);
            }
        }
        let members: [(&str, &str); 17] = [
            ("turn", "param turn: px/s = 0\n"),
            ("size", "param size: px = 16\n"),
            ("speed", "param speed: px/s = 60\n"),
            ("force", "param force: px/s^2 = 200\n"),
            ("delay", "param delay: s = 0.2\n"),
            ("n", "param n: 1 = 2\n"),
            ("q", "continuous q: px = 0\n"),
            ("heat", "continuous heat: 1\n"),
            ("count", "discrete count: int 0..3 = 0\n"),
            ("flag", "discrete flag: bool = false\n"),
            ("colour", "discrete colour: {red, green, blue} = red\n"),
            ("friend", "ref friend: any\n"),
            ("foe_a", "ref foe_a: A\n"),
            ("foe_b", "ref foe_b: B\n"),
            ("foe_c", "ref foe_c: C\n"),
            ("jump", "button jump, run\n"),
            ("horizontal", "axis horizontal, vertical\n"),
        ];
        for (plan, body) in self.plans.iter().zip(entities) {
            out.push_str(&format!("entity {} {{\n", plan.name));
            for (word, member) in members {
                // What is read of others, and what a spawn or a place sets.
                let also = !matches!(word, "jump" | "horizontal") && uses(&all, word);
                let run = word == "jump" && uses(body, "run") || word == "horizontal" && uses(body, "vertical");
                if uses(body, word) || also || run {
                    out.push_str(member);
                }
            }
            out.push_str(body);
            out.push_str("}\n");
        }
        out + world
    }
}

/// The words of a text, derivatives without their marks.
pub fn words(text: &str) -> impl Iterator<Item = &str> {
    text.split(|c: char| !c.is_alphanumeric() && c != '_').filter(|w| !w.is_empty())
}
