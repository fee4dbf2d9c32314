//! Expressions and guards of random worlds.

use super::generate::{Dim, Generator, May};

impl Generator<'_> {
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
        let param = dim.param();
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
            Dim::Length if self.draw.chance(15) => self.maybe_drawn("size * count"),
            Dim::Length if self.draw.chance(6) => self.draw.one(&["tile", "wide", "width"]).into(),
            Dim::Length if self.palette.charges => own(self, &["x", "y", "q", "q"]),
            Dim::Length => own(self, &["x", "y"]),
            Dim::Speed if timed => "force * timer".into(),
            Dim::Speed if self.draw.chance(15) => self.maybe_drawn("speed * count"),
            Dim::Speed => own(self, &["x'", "y'", "q'"]),
            Dim::Force if self.draw.chance(10) => "pull".into(),
            Dim::Force => own(self, &["force * n", "x''", "y''", "q''"]),
            Dim::Time if timed => "timer".into(),
            Dim::Time => "delay".into(),
            Dim::Pure if self.palette.charges => {
                let of = self.draw.one(&["count", "heat", "count"]);
                self.maybe_drawn(of)
            }
            Dim::Pure => self.maybe_drawn("count"),
        }
    }

    /// A value of another instance, if there is one.
    fn read_other(&mut self, dim: Dim) -> String {
        let param = dim.param();
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
        match self.draw.pick(17) {
            0 => format!("({a} + {})", self.value(dim)),
            1 => format!("({a} - {})", self.value(dim)),
            2 => format!("min({a}, {})", self.value(dim)),
            3 => format!("max({a}, {})", self.value(dim)),
            4 => format!("abs({a})"),
            5 => format!("clamp({a}, {}, {})", self.value(dim), self.value(dim)),
            6 | 7 => format!("if({}, {a}, {})", self.guard(), self.value(dim)),
            8 => format!("-({a})"),
            9 | 15 | 16 => {
                let angle = self.ratio();
                let turn =
                    self.draw.one(&["sin", "cos", "sign", "floor", "floor", "floor", "ceil", "ceil", "round", "round"]);
                format!("({a} + {known} * {turn}({angle}))")
            }
            10 => {
                let angle = self.ratio();
                let size = if self.draw.chance(15) { "" } else { "abs" };
                format!("({known} * sqrt({size}({angle})))")
            }
            11 => {
                let (y, x) = (self.axes.read("", "y"), self.axes.read("", "x"));
                match self.may {
                    May::Params => format!("({a}) / 2"),
                    _ => format!("({known} * atan2({y}, {x}))"),
                }
            }
            13 => format!("mod({a}, {})", self.draw.one(&[&format!("2 * {known}"), known, &format!("(-3 * {known})")])),
            // Numbers alone would have no dimension.
            12 => format!("({a} + {known}) * {}", self.draw.one(&["n", "0.5", "2"])),
            _ => format!("({a} - {known}) / {}", self.draw.one(&["2", "(1 + abs(n))", "max(n, 1)", "n"])),
        }
    }

    /// A number without dimension from a length or a count.
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

    /// The tags that a collider of this entity can touch.
    fn other_tag(&mut self) -> String {
        let mut tags = vec!["wall", "wall", "wall", "cloud", "\"thin ice\""];
        tags.extend(self.plans.iter().map(|p| p.tag));
        tags.extend(self.plans.iter().map(|p| p.tag));
        self.draw.one(&tags).into()
    }

    pub fn touching(&mut self) -> String {
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
        if let Some(probe) = self.maybe_probe(&other) {
            return probe;
        }
        match (self.draw.chance(25), side) {
            (false, "") => format!("touching({other})"),
            (true, "") => format!("touching({mine}, {other})"),
            (false, side) => format!("touching({other}, {side})"),
            (true, side) => format!("touching({mine}, {other}, {side})"),
        }
    }

    /// Every third question about a contact is one about a place instead, so that all other choices are the same as
    /// without.
    pub fn maybe_probe(&mut self, other: &str) -> Option<String> {
        const OFFSETS: [(&str, &str); 9] = [
            ("size", "0"),
            ("0", "-1"),
            ("-size", "0"),
            ("16", "8"),
            ("if(flag, size, -size)", "0"),
            ("0", "size * count"),
            ("40", "-40"),
            ("0", "0"),
            ("size * n", "size / 2"),
        ];
        self.asked += 1;
        let (x, y) = OFFSETS[self.asked / 3 % OFFSETS.len()];
        let (mine, x) = (self.plan().tag, self.axes.beside(x, ""));
        self.asked.is_multiple_of(3).then(|| format!("touching({mine} at ({x}, {y}), {other})"))
    }

    /// A text about the count of the entity, or about what nature draws instead. Every fourth text where inputs may be read
    /// is, so that all other choices are the same as without.
    pub fn maybe_drawn(&mut self, text: impl Into<String>) -> String {
        let text = text.into();
        self.counts += usize::from(self.may == May::All);
        let is_drawn = self.may == May::All && self.counts.is_multiple_of(4);
        if is_drawn { text.replace("count", "roll") } else { text }
    }

    /// A guard.
    pub fn guard(&mut self) -> String {
        self.depth += 1;
        let out = self.any_guard();
        self.depth -= 1;
        out
    }

    /// A guard, or the name of a condition that is declared before the statement. Every fifth guard has a name, so that
    /// all other choices are the same as without.
    pub fn maybe_named(&mut self, guard: String) -> String {
        self.nameable += 1;
        if !self.nameable.is_multiple_of(5) {
            return guard;
        }
        let name = format!("fits{}", self.nameable);
        // The second of two names for one guard uses the first.
        if self.nameable.is_multiple_of(2) {
            self.line(format!("condition {name}_part = {guard}"));
            self.line(format!("condition {name} = {name}_part"));
        } else {
            self.line(format!("condition {name} = {guard}"));
        }
        name
    }

    pub fn any_guard(&mut self) -> String {
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
            11 | 0 | 1 => {
                let compared = format!("count {op} {}", self.draw.pick(4));
                self.maybe_drawn(compared)
            }
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
}
