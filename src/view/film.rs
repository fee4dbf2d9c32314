//! Pictures of the states of a run for an animation: a camera on one space, which follows the first player where the
//! space is larger than the picture.

use std::collections::BTreeSet;

use crate::ir::{Bounds, Collider, Extremes, Look, PlayerId, Program, SpaceId, TagSet, World};
use crate::ordered::Ordered;
use crate::sim::{Instance, Simulator};

use super::appearance::{Appearance, Appearances, Role, for_players};
use super::body::{Body, outline, pushes};
use super::canvas::{Area, Canvas, Paint};
use super::extent::{Visits, content};
use super::frame::{moved, shared};
use super::goal::{Form, Goal};
use super::look::Images;
use super::palette::{self, Scheme};
use super::route::drawn;
use super::track::Part;

/// Size of a picture if none is asked for, and the largest scale then, in pixels.
const TARGET: (f64, f64) = (640.0, 480.0);
const MAX_SCALE: u32 = 4;
/// The scale at which large rooms are shown in part.
const CAMERA_SCALE: u32 = 2;
/// The part of the picture, from its middle, in which the player moves before the camera does.
const CALM: f64 = 1.0 / 8.0;

/// What an animation looks like.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct FilmOptions {
    /// Pixels of the picture for each px of the game.
    pub scale: Option<u32>,
    /// Width and height of the picture in pixels; smaller if all rooms are.
    pub size: Option<(u32, u32)>,
    /// With dark colours.
    pub is_dark: bool,
}

/// Where the players of a run are: an animation shows so much of each space.
#[derive(Debug, Clone)]
pub struct PlayerArea(Vec<Option<Bounds>>);

impl PlayerArea {
    /// Before the first state.
    pub fn new(sim: &Simulator) -> PlayerArea {
        PlayerArea(vec![None; sim.world().spaces.len()])
    }

    /// Adds a state.
    pub fn observe(&mut self, sim: &Simulator, state: &[u8]) {
        for player in sim.world().players.iter() {
            let instance = sim.instance(state, player.slot);
            let (x, y) = instance.position();
            let [x, y] = drawn(sim.world(), instance.space(), [x, y]);
            let Some(area) = self.0.get_mut(instance.space().0 as usize).filter(|_| instance.is_alive()) else {
                continue;
            };
            let body = instance.colliders().map(|(_, bounds)| moved(bounds, [x, y]));
            *area = body.chain([Bounds::new([x, y, 0.0, 0.0])]).chain(*area).reduce(Bounds::join);
        }
    }
}

/// Paints states of a world.
pub struct Film<'s> {
    sim: &'s Simulator,
    scale: f64,
    scheme: Scheme,
    appearances: Appearances,
    goals: Vec<Goal>,
    images: &'s Images,
    /// For each space what there is to see.
    extents: Vec<Bounds>,
    canvas: Canvas,
    camera: Option<Camera>,
    /// The goals that held in a painted state.
    reached: BTreeSet<usize>,
}

/// What the picture shows.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Camera {
    space: SpaceId,
    /// Its middle, px.
    at: [f64; 2],
}

