//! Random tiny worlds with many instances that never move: lamps, which the others touch, switch, destroy and ask for.

use std::fmt::Write;

use crate::support::draw::Draw;
use hypedc::ir::{Program, WorldId};
use hypedc::sim::{Event, Input, PlayerInput, Run};
use rand::{Rng, RngExt};
use std::sync::Arc;

use super::generate;

/// What lamps do; some of it only while something touches them.
const EDGES: &[&str] = &[
    "when touching(lamp, body) -> lit",
    "when touching(lamp, body) -> dark",
    "when touching(body) as h { destroy self }",
    "when touching(lamp, body) as h { destroy h }",
    "when touching(lamp, body, above) { n := min(n + 1, 2) }",
    "when touching(lamp, body, left) or touching(lamp, body, right) -> lit { n := 1 }",
    "when touching(lamp, wall) -> lit",
    "when touching(lamp, lamp) { n := min(n + 1, 2) }",
    "when touching(lamp, lamp) as l { destroy l }",
    "when timer >= 0.5s -> dark",
    "when n > 0 and touching(lamp, body) { destroy self }",
    "when not touching(lamp, body) -> dark",
    "when touching(lamp, body) and timer >= 2frames -> dark",
    "when x >= 32 and n == 0 { n := 1 }",
    "when touching(lamp at (8, 0), body) -> lit",
    "when touching(lamp, brick) as b { destroy b }",
    "when touching(lamp, foe) -> lit",
    "when touching(lamp, foe) as f { destroy f }",
];

/// What the others do with lamps.
const ASKS: &[&str] = &[
    "when touching(lamp) as e { destroy e }",
    "when touching(lamp, above) { n := 1 }",
    "when touching(lamp) as e { x := e.x }",
    "when touching(body at (l, 0), lamp) { n := 1 }",
    "when touching(body at (l, 0), lamp) as e { destroy e }",
];

/// The text of a program.
pub fn program(choices: &[u16]) -> String {
    let text = generate::program(choices);
    let mut draw = Draw::new(choices);
    let kinematic = if draw.chance(40) { "kinematic " } else { "" };
    let shape = draw.one(&[
        "rect(0, 0, 8, 8)",
        "circle(4, 4, 5)",
        "rect(2, 0, 4, 12)",
        "rect(0, 0, 40, 4)",
        "rect(0, 0, 0, 4)",
    ]);
    let when = draw.one(&["", "", "", " when in dark", " when not in lit"]);
    let mut lamp =
        format!("entity Lamp {{\n    discrete n: int 0..2 = 0\n    {kinematic}collider lamp: {shape}{when}\n");
    if draw.chance(25) {
        lamp += &format!("    always {{\n        {}\n    }}\n", draw.one(&EDGES[2..4]));
    }
    for mode in ["dark", "lit"] {
        let flow = draw.one(&["", "", "", "x' = 0", "y'' = 0"]);
        let _ = writeln!(lamp, "    mode {mode} {{\n        {flow}");
        for _ in 0..draw.pick(4) {
            let edge = if draw.chance(60) { EDGES[draw.pick(6)] } else { draw.one(EDGES) };
            if (!edge.contains("brick") || text.contains("breakable"))
                && (!edge.contains("foe") || text.contains("Foe"))
            {
                let _ = writeln!(lamp, "        {edge}");
            }
        }
        lamp += "    }\n";
    }
    lamp += "}\n";
    let mut rules = String::new();
    let pushes = ["sense", "sense", "block", "block, carry", "block from above", "block from above, carry"];
    let of = if kinematic.is_empty() && draw.chance(80) { 2 } else { pushes.len() };
    let _ = writeln!(rules, "    collide body with lamp: {}", pushes[draw.pick(of)]);
    for (other, percent) in [("lamp", 40), ("wall", 40), ("brick", 30), ("foe", 40)] {
        if draw.chance(percent) && text.contains(other) {
            let _ = writeln!(rules, "    collide lamp with {other}: sense");
        }
    }
    let mut places = String::new();
    let apart = [12, 8, 16, 7, 40][draw.pick(5)];
    for i in 0..16 + draw.pick(20) {
        let (x, y) = (apart * (i % 6), apart * (i / 6));
        let _ = writeln!(places, "        place lamp{i}: Lamp at ({x}, {y})");
    }
    let ask = if draw.chance(60) { draw.one(ASKS) } else { "" };
    let text = text.replacen("    mode a0 {\n", &format!("    mode a0 {{\n        {ask}\n"), 1);
    let text = text.replacen("    tiles t 16", &format!("{rules}    tiles t 16"), 1);
    let text = text.replacen("    space main {\n", &format!("    space main {{\n{places}"), 1);
    let goals = [
        "lamps: count(Lamp in lit) >= 2",
        "gone: not any Lamp",
        "third: near(lamp3, (20, 8), 16)",
        "there: lamp5.x > 8",
    ];
    let goals: String = goals.iter().map(|goal| format!("    goal {goal}\n")).collect();
    lamp + &text.replacen("    player 1: hero\n", &format!("    player 1: hero\n{goals}"), 1)
}

/// What happened to instances that never move.
#[derive(Debug, Default)]
pub struct Tally {
    pub worlds: usize,
    pub instances: usize,
    pub edges: usize,
    pub contacts: usize,
    pub destroyed: usize,
}

impl Tally {
    /// Runs a world with random inputs.
    pub fn count(&mut self, program: &Arc<Program>, world: WorldId, steps: usize, rng: &mut impl Rng) {
        let still = program.still_slots(&program.worlds[world]);
        let instances = still.iter().filter(|is| **is).count();
        self.worlds += usize::from(instances > 0);
        self.instances += instances;
        let Ok(mut run) = Run::new(program, world) else { return };
        for _ in 0..steps {
            let keys = PlayerInput { buttons: rng.random_range(0..2), axes: [f64::from(rng.random_range(-1..=1)); 4] };
            let input = Input::of_players(vec![keys; run.world().players.len()]);
            let count = &mut |event| match event {
                Event::Edge(slot, _) if still[slot] => self.edges += 1,
                Event::Touched(slot, _) if still[slot] => self.contacts += 1,
                Event::Destroyed(slot) if still[slot] => self.destroyed += 1,
                _ => {}
            };
            if run.step_with_events(&input, count).is_err() {
                return;
            }
        }
    }
}
