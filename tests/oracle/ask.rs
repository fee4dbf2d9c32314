//! Edges of random tiny worlds that ask the instances of an entity, or for distances.

use super::generate::{Generator, Role};

impl Generator<'_> {
    /// An edge that a question to the instances of an entity decides.
    pub fn asking_edge(&mut self) -> String {
        let of = match self.draw.pick(4) {
            0 | 1 if self.has_foe => Role::Foe,
            2 if self.has_shot => Role::Shot,
            _ => Role::Hero,
        };
        let name = of.name();
        let (mode, op) = (self.mode_of(of), self.draw.one(&["<", ">=", "=="]));
        let (length, few) = (self.length(), self.draw.pick(3));
        if self.draw.chance(35) {
            let within = match self.draw.pick(4) {
                0 => format!(" in {mode}"),
                1 => format!(" within {}", length.replace('-', "")),
                2 => " within (l + n * l)".into(),
                _ => String::new(),
            };
            let what = match self.draw.pick(6) {
                0 => "destroy e".to_string(),
                1 => "x := e.x".into(),
                2 if of == Role::Foe && self.has_foe => "t := e".into(),
                3 if self.has_signals => "send e.ping(1)".into(),
                4 => "n := min(e.n, 1); y := e.y".into(),
                _ => "y := y + e.x / 2".into(),
            };
            let more = if self.draw.chance(30) { format!(" and e.x {op} x") } else { String::new() };
            return format!("when nearest {name}{within} as e{more} {{ {what} }}");
        }
        let guard = match self.draw.pick(13) {
            _ if self.has_bricks && self.has_map && self.draw.chance(20) => format!("count(brick) {op} {}", few + 1),
            0 => format!("count({name}) {op} {few}"),
            1 => format!("count({name} in {mode}) {op} {few}"),
            2 => format!("any {name}.x {op} {length}"),
            3 => format!("all {name}.n {op} n"),
            4 => format!("any {name} in {mode}"),
            5 => format!("all {name} touching wall"),
            6 => format!("near(any {name}, self, {length})"),
            7 => format!("distance(({length}, 8)) {op} {length}"),
            8 => "t is none or distance(t) < l".to_string(),
            9 => format!("near(self, ({length}, 0), 20) and not any {name}.f"),
            10 => format!("near(t, self, {length})"),
            11 => format!("not nearest {name} in {mode} within {}", length.replace('-', "")),
            _ => format!("0 <= any {name}.x - x < {length}"),
        };
        let target = if self.draw.chance(50) { format!(" -> {}", self.mode()) } else { String::new() };
        let update = self.update();
        format!("when {guard}{target} {{ {update} }}")
    }
}
