//! The members of entities of random worlds: colliders, clamps, modes, edges.

use super::generate::{Dim, Generator, May, NAMES};

impl Generator<'_> {
    /// The members of an entity except its declarations.
    pub fn entity(&mut self) -> String {
        self.out.clear();
        let plan = self.plan().clone();
        self.group = None;
        self.may = May::Own;
        let (kinematic, tag) = (if plan.is_kinematic { "kinematic " } else { "" }, plan.tag);
        if self.palette.sizes && !plan.modes.is_empty() {
            self.sizes(kinematic, tag);
        } else if self.draw.chance(90) {
            let shape = self.shape();
            let guard = match self.palette.shapes && self.draw.chance(40) {
                true => {
                    let guard = self.guard();
                    format!(" when {}", self.maybe_named(guard))
                }
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
            let invariant = self.maybe_named(invariant);
            self.line(format!("invariant {invariant}"));
        }
        self.may = May::All;
        let drift = self.draw.chance(6);
        if drift {
            self.line("use Drift(pace = speed)");
        }
        let walks = (self.palette.walks || self.palette.travels) && self.me == 0 && self.draw.chance(80);
        if walks {
            self.gait();
        }
        for variable in if walks { &["q"][..] } else { &["x", "y", "q"] }.iter().copied() {
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
        if self.draw.chance(12) {
            self.always();
        }
        for (group, driven) in driven.iter().enumerate() {
            self.group = Some(group);
            let is_named = plan.modes.len() > 1 && plan.nameless != Some(group);
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

    /// Edges beside all modes.
    fn always(&mut self) {
        self.line("always {");
        for _ in 0..1 + self.draw.pick(2) {
            self.edge(&[]);
        }
        self.line("}");
    }

    /// Colliders, each active in one of the modes.
    fn sizes(&mut self, kinematic: &str, tag: &str) {
        for mode in self.plan().modes[0].clone() {
            let (width, height) = (["16", "16", "8", "24"], ["16", "32", "30", "16.5", "8"]);
            let (width, height) = (self.draw.one(&width), self.draw.one(&height));
            let left = self.axes.beside("0", width);
            let guard = match self.draw.chance(15) {
                true => format!("timer({mode}) >= 0.1"),
                false => format!("in {mode}"),
            };
            self.line(format!("{kinematic}collider {tag}: rect({left}, 0, {width}, {height}) when {guard}"));
        }
    }

    /// A player that walks and falls; links are followed in each mode.
    fn gait(&mut self) {
        let speed = format!("speed * {}", self.axes.axis("horizontal"));
        self.line(format!("x' = {}", self.axes.write("x'", &speed)));
        let force = self.draw.one(&["-400", "-400", "-force", "-900"]);
        self.line(format!("y'' = {force}"));
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

    /// The side of a collider whose size changes.
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

    /// Modes of one group, with their contents.
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
        let leaps = (self.palette.walks || self.palette.travels) && self.me == 0;
        let dash = if self.palette.dashes && self.draw.chance(50) { self.draw.pick(driven.len().min(2)) } else { 9 };
        if driven.len() >= 2 && self.plan().is_played && self.palette.envelopes && self.draw.chance(25) {
            let vector = self.vector();
            self.line(vector);
        } else {
            for (index, variable) in driven.iter().enumerate() {
                if index == dash {
                    // There in one mode, back in the next one.
                    let speed =
                        if own.is_multiple_of(2) { self.draw.one(&["60000", "4800", "12000"]) } else { "-60000" };
                    let name = format!("{variable}'");
                    let speed = self.axes.write(&name, speed);
                    self.line(format!("{name} = {speed}"));
                    continue;
                }
                if leaps && self.draw.chance(75) {
                    continue;
                }
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
        if leaps && self.draw.chance(60) {
            let asked = self.draw.one(&["pressed(jump)", "held(jump)", "pressed(jump)"]);
            let (floor, leap) =
                (self.draw.one(&[" and touching(wall, below)", ""]), self.draw.one(&["200", "120", "speed", "300"]));
            self.line(format!("when {asked}{floor} {{ y' := {leap} }}"));
        }
        if self.draw.chance(if self.palette.travels && self.me == 0 {
            90
        } else if self.arena.links {
            60
        } else {
            5
        }) {
            self.may = May::All;
            let guard = match self.draw.chance(25) {
                true => {
                    let guard = self.guard();
                    format!(" when {}", self.maybe_named(guard))
                }
                false => String::new(),
            };
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
        // Without this, most worlds stay in their first mode.
        if siblings.len() > 1 && self.draw.chance(60) {
            let target = &siblings[(own + 1) % siblings.len()];
            let time = match self.palette.dashes && self.draw.chance(60) {
                true => self.draw.one(&["1frames", "2frames"]),
                false => self.draw.one(&["0.1", "3frames", "0.3s", "delay"]),
            };
            let updates = if self.draw.chance(50) { self.updates(None, 2) } else { String::new() };
            self.line(format!("when timer >= {time} -> {target} {updates}"));
        }
        if self.palette.spawns && self.draw.chance(30) {
            let generation = self.spawn();
            let guard = self.draw.one(&["timer >= 0.2s", "timer >= delay", "count < 2", "touching(wall)", "n > 0"]);
            let after = self.draw.one(&["; destroy self", "", "; count := min(count + 1, 3)"]);
            self.line(format!("when {guard} {{ {generation}{after} }}"));
        }
        for _ in 0..self.draw.pick(if self.palette.is_small { 2 } else { 3 }) {
            self.edge(siblings);
        }
    }

    fn edge(&mut self, siblings: &[String]) {
        if self.arena.has_bricks && self.draw.chance(45) {
            self.breaking_edge();
            return;
        }
        let group = self.group.unwrap_or(0);
        let is_named = self.palette.contacts && self.draw.chance(28);
        let (guard, named) = if group > 0 && self.draw.chance(15) {
            let earlier = self.draw.pick(group);
            let all = self.plan().modes[earlier].clone();
            let mode = &all[self.draw.pick(all.len())];
            (format!("{}({mode})", self.draw.one(&["entering", "exiting"])), None)
        } else if is_named {
            let of = self.any_plan();
            let (tag, name) = (self.plans[of].tag, self.plans[of].name.clone());
            let touching = self.maybe_probe(tag).unwrap_or(format!("touching({tag})"));
            if self.palette.ends && touching.contains(" at ") && self.draw.chance(40) {
                self.line(format!("when {touching} as seen {{ destroy seen }}"));
            }
            match self.draw.pick(3) {
                0 => (format!("{touching} as seen"), Some(None)),
                1 => {
                    let (there, here) = (self.axes.read("seen.", "x"), self.axes.read("", "x"));
                    (format!("{touching} as seen and {there} > {here}"), Some(None))
                }
                _ => (format!("{touching} as seen and seen is {name} and seen.count < 3"), Some(Some(of))),
            }
        } else if self.palette.signals && self.draw.chance(50) {
            let guard = self.draw.one(&[
                "received(tick)",
                "received(tally)",
                "received(kick)",
                "tally.points >= 2",
                "not received(tick) and count < 3",
            ]);
            (guard.into(), None)
        } else {
            (self.guard(), None)
        };
        let (guard, named) = match named {
            None => self.maybe_asked(guard),
            Some(_) => (guard, named),
        };
        if self.edge_on(&format!("when {guard}"), named, siblings) && self.draw.chance(20) {
            self.edge_on("else", None, siblings);
        }
    }

    /// An edge that breaks tiles.
    fn breaking_edge(&mut self) {
        let tag = self.plan().tag;
        let guard = match self.draw.pick(3) {
            0 => {
                let (x, y) = (self.draw.one(&["0", "8", "-8", "16"]), self.draw.one(&["-8", "8", "-16", "0"]));
                format!("touching({tag} at ({}, {y}), brick) as hit", self.axes.level("x", x))
            }
            1 => format!("touching({tag}, brick) as hit"),
            _ => {
                let side = self.draw.one(&["above", "below", "left", "right"]);
                format!("touching({tag}, brick, {}) as hit", self.axes.side(side))
            }
        };
        let (asked, more) =
            (self.draw.one(&["", "", "count < 3 and "]), self.draw.one(&["", "; count += 1", "; y' := 0"]));
        self.line(format!("when {asked}{guard} {{ destroy hit{more} }}"));
    }

    /// Writes an edge unless it would do nothing; returns whether it was written.
    fn edge_on(&mut self, guard: &str, named: Option<Option<usize>>, siblings: &[String]) -> bool {
        let target = match !siblings.is_empty() && self.draw.chance(65) {
            true => format!(" -> {}", siblings[self.draw.pick(siblings.len())]),
            false => String::new(),
        };
        let updates = self.updates(named, 3);
        let does_something = !target.is_empty() || !updates.is_empty();
        if does_something {
            let nameable = guard.strip_prefix("when ").filter(|guard| !guard.contains(" as "));
            let guard = match nameable {
                Some(nameable) => format!("when {}", self.maybe_named(nameable.to_string())),
                None => guard.to_string(),
            };
            self.line(format!("{guard}{target} {updates}"));
        }
        does_something
    }
}
