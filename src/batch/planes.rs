//! A window of tiles around a player as planes of 0 and 1: one for each tag of what does not move, one for each entity.

use crate::diagnostic::catalogue::run::NoQuestion;
use crate::diagnostic::similar;
use crate::ir::{Bounds, BreakableTiles, EntityId, Id, Period, SlotId, Space, SpaceId, TagId, TagSet, TileId, TileMap};
use crate::sim::Simulator;

use super::Sample;

/// The size of a cell in a space without a map, px.
const CELL: f64 = 16.0;

/// Planes of a window around a player: its middle cell is the one in which the player's position is, its first row the
/// uppermost.
pub struct Planes {
    player: SlotId,
    columns: usize,
    rows: usize,
    tags: Vec<TagId>,
    /// The same as a set.
    shown_tags: TagSet,
    /// For each entity of the program its plane among those of entities.
    entities: Vec<Option<usize>>,
    shown: usize,
    spaces: Vec<Grid>,
}

/// What does not move in a space.
struct Grid {
    cell: (f64, f64),
    columns: i64,
    rows: i64,
    /// The tags of each cell, row by row from the lowest.
    tags: Vec<TagSet>,
    /// The breakable tile of each cell; empty if there are none.
    breakable: Vec<Option<TileId>>,
    /// After how many cells it repeats along each axis.
    repeats: [Option<i64>; 2],
}

/// The names of what planes show, and the size of their window.
#[derive(Debug, Clone, Default)]
pub struct PlaneChoice {
    /// The player by number; the first one if none.
    pub player: Option<u32>,
    /// Columns and rows of the window.
    pub size: (usize, usize),
    /// The tags; those of all tiles and free-standing geometry if none are given.
    pub tags: Option<Vec<String>>,
    /// The entities; all that have a place in the world if none are given.
    pub entities: Option<Vec<String>>,
}

impl Planes {
    /// Looks up the names.
    ///
    /// # Errors
    /// A name that the program does not have, a player that the world does not have.
    pub fn new(sim: &Simulator, choice: &PlaneChoice) -> Result<Planes, NoQuestion> {
        let (program, world) = (sim.program(), sim.world());
        let numbers: Vec<String> = world.players.iter().map(|player| player.number.to_string()).collect();
        let player = match choice.player {
            Some(number) => world.players.iter().find(|player| player.number == number),
            None => world.players.iter().min_by_key(|player| player.number),
        };
        let player = player.map(|player| player.slot).ok_or_else(|| {
            let which = choice.player.map_or_else(String::new, |number| format!(" {number}"));
            unknown(&format!("player{which}"), &world.name, "", &numbers)
        })?;
        let tag_names: Vec<String> = program.tags.iter().cloned().collect();
        let tag = |name: &String| {
            let found = program.tags.find(|tag| tag == name);
            found.ok_or_else(|| unknown("tag", &world.name, name, &tag_names))
        };
        let tags = match &choice.tags {
            Some(names) => names.iter().map(tag).collect::<Result<Vec<_>, _>>()?,
            None => {
                let tiles = world.spaces.iter().filter_map(|space| space.map.as_ref()).flat_map(|map| &map.kinds);
                let solids = world.spaces.iter().flat_map(|space| &space.solids);
                let sets = tiles.flat_map(|kind| kind.tags.iter().map(|tag| TagSet::of(*tag)));
                sets.chain(solids.map(|solid| solid.tags)).fold(TagSet::default(), TagSet::with).iter().collect()
            }
        };
        let entity_names: Vec<String> = program.entities.iter().map(|entity| entity.name.to_string()).collect();
        let entity = |name: &String| {
            let found = program.entity_named(name);
            found.ok_or_else(|| unknown("entity", &world.name, name, &entity_names))
        };
        let chosen: Vec<EntityId> = match &choice.entities {
            Some(names) => names.iter().map(entity).collect::<Result<_, _>>()?,
            None => program.entities.ids().filter(|id| world.slots.iter().any(|slot| slot.entity == *id)).collect(),
        };
        let place = |id: EntityId| chosen.iter().position(|other| *other == id);
        Ok(Planes {
            player,
            columns: choice.size.0,
            rows: choice.size.1,
            shown_tags: tags.iter().copied().collect(),
            tags,
            entities: program.entities.ids().map(place).collect(),
            shown: chosen.len(),
            spaces: grids(sim),
        })
    }

