//! A program as named parts, from its syntax trees: what a change is told by. Comments, layout, looks, tests and the rows of
//! maps are left out.

use std::path::Path;

use crate::source::{Files, SourceMap, Span, code_on_one_line};
use crate::syntax::ast::{
    Assignment, Constant, Domain, Edge, Entity, File, Initial, Item, Map, MapSource, Member, Mode, Name, Place, Space,
    SpaceItem, Tile, Tiles, Update, World, WorldItem, Wrap,
};
use crate::syntax::{self, Unshared};

/// A named part of a program.
#[derive(Debug, Clone, PartialEq)]
pub struct Part {
    /// What it is: `param`, `mode`, `edge`.
    pub kind: &'static str,
    /// Its name within the part around it.
    pub name: String,
    /// What it says, on one line; parts inside are left out.
    pub text: String,
    /// Where it is, such as `game.hyped:12`.
    pub place: String,
    /// The parts inside.
    pub parts: Vec<Part>,
}

impl Part {
    /// Whether two parts say the same, wherever they are.
    pub fn is_same(&self, other: &Part) -> bool {
        (self.kind, &self.name) == (other.kind, &other.name) && self.says_the_same(other)
    }

    /// Whether two parts say the same, whatever their names are.
    pub fn says_the_same(&self, other: &Part) -> bool {
        self.text == other.text
            && self.parts.len() == other.parts.len()
            && self.parts.iter().zip(&other.parts).all(|(a, b)| a.is_same(b))
    }
}

/// The parts of a file and of all that it imports. What cannot be read is left out: a program that compiles has no
/// such parts.
pub fn outline(root: &Path, files: &dyn Files) -> Vec<Part> {
    let mut sources = SourceMap::new();
    let (trees, _) = syntax::load(root, (files, &Unshared), &mut sources);
    let reader = Reader { sources: &sources };
    trees.iter().flat_map(|tree| reader.file(tree)).collect()
}

/// Reads parts from trees.
struct Reader<'s> {
    sources: &'s SourceMap,
}

