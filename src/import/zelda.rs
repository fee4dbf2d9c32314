//! Importer of dungeons of *The Legend of Zelda* from the Video Game Level Corpus as a world: rooms become spaces,
//! doors links.
//!
//! The corpus writes columns as rows: its rooms are 11 characters wide and 16 lines high, those of the game 16 tiles
//! wide and 11 high. Here they are as in the game, each named by its column (a letter) and its row (a number, from
//! above). The corpus has neither a start nor a goal: the start is a door without a room behind it, and the goals are
//! the stairs, and the room that is the most doors away within walking distance: keys, movable blocks and rafts are not
//! in the corpus either.

use std::collections::{BTreeMap, BTreeSet, VecDeque};
use std::fmt::Write;

use super::Import;
use crate::diagnostic::Diagnostics;
use crate::diagnostic::catalogue::import::{Assumed, LeftOut, NotWellFormed};
use crate::format::format;
use crate::source::{FileId, Span};

/// Lines of a room in the file: its columns.
const COLUMNS: usize = 16;
/// Characters of a room in each of these lines: its rows.
const ROWS: usize = 11;
/// The side of a tile, px.
const TILE: i64 = 16;
/// Distance beyond the inner edge of its tiles at which a door takes effect, px.
const INTO: i64 = 9;
/// Distance from the exit position to the nearest position that would lead back, px.
const APART: i64 = 1;
/// Maximum number of characters of a file: a hundred times the largest dungeon.
const MAX_CHARACTERS: usize = 1 << 20;

/// The tiles of the corpus, and their tags here.
const TILES: [(char, &str); 10] = [
    ('F', "empty"),
    ('-', "empty"),
    ('W', "wall"),
    ('B', "block"),
    ('D', "door"),
    ('S', "stair"),
    ('M', "spawn Monster"),
    ('P', "water"),
    ('I', "water, block"),
    // The neighbours of this tile suggest floor beside an element.
    ('O', "empty"),
];

/// A side of a room, in the orientation of the game.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Side {
    Left,
    Right,
    Above,
    Below,
}

impl Side {
    const ALL: [Side; 4] = [Side::Left, Side::Right, Side::Above, Side::Below];

    fn opposite(self) -> Side {
        match self {
            Side::Left => Side::Right,
            Side::Right => Side::Left,
            Side::Above => Side::Below,
            Side::Below => Side::Above,
        }
    }

    /// The room beyond, by column and row.
    fn beyond(self, (column, row): Place) -> Option<Place> {
        Some(match self {
            Side::Left => (column.checked_sub(1)?, row),
            Side::Right => (column + 1, row),
            Side::Above => (column, row.checked_sub(1)?),
            Side::Below => (column, row + 1),
        })
    }

    /// Whether a tile of a room lies in the wall on this side.
    fn has(self, (column, row): Place) -> bool {
        match self {
            Side::Left => column < 2,
            Side::Right => column >= COLUMNS - 2,
            Side::Above => row < 2,
            Side::Below => row >= ROWS - 2,
        }
    }

    fn name(self) -> &'static str {
        match self {
            Side::Left => "left",
            Side::Right => "right",
            Side::Above => "upper",
            Side::Below => "lower",
        }
    }
}

/// A column and a row, from the upper left.
type Place = (usize, usize);

/// Tiles of a room: from the first column and row to the last.
type Area = (Place, Place);

/// A tile with its place in the file.
type Cell = (char, Span);

/// A room.
struct Room {
    /// Row by row from above.
    cells: Vec<Vec<Cell>>,
    /// The door on each side, in the order of [`Side::ALL`].
    doors: [Option<Area>; 4],
}

impl Room {
    fn door(&self, side: Side) -> Option<Area> {
        self.doors[side as usize]
    }

    /// The tiles of the entrance: a door, or the middle of the room without one.
    fn entry(&self, side: Option<Side>) -> Area {
        side.and_then(|side| self.door(side)).unwrap_or(((COLUMNS / 2, ROWS / 2), (COLUMNS / 2, ROWS / 2)))
    }

    fn span(&self, (column, row): Place) -> Span {
        self.cells[row][column].1
    }
}

/// Imports a file as a world, in a program that takes `Link` and `Monster` from another file.
pub fn import(file: FileId, text: &str, name: &str, entities: &str) -> Import {
    let mut diagnostics = Diagnostics::new();
    let rooms = match rooms(file, text) {
        Ok(rooms) => rooms,
        Err(fact) => {
            diagnostics.report(fact);
            return Import { text: None, diagnostics };
        }
    };
    let text = world(&rooms, name, entities, &mut diagnostics);
    diagnostics.sort();
    Import { text: format(FileId(0), &text).ok(), diagnostics }
}

