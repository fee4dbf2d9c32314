//! Random tiny worlds: one to three entities of a few modes, a small map or a few rectangles, one button or one axis.
//! Numbers are small and mostly go up evenly in steps, so that there are few states. Drawn from a list of choices, so
//! that a failing world shrinks: without choices left the first alternative is taken, which is the plainest.

use std::fmt::Write;

use crate::support::draw::Draw;

/// The role of an entity.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Role {
    Hero,
    Foe,
    Shot,
}

impl Role {
    pub(super) fn name(self) -> &'static str {
        ["Hero", "Foe", "Shot"][self as usize]
    }

    fn tag(self) -> &'static str {
        ["body", "foe", "shot"][self as usize]
    }
}

/// The step's length as a fraction.
const STEPS: [(u32, u32); 8] = [(1, 4), (1, 10), (1, 8), (1, 60), (1, 2), (1, 20), (1, 30), (1, 1)];

pub(super) struct Generator<'c> {
    pub(super) draw: Draw<'c>,
    out: String,
    step: (u32, u32),
    role: Role,
    /// The modes of each entity, group by group.
    modes: [Vec<Vec<String>>; 3],
    pub(super) has_foe: bool,
    pub(super) has_shot: bool,
    has_button: bool,
    has_axis: bool,
    pub(super) has_signals: bool,
    /// Whether there are tiles that can be broken.
    pub has_bricks: bool,
    /// Whether there are slopes.
    has_slopes: bool,
    /// Whether a space has a map.
    pub has_map: bool,
    /// Which entities have a chance.
    lucky: [bool; 3],
    /// The current group.
    group: usize,
    in_mode: bool,
}

/// The text of a program.
pub fn program(choices: &[u16]) -> String {
    let mut g = Generator {
        draw: Draw::new(choices),
        out: String::new(),
        step: (1, 4),
        role: Role::Hero,
        modes: Default::default(),
        has_foe: false,
        has_shot: false,
        has_button: true,
        has_axis: false,
        has_signals: false,
        has_bricks: false,
        has_slopes: false,
        has_map: false,
        lucky: [false; 3],
        group: 0,
        in_mode: false,
    };
    g.step = STEPS[g.draw.pick(STEPS.len())];
    let inputs = g.draw.pick(5);
    (g.has_button, g.has_axis) = (inputs != 1 && inputs != 3, matches!(inputs, 1 | 3 | 4));
    g.has_foe = g.draw.chance(55);
    g.has_shot = g.draw.chance(30);
    g.has_signals = g.draw.chance(30);
    g.has_bricks = g.draw.chance(25);
    g.has_slopes = g.draw.chance(35);
    for role in [Role::Hero, Role::Foe, Role::Shot] {
        g.role = role;
        g.names();
    }
    // Of many instances, nature could draw too much to try it all.
    g.lucky[Role::Hero as usize] = g.draw.chance(30);
    g.world();
    let world = std::mem::take(&mut g.out);
    let roles = [(Role::Hero, true), (Role::Foe, g.has_foe), (Role::Shot, g.has_shot)];
    for (role, _) in roles.into_iter().filter(|(_, is_there)| *is_there) {
        g.role = role;
        g.entity();
    }
    g.out + &world
}

