//! Painted maps: what a search and the known ways saw of each tile of a world, beside the characters of its map; and
//! the question whether a player can get to a tile.

use std::ops::Range;
use std::path::PathBuf;

use crate::compile::{Asked, Changes, Compilation, ExtraQuestion, compile_changed, is_name, question_name};
use crate::ir::{Bounds, Extremes, Push, SlotId, TagSet, World, WorldId};
use crate::lsp::buffers::Buffers;
use crate::reach::query::{Kind, Query, Session};
use crate::reach::{End, Limits, Planner, Settings, Style, Target, TileTrail, Trail};
use crate::sim::parse_script;
use crate::source::{SourceMap, normalize};
use crate::studio::Written;
use crate::watch::{Meter, Watch};

use super::ask::Budget;
use super::level::ChosenLevel;
use super::verdict::{Verdict, Way};

/// The name of the source of the questions.
const ORIGIN: &str = "paint";
/// How near to the border of a tile a body is not in it, px: as when states are seen.
const NEAR: f64 = 0.05;

/// The world of a program that is painted.
pub(in crate::lsp) struct Canvas<'a> {
    pub root: &'a std::path::Path,
    pub world: &'a str,
    pub level: Option<&'a ChosenLevel>,
    pub files: &'a Buffers,
}

/// What was seen of a world.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::lsp) struct Painted {
    /// Nodes of the search.
    pub nodes: u64,
    /// The duration of a step, s.
    pub seconds_per_step: f64,
    pub spaces: Vec<PaintedSpace>,
}

/// The map of a space.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::lsp) struct PaintedSpace {
    pub name: String,
    /// The file that the map is written in.
    pub path: PathBuf,
    pub columns: usize,
    /// The bytes of the rows in that file, from the highest.
    pub rows: Vec<Range<usize>>,
    /// The characters with the tags of their tiles.
    pub kinds: Vec<(char, Vec<String>)>,
    /// The tiles, row by row from the highest.
    pub tiles: Vec<PaintedTile>,
}

/// What was seen of a tile.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::lsp) struct PaintedTile {
    /// Its kind.
    pub kind: usize,
    /// The fewest steps after which a player was in it, and their inputs.
    pub first: Option<(u64, String)>,
    /// Number of states in which a player was in it.
    pub visits: u64,
    /// Whether a known way leads through it.
    pub is_on_way: bool,
    /// Whether a player stood on it.
    pub is_stood_on: bool,
}

/// A tile: its space, and its column and row from the upper left one.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(in crate::lsp) struct TilePlace {
    pub space: String,
    pub column: usize,
    pub row: usize,
}

impl Painted {
    /// The tile whose character begins at a byte of a file.
    pub fn tile_at(&self, path: &std::path::Path, text: &str, byte: usize) -> Option<&PaintedTile> {
        self.spaces.iter().filter(|space| space.path == path).find_map(|space| {
            let row = space.rows.iter().position(|row| row.contains(&byte))?;
            let column = text.get(space.rows.get(row)?.start..byte)?.chars().count();
            space.tiles.get(row * space.columns + column).filter(|_| column < space.columns)
        })
    }

    /// The way to a tile that was seen; its inputs were simulated.
    pub fn way_to(&self, place: &TilePlace) -> Option<Verdict> {
        let space = self.spaces.iter().find(|space| space.name == place.space)?;
        let tile =
            space.tiles.get(place.row * space.columns + place.column).filter(|_| place.column < space.columns)?;
        let (steps, inputs) = tile.first.clone()?;
        let seconds = steps as f64 * self.seconds_per_step;
        Some(Verdict::of_way(Kind::Goal, Way { inputs, steps, seconds, luck: None }))
    }
}