/// The rooms by their places; an error for a file of another form.
fn rooms(file: FileId, text: &str) -> Result<BTreeMap<Place, Room>, NotWellFormed> {
    let wrong = |what: String, at: Span, help: &str| NotWellFormed { what, at, help: Some(help.into()) };
    let begin = Span::new(file, 0, text.len().min(1));
    if text.len() > MAX_CHARACTERS {
        return Err(wrong("this is too much for a dungeon".into(), begin, "a dungeon of the corpus has some 10 kB"));
    }
    let mut lines: Vec<Vec<Cell>> = Vec::new();
    let mut start = 0;
    for line in text.split_inclusive('\n') {
        let row = line.trim_end();
        let cell = |(at, c): (usize, char)| (c, Span::new(file, start + at, start + at + c.len_utf8()));
        lines.push(row.char_indices().map(cell).filter(|(c, _)| *c != '\u{feff}').collect());
        start += line.len();
    }
    while lines.last().is_some_and(Vec::is_empty) {
        lines.pop();
    }
    let form = "a dungeon of the corpus is a grid of rooms, each 11 characters wide and 16 lines high";
    let Some(width) = lines.first().map(Vec::len).filter(|width| *width > 0) else {
        return Err(wrong("there is no dungeon here".into(), begin, form));
    };
    let mut known: Vec<String> = TILES.iter().map(|(c, _)| format!("`{c}`")).collect();
    known.sort();
    for (number, line) in (1..).zip(&lines) {
        if let Some((c, at)) = line.iter().find(|(c, _)| TILES.iter().all(|(known, _)| known != c)) {
            let what = format!("`{}` in line {number} is no tile of a dungeon", c.escape_debug());
            return Err(wrong(what, *at, &format!("the tiles are {}", known.join(", "))));
        }
        if line.len() != width {
            let at = line.last().map_or(begin, |(_, at)| *at);
            let what = format!("line {number} has {} characters, the first has {width}", line.len());
            return Err(wrong(what, at, form));
        }
    }
    if !width.is_multiple_of(ROWS) || !lines.len().is_multiple_of(COLUMNS) {
        let what = format!("{width} characters in {} lines make no whole rooms", lines.len());
        return Err(wrong(what, begin, form));
    }
    let mut rooms = BTreeMap::new();
    for column in 0..lines.len() / COLUMNS {
        for row in 0..width / ROWS {
            let cell = |x: usize, y: usize| lines[column * COLUMNS + x][row * ROWS + y];
            let cells: Vec<Vec<Cell>> = (0..ROWS).map(|y| (0..COLUMNS).map(|x| cell(x, y)).collect()).collect();
            if cells.iter().flatten().any(|(c, _)| *c != '-') {
                rooms.insert((column, row), Room { doors: doors(&cells), cells });
            }
        }
    }
    if rooms.is_empty() {
        return Err(wrong("there is no room in this dungeon".into(), begin, form));
    }
    Ok(rooms)
}

/// The doors of a room by their sides.
fn doors(cells: &[Vec<Cell>]) -> [Option<Area>; 4] {
    let mut doors = [None; 4];
    for (row, line) in cells.iter().enumerate() {
        for (column, _) in line.iter().enumerate().filter(|(_, (c, _))| *c == 'D') {
            let Some(side) = Side::ALL.into_iter().find(|side| side.has((column, row))) else { continue };
            let door: &mut Area = doors[side as usize].get_or_insert(((column, row), (column, row)));
            door.0 = (door.0.0.min(column), door.0.1.min(row));
            door.1 = (door.1.0.max(column), door.1.1.max(row));
        }
    }
    doors
}

/// The letter of a column, and the number of a row.
fn called((column, row): Place) -> String {
    let mut letters = String::new();
    let mut left = column + 1;
    while left > 0 {
        left -= 1;
        letters.insert(0, char::from(b'a' + (left % 26) as u8));
        left /= 26;
    }
    format!("{letters}{}", row + 1)
}

/// A link through a door: the room, the side, and the other room.
struct DoorLink {
    from: Place,
    side: Side,
    to: Place,
}