    /// Planes, rows and columns.
    pub fn shape(&self) -> [usize; 3] {
        [self.tags.len() + self.shown, self.rows, self.columns]
    }

    /// Writes the planes of a state, one after the other, each row by row from the top; all 0 without the player.
    pub(super) fn write<T: Sample>(&self, sim: &Simulator, state: &[u8], out: &mut [T]) {
        out.fill(T::of(0.0));
        let player = sim.instance(state, self.player);
        let space = player.space();
        let Some(grid) = self.spaces.get(space.index()).filter(|_| player.is_alive()) else { return };
        let (column, row) = grid.cell_at(player.position());
        let corner = (column - self.columns as i64 / 2, row - self.rows as i64 / 2);
        self.tiles(sim, state, grid, corner, out);
        let one = T::of(1.0);
        for solid in &sim.world().spaces[space].solids {
            for (plane, tag) in self.tags.iter().enumerate() {
                if solid.tags.meets(TagSet::of(*tag)) {
                    self.mark(grid, corner, solid.bounds, plane, one, out);
                }
            }
        }
        for instance in sim.instances(state).filter(|instance| instance.space() == space) {
            let entity = sim.world().slots[instance.slot()].entity;
            let Some(plane) = self.entities.get(entity.index()).copied().flatten() else { continue };
            let (at, plane) = (instance.position(), self.tags.len() + plane);
            let mut has_body = false;
            for (_, bounds) in instance.colliders() {
                has_body = true;
                self.mark(grid, corner, bounds.placed(at), plane, one, out);
            }
            if !has_body {
                self.mark(grid, corner, Bounds::new([at.0, at.1, 0.0, 0.0]), plane, one, out);
            }
        }
    }

    fn tiles<T: Sample>(&self, sim: &Simulator, state: &[u8], grid: &Grid, corner: (i64, i64), out: &mut [T]) {
        // What of the window is in the map; a map that repeats fills it.
        let inside = |axis: usize, corner: i64, size: usize, cells: i64| match grid.repeats[axis] {
            Some(_) => 0..size,
            None => ((-corner).clamp(0, size as i64) as usize)..((cells - corner).clamp(0, size as i64) as usize),
        };
        for y in inside(1, corner.1, self.rows, grid.rows) {
            let row = grid.wrapped(1, corner.1 + y as i64);
            for x in inside(0, corner.0, self.columns, grid.columns) {
                let cell = row * grid.columns as usize + grid.wrapped(0, corner.0 + x as i64);
                let tags = grid.tags.get(cell).copied().unwrap_or_default();
                if !tags.meets(self.shown_tags) {
                    continue;
                }
                if grid.breakable.get(cell).copied().flatten().is_some_and(|tile| sim.is_broken(state, tile)) {
                    continue;
                }
                for (plane, tag) in self.tags.iter().enumerate() {
                    if tags.meets(TagSet::of(*tag)) {
                        self.set(plane, x, y, T::of(1.0), out);
                    }
                }
            }
        }
    }

    /// Marks the cells that a rectangle overlaps, or for a point the cell in which it is.
    fn mark<T: Sample>(&self, grid: &Grid, corner: (i64, i64), of: Bounds, plane: usize, one: T, out: &mut [T]) {
        let range = |axis: usize, low: f64, high: f64, corner: i64, count: usize| {
            let cell = [grid.cell.0, grid.cell.1][axis];
            let first = (low / cell).floor() as i64;
            let last = if high > low { (high / cell).ceil() as i64 - 1 } else { first };
            match grid.repeats[axis] {
                Some(period) => (first, last.min(first.saturating_add(period - 1))),
                // What cannot be seen is not walked through.
                None => (first.max(corner - 1), last.min(corner + count as i64)),
            }
        };
        let (left, right) = range(0, of.left, of.right, corner.0, self.columns);
        let (bottom, top) = range(1, of.bottom, of.top, corner.1, self.rows);
        for row in bottom..=top {
            let Some(y) = grid.seen(1, row - corner.1, self.rows) else { continue };
            for column in left..=right {
                if let Some(x) = grid.seen(0, column - corner.0, self.columns) {
                    self.set(plane, x, y, one, out);
                }
            }
        }
    }