impl Canvas<'_> {
    /// Compiles the program with a further goal; says why not.
    fn compile(&self, goal: &str) -> Result<(Compilation, WorldId), String> {
        let asked = [ExtraQuestion { asked: Asked::Goal, world: Some(self.world), text: goal, origin: ORIGIN }];
        let level = self.level.map(ChosenLevel::file).unwrap_or_default();
        let changes = Changes { questions: &asked, ..Changes::default() };
        let compilation = compile_changed(self.root, level, &changes, self.files);
        let Some(program) = &compilation.program else { return Err("the program has errors".to_string()) };
        let world = program.world_named(self.world).ok_or_else(|| format!("there is no world `{}`", self.world))?;
        match program.worlds[world].open {
            Some(_) => Err("the world leaves its map open: choose a level".to_string()),
            None => Ok((compilation, world)),
        }
    }

    /// Searches without a goal, and paints the maps with what was seen, and with some known ways. `Ok(None)` if the
    /// watch stops it.
    pub fn paint(&self, ways: &[String], budget: Budget, watch: &dyn Watch) -> Result<Option<Painted>, String> {
        let (compilation, id) = self.compile("false")?;
        let Some(program) = &compilation.program else { return Err("the program has errors".to_string()) };
        let world = &program.worlds[id];
        let goal = world.goal_named(&question_name("false")).ok_or("the world cannot be searched")?;
        let query = Query {
            settings: Settings { planner: Planner::Coverage, ..Settings::default() },
            limits: Limits { nodes: budget.nodes, memory: budget.memory },
            ..Query::new(vec![Target::Goal(goal)])
        };
        let session = Session::new(program, id, query, watch);
        let trail = Trail::new(session.simulator());
        let fault = |_| "the initial state breaks a rule".to_string();
        if let Some(problem) = session.query().problem(session.simulator(), Target::Goal(goal), watch).map_err(fault)? {
            for way in ways {
                let mut sources = SourceMap::new();
                let file = sources.add("way", way.as_str());
                let (script, found) = parse_script(program, id, file, way);
                if !found.has_errors() {
                    trail.follow(&problem, &script, &Meter::new(watch));
                }
            }
        }
        let outcome = session.explore(&trail, watch).map_err(fault)?;
        if outcome.end == End::Stopped || watch.stop() {
            return Ok(None);
        }
        let written = Written::read(self.root, self.level.map(|level| level.map.as_path()), self.files);
        let (explored, tiles) = trail.into_tiles();
        let mut spaces = Vec::new();
        for ((space, trails), covered) in world.spaces.iter().zip(&tiles).zip(&explored.spaces) {
            let (Some(map), Some(rows)) = (&space.map, written.map_rows(&world.name, &space.name)) else { continue };
            // What is not written as it is read is not painted.
            let Some((_, first)) = rows.first().filter(|_| rows.len() == map.rows && map.columns > 0) else { continue };
            let stood: Vec<(usize, usize)> =
                covered.tops.iter().filter(|top| top.is_covered).filter_map(|top| top.tile).collect();
            let tile = |cell: usize| {
                let (column, row) = (cell % map.columns, map.rows - 1 - cell / map.columns);
                let index = row * map.columns + column;
                let TileTrail { first, visits, is_on_way, .. } = trails.get(index)?;
                Some(PaintedTile {
                    kind: map.cells.get(index).map_or(0, |kind| usize::from(*kind)),
                    first: first.as_ref().map(|(steps, script)| (*steps, script.text(program, id))),
                    visits: *visits,
                    is_on_way: *is_on_way,
                    is_stood_on: stood.contains(&(column, row)),
                })
            };
            let tags = |tags: &[crate::ir::TagId]| tags.iter().map(|tag| program.tags[*tag].clone()).collect();
            spaces.push(PaintedSpace {
                name: space.name.clone(),
                path: normalize(written.path(first.file())),
                columns: map.columns,
                rows: rows.iter().map(|(_, span)| span.range()).collect(),
                kinds: map.kinds.iter().map(|kind| (kind.symbol, tags(&kind.tags))).collect(),
                tiles: (0..map.cells.len()).filter_map(tile).collect(),
            });
        }
        let seconds_per_step = world.step.seconds();
        Ok(Some(Painted { nodes: outcome.statistics.nodes, seconds_per_step, spaces }))
    }

    /// Whether a player can get to a tile: as a goal that its body is in it. `Ok(None)` if the watch stops it.
    pub fn way_to(&self, place: &TilePlace, budget: Budget, watch: &dyn Watch) -> Result<Option<Verdict>, String> {
        let predicate = {
            let (compilation, id) = self.compile("false")?;
            let Some(program) = &compilation.program else { return Err("the program has errors".to_string()) };
            let world = &program.worlds[id];
            let players = world.players.iter().map(|player| player.slot);
            let within = |slot: SlotId| in_tile(program, world, slot, place);
            let parts = players.map(within).collect::<Result<Vec<String>, String>>()?;
            if parts.is_empty() {
                return Err("the world has no player".to_string());
            }
            parts.join(" or ")
        };
        let (compilation, id) = self.compile(&predicate)?;
        let Some(program) = &compilation.program else { return Err("the program has errors".to_string()) };
        let goal = program.worlds[id].goal_named(&question_name(&predicate)).ok_or("the tile cannot be asked about")?;
        let query = Query {
            settings: Settings { explains: true, ..Settings::default() },
            limits: Limits { nodes: budget.nodes, memory: budget.memory },
            style: Some(Style::Fast),
            ..Query::new(vec![Target::Goal(goal)])
        };
        let session = Session::new(program, id, query, watch);
        let found = session.find(Target::Goal(goal), watch);
        let mut found = found.map_err(|_| "the initial state breaks a rule".to_string())?;
        if found.outcome.end == End::Stopped || watch.stop() {
            return Ok(None);
        }
        Ok(Some(Verdict::of_answer(&session.answer(&mut found, &compilation.sources))))
    }
}

