//! What is measured by the maps of a world: its rectangles, and the places of its instances.

use crate::diagnostic::catalogue::types::{OutOfRange, TypeMismatch};
use crate::diagnostic::catalogue::world::NoPlaceAbove;
use crate::ir::{Id, SpaceId, TagId, TileMap};
use crate::source::Span;
use crate::syntax::ast::{self, Name, PathRef};
use crate::syntax::occurrence::NameKind;

use super::Checker;
use super::checked::{Term, TermKind, Type};
use super::constant::ConstantContext;
use super::expression::Scope;
use super::names::unknown;

/// The size of a space with a map, px.
#[derive(Debug, Clone, Copy)]
pub(super) struct MapSize {
    pub width: f64,
    pub height: f64,
    /// Whether the map could be read. A world with a missing or wrong map is checked, but not run: its size does not
    /// matter.
    pub is_known: bool,
}

impl MapSize {
    pub fn of(map: Option<&TileMap<TagId>>) -> Self {
        let (width, height) = map.map_or((0.0, 0.0), TileMap::size);
        MapSize { width, height, is_known: map.is_some() }
    }
}

/// A space in which something is placed.
pub(super) struct Room<'s> {
    /// All spaces of the world.
    pub spaces: &'s [(Name, Option<MapSize>)],
    pub id: SpaceId,
    /// Its map, if it could be read.
    pub map: Option<&'s TileMap<TagId>>,
}

impl Room<'_> {
    /// A space by which nothing is measured.
    pub const UNKNOWN: Room<'static> = Room { spaces: &[], id: SpaceId(0), map: None };
}

impl Checker<'_> {
    /// `level.width`, `level.height`.
    pub(super) fn measure(
        &mut self,
        (declared, size): &(Name, Option<MapSize>),
        path: &PathRef<'_>,
        first: &Name,
        second: &Name,
        span: Span,
    ) -> Option<Term> {
        self.unprimed(path)?;
        self.record_use(NameKind::Space, first.span, declared.span);
        let Some(size) = size else {
            self.diagnostics.report(TypeMismatch {
                at: span,
                found: "a space without a map".into(),
                expected: "a space with a map".into(),
                help: Some("the size of a space is the size of its map".into()),
            });
            return None;
        };
        let value = match &*second.text {
            "width" => size.width,
            "height" => size.height,
            other => {
                let fact = unknown("measure of a space", other, second.span, ["width", "height"]);
                self.report_unknown(fact);
                return None;
            }
        };
        self.reads_unknown_size |= !size.is_known;
        Some(Term { kind: TermKind::Number(value), ty: Type::Real, span })
    }

    /// The value of a coordinate; 0 if it is measured by a map that is missing.
    pub(super) fn measured(&mut self, term: &Term, constants: ConstantContext<'_>, at: Span) -> Option<f64> {
        if std::mem::take(&mut self.reads_unknown_size) {
            return Some(0.0);
        }
        self.evaluated(term, constants).and_then(|value| self.length(value, at))
    }

    /// A rectangle with constant sides, px; none if it is measured by a map that is missing.
    pub(super) fn rectangle(
        &mut self,
        r: &ast::Rectangle,
        spaces: &[(Name, Option<MapSize>)],
        lengths: &mut Vec<Term>,
    ) -> Option<[f64; 4]> {
        let scope = Scope::measured(spaces);
        let mut known = [None; 4];
        for (index, (slot, e)) in known.iter_mut().zip(r.sides.iter()).enumerate() {
            let Some(term) = self.number(e, &scope) else { continue };
            let is_unknown = std::mem::take(&mut self.reads_unknown_size);
            *slot = self.evaluated(&term, ConstantContext::LITERALS).filter(|_| !is_unknown);
            lengths.push(term);
            if index >= 2
                && let Some(value) = slot.filter(|v| *v <= 0.0)
            {
                *slot = None;
                self.diagnostics.report(OutOfRange {
                    at: e.span,
                    what: format!("a side of {value} px"),
                    range: "what is above 0 px".into(),
                });
            }
            *slot = slot.and_then(|value| self.length(value, e.span));
        }
        let [x, y, width, height] = known;
        Some([x?, y?, width?, height?])
    }

    /// `above tag`: the upper edge of the lowest tile with the tag over which there is room, below what is as wide as a
    /// tile and begins at `x`; 0 if the map is missing.
    pub(super) fn above(&mut self, tag: &Name, x: Option<f64>, room: &Room<'_>) -> Option<f64> {
        let asked = self.tag(tag);
        let (name, size) = room.spaces.get(room.id.index())?;
        let Some(map) = room.map else {
            if size.is_none() {
                self.diagnostics.report(NoPlaceAbove {
                    at: tag.span,
                    tag: tag.text.to_string(),
                    space: name.text.to_string(),
                    x: None,
                });
            }
            return size.map(|_| 0.0);
        };
        let x = x?;
        let found = lowest_above(map, asked, x);
        if found.is_none() {
            let (at, tag, space) = (tag.span, tag.text.to_string(), name.text.to_string());
            self.diagnostics.report(NoPlaceAbove { at, tag, space, x: Some(x) });
        }
        found
    }
}

/// The height of the lowest place above tiles with a tag, for what is as wide as a tile and begins at `x`.
fn lowest_above(map: &TileMap<TagId>, tag: TagId, x: f64) -> Option<f64> {
    let (width, height) = map.tile;
    let first = (x / width).floor();
    let last = if first * width == x { first } else { first + 1.0 };
    let columns = first as i64..=last as i64;
    let has =
        |row: i64| columns.clone().filter_map(|c| map.kind(c, row)).any(|kind| map.kinds[kind].tags.contains(&tag));
    let row = (1..=map.rows as i64).find(|row| has(row - 1) && !has(*row))?;
    Some(row as f64 * height)
}