impl<'s> Film<'s> {
    /// For a world. The size of its pictures never changes.
    pub fn new(sim: &'s Simulator, options: FilmOptions, images: &'s Images, players: &PlayerArea) -> Film<'s> {
        let (program, world): (&Program, &World) = (sim.program(), sim.world());
        let hero = world.players.get(PlayerId(0)).map(|player| player.slot);
        let body = hero.map(|hero| Body::new(program, world, hero)).unwrap_or_default();
        let goals: Vec<Goal> = world.goals.iter().map(|goal| Goal::new(program, world, goal, body.middle())).collect();
        let wanted = goals.iter().map(|goal| goal.tags).fold(TagSet::default(), TagSet::with);
        let visits =
            |id: SpaceId| Visits { path: players.0.get(id.0 as usize).copied().flatten(), ..Visits::default() };
        let extents: Vec<Bounds> = world.spaces.ids().map(|id| content(program, world, id, &visits(id), 0.0)).collect();
        let largest = |side: fn(&Bounds) -> f64| extents.iter().map(side).fold(1.0, f64::greatest);
        let (width, height) = (largest(|b| b.right - b.left), largest(|b| b.top - b.bottom));
        let most = options.size.map_or(TARGET, |(width, height)| (f64::from(width), f64::from(height)));
        let fits = |scale: u32| width * f64::from(scale) <= most.0 && height * f64::from(scale) <= most.1;
        let scale =
            options.scale.unwrap_or_else(|| (1..=MAX_SCALE).rev().find(|&scale| fits(scale)).unwrap_or(CAMERA_SCALE));
        let scale = f64::from(scale.max(1));
        let side = |length: f64, most: f64| (length * scale).ceil().least(most).greatest(1.0) as usize;
        let scheme = Scheme::new(options.is_dark);
        Film {
            sim,
            scale,
            scheme,
            appearances: Appearances::new(program, sim.world_id(), wanted),
            goals,
            images,
            extents,
            canvas: Canvas::new(side(width, most.0), side(height, most.1), scheme.air),
            camera: None,
            reached: BTreeSet::new(),
        }
    }

    /// Width and height of its pictures, in pixels.
    pub fn size(&self) -> (usize, usize) {
        (self.canvas.width(), self.canvas.height())
    }

    /// Begins anew: the camera has not seen a state yet.
    pub fn restart(&mut self) {
        self.camera = None;
        self.reached.clear();
    }

    /// Paints a state.
    pub fn paint(&mut self, state: &[u8]) -> &Canvas {
        let world = self.sim.world();
        self.follow(state);
        let holds = world.goals.pairs().filter(|(_, goal)| self.sim.holds(state, goal.holds) == Ok(true));
        self.reached.extend(holds.map(|(id, _)| id.0 as usize));
        let Some(camera) = self.camera else { return &self.canvas };
        let view = self.view(camera);
        let place = Place { view, scale: self.scale };
        self.canvas.clear(self.scheme.paper);
        self.canvas.fill(place.area(shared(view, self.room(camera))), self.scheme.air);
        self.goals(place, camera.space, false);
        self.level(place, camera.space, state);
        self.goals(place, camera.space, true);
        let mut instances: Vec<Instance<'_>> =
            self.sim.instances(state).filter(|instance| instance.space() == camera.space).collect();
        // Players are in front.
        instances.order_by_key(|instance| world.slots[instance.slot()].player.is_some());
        for instance in instances {
            self.instance(place, instance);
        }
        if !self.reached.is_empty() {
            let (width, height) = (self.canvas.width() as f64, self.canvas.height() as f64);
            self.canvas.border([0.0, 0.0, width, height], 3.0, None, self.scheme.reached);
        }
        &self.canvas
    }

    /// Moves the camera to where the first player is.
    fn follow(&mut self, state: &[u8]) {
        let world = self.sim.world();
        let hero = world.players.get(PlayerId(0)).map(|player| self.sim.instance(state, player.slot));
        let (width, height) = (self.canvas.width() as f64 / self.scale, self.canvas.height() as f64 / self.scale);
        let (space, target) = match hero.filter(|hero| hero.is_alive()) {
            Some(hero) => {
                let (x, y) = hero.position();
                (hero.space(), drawn(world, hero.space(), [x, y]))
            }
            None if self.camera.is_some() => return,
            None => {
                let all = self.extents.first().copied().unwrap_or(Bounds::new([0.0; 4]));
                (SpaceId(0), [(all.left + all.right) / 2.0, (all.bottom + all.top) / 2.0])
            }
        };
        let calm = [width * CALM, height * CALM];
        let last = self.camera.filter(|camera| {
            // After a jump the camera begins anew.
            camera.space == space && (0..2).all(|axis| (camera.at[axis] - target[axis]).abs() < [width, height][axis])
        });
        let at = [0, 1].map(|axis| match last {
            Some(camera) => camera.at[axis].clamp(target[axis] - calm[axis], target[axis] + calm[axis]),
            None => target[axis],
        });
        let room = self.extents.get(space.0 as usize).copied().unwrap_or(Bounds::new([0.0; 4]));
        let within = |at: f64, low: f64, high: f64, size: f64| {
            if high - low <= size { (low + high) / 2.0 } else { at.clamp(low + size / 2.0, high - size / 2.0) }
        };
        let at = match world.spaces.get(space).and_then(|space| space.extent()) {
            Some(_) => [within(at[0], room.left, room.right, width), within(at[1], room.bottom, room.top, height)],
            None => at,
        };
        self.camera = Some(Camera { space, at });
    }

    fn room(&self, camera: Camera) -> Bounds {
        let world = self.sim.world();
        match world.spaces.get(camera.space).and_then(|space| space.extent()) {
            Some(_) => self.extents[camera.space.0 as usize],
            // Without a border everything is inside.
            None => self.view(camera),
        }
    }

    /// What the camera shows, from whole pixel to whole pixel.
    fn view(&self, camera: Camera) -> Bounds {
        let (width, height) = (self.canvas.width() as f64 / self.scale, self.canvas.height() as f64 / self.scale);
        let whole = |x: f64| (x * self.scale).round() / self.scale;
        Bounds::new([whole(camera.at[0] - width / 2.0), whole(camera.at[1] - height / 2.0), width, height])
    }

    /// Paints tiles, free-standing geometry and links.
    fn level(&mut self, place: Place, id: SpaceId, state: &[u8]) {
        let (sim, world) = (self.sim, self.sim.world());
        let space = &world.spaces[id];
        if let Some(map) = &space.map {
            let broken: BTreeSet<(usize, usize)> = sim
                .broken_tiles(state)
                .into_iter()
                .filter_map(|tile| sim.place_of_tile(tile))
                .filter(|(of, ..)| *of == id)
                .map(|(_, column, row)| (column, row))
                .collect();
            let kinds: Vec<Option<usize>> =
                map.kinds.iter().map(|kind| self.appearances.of(kind.tags.iter().copied().collect())).collect();
            let range = |low: f64, high: f64, tile: f64, count: usize| {
                ((low / tile).floor().greatest(0.0) as usize).min(count)
                    ..((high / tile).ceil().greatest(0.0) as usize).min(count)
            };
            for row in range(place.view.bottom, place.view.top, map.tile.1, map.rows) {
                for column in range(place.view.left, place.view.right, map.tile.0, map.columns) {
                    let kind = usize::from(map.cells[row * map.columns + column]);
                    let Some(appearance) = kinds[kind].filter(|_| !broken.contains(&(column, row))) else { continue };
                    let appearance = &self.appearances.list[appearance];
                    let area = place.area(Bounds::new(map.rectangle(row * map.columns + column)));
                    let paint = tile_paint(&self.scheme, appearance);
                    let image = appearance.look.as_ref().and_then(|look| self.images.image(look));
                    match (map.kinds[kind].slope, image) {
                        (None, Some(image)) => self.canvas.image(area, image, [0, 0, image.width, image.height]),
                        (Some(slope), _) => {
                            let top = |height: f64| area[3] - height * self.scale;
                            self.canvas.slope(area, (top(slope.left), top(slope.right)), paint);
                        }
                        (None, None) => self.canvas.fill(area, paint),
                    }
                    if appearance.role == Role::OneWay {
                        let lip = [area[0], area[1], area[2], area[1] + 1.5 * self.scale];
                        self.canvas.fill(lip, self.scheme.tile("lip"));
                    }
                    if map.kinds[kind].breakable.is_some() {
                        self.canvas.border(area, 1.0, Some(2), self.scheme.crack);
                    }
                }
            }
        }
        for solid in &space.solids {
            let appearance = self.appearances.of(solid.tags).map(|index| &self.appearances.list[index]);
            if let Some(appearance) = appearance {
                match appearance.look.as_ref().and_then(|look| self.images.image(look)) {
                    Some(image) => {
                        self.canvas.image(place.whole(solid.bounds), image, [0, 0, image.width, image.height]);
                    }
                    None => self.canvas.fill(place.area(solid.bounds), tile_paint(&self.scheme, appearance)),
                }
            }
        }
        for link in &space.links {
            self.canvas.fill(place.area(link.from), self.scheme.link.0);
            self.canvas.border(place.area(link.from), 1.0, Some(2), self.scheme.link.1);
        }
    }

    /// Paints the regions of goals: their areas, or their borders.
    fn goals(&mut self, place: Place, space: SpaceId, border: bool) {
        for (index, goal) in self.goals.iter().enumerate() {
            let paint = if self.reached.contains(&index) { self.scheme.reached } else { self.scheme.goal };
            for area in goal.areas.iter().filter(|area| area.space.is_none_or(|of| of == space)) {
                match area.form {
                    Form::Box(bounds) if border => self.canvas.border(place.area(bounds), 1.0, Some(3), paint),
                    Form::Box(bounds) => {
                        self.canvas.fill(place.area(bounds), Paint { opacity: 0.18 * paint.opacity, ..paint });
                    }
                    Form::Circle(center, radius) => {
                        let radius = radius * self.scale;
                        let (inner, opacity) = if border { (radius - 1.0, 1.0) } else { (0.0, 0.18) };
                        self.canvas.disc(place.point(center), radius, inner.greatest(0.0), Paint { opacity, ..paint });
                    }
                }
            }
        }
    }

    fn instance(&mut self, place: Place, instance: Instance<'_>) {
        let (program, world): (&Program, &World) = (self.sim.program(), self.sim.world());
        let (x, y) = instance.position();
        let at = drawn(world, instance.space(), [x, y]);
        let colliders = &instance.entity().colliders;
        let player = world.players.iter().position(|player| player.slot == instance.slot());
        let mut parts: Vec<_> = instance.colliders().map(|(id, bounds)| (&colliders[id], bounds)).collect();
        let look = program.look_of(self.sim.world_id(), instance.slot());
        if let Some(image) = look.and_then(|look| self.images.image(look)) {
            let part = |(collider, bounds): &(&Collider, Bounds)| Part {
                bounds: *bounds,
                round: collider.shape.is_round(),
                tags: collider.tags,
            };
            let shown = outline(world, &parts.iter().map(part).collect::<Vec<_>>());
            if let Some(whole) = shown.iter().map(|part| moved(part.bounds, at)).reduce(Bounds::join) {
                self.canvas.image(place.whole(whole), image, [0, 0, image.width, image.height]);
            }
            return;
        }
        // Sensors are drawn over bodies.
        parts.order_by_key(|(collider, _)| !pushes(world, collider.tags));
        let size = |b: &Bounds| (b.right - b.left) * (b.top - b.bottom);
        let body = parts
            .iter()
            .filter(|(collider, _)| pushes(world, collider.tags))
            .map(|(_, b)| size(b))
            .fold(0.0, f64::greatest);
        for (collider, bounds) in parts {
            let is_sensor = !pushes(world, collider.tags);
            // A sensor larger than the solid collider is a field of view.
            if is_sensor && body > 0.0 && size(&bounds) > body {
                continue;
            }
            let wanted =
                self.goals.iter().any(|goal| collider.tags.meets(goal.tags) || goal.slots.contains(&instance.slot()));
            let color = match (player, for_players(program, world, collider.tags)) {
                (Some(player), _) => self.scheme.players[player % palette::PLAYERS],
                (None, _) if wanted => self.scheme.asked,
                (None, Some(Role::Solid | Role::OneWay)) => self.scheme.block,
                (None, _) => self.scheme.thing,
            };
            let color = look.and_then(Look::rgb).map_or(color, |rgb| Paint { rgb, opacity: 1.0 });
            let area = place.area(moved(bounds, at));
            let is_outline = is_sensor && body > 0.0;
            // What has only sensors is seen by them.
            let inside = if is_sensor { Paint { opacity: 0.5, ..color } } else { color };
            let edge = if is_sensor { color } else { palette::edge(color) };
            let thick = (self.scale / 2.0).clamp(1.0, 2.0);
            if collider.shape.is_round() {
                let center = [(area[0] + area[2]) / 2.0, (area[1] + area[3]) / 2.0];
                let radius = (area[2] - area[0]) / 2.0;
                if !is_outline {
                    self.canvas.disc(center, radius, 0.0, inside);
                }
                self.canvas.disc(center, radius, (radius - thick).greatest(0.0), edge);
            } else if is_outline {
                self.canvas.border(area, thick, Some(2), edge);
            } else {
                self.canvas.fill(area, inside);
                self.canvas.border(area, thick, None, edge);
            }
        }
    }
}