impl Reader<'_> {
    /// A text on one line, without comments.
    fn text(&self, span: Span) -> String {
        code_on_one_line(self.sources.slice(span))
    }

    fn part(&self, kind: &'static str, name: impl Into<String>, text: String, at: Span) -> Part {
        let file = self.sources.file(at.file());
        let (line, _) = file.line_column(at.start() as usize);
        let place = format!("{}:{line}", file.path.display());
        Part { kind, name: name.into(), text, place, parts: Vec::new() }
    }

    /// A part of which the whole text counts.
    fn whole(&self, kind: &'static str, name: impl Into<String>, at: Span) -> Part {
        self.part(kind, name, self.text(at), at)
    }

    fn file(&self, tree: &File) -> Vec<Part> {
        let part = |item: &Item| {
            Some(match item {
                Item::Import(_) => return None,
                Item::Constant(constant) => self.number("const", constant),
                Item::Entity(entity) => self.entity(entity),
                Item::Behavior(behavior) => Part {
                    parts: self.members(&behavior.members),
                    ..self.part("behavior", word(&behavior.name), words(&behavior.parameters), behavior.name.span)
                },
                Item::World(world) => self.world(world),
            })
        };
        tree.items.iter().filter_map(part).collect()
    }

    fn number(&self, kind: &'static str, constant: &Constant) -> Part {
        let dimension = constant.dimension.as_ref().map(|dimension| format!("{}: ", self.text(dimension.span)));
        let text = format!("{}{}", dimension.unwrap_or_default(), self.text(constant.value.span));
        self.part(kind, word(&constant.name), text, constant.name.span)
    }

    fn entity(&self, entity: &Entity) -> Part {
        let part = self.part("entity", word(&entity.name), String::new(), entity.name.span);
        Part { parts: self.members(&entity.members), ..part }
    }

    fn members(&self, members: &[Member]) -> Vec<Part> {
        members.iter().flat_map(|member| self.member(member)).collect()
    }

    fn member(&self, member: &Member) -> Vec<Part> {
        let each = |kind, names: &[Name]| -> Vec<Part> {
            names.iter().map(|name| self.part(kind, word(name), String::new(), name.span)).collect()
        };
        let one = match member {
            Member::Buttons(of) => return each("button", &of.0),
            Member::Axes(of) => return each("axis", &of.0),
            Member::Signals(of) => {
                return of.0.iter().map(|signal| self.whole("signal", word(&signal.name), signal.span)).collect();
            }
            Member::Look(_) => return Vec::new(),
            Member::Parameter(constant) => self.number("param", constant),
            Member::Continuous(of) => {
                let text = of.initial.as_ref().map_or("0".to_string(), |initial| self.text(initial.span));
                self.part("variable", word(&of.name), text, of.name.span)
            }
            Member::Discrete(of) => {
                let domain = match &of.domain {
                    Domain::Int(low, high) => format!("int {}..{}", self.text(low.span), self.text(high.span)),
                    Domain::Bool => "bool".to_string(),
                    Domain::Set(names) => format!("{{{}}}", words(names)),
                };
                let text = format!("{domain} = {}", self.text(of.initial.span));
                self.part("discrete", word(&of.name), text, of.name.span)
            }
            Member::Chance(of) => {
                let text = format!("{}..{}", self.text(of.low.span), self.text(of.high.span));
                self.part("chance", word(&of.name), text, of.span)
            }
            Member::Collider(of) => {
                let whole = self.text(of.span);
                let text = whole.split_once(':').map_or(whole.as_str(), |(_, shape)| shape.trim());
                let kinematic = if of.kinematic { "kinematic " } else { "" };
                self.part("collider", words(&of.tags), format!("{kinematic}{text}"), of.span)
            }
            Member::Group(of) => {
                let part = self.part("group", word(&of.name), String::new(), of.span);
                Part { parts: self.members(&of.members), ..part }
            }
            Member::Mode(mode) => self.mode(mode),
            Member::Flow(of) => self.assignment("flow", of),
            Member::Reference(of) => self.part("ref", word(&of.name), word(&of.entity), of.name.span),
            Member::Clamp(of) => self.whole("clamp", self.text(of.variable.span), of.span),
            Member::Invariant(of) => {
                self.part("invariant", self.text(of.predicate.span), String::new(), of.predicate.span)
            }
            Member::Condition(of) => self.part("condition", word(&of.name), self.text(of.value.span), of.span),
            Member::Entry(update) => self.entry(update),
            Member::Edge(edge) => self.edge(edge),
            Member::Envelope(of) => {
                let controlled: Vec<String> = of.controlled.iter().map(|variable| self.text(variable.span)).collect();
                self.whole("envelope", controlled.join(", "), of.span)
            }
            Member::Follow(of) => self.whole("follow", "links", of.span),
            Member::Use(of) => self.whole("use", word(&of.behavior), of.span),
        };
        vec![one]
    }

    fn assignment(&self, kind: &'static str, of: &Assignment) -> Part {
        self.part(kind, self.text(of.variable.span), self.text(of.value.span), of.span())
    }

    fn mode(&self, mode: &Mode) -> Part {
        let initial = match &mode.initial {
            Initial::Always | Initial::No => String::new(),
            Initial::Plain => "initial".to_string(),
            Initial::When(guard) => format!("initial when {}", self.text(guard.span)),
        };
        let part = self.part("mode", word(&mode.name), initial, mode.span);
        Part { parts: self.members(&mode.members), ..part }
    }

    fn entry(&self, update: &Update) -> Part {
        match update {
            Update::Assign(of) => self.whole("entry", self.text(of.variable.span), of.span()),
            Update::Spawn(of) => self.whole("entry", format!("spawn {}", word(&of.entity)), of.span),
            Update::Destroy(of) => self.whole("entry", "destroy", of.span),
            Update::Send(of) => self.whole("entry", format!("send {}", word(&of.signal)), of.span),
        }
    }

    fn edge(&self, edge: &Edge) -> Part {
        let name =
            edge.target.as_ref().map_or("(stays)".to_string(), |target| format!("-> {}", self.text(target.span())));
        self.whole("edge", name, edge.span)
    }

    fn world(&self, world: &World) -> Part {
        let part = self.part("world", word(&world.name), String::new(), world.name.span);
        Part { parts: world.items.iter().filter_map(|item| self.world_item(item)).collect(), ..part }
    }

    fn world_item(&self, item: &WorldItem) -> Option<Part> {
        Some(match item {
            WorldItem::Look(_) | WorldItem::Test(_) => return None,
            WorldItem::Step(of) => self.part("step", "", self.text(of.span), of.span),
            WorldItem::Collide(of) => {
                let name = format!("{} with {}", words(&of.left), words(&of.right));
                self.part("collide", name, self.text(of.response.span), of.span)
            }
            WorldItem::Tiles(tiles) => self.tiles(tiles),
            WorldItem::Space(space) => self.space(space),
            WorldItem::Limit(of) => self.part("limit", word(&of.entity), self.text(of.count.span), of.span),
            WorldItem::Player(of) => self.part("player", word(&of.number), word(&of.instance), of.span),
            WorldItem::Condition(of) => self.part("condition", word(&of.name), self.text(of.value.span), of.span),
            WorldItem::Goal(of) => self.part("goal", word(&of.name), self.text(of.predicate.span), of.name.span),
            WorldItem::Never(of) => self.part("never", word(&of.name), self.text(of.predicate.span), of.name.span),
        })
    }

    fn tiles(&self, tiles: &Tiles) -> Part {
        let size = format!("{} x {}", self.text(tiles.width.span), self.text(tiles.height.span));
        let part = self.part("tiles", word(&tiles.name), size, tiles.span);
        Part { parts: tiles.tiles.iter().map(|tile| self.tile(tile)).collect(), ..part }
    }

    fn tile(&self, tile: &Tile) -> Part {
        let mut words = vec![words(&tile.tags)];
        words.extend(tile.slope.as_ref().map(|slope| self.text(slope.span)));
        words.extend(tile.breakable.as_ref().map(|breakable| self.text(breakable.span)));
        words.extend(tile.spawn.as_ref().map(|spawn| self.text(spawn.whole)));
        words.retain(|word| !word.is_empty());
        self.part("tile", format!("'{}'", tile.symbol), words.join(" "), tile.symbol_span)
    }

    fn space(&self, space: &Space) -> Part {
        let part = self.part("space", word(&space.name), String::new(), space.name.span);
        Part { parts: space.items.iter().map(|item| self.space_item(item)).collect(), ..part }
    }

    fn space_item(&self, item: &SpaceItem) -> Part {
        match item {
            SpaceItem::Map(map) => self.map(map),
            SpaceItem::Link(of) => self.whole("link", format!("to {}", word(&of.space)), of.span),
            SpaceItem::Place(place) => self.place(place),
            SpaceItem::Solid(of) => self.whole("rect", words(&of.tags), of.rectangle.span),
            SpaceItem::Bounds(of) => self.whole("bounds", "", of.span),
            SpaceItem::Wrap(Wrap { is_vertical, span }) => {
                self.part("wrap", if *is_vertical { "vertical" } else { "horizontal" }, String::new(), *span)
            }
        }
    }

    fn map(&self, map: &Map) -> Part {
        // The rows are compared as tiles.
        let text = match &map.source {
            MapSource::Inline(tiles, _) => word(tiles),
            _ => self.text(map.span),
        };
        self.part("map", "", text, map.span)
    }

    fn place(&self, place: &Place) -> Part {
        let whole = self.text(place.span);
        let text = whole.split_once(':').map_or(whole.as_str(), |(_, rest)| rest.trim());
        self.part("place", word(&place.name), text.to_string(), place.name.span)
    }
}

fn word(name: &Name) -> String {
    name.text.to_string()
}

fn words(names: &[Name]) -> String {
    names.iter().map(word).collect::<Vec<_>>().join(", ")
}
