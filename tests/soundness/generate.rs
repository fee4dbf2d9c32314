//! Random small worlds in which much happens, with every construct of the grammar. What an entity's text uses of a fixed
//! vocabulary is declared, so that programs are short.

use super::arena::Arena;
use super::frame::{Axes, Frame};
use super::situations::Situation;
use crate::support::draw::Draw;

/// The dimension of an expression.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Dim {
    Length,
    Speed,
    Force,
    Time,
    Pure,
}

impl Dim {
    /// The parameter of this dimension that every entity has.
    pub fn param(self) -> &'static str {
        match self {
            Dim::Length => "size",
            Dim::Speed => "speed",
            Dim::Force => "force",
            Dim::Time => "delay",
            Dim::Pure => "n",
        }
    }
}

/// Properties of an entity that are drawn before any text, as others refer to it.
#[derive(Debug, Clone, Default)]
pub struct Plan {
    pub name: String,
    pub tag: &'static str,
    /// The paths of the modes of each group, outer modes first.
    pub modes: Vec<Vec<String>>,
    /// The group without a name, of several.
    pub nameless: Option<usize>,
    pub is_kinematic: bool,
    pub is_played: bool,
    /// Whether anything spawns it.
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
    /// The current entity.
    pub me: usize,
    /// The current group, and the path of the current mode.
    pub group: Option<usize>,
    pub mode: String,
    /// What the current expression can read: inputs, contacts, others.
    pub may: May,
    pub depth: usize,
    /// Number of guards and predicates that could have a name so far.
    pub nameable: usize,
    /// Number of contact queries so far, some of which become probes.
    pub asked: usize,
    /// Number of counts that could be drawn instead.
    pub counts: usize,
    /// Number of edges that could ask all instances of an entity.
    pub edges: usize,
}

/// What a program may use: each world does without most of it, so that what it does use shows, and much can be proven
/// of it (Groce, Zhang, Eide, Chen, Regehr, *Swarm testing*, ISSTA 2012).
#[derive(Clone, Copy)]
pub struct Palette {
    /// Tiny, huge and slightly changed numbers.
    pub extremes: bool,
    /// Expressions of several parts.
    pub nodes: bool,
    /// References, and values of others.
    pub others: bool,
    /// Envelopes.
    pub envelopes: bool,
    /// Updates of positions.
    pub jumps: bool,
    /// Updates of velocities and accelerations.
    pub kicks: bool,
    /// Variables other than the position.
    pub charges: bool,
    /// Spawning.
    pub spawns: bool,
    /// Signals.
    pub signals: bool,
    /// Destroying.
    pub ends: bool,
    pub clamps: bool,
    /// Colliders that appear, disappear or change.
    pub shapes: bool,
    /// Guards that read positions and velocities.
    pub senses: bool,
    /// Accelerations.
    pub forces: bool,
    /// Inputs in values and guards.
    pub inputs: bool,
    /// Contacts in guards.
    pub contacts: bool,
    /// Steps longer than the distance between walls, through all of them and back.
    pub dashes: bool,
    /// Walls that almost touch, and gaps that almost fit.
    pub seams: bool,
    /// Colliders of several sizes, one in each mode.
    pub sizes: bool,
    /// A player that falls and jumps in several rooms.
    pub travels: bool,
    /// A player in a room with few other instances, distinguished by place.
    pub walks: bool,
    /// Few entities with few modes: such worlds are analysed quickly.
    pub is_small: bool,
}

impl Palette {
    fn draw(draw: &mut Draw<'_>) -> Self {
        let mut on = |percent: usize| draw.chance(percent);
        // A player in a level, or anything.
        let walks = on(30);
        let travels = on(20);
        let mut palette = Palette {
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
            dashes: on(15),
            seams: on(20),
            sizes: on(15),
            signals: on(20),
            travels,
            walks,
            is_small: walks || on(55),
        };
        if walks || travels {
            palette.inputs = true;
            palette.extremes = false;
        }
        palette
    }
}

/// What an expression can read.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum May {
    /// Anything.
    All,
    /// No inputs and no contacts: for colliders.
    Own,
    /// Its own variables, parameters and modes: for invariants.
    State,
    /// Variables and parameters: for clamps.
    Values,
    /// Parameters: for initial choices.
    Params,
}

pub const NAMES: [(&str, &str); 3] = [("A", "a"), ("B", "b"), ("C", "c")];

