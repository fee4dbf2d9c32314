//! The worlds of random programs: rooms of a few tiles with everything close together, instances, goals.

use super::frame::{Frame, number};
use super::generate::{Dim, Generator, Palette};
use crate::support::draw::Draw;

/// Properties of a world that are drawn before its text.
pub struct Arena {
    /// The side of a tile, px.
    pub tile: f64,
    columns: usize,
    rows: usize,
    /// Whether there is a second room.
    pub links: bool,
    /// Whether there is a third room.
    has_attic: bool,
    main: Kind,
    second: Kind,
    /// Thickness of the walls of a chamber, px.
    thickness: f64,
    /// Whether the instance of a tile has a name.
    has_boss: bool,
    /// Whether it has tiles that can be broken.
    pub has_bricks: bool,
    /// Whether it has slopes.
    has_slopes: bool,
    /// The instances that are placed, each with the number of its entity.
    pub places: Vec<usize>,
    /// Position of the last one.
    pub last: (f64, f64),
    /// The size of the player's body, px.
    pub body: [f64; 2],
    /// How its instances are placed: the text after them.
    pub settings: &'static str,
    /// The rows of the map of the room that is written, the highest first.
    map: Vec<String>,
}

/// The contents of a room.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Kind {
    Map,
    OpenMap,
    Rects,
    Floor,
    Nothing,
    File,
    /// Four walls, closed.
    Chamber,
}

impl Arena {
    pub fn draw(draw: &mut Draw<'_>, palette: Palette) -> Self {
        use Kind::{Chamber, File, Floor, Map, Nothing, OpenMap, Rects};
        let links = draw.chance(if palette.travels { 90 } else { 20 });
        let mut main = [Map, Map, Rects, OpenMap, Rects, Floor, Nothing, Map, Chamber][draw.pick(9)];
        if palette.walks && draw.chance(60) {
            // Few edges meet here, so there are few places to distinguish.
            main = [Chamber, Floor, Rects][draw.pick(3)];
        }
        if palette.dashes && draw.chance(50) {
            main = Chamber;
        }
        Arena {
            tile: [16.0, 8.0, 32.0][draw.pick(3)],
            columns: 5 + draw.pick(5),
            rows: 4 + draw.pick(3),
            links,
            has_attic: links && draw.chance(if palette.travels { 50 } else { 10 }),
            main,
            second: [Nothing, Map, Rects, OpenMap, File, Floor, Chamber][draw.pick(7)],
            thickness: [8.0, 2.0, 16.0, 120.0][draw.pick(4)],
            has_boss: draw.chance(10),
            has_bricks: draw.chance(20),
            has_slopes: draw.chance(25),
            places: Vec::new(),
            last: (16.0, 16.0),
            body: [16.0; 2],
            settings: "",
            map: Vec::new(),
        }
    }

    /// Nothing of its own: other options define its contents.
    pub fn clear(&mut self, links: bool) {
        (self.main, self.has_boss, self.links, self.has_attic) = (Kind::Nothing, false, links, false);
        (self.has_bricks, self.has_slopes) = (false, false);
    }

    /// The width of its maps, px.
    pub fn width(&self) -> f64 {
        self.columns as f64 * self.tile
    }

    /// Whether the first room has a map of its own.
    pub fn is_mapped(&self) -> bool {
        matches!(self.main, Kind::Map | Kind::OpenMap)
    }

    fn height(&self) -> f64 {
        self.rows as f64 * self.tile
    }
}

pub const STEPS: [&str; 12] =
    ["1/60", "1/30", "1/10", "1/60", "1/240", "1/4", "20ms", "1/50", "1/8", "1/60", "1/60", "1/30"];
const RESPONSES: [&str; 13] = [
    "block",
    "sense",
    "block",
    "block, carry",
    "block, keep velocity",
    "block from above",
    "block from above, carry",
    "block, keep velocity, carry",
    "block",
    "block, bounce 1",
    "block, bounce 0.6",
    "block from above, bounce 1",
    "block, carry, bounce 0.3",
];