impl Generator<'_> {
    fn line(&mut self, text: impl AsRef<str>) {
        self.out.push_str(text.as_ref());
        self.out.push('\n');
    }

    /// The current modes of all instances.
    fn names(&mut self) {
        let role = self.role;
        let prefix = ["a", "p", "u"][role as usize];
        let count = 1 + self.draw.pick(3);
        let mut groups = vec![(0..count).map(|i| format!("{prefix}{i}")).collect::<Vec<String>>()];
        if role == Role::Hero && self.draw.chance(20) {
            groups.push(vec!["b0".into(), "b1".into()]);
        }
        self.modes[role as usize] = groups;
    }

    pub(super) fn length(&mut self) -> String {
        self.draw.one(&["16", "0", "8", "32", "24", "4", "48", "12", "40", "20", "2", "15", "6.5", "-8", "64"]).into()
    }

    /// A speed in px per step.
    fn speed(&mut self) -> String {
        let px = [4.0, -4.0, 8.0, 0.0, -8.0, 2.0, 1.0, 16.0, -16.0, 3.0, -2.0, 20.0, -5.0][self.draw.pick(13)];
        number(px * f64::from(self.step.1) / f64::from(self.step.0))
    }

    /// An acceleration in px per step for each step.
    fn acceleration(&mut self) -> String {
        let px = [-1.0, -2.0, 1.0, -4.0, 0.0, 2.0, -0.5][self.draw.pick(7)];
        number(px * f64::from(self.step.1 * self.step.1) / f64::from(self.step.0 * self.step.0))
    }

    fn time(&mut self) -> String {
        let steps = 1 + self.draw.pick(5);
        match self.draw.pick(3) {
            0 => format!("{steps}frames"),
            1 => number(f64::from(steps as u32 * self.step.0) / f64::from(self.step.1)),
            _ => self.draw.one(&["0.5", "0.25s", "100ms", "1s"]).into(),
        }
    }

    /// A mode of the entity that is written, of its current group.
    pub(super) fn mode(&mut self) -> String {
        let modes = self.modes[self.role as usize][self.group].clone();
        modes[self.draw.pick(modes.len())].clone()
    }

    pub(super) fn mode_of(&mut self, role: Role) -> String {
        let group = self.draw.pick(self.modes[role as usize].len());
        let modes = self.modes[role as usize][group].clone();
        modes[self.draw.pick(modes.len())].clone()
    }

    /// A tag that the current entity can touch.
    fn other(&mut self) -> &'static str {
        let mut all = vec!["wall", "coin", "cloud"];
        let roles = [(Role::Hero, true), (Role::Foe, self.has_foe), (Role::Shot, self.has_shot)];
        all.extend(roles.iter().filter(|(role, is)| *is && *role != self.role).map(|(role, _)| role.tag()));
        all.extend(self.has_bricks.then_some("brick"));
        all[self.draw.pick(all.len())]
    }

    /// The side of a contact query.
    fn side(&mut self) -> &'static str {
        self.draw.one(&["", "", ", below", ", right", ", left", ", above"])
    }

    fn entity(&mut self) {
        let role = self.role;
        self.line(format!("entity {} {{", role.name()));
        if role == Role::Hero && self.has_button {
            self.line("    button go");
        }
        if role == Role::Hero && self.has_axis {
            self.line("    axis h");
        }
        if self.lucky[role as usize] {
            let range = if role == Role::Hero { self.draw.one(&["1..2", "0..2"]) } else { "1..2" };
            self.line(format!("    chance r: {range}"));
        }
        let speed = self.speed();
        self.line(format!("    param s: px/s = {speed}"));
        self.line("    param l: px = 16");
        let most = 1 + self.draw.pick(3);
        self.line(format!("    discrete n: int 0..{most} = 0"));
        if self.draw.chance(30) {
            self.line("    discrete f: bool = false");
        } else {
            self.line("    discrete f: bool = true");
        }
        let target = match self.draw.pick(3) {
            0 if self.has_foe => "Foe",
            1 if self.has_shot => "Shot",
            _ => "any",
        };
        self.line(format!("    ref t: {}", if self.has_foe { "Foe" } else { target }));
        if self.has_signals {
            self.line("    signal tick");
            self.line("    signal ping(count)");
            self.line("    signal push(way: px)");
        }
        if self.draw.chance(85) {
            let kinematic = if role == Role::Foe && self.draw.chance(40) { "kinematic " } else { "" };
            let shape = if self.draw.chance(85) {
                let at = self.draw.one(&["0, 0", "0, 0", "2, 0", "-4, 4"]);
                let size = self.draw.one(&["8, 8", "16, 16", "12, 16", "16, 4", "4, 4", "24, 8"]);
                format!("rect({at}, {size})")
            } else {
                format!("circle({})", self.draw.one(&["8, 8, 8", "0, 0, 4", "4, 4, 6.5"]))
            };
            self.in_mode = false;
            let when = match self.draw.pick(10) {
                1 => " when f".to_string(),
                2 => format!(" when in {}", self.modes[role as usize][0].last().unwrap()),
                _ => String::new(),
            };
            self.line(format!("    {kinematic}collider {}: {shape}{when}", role.tag()));
            if self.draw.chance(12) {
                let size = self.draw.one(&["4, 4", "if(f, l, l / 2), 4"]);
                self.line(format!("    collider nose, coin: rect(16, 0, {size})"));
            }
        }
        self.clamps();
        if self.draw.chance(15) {
            let var = self.draw.one(&["x", "y"]);
            let flow = self.flow(var);
            self.line(format!("    {flow}"));
        }
        if role != Role::Shot && self.draw.chance(10) {
            let (guard, update) = (self.guard(2), self.update());
            self.line(format!("    always {{ when {guard} {{ {update} }} }}"));
        }
        let groups = self.modes[role as usize].clone();
        let nameless = self.draw.chance(30).then(|| self.draw.pick(groups.len()));
        for (group, modes) in groups.iter().enumerate() {
            self.group = group;
            let is_named = groups.len() > 1 && nameless != Some(group);
            if is_named {
                self.line(format!("    group {} {{", ["first", "second"][group]));
            }
            for mode in modes {
                self.a_mode(mode, groups.len() > 1, group);
            }
            if is_named {
                self.line("    }");
            }
        }
        self.line("}");
    }

    fn clamps(&mut self) {
        let top = self.draw.one(&["48", "32", "64", "40"]);
        match self.draw.pick(6) {
            5 => {}
            4 => self.line(format!("    clamp x in 0..{top}")),
            _ => {
                self.line(format!("    clamp x in 0..{top}"));
                let top = self.draw.one(&["32", "48", "16"]);
                self.line(format!("    clamp y in 0..{top}"));
            }
        }
        for var in ["x'", "y'"] {
            if self.draw.chance(45) {
                let most = 2.0_f64.powi(1 + self.draw.pick(3) as i32) * f64::from(self.step.1) / f64::from(self.step.0);
                self.line(format!("    clamp {var} in -{0}..{0}", number(most)));
            }
        }
    }

    fn flow(&mut self, var: &str) -> String {
        let played = self.role == Role::Hero;
        if self.lucky[self.role as usize] && self.draw.chance(20) {
            return format!("{var}' = {}", self.draw.one(&["if(r > 1, s, -s)", "s * r", "s * (r - 1)"]));
        }
        match self.draw.pick(12) {
            1 if played && self.has_axis => format!("{var}' = s * h"),
            2 if played && self.has_button => format!("{var}' = if(held(go), s, 0)"),
            3 => format!("{var}'' = {}", self.acceleration()),
            4 => format!("{var}' = 0"),
            5 => format!("{var} = {}", self.length()),
            6 => format!("{var}' = if({}, s, -s)", self.guard(1)),
            7 if self.has_foe && self.role != Role::Foe => format!("{var}' = if(t is Foe, t.{var}', s)"),
            8 if played && (self.has_axis || self.has_button) => {
                let by = if self.has_axis { "h" } else { "held(go)" };
                let (rate, level) = (self.acceleration().replace('-', ""), self.speed().replace('-', ""));
                let attack = match self.draw.pick(4) {
                    0 => format!("attack accel {rate}"),
                    1 => format!("attack over {}", self.time()),
                    2 => format!("attack accel {rate} to {}", self.speed().replace('-', "")),
                    _ => "attack instant".into(),
                };
                let release = match self.draw.pick(4) {
                    0 => format!("release accel {rate}"),
                    1 => "release hold".into(),
                    2 => format!("release instant to {}", self.speed().replace('-', "")),
                    _ => "release instant".into(),
                };
                format!("envelope {var}' by {by} {{ {attack}; sustain {level}; {release} }}")
            }
            9 => format!("{var}' = if(x > y, -s, s)"),
            10 => format!("{var}' = s / 2"),
            _ => format!("{var}' = {}", self.draw.one(&["s", "-s"])),
        }
    }

    fn a_mode(&mut self, mode: &str, grouped: bool, group: usize) {
        self.line(format!("    mode {mode} {{"));
        self.in_mode = true;
        for (index, var) in ["x", "y"].into_iter().enumerate() {
            if (!grouped || index == group) && self.draw.chance(60) {
                let flow = self.flow(var);
                self.line(format!("        {flow}"));
            }
        }
        if self.role != Role::Shot && group == 0 && self.draw.chance(30) {
            let guard = if self.draw.chance(30) { format!(" when {}", self.guard(1)) } else { String::new() };
            let updates = if self.draw.chance(30) { format!(" {{ {} }}", self.update()) } else { String::new() };
            self.line(format!("        follow links{guard}{updates}"));
        }
        if self.draw.chance(15) {
            let update = self.update();
            self.line(format!("        {update}"));
        }
        for _ in 0..1 + self.draw.pick(3) {
            let edge = self.edge();
            self.line(format!("        {edge}"));
        }
        self.in_mode = false;
        self.line("    }");
    }

    fn edge(&mut self) -> String {
        if self.has_bricks && self.draw.chance(30) {
            let what =
                self.draw.one(&["destroy e", "destroy e", "n := min(n + 1, 1); destroy e", "y' := -y'; destroy e"]);
            if self.draw.chance(35) {
                let probe = self.probe_of("brick");
                let button = if self.role == Role::Hero && self.has_button { "pressed(go) and " } else { "" };
                return format!("when {button}{probe} as e {{ {what} }}");
            }
            let (own, side) = (if self.draw.chance(50) { "" } else { self.role.tag() }, self.side());
            let own = if own.is_empty() { String::new() } else { format!("{own}, ") };
            return format!("when touching({own}brick{side}) as e {{ {what} }}");
        }
        if self.draw.chance(6) {
            let (other, what) =
                (self.other(), self.draw.one(&["destroy e", "n := 1; destroy e", "x := e.x", "y := e.y"]));
            let what = if other == "brick" { "n := 1; destroy e" } else { what };
            return format!("when touching({other}) as e {{ {what} }}");
        }
        if self.draw.chance(5) {
            let (probe, what) =
                (self.probe(), self.draw.one(&["destroy e", "n := 1", "x := e.x", "t := none; y := e.y"]));
            let what = if probe.ends_with("brick)") { "destroy e" } else { what };
            return format!("when {probe} as e {{ {what} }}");
        }
        if self.draw.chance(5) {
            return format!("when lost(t) -> {} {{ n := 0 }}", self.mode());
        }
        if self.draw.chance(12) {
            return self.asking_edge();
        }
        if self.has_signals && self.draw.chance(25) {
            return self.receiving_edge();
        }
        let guard = self.guard(2);
        let target = if self.draw.chance(65) { format!(" -> {}", self.mode()) } else { String::new() };
        let mut updates = Vec::new();
        for _ in 0..if target.is_empty() { 1 + self.draw.pick(2) } else { self.draw.pick(3) } {
            let update = self.update();
            let place = |u: &str| u.split(' ').next().map(str::to_string);
            if updates.iter().all(|u: &String| place(u) != place(&update)) {
                updates.push(update);
            }
        }
        let updates = if updates.is_empty() { String::new() } else { format!(" {{ {} }}", updates.join("; ")) };
        format!("when {guard}{target}{updates}")
    }

    /// An edge that a signal decides.
    fn receiving_edge(&mut self) -> String {
        let signal = self.draw.one(&[
            "received(tick)",
            "received(ping)",
            "not received(ping)",
            "ping.count > 1",
            "received(push)",
            "received(tick) and received(ping)",
        ]);
        let target = if self.draw.chance(40) { format!(" -> {}", self.mode()) } else { String::new() };
        let update = match self.draw.pick(5) {
            0 => "n := clamp(ping.count, 0, 1)".to_string(),
            1 => "x := x + push.way".into(),
            2 => "y := y - push.way / 2".into(),
            3 => self.send(),
            _ => self.update(),
        };
        format!("when {signal}{target} {{ {update} }}")
    }

    fn send(&mut self) -> String {
        let to = match self.draw.pick(4) {
            0 if self.has_foe => "t",
            1 => "self",
            2 if self.has_foe => "all Foe",
            3 if self.has_shot => "all Shot",
            _ => "all Hero",
        };
        let signal = match self.draw.pick(5) {
            0 => "tick".to_string(),
            1 => "ping(1)".into(),
            2 => "ping(n + 1)".into(),
            3 => format!("push({})", self.length()),
            _ => "push(x / 3)".into(),
        };
        format!("send {to}.{signal}")
    }

    pub(super) fn update(&mut self) -> String {
        if self.has_signals && self.draw.chance(25) {
            return self.send();
        }
        if self.lucky[self.role as usize] && self.draw.chance(25) {
            return self.draw.one(&["n := min(r, 1)", "x := l * r", "f := r == 2", "n := max(r - 1, 0)"]).into();
        }
        match self.draw.pick(14) {
            0 => "n := min(n + 1, 1)".into(),
            1 => format!("x := {}", self.length()),
            2 => format!("y := {}", self.length()),
            3 => format!("y' := {}", self.speed()),
            4 => format!("x' := {}", self.speed()),
            5 => "f := not f".into(),
            6 => "n := if(n > 0, 0, 1)".into(),
            7 if self.has_shot && (self.role != Role::Shot || self.draw.chance(40)) => {
                let given = match self.draw.pick(5) {
                    0 => String::new(),
                    1 => self.draw.one(&["(s = -s)", "(s = s + s)", "(x = x + l, s = l / 0.25s)"]).into(),
                    2 => format!("(x = x + l, s = {})", self.speed()),
                    3 => format!("(y = {}, n = 1)", self.length()),
                    _ => format!("(x' = {}, s = s, f = f)", self.speed()),
                };
                format!("spawn Shot{given}")
            }
            8 if self.role != Role::Hero || self.draw.chance(20) => "destroy self".into(),
            9 => "destroy t".into(),
            10 => "t := none".into(),
            11 => format!("x := x + {}", self.length()),
            12 => "y := y + l".into(),
            13 => "x' := -x'".into(),
            _ => "n := 0".into(),
        }
    }

    fn guard(&mut self, depth: usize) -> String {
        if depth > 0 && self.draw.chance(30) {
            let (a, b) = (self.guard(depth - 1), self.guard(depth - 1));
            return match self.draw.pick(3) {
                0 => format!("{a} and {b}"),
                1 => format!("({a} or {b})"),
                _ => format!("not ({a}) and {b}"),
            };
        }
        let played = self.role == Role::Hero;
        if self.lucky[self.role as usize] && self.draw.chance(25) {
            return self.draw.one(&["r == 2", "r > n", "r < 2", "r != 1"]).into();
        }
        match self.draw.pick(20) {
            18 | 19 => self.probe(),
            0 if played && self.has_button => "pressed(go)".into(),
            1 if played && self.has_button => "held(go)".into(),
            2 if played && self.has_button => "released(go)".into(),
            0..=2 if played => self.draw.one(&["h > 0", "h < 0", "h == 0"]).into(),
            3 => format!("x >= {}", self.length()),
            4 => format!("x < {}", self.length()),
            5 => format!("y {} {}", self.draw.one(&[">", "<=", "=="]), self.length()),
            6 | 7 => format!("touching({})", self.other()),
            8 | 9 => format!("touching({}, {})", self.other(), self.draw.one(&["below", "right", "left", "above"])),
            10 => format!("n {} 1", self.draw.one(&["==", ">=", "<"])),
            11 => "f".into(),
            12 => self.draw.one(&["x' > 0", "y' < 0", "y' <= 0", "x' == 0"]).into(),
            13 if self.has_foe => format!("t is Foe and t.x {} x", self.draw.one(&["<", ">", "=="])),
            14 if self.has_foe => format!("t in {}", self.mode_of(Role::Foe)),
            15 if self.modes[self.role as usize].len() > 1 && self.in_mode => {
                let other = self.modes[self.role as usize][1 - self.group].clone();
                let mode = other[self.draw.pick(other.len())].clone();
                // Only the second group waits for the first one.
                let word = if self.group == 1 { self.draw.one(&["in", "entering", "exiting"]) } else { "in" };
                if word == "in" { format!("in {mode}") } else { format!("{word}({mode})") }
            }
            16 if self.has_foe => "t is none".into(),
            _ if self.in_mode => {
                let time = self.time();
                format!("timer {} {time}", self.draw.one(&[">=", ">", "<"]))
            }
            _ => "x > y".into(),
        }
    }

    /// Whether a place is taken.
    fn probe(&mut self) -> String {
        let other = self.other();
        self.probe_of(other)
    }

    fn probe_of(&mut self, other: &str) -> String {
        let offset = |g: &mut Self| match g.draw.pick(8) {
            1 => "l".into(),
            2 => "-l".into(),
            3 => "n * l".into(),
            4 => "if(f, l, -l)".into(),
            5 if g.role == Role::Hero && g.has_axis => "h * l".into(),
            6 => "x - 24".into(),
            7 => "0".into(),
            _ => g.length(),
        };
        let (x, y) = (offset(self), offset(self));
        let mine = if self.draw.chance(10) { "coin" } else { self.role.tag() };
        format!("touching({mine} at ({x}, {y}), {other})")
    }

    fn world(&mut self) {
        self.line("world W {");
        let step = self.step;
        self.line(format!("    step {}/{}", step.0, step.1));
        self.collides();
        self.line("    tiles t 16 x 16 {");
        self.line("        '.': empty");
        self.line("        '#': wall");
        self.line("        'c': cloud");
        self.line("        'o': coin");
        if self.has_bricks {
            let second = self.draw.one(&["coin, brick", "brick", "wall, brick"]);
            self.line("        'b': wall, brick breakable");
            let steps = 1 + self.draw.pick(5);
            self.line(format!("        'r': {second} breakable restore after {steps}frames"));
        }
        if self.has_slopes {
            let (tag, breaks) = (self.draw.one(&["wall", "cloud", "wall, coin", "coin"]), self.has_bricks);
            self.line("        '/': wall slope (0, 0)-(16, 16)");
            self.line("        'd': wall slope (0, 16)-(16, 0)");
            self.line("        'h': wall slope (0, 0)-(16, 8)");
            self.line("        'H': wall slope (0, 8)-(16, 16)");
            let end = self.draw.one(&["0", "2.5", "12", "16"]);
            self.line(format!("        's': {tag} slope (0, 12)-(16, {end})"));
            self.line(if breaks { "        'B': brick slope (0, 0)-(16, 16) breakable" } else { "        'B': empty" });
        }
        let tile_foe = self.has_foe && self.draw.chance(25);
        self.lucky[Role::Foe as usize] = self.has_foe && !tile_foe && self.draw.chance(25);
        if tile_foe {
            self.line("        'F': spawn Foe");
        }
        self.line("    }");
        let has_link = self.draw.chance(25);
        self.line("    space main {");
        let map = self.draw.chance(70).then(|| self.map(tile_foe));
        let wraps = [self.draw.chance(22), self.draw.chance(12)];
        for _ in 0..self.draw.pick(3) {
            let (tag, at) = (self.draw.one(&["wall", "coin", "cloud", "wall"]), (self.length(), self.length()));
            let size = self.draw.one(&["16, 16", "48, 8", "8, 24", "64, 16", "4, 4"]);
            self.line(format!("        rect {tag} ({}, {}, {size})", at.0, at.1));
        }
        if wraps != [false; 2] {
            self.wrap(wraps, map);
        } else if self.draw.chance(30) {
            let bounds = self.draw.one(&["0, 0, 48, 32", "-16, -8, 64, 64", "8, 8, 32, 32", "0, 0, 40, 100"]);
            self.line(format!("        bounds rect({bounds})"));
        }
        let (x, y) = (self.length(), self.length());
        let foe = self.has_foe && !self.draw.chance(20);
        let refs = if foe && self.draw.chance(70) { " { t = foe }" } else { "" };
        self.line(format!("        place hero: Hero at ({x}, {y}){refs}"));
        if foe {
            let (x, y) = (self.length(), self.length());
            let refs = if self.draw.chance(30) { " { n = 1 }" } else { "" };
            self.line(format!("        place foe: Foe at ({x}, {y}){refs}"));
        }
        let shot = self.has_shot && self.draw.chance(30);
        if shot {
            let (x, y) = (self.length(), self.length());
            self.line(format!("        place shot: Shot at ({x}, {y})"));
        }
        if has_link {
            let (from, to) = (self.draw.one(&["16, 0, 16, 16", "0, 0, 48, 48", "32, 0, 8, 64"]), self.length());
            let when = if self.draw.chance(40) { " when hero.n > 0" } else { "" };
            self.line(format!("        link rect({from}) -> cellar at rect({to}, 8, 16, 16){when}"));
        }
        self.line("    }");
        if has_link {
            self.line("    space cellar {");
            if self.draw.chance(50) {
                self.map(false);
            }
            if self.draw.chance(50) {
                self.line("        link rect(8, 8, 32, 16) -> main at rect(16, 16, 16, 16)");
            }
            self.line("    }");
        }
        if self.has_foe && tile_foe && self.draw.chance(50) {
            self.line("    limit Foe 20");
        }
        if self.has_shot {
            let limit = 1 + self.draw.pick(2) + usize::from(shot);
            self.line(format!("    limit Shot {limit}"));
        }
        self.line("    player 1: hero");
        for goal in 0..4 {
            let predicate = self.predicate(foe, has_link);
            self.line(format!("    goal g{goal}: {predicate}"));
        }
        if self.draw.chance(25) {
            let predicate = self.predicate(foe, has_link);
            self.line(format!("    never n0: {predicate}"));
        }
        self.line("}");
    }

    fn collides(&mut self) {
        let responses =
            ["block", "sense", "block, keep velocity", "block from above", "block, carry", "block, bounce 1"];
        let mut lines = vec![("body", "wall", 85), ("body", "coin", 60), ("body", "cloud", 40)];
        if self.has_bricks {
            lines.push(("body", "brick", 50));
        }
        if self.has_foe {
            lines.extend([("body", "foe", 75), ("foe", "wall", 60), ("foe", "coin", 20)]);
        }
        if self.has_shot {
            lines.extend([("shot", "wall", 60), ("body", "shot", 40)]);
        }
        if self.has_foe && self.has_shot {
            lines.push(("foe", "shot", 50));
        }
        for (left, right, percent) in lines {
            if self.draw.chance(percent) {
                let first = match right {
                    "coin" => 1,
                    "cloud" => 3,
                    _ => 0,
                };
                let response = if self.draw.chance(60) { responses[first] } else { responses[self.draw.pick(6)] };
                let (left, right) = if self.draw.chance(12) { (right, left) } else { (left, right) };
                self.line(format!("    collide {left} with {right}: {response}"));
            }
        }
    }

    /// A space that wraps; its bounds are as long as its map, if it has one.
    fn wrap(&mut self, wraps: [bool; 2], map: Option<(usize, usize)>) {
        let size = map.map(|(columns, rows)| (16 * columns, 16 * rows));
        match size {
            Some(_) if self.draw.chance(60) => {}
            Some((width, height)) => self.line(format!("        bounds rect(0, 0, {width}, {height})")),
            None => {
                let bounds = self.draw.one(&["0, 0, 64, 64", "-16, -8, 80, 64", "8, 8, 48.5, 60", "0, 0, 100, 52"]);
                self.line(format!("        bounds rect({bounds})"));
            }
        }
        for (way, _) in ["horizontal", "vertical"].iter().zip(wraps).filter(|(_, wraps)| *wraps) {
            self.line(format!("        wrap {way}"));
        }
    }

    fn map(&mut self, tile_foe: bool) -> (usize, usize) {
        self.has_map = true;
        let (columns, rows) = (3 + self.draw.pick(4), 2 + self.draw.pick(3));
        self.line("        map t \"");
        for row in 0..rows {
            let mut text = String::from("            ");
            for _ in 0..columns {
                let tile = match self.draw.pick(16) {
                    1 | 2 => '#',
                    3 => 'c',
                    4 => 'o',
                    5 if tile_foe => 'F',
                    10 | 11 if self.has_bricks => 'b',
                    12 if self.has_bricks => 'r',
                    10..=15 if self.has_slopes && row + 2 >= rows => {
                        ['/', 'd', 'h', 'H', 's', 'B', '#', '.'][self.draw.pick(8)]
                    }
                    6..=9 if row + 1 == rows => '#',
                    _ => '.',
                };
                text.push(tile);
            }
            self.line(text);
        }
        self.line("        \"");
        (columns, rows)
    }

    /// The goals and nevers of the world.
    fn predicate(&mut self, has_foe: bool, has_cellar: bool) -> String {
        let who = if has_foe && self.draw.chance(30) { "foe" } else { "hero" };
        let role = if who == "foe" { Role::Foe } else { Role::Hero };
        if self.draw.chance(20) {
            let (a, b) =
                (self.question(who, role, has_foe, has_cellar), self.question("hero", Role::Hero, has_foe, has_cellar));
            return format!("{a} {} {b}", self.draw.one(&["and", "or"]));
        }
        self.question(who, role, has_foe, has_cellar)
    }

    fn question(&mut self, who: &str, role: Role, has_foe: bool, has_cellar: bool) -> String {
        let mut out = String::new();
        if self.has_bricks && self.draw.chance(25) {
            let (tag, sign) = (self.draw.one(&["brick", "wall"]), self.draw.one(&["<", "<=", "==", ">", "!="]));
            // A map without bricks has no such tag.
            return match self.has_map {
                true => format!("count({tag}) {sign} {}", self.draw.pick(6)),
                false => format!("{who}.x < {}", self.length()),
            };
        }
        let _ = match self.draw.pick(16) {
            0..=3 => {
                let modes: Vec<String> =
                    self.modes[role as usize].iter().flat_map(|g| &g[g.len().min(2) - 1..]).cloned().collect();
                write!(out, "{who} in {}", modes[self.draw.pick(modes.len())])
            }
            4 => write!(out, "{who}.x {} {}", self.draw.one(&[">=", "<"]), self.length()),
            5 => write!(out, "{who}.y > {}", self.length()),
            6 => write!(out, "{who}.y < {}", self.length()),
            7 => write!(out, "{who}.n == 1"),
            8 => {
                self.role = role;
                write!(out, "{who} touching {}", self.other())
            }
            9 => write!(out, "near({who}, ({}, {}), 8)", self.length(), self.length()),
            10 => write!(out, "{who}.x' {} 0", self.draw.one(&[">", "<", "=="])),
            11 if self.has_shot => write!(out, "any Shot"),
            12 if self.has_shot => {
                let mode = self.mode_of(Role::Shot);
                match self.draw.pick(4) {
                    0 => write!(out, "all Shot in {mode}"),
                    1 => write!(out, "count(Shot) >= {}", 1 + self.draw.pick(2)),
                    2 => write!(out, "count(Shot in {mode}) == 1"),
                    _ => write!(out, "any Shot in {mode}"),
                }
            }
            13 if has_foe => write!(out, "near(hero, foe, 12)"),
            14 if has_cellar => write!(out, "inside({who}, cellar)"),
            _ => write!(out, "{who}.x == {}", self.length()),
        };
        out
    }
}

/// A number as it is written.
fn number(value: f64) -> String {
    let text = format!("{value}");
    if text.contains('e') { "0".into() } else { text }
}