/// Velocities of many walls per step.
pub const DASHES: &[&str] = &["60000", "-60000", "4800", "-4800", "30000", "-12000"];

/// The text of a program.
pub fn program(choices: &[u16], frame: Frame) -> String {
    let mut draw = Draw::new(choices);
    let situation = Situation::draw(&mut draw);
    let palette = Palette::draw(&mut draw);
    let palette = situation.map_or(palette, |s| s.palette(palette));
    let arena = Arena::draw(&mut draw, palette);
    let axes = Axes::new(frame, arena.width(), arena.tile);
    let count = if palette.is_small { [1, 1, 2, 1][draw.pick(4)] } else { [1, 2, 1, 2, 3][draw.pick(5)] };
    let mut plans: Vec<Plan> = (0..count).map(|index| plan(&mut draw, index, palette.is_small)).collect();
    plans[0].is_played = draw.chance(75) && palette.inputs || palette.walks || palette.travels;
    if let Some(situation) = situation {
        plans = situation.plans(&mut draw);
    }
    let count = plans.len();
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
        nameable: 0,
        asked: 0,
        counts: 0,
        edges: 0,
    };
    let world = match situation {
        Some(situation) => g.stage(situation),
        None => g.world(frame),
    };
    let mut entities = Vec::new();
    for index in 0..count {
        g.me = index;
        entities.push(match situation {
            Some(situation) => g.actor(situation),
            None => g.entity(),
        });
    }
    let limits = g.limits();
    g.assembled(&entities, &world.replace("LIMITS\n", &limits))
}

fn plan(draw: &mut Draw<'_>, index: usize, is_small: bool) -> Plan {
    let (name, tag) = NAMES[index];
    let groups = if is_small { [1, 0, 1, 1][draw.pick(4)] } else { [1, 1, 1, 0, 2, 1, 0, 1, 3][draw.pick(9)] };
    let mut modes = Vec::new();
    let nameless = (groups > 1 && draw.chance(30)).then(|| draw.pick(groups));
    for group in 0..groups {
        let count = if is_small { [2, 1, 2][draw.pick(3)] } else { [2, 1, 2, 3, 2][draw.pick(5)] };
        let is_named = groups > 1 && nameless != Some(group);
        let prefix = if is_named { format!("g{group}.") } else { String::new() };
        let mut paths = Vec::new();
        for mode in 0..count {
            let path = format!("{prefix}m{group}{mode}");
            paths.push(path.clone());
            if draw.chance(if is_small { 5 } else { 20 }) {
                let inner = 1 + draw.pick(2);
                paths.extend((0..inner).map(|i| format!("{path}.i{group}{mode}{i}")));
            }
        }
        modes.push(paths);
    }
    let is_kinematic = index > 0 && draw.chance(35);
    Plan { name: name.into(), tag, modes, nameless, is_kinematic, is_played: draw.chance(25), is_spawned: false }
}

impl Generator<'_> {
    pub fn line(&mut self, text: impl AsRef<str>) {
        self.out.push_str(text.as_ref());
        self.out.push('\n');
    }

    pub fn plan(&self) -> &Plan {
        &self.plans[self.me]
    }

    /// Names of others.
    pub fn any_plan(&mut self) -> usize {
        self.draw.pick(self.plans.len())
    }

    pub fn number(&mut self, dim: Dim) -> String {
        let rare = self.palette.extremes && self.draw.chance(15);
        let dashes = self.palette.dashes && self.draw.chance(30);
        let of: &[&str] = match (dim, rare) {
            (Dim::Length, false) if dashes => &["1000", "-1000", "200", "-200", "100.5"],
            (Dim::Speed, false) if dashes => DASHES,
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
        let members: [(&str, &str); 21] = [
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
            ("tick", "signal tick\n"),
            ("tally", "signal tally(points)\n"),
            ("kick", "signal kick(way: px/s)\n"),
            ("jump", "button jump, run\n"),
            ("horizontal", "axis horizontal, vertical\n"),
            ("roll", "chance roll: 1..3\n"),
        ];
        for (plan, body) in self.plans.iter().zip(entities) {
            out.push_str(&format!("entity {} {{\n", plan.name));
            // What things look like changes nothing.
            out.push_str("look #e43\n");
            for (word, member) in members {
                // Parameters that others read, or that a spawn or a place sets.
                let also = !matches!(word, "jump" | "horizontal" | "roll") && uses(&all, word);
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
