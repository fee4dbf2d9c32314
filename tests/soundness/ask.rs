//! Guards of random worlds that ask the instances of an entity, or for distances.

use super::generate::Generator;

impl Generator<'_> {
    /// Every fourth guard of an edge asks all instances of an entity instead, so that all other choices are the same as
    /// without. With the entity of the instance that the guard names `seen`, if it does.
    pub fn maybe_asked(&mut self, guard: String) -> (String, Option<Option<usize>>) {
        self.edges += 1;
        if !self.edges.is_multiple_of(4) {
            return (guard, None);
        }
        // What has been drawn so far varies it.
        let turn = self.edges / 4 + 5 * self.asked + 3 * self.nameable + self.counts + 7 * self.me;
        let of = turn / 3 % self.plans.len();
        let (name, tag) = (self.plans[of].name.clone(), self.plans[of].tag);
        let op = [">=", "<", "==", "!=", "<=", ">"][turn / 2 % 6];
        let (few, radius) = (turn / 5 % 3, ["24", "60", "size", "(2 * size)", "400"][turn / 7 % 5]);
        let modes: Vec<String> = self.plans[of].modes.iter().flatten().cloned().collect();
        let mode = (!modes.is_empty()).then(|| modes[turn % modes.len()].clone());
        let within = mode.as_ref().map_or(String::new(), |mode| format!(" in {mode}"));
        let (there, here) = (self.axes.read(&format!("any {name}."), "x"), self.axes.read("", "x"));
        let lower = name.to_lowercase();
        let point = self.axes.point(48.0, 32.0);
        let asked = match turn % 16 {
            _ if turn.is_multiple_of(3) && self.arena.has_bricks && self.arena.is_mapped() => {
                format!("count(brick) {op} {}", turn / 3 % 6)
            }
            0 => format!("count({name}) {op} {few}"),
            1 => format!("count({name}{within}) {op} {few}"),
            2 => format!("{there} {op} {here}"),
            3 => format!("all {name}.count {op} {few}"),
            4 => format!("nearest {name} as seen"),
            5 => format!("nearest {name} within {radius} as seen"),
            6 => format!("nearest {name}{within} within {radius} as seen and seen.count < 3"),
            7 => format!("any {name} touching {tag} or all {name} touching wall"),
            8 => format!("distance({point}) {op} {radius} / 2"),
            9 => format!("near(any {name}, self, {radius})"),
            10 => format!("foe_{lower} is {name} and distance(foe_{lower}) {op} {radius}"),
            11 => format!("not nearest {name}{within} within {radius}"),
            12 => format!("any {name}.flag and not all {name}.colour == red"),
            13 => format!("near(self, {point}, {radius}) or near(foe_{lower}, self, {radius})"),
            14 => format!("any {name}{within}"),
            _ if within.is_empty() => format!("all {name}.flag and count < 3"),
            _ => format!("all {name}{within} and count < 3"),
        };
        let named = asked.contains(" as seen").then_some(Some(of));
        (asked, named)
    }
}