    fn set<T: Sample>(&self, plane: usize, x: usize, y: usize, value: T, out: &mut [T]) {
        let at = (plane * self.rows + self.rows - 1 - y) * self.columns + x;
        if let Some(out) = out.get_mut(at) {
            *out = value;
        }
    }
}

impl Grid {
    fn new(space: &Space) -> Grid {
        let Some(map) = &space.map else {
            let (tags, breakable) = (Vec::new(), Vec::new());
            return Grid { cell: (CELL, CELL), columns: 0, rows: 0, tags, breakable, repeats: [None; 2] };
        };
        let sets: Vec<TagSet> = map.kinds.iter().map(|kind| kind.tags.iter().copied().collect()).collect();
        let tags = map.cells.iter().map(|kind| sets.get(usize::from(*kind)).copied().unwrap_or_default()).collect();
        Grid {
            cell: map.tile,
            columns: map.columns as i64,
            rows: map.rows as i64,
            tags,
            breakable: Vec::new(),
            repeats: repeats(map, &space.periods),
        }
    }

    fn cell_at(&self, (x, y): (f64, f64)) -> (i64, i64) {
        // Far enough away nothing can be seen; a window around it has no cells beyond the numbers that there are.
        let along = |x: f64, cell: f64| ((x / cell).floor() as i64).clamp(-(1 << 40), 1 << 40);
        (along(x, self.cell.0), along(y, self.cell.1))
    }

    /// The column or row of the map for one that may be beyond its end.
    fn wrapped(&self, axis: usize, at: i64) -> usize {
        self.repeats[axis].map_or(at, |period| at.rem_euclid(period)) as usize
    }

    /// Where in a window of a size something is, by the distance of its cell from the corner.
    fn seen(&self, axis: usize, way: i64, size: usize) -> Option<usize> {
        let way = self.repeats[axis].map_or(way, |period| way.rem_euclid(period));
        usize::try_from(way).ok().filter(|way| *way < size)
    }
}

/// After how many cells a space repeats along each axis, where that is a whole number of them.
fn repeats<T>(map: &TileMap<T>, periods: &[Option<Period>; 2]) -> [Option<i64>; 2] {
    let of = |axis: usize| {
        let (cells, cell) = [(map.columns, map.tile.0), (map.rows, map.tile.1)][axis];
        periods[axis].filter(|p| p.low == 0.0 && p.size() == cells as f64 * cell).map(|_| cells as i64)
    };
    [of(0), of(1)]
}

fn grids(sim: &Simulator) -> Vec<Grid> {
    let spaces = &sim.world().spaces;
    let mut grids: Vec<Grid> = spaces.iter().map(Grid::new).collect();
    for (tile, (space, cell)) in BreakableTiles::of(spaces).places.pairs() {
        let grid: &mut Grid = &mut grids[SpaceId::index(*space)];
        if grid.breakable.is_empty() {
            grid.breakable.resize(grid.tags.len(), None);
        }
        grid.breakable[*cell as usize] = Some(tile);
    }
    grids
}

fn unknown(kind: &str, world: &str, name: &str, known: &[String]) -> NoQuestion {
    let name = if name.is_empty() { String::new() } else { format!(" `{name}`") };
    let list: Vec<String> = known.iter().take(24).map(|known| format!("`{known}`")).collect();
    NoQuestion {
        why: format!("no {kind}{name} in `{world}`"),
        near: similar(name.trim_matches([' ', '`']), known.iter().map(String::as_str)),
        help: (!list.is_empty()).then(|| format!("there is {}", list.join(", "))),
    }
}
