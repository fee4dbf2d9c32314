//! Actions of edges, entries and links in random worlds: updates, spawns, destroys.

use super::generate::{Dim, Generator, NAMES};

impl Generator<'_> {
    /// Updates of different places; `named` is the instance that the guard names, with its entity if it is known.
    pub fn updates(&mut self, named: Option<Option<usize>>, most: usize) -> String {
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

    /// An update, and its place.
    fn update(&mut self, named: Option<Option<usize>>) -> (String, String) {
        if self.palette.signals && self.draw.chance(30) {
            let update = if self.draw.chance(25) { self.received_value() } else { self.send(named) };
            return update;
        }
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
        // A named instance is worth using.
        if named.is_some() && self.draw.chance(30) {
            place = self.draw.one(&["friend", "destroy"]);
        }
        let set = |g: &Self, value: String| format!("{place} := {}", g.axes.write(place, &value));
        let update = match place {
            "count" => {
                let value = self.draw.one(&["min(count + 1, 3)", "max(count - 1, 0)", "0", "3 - count", "count + 1"]);
                match self.draw.pick(4) {
                    0 => "count += 1".to_string(),
                    1 => format!("count -= {}", self.draw.one(&["1", "2", "-1"])),
                    _ => format!("count := {}", self.maybe_drawn(value)),
                }
            }
            "x'" | "y'" | "q'" => {
                let value = match self.draw.chance(25) {
                    true => format!("-0.8 * {}", self.axes.read("", place)),
                    false => self.value(Dim::Speed),
                };
                set(self, value)
            }
            "q" if self.draw.chance(30) => format!("q += {}", self.number(Dim::Length)),
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
            "heat" if p.extremes && self.draw.chance(40) => "heat := (heat + 1) * 1000000000 * 1000000000".into(),
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

    /// An update by what came with a signal, and its place.
    fn received_value(&mut self) -> (String, String) {
        let flipped = |g: &Self, place: &str, value: &str| format!("{place} := {}", g.axes.write(place, value));
        match self.draw.pick(3) {
            0 => ("count".into(), "count := clamp(count + tally.points, 0, 3)".into()),
            1 => ("x'".into(), flipped(self, "x'", "kick.way")),
            _ => ("y'".into(), flipped(self, "y'", "kick.way + speed")),
        }
    }

    /// A signal to one or all; several in one list are all sent.
    fn send(&mut self, named: Option<Option<usize>>) -> (String, String) {
        let of = self.any_plan();
        let to = match (named, self.draw.pick(4)) {
            (Some(Some(_)), 0) => "seen".into(),
            (_, 1) => "self".into(),
            (_, 2) if self.palette.others => format!("foe_{}", NAMES[of].1),
            _ => format!("all {}", self.plans[of].name),
        };
        let signal = match self.draw.pick(4) {
            0 => "tick".into(),
            1 => format!("tally({})", self.draw.one(&["1", "count", "2", "-1", "count + tally.points"])),
            2 => format!("kick({})", self.number(Dim::Speed)),
            _ => format!("kick({})", self.value(Dim::Speed)),
        };
        let send = format!("send {to}.{signal}");
        (send.clone(), send)
    }

    pub fn spawn(&mut self) -> String {
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
            // In a cycle, from one to the next.
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
}