impl Generator<'_> {
    fn world_line(&mut self, text: impl AsRef<str>) {
        self.out.push_str(text.as_ref());
        self.out.push('\n');
    }

    /// A world with all its spaces and goals.
    pub fn world(&mut self, frame: Frame) -> String {
        self.out.clear();
        self.place_plans();
        self.world_line("world W {");
        let step = self.draw.one(&STEPS);
        self.world_line(format!("step {step}"));
        self.collide_lines();
        // Spawned entities are known once the entities are written.
        self.world_line("LIMITS");
        let tile = number(self.arena.tile);
        self.world_line(format!("tiles t {tile} x {tile} {{"));
        self.world_line("'.': empty\n'#': wall\n'-': cloud\n'~': \"thin ice\"\n'w': wall, \"thin ice\"");
        if self.arena.has_bricks {
            let (first, time) = (self.draw.one(&["wall, brick", "brick"]), self.draw.one(&["0.2s", "3frames", "0.5"]));
            self.world_line(format!("'b': {first} breakable"));
            self.world_line(format!("'r': wall, brick breakable restore after {time}"));
        }
        if self.arena.has_slopes {
            let (tag, end) =
                (self.draw.one(&["wall", "cloud", "wall, \"thin ice\""]), self.draw.one(&["0", "2.5", "8"]));
            let half = number(self.arena.tile / 2.0);
            self.world_line(format!(
                "'/': wall slope (0, 0)-({tile}, {tile})\n'd': wall slope (0, {tile})-({tile}, 0)"
            ));
            self.world_line(format!(
                "'h': wall slope (0, 0)-({tile}, {half})\n'H': {tag} slope (0, {half})-({tile}, {end})"
            ));
        }
        let settings = if self.draw.chance(40) { self.settings() } else { String::new() };
        self.world_line(format!("'a': spawn A{settings}"));
        self.arena.has_boss &= self.arena.is_mapped();
        if self.arena.has_boss {
            let settings = if self.draw.chance(40) { self.settings() } else { String::new() };
            self.world_line(format!("'s': spawn A as boss{settings}"));
        }
        self.world_line("}");
        self.space("main", self.arena.main, frame);
        if self.arena.links {
            self.space("cellar", self.arena.second, frame);
        }
        if self.arena.has_attic {
            self.space("attic", Kind::Rects, frame);
        }
        self.players();
        self.questions();
        self.world_line("}");
        std::mem::take(&mut self.out)
    }

    /// Limits of each entity that is spawned, and sometimes of another one.
    pub fn limits(&mut self) -> String {
        let mut out = String::new();
        for (index, plan) in self.plans.iter().enumerate() {
            // Without any, only what is destroyed leaves room.
            let free = self.draw.pick(4);
            if plan.is_spawned || self.draw.chance(5) {
                // One can be placed by a tile of each map.
                let tiles = if index == 0 { 2 + usize::from(self.arena.has_boss) } else { 0 };
                let placed = self.arena.places.iter().filter(|p| **p == index).count() + tiles;
                out.push_str(&format!("limit {} {}\n", plan.name, placed + free));
            }
        }
        out
    }

    fn place_plans(&mut self) {
        let count = self.plans.len();
        let mut places = vec![0];
        places.extend(1..count);
        for _ in 0..[0, 0, 0, 1, 2][self.draw.pick(5)] {
            places.push(self.draw.pick(count));
        }
        self.arena.places = places;
    }

    fn collide_lines(&mut self) {
        let tags: Vec<&str> = self.plans.iter().map(|p| p.tag).collect();
        let mut lines = Vec::new();
        for (index, tag) in tags.iter().enumerate() {
            if self.draw.chance(85) {
                let usual = self.draw.chance(60);
                lines.push(format!("{tag} with wall: {}", if usual { "block" } else { self.draw.one(&RESPONSES) }));
            }
            if self.draw.chance(25) {
                lines.push(format!("{tag} with cloud: block from above"));
            }
            if self.arena.has_bricks && self.draw.chance(60) {
                lines.push(format!("{tag} with brick: {}", self.draw.one(&["block", "sense", "block, bounce 1"])));
            }
            if self.draw.chance(15) {
                lines.push(format!("{tag} with \"thin ice\": {}", self.draw.one(&RESPONSES)));
            }
            for other in &tags[index..] {
                if self.draw.chance(65) {
                    let (a, b) = if self.draw.chance(50) { (tag, other) } else { (other, tag) };
                    lines.push(format!("{a} with {b}: {}", self.draw.one(&RESPONSES)));
                }
            }
        }
        if lines.is_empty() {
            lines.push("a with wall: block".into());
        }
        for line in lines {
            self.world_line(format!("collide {line}"));
        }
        self.world_line("look wall, a: \"wall.png\"");
    }

    fn space(&mut self, name: &str, kind: Kind, frame: Frame) {
        self.arena.map.clear();
        self.world_line(format!("space {name} {{"));
        let (width, height) = (self.arena.width(), self.arena.height());
        match kind {
            Kind::Map | Kind::OpenMap => self.map(kind == Kind::OpenMap, name == "main", frame),
            Kind::Rects => {
                let walls = [
                    [0.0, 0.0, width, 8.0],
                    [0.0, 0.0, 8.0, height],
                    [width - 8.0, 0.0, 8.0, height],
                    [0.0, height - 8.0, width, 8.0],
                ];
                for wall in walls {
                    if self.draw.chance(85) {
                        self.rect(wall);
                    }
                }
            }
            Kind::Chamber => {
                let thick = self.arena.thickness;
                let walls = [
                    [-thick, -thick, width + 2.0 * thick, thick],
                    [-thick, 0.0, thick, height],
                    [width, 0.0, thick, height],
                    [-thick, height, width + 2.0 * thick, thick],
                ];
                for wall in walls {
                    let rect = self.axes.rect(wall);
                    self.world_line(format!("rect wall {rect}"));
                }
            }
            Kind::Floor => self.rect([-200.0, -16.0, 600.0, 24.0]),
            Kind::Nothing => {}
            Kind::File => {
                let map = self.draw.one(&[
                    "t from \"levels/room.txt\"",
                    "vglc \"levels/room.txt\" legend \"levels/legend.json\" tile 16 x 16 { 'a': spawn A }",
                    "tiled \"levels/cave.tmx\" { Rock: wall; blob: spawn A { speed = -60; x' = 30 } }",
                    "ldtk \"levels/world.ldtk\" level \"Cave\" { Rock: wall; Mob: spawn A }",
                    "level t",
                    "level legend \"levels/legend.json\" tile 16 x 16",
                    "level { '#': wall; 'a': empty; '.': empty }",
                ]);
                self.world_line(format!("map {map}"));
            }
        }
        let rects = [0, 0, 1, 2, 3][self.draw.pick(if self.palette.walks { 3 } else { 5 })];
        for _ in 0..rects.max(usize::from(self.palette.seams)) {
            let (x, y) = self.spot();
            let (width, height) =
                ([16.0, 4.0, 48.0, 8.0][self.draw.pick(4)], [8.0, 16.0, 3.0, 40.0][self.draw.pick(4)]);
            self.rect([x, y, width, height]);
            if self.palette.seams {
                let gap = [0.5, 16.0, 15.5, 16.5, 8.5, 0.5, 0.0005, 31.5][self.draw.pick(8)];
                let beside = if self.draw.chance(50) { [x + width + gap, y] } else { [x, y + height + gap] };
                self.rect([beside[0], beside[1], width, height]);
            }
        }
        let wraps = [self.draw.chance(10), self.draw.chance(6)];
        if wraps != [false; 2] {
            self.wrap(kind, wraps);
        } else if self.draw.chance(20) {
            let rect = match self.draw.pick(3) {
                0 => [-50.0, -50.0, width + 100.0, height + 100.0],
                1 => [0.0, 0.0, width, height],
                _ => [8.0, 0.0, width, 40.0],
            };
            let rect = self.axes.rect(rect);
            self.world_line(format!("bounds rect{rect}"));
        }
        if name == "main" {
            self.placed();
        } else if self.draw.chance(30) {
            self.place_one(self.arena.places.len(), 0);
            self.arena.places.push(0);
        }
        if self.arena.links {
            for _ in 0..[1, 1, 2][self.draw.pick(3)] {
                let to = match name {
                    "main" if self.arena.has_attic && self.draw.chance(40) => "attic",
                    "main" => "cellar",
                    "cellar" if self.arena.has_attic && self.draw.chance(50) => "attic",
                    _ => "main",
                };
                self.link(to);
            }
        }
        self.world_line("}");
    }

    /// A space that wraps, as wide and as high as what it holds, or more.
    fn wrap(&mut self, kind: Kind, wraps: [bool; 2]) {
        let (width, height) = (self.arena.width(), self.arena.height());
        let thick = self.arena.thickness;
        let rect = match kind {
            Kind::Map | Kind::OpenMap | Kind::File => None,
            Kind::Floor => Some([-200.0, -40.0, 600.0, height + 80.0]),
            Kind::Chamber => Some([-thick, -thick, width + 2.0 * thick, height + 2.0 * thick]),
            Kind::Rects | Kind::Nothing => {
                let more = [0.0, 8.0, 40.5][self.draw.pick(3)];
                Some([-more, 0.0, width + more, height.max(64.0) + more])
            }
        };
        if let Some(rect) = rect {
            let rect = self.axes.rect(rect);
            self.world_line(format!("bounds rect{rect}"));
        }
        for (way, _) in ["horizontal", "vertical"].iter().zip(wraps).filter(|(_, wraps)| *wraps) {
            self.world_line(format!("wrap {way}"));
        }
    }

    fn map(&mut self, is_open: bool, is_main: bool, frame: Frame) {
        self.world_line("map t \"");
        let (columns, rows) = (self.arena.columns, self.arena.rows);
        let mut boss = is_main && self.arena.has_boss;
        let mut spawned = 0;
        let mut lines: Vec<String> = Vec::new();
        for row in 0..rows {
            let mut line = String::new();
            for column in 0..columns {
                let is_border = column == 0 || column + 1 == columns || row == 0 || row + 1 == rows;
                let chosen = match () {
                    () if is_border && is_open && self.draw.chance(25) => '.',
                    () if is_border => '#',
                    () if self.arena.has_bricks && self.draw.chance(30) => ['b', 'r'][self.draw.pick(2)],
                    () if self.arena.has_slopes && row + 3 >= rows && self.draw.chance(45) => {
                        ['/', 'd', 'h', 'H'][self.draw.pick(4)]
                    }
                    () if self.draw.chance(15) => ['#', '-', '#', '~', 'w', 'a'][self.draw.pick(6)],
                    () if boss => {
                        boss = false;
                        's'
                    }
                    () => '.',
                };
                spawned += usize::from(chosen == 'a');
                line.push(if chosen == 'a' && spawned > 1 { '.' } else { chosen });
            }
            lines.push(line);
        }
        if is_main && self.arena.has_boss && !lines.iter().any(|l| l.contains('s')) {
            lines[1].replace_range(1..2, "s");
        }
        for line in &lines {
            let row = self.axes.row(line, frame.tiles);
            self.world_line(row);
        }
        self.arena.map = lines;
        for _ in 0..frame.tiles.1 {
            self.world_line(".".repeat(columns + frame.tiles.0 as usize));
        }
        self.world_line("\"");
    }

    fn rect(&mut self, rect: [f64; 4]) {
        let tags = self.draw.one(&["wall", "wall", "wall", "wall, cloud", "cloud", "\"thin ice\""]);
        let rect = self.axes.rect(rect);
        self.world_line(format!("rect {tags} {rect}"));
    }

    /// A position in or near the room, mostly on a grid of 8 px.
    fn spot(&mut self) -> (f64, f64) {
        let count = |size: f64| (size / 8.0) as usize + 2;
        let x = 8.0 * self.draw.pick(count(self.arena.width())) as f64;
        let y = 8.0 * self.draw.pick(count(self.arena.height())) as f64;
        let extremes = self.palette.extremes;
        let by = |g: &mut Self| {
            [0.0, 0.0, 0.0, 0.0, 0.5, 3.0, 0.0005, -0.0005, 0.000_000_001][g.draw.pick(if extremes { 9 } else { 6 })]
        };
        let far = if extremes && self.draw.chance(2) { 1e9 } else { 0.0 };
        (x + by(self) + far, y + by(self))
    }

    fn placed(&mut self) {
        for (index, plan) in self.arena.places.clone().into_iter().enumerate() {
            self.place_one(index, plan);
        }
    }

    fn place_one(&mut self, index: usize, plan: usize) {
        let (mut x, mut y) = self.spot();
        if index > 0 && self.draw.chance(50) {
            // Next to another instance, or on it.
            let by = [16.0, 0.0, -16.0, 24.0, 8.0, -8.0];
            (x, y) = (self.arena.last.0 + by[self.draw.pick(6)], self.arena.last.1 + by[self.draw.pick(5)]);
        }
        let ground = self.ground(x).filter(|_| index > 0 && x % 24.0 == 0.0);
        y = ground.unwrap_or(y);
        self.arena.last = (x, y);
        let settings = self.settings();
        let at = match ground {
            // In another frame the same place is a number.
            Some(_) if self.axes.is_own() => format!("({}, above wall)", number(x)),
            _ => self.axes.point(x, y),
        };
        let name = self.plans[plan].name.clone();
        self.world_line(format!("place p{index}: {name} at {at}{settings}"));
    }

    /// How high the lowest place above a wall is in the map, for what is as wide as a tile and begins at `x`.
    fn ground(&self, x: f64) -> Option<f64> {
        let tile = self.arena.tile;
        let touched = |column: usize| (column as f64 + 1.0) * tile > x && (column as f64) * tile < x + tile;
        let columns: Vec<usize> = (0..self.arena.columns).filter(|column| touched(*column)).collect();
        let row = |up: usize| -> Vec<char> {
            let row = self.arena.map.len().checked_sub(up + 1).map(|row| &self.arena.map[row]);
            columns.iter().filter_map(|column| row?.chars().nth(*column)).collect()
        };
        // What tags these tiles have is drawn.
        if (0..self.arena.map.len()).any(|up| row(up).iter().any(|c| matches!(c, 'b' | 'H'))) {
            return None;
        }
        let is_wall = |up: usize| row(up).iter().any(|c| "#wr/dh".contains(*c));
        let up = (1..=self.arena.map.len()).find(|up| is_wall(up - 1) && !is_wall(*up))?;
        Some(up as f64 * tile)
    }

    /// The settings of an instance; sometimes none.
    fn settings(&mut self) -> String {
        let mut settings = Vec::new();
        if self.draw.chance(20) {
            let speed = self.draw.one(&["30", "-60", "0", "200", "-7.5"]);
            settings.push(format!("speed = {speed}"));
        }
        if self.draw.chance(15) {
            settings.push(
                self.draw
                    .one(&["n = 0", "n = 3", "n = -1", "size = 8", "size = 24", "delay = 0.1", "force = -400"])
                    .into(),
            );
        }
        if self.draw.chance(15) {
            let speed = self.draw.one(&["60", "-60", "200"]);
            settings.push(format!("x' = {}", self.axes.write("x'", speed)));
        }
        if self.draw.chance(15) {
            settings.push(
                self.draw
                    .one(&["count = 2", "y' = 100", "q = 12", "flag = true", "colour = blue", "y'' = -400"])
                    .into(),
            );
        }
        let others = self.arena.places.len();
        if self.draw.chance(50) {
            let to = self.draw.pick(others);
            settings.push(format!("friend = p{to}"));
        }
        for of in 0..self.plans.len() {
            let found = (0..others).rfind(|p| self.arena.places[*p] == of);
            if let Some(to) = found.filter(|_| self.draw.chance(60)) {
                settings.push(format!("foe_{} = p{to}", self.plans[of].name.to_lowercase()));
            }
        }
        if settings.is_empty() { String::new() } else { format!(" {{ {} }}", settings.join("; ")) }
    }

    fn link(&mut self, to: &str) {
        let (x, y) = self.spot();
        let from = self.axes.rect([x - 8.0, y - 8.0, [24.0, 100.0][self.draw.pick(2)], 30.0]);
        let (x, y) = self.spot();
        let (width, height) = ([24.0, 16.0, 1.0][self.draw.pick(3)], [30.0, 8.0][self.draw.pick(2)]);
        // It must end in the room, whatever its contents.
        let (x, y) = (x.clamp(8.0, (self.arena.width() - width).min(24.0)), y.clamp(0.0, 32.0 - height));
        let at = self.axes.rect([x, y, width, height]);
        let guard = if self.draw.chance(30) { format!(" when {}", self.predicate()) } else { String::new() };
        self.world_line(format!("link rect{from} -> {to} at rect{at}{guard}"));
    }

    fn players(&mut self) {
        let mut number = 1;
        for (index, plan) in self.arena.places.clone().into_iter().enumerate().take(3) {
            if self.plans[plan].is_played && (index == 0 || self.draw.chance(60)) {
                self.world_line(format!("player {number}: p{index}"));
                number += 1;
            }
        }
    }

    pub fn questions(&mut self) {
        for index in 0..2 + self.draw.pick(3) {
            let mut predicate = self.predicate();
            if index == 1 {
                self.world_line(format!("condition asked = {predicate}"));
                predicate = "asked".into();
            }
            self.world_line(format!("goal goal{index}: {predicate}"));
        }
        if self.draw.chance(35) {
            let predicate = self.predicate();
            self.world_line(format!("never n0: {predicate}"));
        }
        self.test();
    }

    /// A test, which no state depends on.
    fn test(&mut self) {
        self.world_line("test \"random\" {");
        self.world_line("inputs \"-*3\"; chance seed 7");
        for moment in ["at end", "by end", "always", "never"] {
            let predicate = self.predicate();
            self.world_line(format!("expect {predicate} {moment}"));
        }
        let (goal, barrier) = (self.predicate(), self.predicate());
        self.world_line(format!("reachable {goal} not without {barrier} within 60frames"));
        self.world_line(format!("unreachable {barrier}; unfound {goal}"));
        self.world_line("}");
    }

    /// A predicate of the world.
    pub fn predicate(&mut self) -> String {
        match self.draw.pick(8) {
            0 => format!("({} and {})", self.question(), self.question()),
            1 => format!("({} or {})", self.question(), self.question()),
            2 => format!("not {}", self.question()),
            _ => self.question(),
        }
    }

    fn question(&mut self) -> String {
        let place = self.draw.pick(self.arena.places.len().max(1));
        let plan = self.arena.places.get(place).copied().unwrap_or(0);
        let who = match self.draw.chance(12) && self.arena.has_boss {
            true => "boss".to_string(),
            false => format!("p{place}"),
        };
        let of = format!("{who}.");
        let op = self.draw.one(&[">", "<", ">=", "<=", "==", "!="]);
        let any = self.any_plan();
        let any_name = self.plans[any].name.clone();
        let tag = self.draw.one(&["wall", "cloud", "\"thin ice\"", "a", "b", "c"]).to_string();
        if self.arena.has_bricks && self.arena.is_mapped() && self.draw.chance(25) {
            return format!("count(brick) {op} {}", self.draw.pick(5));
        }
        let (x, y) = self.spot();
        let radius = self.draw.one(&["4", "0.5", "16", "0"]);
        match self.draw.pick(19) {
            16 => format!("count({any_name}) {op} {}", self.draw.pick(3)),
            17 => match self.mode_of(any) {
                Some(mode) => format!("count({any_name} in {mode}) {op} {}", self.draw.pick(3)),
                None => format!("count({any_name} touching {tag}) {op} {}", self.draw.pick(3)),
            },
            18 => match self.mode_of(any).filter(|_| self.draw.chance(60)) {
                Some(mode) => format!("all {any_name} in {mode}"),
                None => format!("all {any_name} touching {tag}"),
            },
            15 if self.arena.is_mapped() => format!("main.width > {}", self.number(Dim::Length)),
            0 | 1 => {
                let variable = self.draw.one(&["x", "y"]);
                format!("{} {op} {}", self.axes.read(&of, variable), self.number(Dim::Length))
            }
            2 => format!("near({who}, {}, {radius})", self.axes.point(x, y)),
            3 => format!("near(any {any_name}, {}, {radius})", self.axes.point(x, y)),
            4 | 5 => match self.mode_of(plan) {
                Some(mode) => format!("{who} in {mode}"),
                None => format!("{who} touching wall"),
            },
            6 => format!("{who} touching {tag}"),
            7 => format!("any {any_name} touching {tag}"),
            8 => match self.mode_of(any) {
                Some(mode) => format!("any {any_name} in {mode}"),
                None => format!("any {any_name}"),
            },
            9 if self.arena.links => {
                format!(
                    "inside({who}, {})",
                    self.draw.one(&["cellar", "main", if self.arena.has_attic { "attic" } else { "main" }])
                )
            }
            10 => format!("near({who}, p{}, {radius})", self.draw.pick(self.arena.places.len().max(1))),
            11 => format!("{who}.count {op} {}", self.draw.pick(4)),
            12 => self.draw.one(&["p0.colour == green", "p0.flag", "p0.n < 2", "p0.q > 20", "p0.size == 16"]).into(),
            13 => {
                let variable = self.draw.one(&["x'", "y'"]);
                format!("{} {op} {}", self.axes.read(&of, variable), self.number(Dim::Speed))
            }
            14 => format!("inside(any {any_name}, main)"),
            _ => format!("{} < {} <= {}", self.number(Dim::Length), self.axes.read(&of, "y"), self.number(Dim::Length)),
        }
    }
}
