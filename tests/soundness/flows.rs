//! The flows and envelopes of random worlds.

use super::generate::{Dim, Generator};

impl Generator<'_> {
    /// The flow or envelope of a variable.
    pub fn flow(&mut self, variable: &str) -> String {
        let played = self.plan().is_played;
        if self.draw.chance(60) || !self.palette.nodes && self.draw.chance(50) {
            // As in games.
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

    pub fn vector(&mut self) -> String {
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
}