fn world(rooms: &BTreeMap<Place, Room>, name: &str, entities: &str, diagnostics: &mut Diagnostics) -> String {
    let mut links: Vec<DoorLink> = Vec::new();
    let mut outside: Vec<(Place, Side)> = Vec::new();
    for (&place, room) in rooms {
        for side in Side::ALL {
            let Some((first, _)) = room.door(side) else { continue };
            let beyond = side.beyond(place).and_then(|p| rooms.get(&p).map(|room| (p, room)));
            match beyond {
                None => outside.push((place, side)),
                Some((to, other)) if other.door(side.opposite()).is_some() => {
                    links.push(DoorLink { from: place, side, to })
                }
                Some((to, _)) => diagnostics.report(LeftOut {
                    what: format!("the {} door of room `{}`", side.name(), called(place)),
                    why: format!("room `{}` has a wall on its side", called(to)),
                    at: room.span(first),
                }),
            }
        }
        let is_void = |(x, y): Place| (2..COLUMNS - 2).contains(&x) && (2..ROWS - 2).contains(&y);
        let mut inside = (0..ROWS).flat_map(|y| (0..COLUMNS).map(move |x| (x, y))).filter(|p| is_void(*p));
        if let Some(at) = inside.find(|(x, y)| room.cells[*y][*x].0 == '-') {
            diagnostics.report(Assumed {
                what: format!("the inside of room `{}` has no meaning; it is taken for floor", called(place)),
                at: room.span(at),
                help: "where it is none, put blocks (`B`) there".into(),
            });
        }
    }
    // The entrance is at the bottom if possible, as in the game.
    let entrance = outside.iter().copied().max_by_key(|(place, side)| (*side == Side::Below, place.1));
    let start = entrance.map(|(place, _)| place).or_else(|| rooms.keys().next().copied());
    let Some(start) = start else { return String::new() };
    if outside.len() != 1 {
        let (count, at) = match entrance {
            Some((place, side)) => (outside.len(), rooms[&place].door(side).map_or((0, 0), |(first, _)| first)),
            None => (0, (0, 0)),
        };
        diagnostics.report(Assumed {
            what: format!("{count} doors lead outside; the entrance is taken to be in room `{}`", called(start)),
            at: rooms[&start].span(at),
            help: "`place hero` says where one comes in".into(),
        });
    }
    let entry = rooms[&start].entry(entrance.map(|(_, side)| side));
    let walk = Walk::new(rooms, start, &links, entry);
    let is_there = |tile: char| rooms.values().any(|r| r.cells.iter().flatten().any(|(c, _)| *c == tile));
    let mut out = String::new();
    let quoted = entities.replace(['"', '\n'], "");
    let _ = writeln!(out, "// {} rooms from the Video Game Level Corpus, as they lie in the game:", rooms.len());
    picture(rooms, &mut out);
    let shut: Vec<String> = rooms.keys().filter(|p| !walk.rooms.contains_key(p)).map(|p| called(*p)).collect();
    if !shut.is_empty() {
        let _ = writeln!(out, "// Nobody walks to {}: what would let one is not in the corpus.", shut.join(", "));
    }
    if is_there('S') && !walk.stairs {
        let _ = writeln!(out, "// Nobody walks to a stair: blocks or water are in the way.");
    }
    let _ = writeln!(out, "\nimport \"{quoted}\"\n\nworld {name} {{");
    let block = if is_there('B') || is_there('I') { ", block" } else { "" };
    let water = if is_there('P') || is_there('I') { ", water" } else { "" };
    let _ = writeln!(out, "    step 1/60\n\n    collide body with wall{block}{water}: block");
    let stair = if is_there('S') { ", stair" } else { "" };
    let _ = writeln!(out, "    collide player with enemy{stair}: sense\n    collide sword with enemy: sense\n");
    let _ = writeln!(out, "    tiles dungeon {TILE} x {TILE} {{");
    for (tile, tags) in TILES.iter().filter(|(tile, _)| is_there(*tile)) {
        let _ = writeln!(out, "        '{tile}': {tags}");
    }
    let _ = writeln!(out, "    }}\n");
    for (&place, room) in rooms {
        let _ = writeln!(out, "    space {} {{\n        map dungeon \"", called(place));
        for row in &room.cells {
            let row: String = row.iter().map(|(c, _)| *c).collect();
            let _ = writeln!(out, "            {row}");
        }
        let _ = writeln!(out, "        \"");
        if place == start {
            let (first, last) = entry;
            let (x, y) = corner(((first.0 + last.0).div_ceil(2), (first.1 + last.1).div_ceil(2)));
            let _ = writeln!(out, "        place hero: Link at ({}, {})", x + 2, y + 2);
        }
        for link in links.iter().filter(|link| link.from == place) {
            let (from, to) = (room.door(link.side), rooms[&link.to].door(link.side.opposite()));
            if let Some((from, to)) = from.zip(to) {
                let [from, to] = link_rectangles(link.side, from, to);
                let _ = writeln!(out, "        link rect({from}) -> {} at rect({to})", called(link.to));
            }
        }
        let _ = writeln!(out, "    }}\n");
    }
    let _ = writeln!(out, "    player 1: hero\n");
    if let Some(last) = walk.last().filter(|last| *last != start) {
        let _ = writeln!(out, "    // The most doors away.\n    goal last: inside(hero, {})", called(last));
    }
    if walk.stairs {
        let _ = writeln!(out, "    goal down: hero touching stair");
    }
    let _ = writeln!(out, "    never died: hero in dead\n}}");
    out
}