/// The predicate that the body of a player is in a tile: the box around all of its colliders that something stops, or
/// its position if there are none.
fn in_tile(
    program: &crate::ir::Program,
    world: &World,
    slot: SlotId,
    TilePlace { space, column, row }: &TilePlace,
) -> Result<String, String> {
    let name = &world.slots[slot].name;
    if !is_name(name) {
        return Err(format!("the player `{name}` has no name that a goal can use"));
    }
    let table = world.spaces.iter().find(|of| of.name == *space);
    let map = table.and_then(|of| of.map.as_ref()).ok_or_else(|| format!("`{space}` has no map"))?;
    let below = map.rows.checked_sub(row + 1).filter(|_| *column < map.columns).ok_or("there is no such tile")?;
    let [left, bottom, width, height] = map.rectangle(below * map.columns + column);
    let is_solid = |tags: TagSet| {
        let mut pushing = world.collide.iter().filter(|line| line.response.push != Push::Sense);
        pushing.any(|line| line.left.meets(tags) || line.right.meets(tags))
    };
    let params = &world.slots[slot].params;
    let number = |id| program.constant(id, params, world.step);
    let colliders = program.entities[world.slots[slot].entity].colliders.iter();
    let boxes = colliders.filter(|collider| is_solid(collider.tags)).map(|collider| collider.shape.sides(number));
    let boxes: Option<Vec<Bounds>> = boxes.map(|sides| sides.map(Bounds::new)).collect();
    let boxes = boxes.ok_or_else(|| format!("the body of `{name}` changes its size"))?;
    let hull = boxes.into_iter().reduce(|a, b| Bounds {
        left: a.left.least(b.left),
        right: a.right.greatest(b.right),
        bottom: a.bottom.least(b.bottom),
        top: a.top.greatest(b.top),
    });
    let body = hull.unwrap_or(Bounds { left: 0.0, right: 0.0, bottom: 0.0, top: 0.0 });
    let (inset, beyond) = if hull.is_some() { (NEAR, ">") } else { (0.0, ">=") };
    let room = if world.spaces.len() > 1 { format!("inside({name}, {space}) and ") } else { String::new() };
    Ok(format!(
        "({room}{name}.x {beyond} {} and {name}.x < {} and {name}.y {beyond} {} and {name}.y < {})",
        left - body.right + inset,
        left + width - body.left - inset,
        bottom - body.top + inset,
        bottom + height - body.bottom - inset,
    ))
}