/// The colour of tiles: that of their look, or that of their class.
fn tile_paint(scheme: &Scheme, appearance: &Appearance) -> Paint {
    let own = appearance.look.as_ref().and_then(Look::rgb);
    own.map_or_else(|| scheme.tile(appearance.class), |rgb| Paint { rgb, opacity: 1.0 })
}

/// The transformation from the game to pixels.
#[derive(Debug, Clone, Copy)]
struct Place {
    view: Bounds,
    scale: f64,
}

impl Place {
    fn point(self, [x, y]: [f64; 2]) -> [f64; 2] {
        [(x - self.view.left) * self.scale, (self.view.top - y) * self.scale]
    }

    /// A rectangle in pixels.
    fn whole(self, b: Bounds) -> Area {
        let ([left, top], [right, bottom]) = (self.point([b.left, b.top]), self.point([b.right, b.bottom]));
        [left, top, right, bottom]
    }

    /// A rectangle in pixels, cut a little outside of the picture.
    fn area(self, b: Bounds) -> Area {
        let around = Bounds {
            left: b.left.greatest(self.view.left - 64.0),
            right: b.right.least(self.view.right + 64.0),
            bottom: b.bottom.greatest(self.view.bottom - 64.0),
            top: b.top.least(self.view.top + 64.0),
        };
        self.whole(around)
    }
}