/// The rooms as a map in a comment.
fn picture(rooms: &BTreeMap<Place, Room>, out: &mut String) {
    let most = |of: &dyn Fn(&Place) -> usize| rooms.keys().map(of).max().unwrap_or(0);
    let (columns, rows) = (most(&|p| p.0), most(&|p| p.1));
    let wide = rooms.keys().map(|p| called(*p).len()).max().unwrap_or(0);
    for row in 0..=rows {
        let names = (0..=columns).map(|column| match rooms.contains_key(&(column, row)) {
            true => format!("{:wide$}", called((column, row))),
            false => format!("{:wide$}", "·"),
        });
        let _ = writeln!(out, "// {}", names.collect::<Vec<String>>().join(" ").trim_end());
    }
}

/// The walkable part of the dungeon: from tile to tile of a room, and through doors.
struct Walk {
    /// The reachable rooms, with the number of doors to each.
    rooms: BTreeMap<Place, usize>,
    /// Whether stairs are reachable.
    stairs: bool,
}

impl Walk {
    fn new(rooms: &BTreeMap<Place, Room>, start: Place, links: &[DoorLink], entry: Area) -> Walk {
        let mut walk = Walk { rooms: BTreeMap::from([(start, 0)]), stairs: false };
        let mut seen: BTreeSet<(Place, Place)> = BTreeSet::new();
        let mut open: VecDeque<(Place, Place, usize)> = cells(entry).map(|at| (start, at, 0)).collect();
        // Doors come last, so that rooms are visited in the order of their distance.
        while let Some((room, at, doors)) = open.pop_front() {
            let tile = rooms[&room].cells[at.1][at.0].0;
            if matches!(tile, 'W' | 'B' | 'P' | 'I') || !seen.insert((room, at)) {
                continue;
            }
            walk.stairs |= tile == 'S';
            for side in Side::ALL {
                let inside = side.beyond(at).filter(|(column, row)| *column < COLUMNS && *row < ROWS);
                if let Some(next) = inside {
                    open.push_front((room, next, doors));
                }
                let Some(link) = links.iter().find(|w| w.from == room && w.side == side) else { continue };
                let is_door = rooms[&room].door(side).is_some_and(|door| lies_in(at, door));
                if let (true, Some((first, _))) = (is_door, rooms[&link.to].door(side.opposite())) {
                    walk.rooms.entry(link.to).or_insert(doors + 1);
                    open.push_back((link.to, first, doors + 1));
                }
            }
        }
        walk
    }

    /// The reachable room that is the most doors away; of several the first, column by column.
    fn last(&self) -> Option<Place> {
        let most = self.rooms.values().max()?;
        self.rooms.iter().find(|(_, doors)| *doors == most).map(|(place, _)| *place)
    }
}

/// The tiles of an area, row by row.
fn cells((first, last): Area) -> impl Iterator<Item = Place> {
    (first.1..=last.1).flat_map(move |row| (first.0..=last.0).map(move |column| (column, row)))
}

fn lies_in((column, row): Place, (first, last): Area) -> bool {
    (first.0..=last.0).contains(&column) && (first.1..=last.1).contains(&row)
}

/// The lower-left corner of a tile of a room, px.
fn corner((column, row): Place) -> (i64, i64) {
    (column as i64 * TILE, (ROWS - 1 - row) as i64 * TILE)
}

/// The trigger rectangle of a door and the destination rectangle of the other one: the trigger is slightly inside the
/// door, and the destination not so deep as to lead back.
fn link_rectangles(side: Side, from: Area, to: Area) -> [String; 2] {
    // Lower-left corner, width and height of a door, px; y points up.
    let area = |(first, last): (Place, Place)| {
        let (x, y) = corner((first.0, last.1));
        (x, y, (last.0 + 1 - first.0) as i64 * TILE, (last.1 + 1 - first.1) as i64 * TILE)
    };
    let (from, to) = (area(from), area(to));
    let rect = |x: i64, y: i64, w: i64, h: i64| format!("{x}, {y}, {w}, {h}");
    // Positions are lower-left corners: a body that comes from the left or from below is in the door at once, otherwise
    // after its own size.
    match side {
        Side::Right => [rect(from.0 + APART, from.1, TILE, from.3), rect(to.0 + INTO, to.1, TILE, to.3)],
        Side::Left => [rect(from.0 + INTO - 1 - TILE, from.1, TILE, from.3), rect(to.0 - TILE, to.1, TILE, to.3)],
        Side::Above => [rect(from.0, from.1 + APART, from.2, TILE), rect(to.0, to.1 + INTO, to.2, TILE)],
        Side::Below => [rect(from.0, from.1 + INTO - 1 - TILE, from.2, TILE), rect(to.0, to.1 - TILE, to.2, TILE)],
    }
}
