//! Moves a part of a syntax tree: when the text before it changes, all its spans do. [`reparse`](super::reparse) takes
//! parts of an older tree so.

use std::sync::Arc;

use crate::source::{FileId, Span};

use super::ast::{
    Appearance, Assignment, Behavior, Breakable, Call, Chance, Clamp, Collide, Collider, Condition, Constant,
    Continuous, Destroy, Dimension, Discrete, Domain, Dotted, Each, Edge, Entity, Envelope, Expect, Expr, ExprKind,
    Follow, Group, Import, Initial, Invariant, Item, Kind, Kinds, Legend, Limit, Link, Look, Map, MapSource, Member,
    Mode, Moment, Name, Nearest, Path, Place, PlaceHeight, Player, Question, Ramp, RampKind, Rate, Receivers,
    Rectangle, Reference, Response, Search, Seed, Send, Signal, Slope, Solid, Space, SpaceItem, Spawn, TagLook, Test,
    TestInputs, TestItem, Tile, TileSpawn, Tiles, Update, Use, Variable, Without, World, WorldItem, Wrap,
};

/// Where a part of a text is now.
#[derive(Clone, Copy)]
pub(super) struct Shift {
    pub file: FileId,
    /// Bytes towards the end of the text.
    pub by: isize,
}

/// A part of a tree that can be moved.
pub(super) trait Moved {
    fn moved(&mut self, shift: Shift);
}

impl Moved for Span {
    fn moved(&mut self, shift: Shift) {
        let std::ops::Range { start, end } = self.range();
        *self = Span::new(shift.file, start.saturating_add_signed(shift.by), end.saturating_add_signed(shift.by));
    }
}

impl<T: Moved + ?Sized> Moved for Box<T> {
    fn moved(&mut self, shift: Shift) {
        (**self).moved(shift);
    }
}

impl<T: Moved + Clone> Moved for Arc<T> {
    fn moved(&mut self, shift: Shift) {
        Arc::make_mut(self).moved(shift);
    }
}

impl<T: Moved> Moved for [T] {
    fn moved(&mut self, shift: Shift) {
        self.iter_mut().for_each(|part| part.moved(shift));
    }
}

impl<T: Moved, const N: usize> Moved for [T; N] {
    fn moved(&mut self, shift: Shift) {
        self.as_mut_slice().moved(shift);
    }
}

impl<T: Moved> Moved for Vec<T> {
    fn moved(&mut self, shift: Shift) {
        self.as_mut_slice().moved(shift);
    }
}

impl<T: Moved> Moved for Option<T> {
    fn moved(&mut self, shift: Shift) {
        self.iter_mut().for_each(|part| part.moved(shift));
    }
}

impl<A: Moved, B: Moved> Moved for (A, B) {
    fn moved(&mut self, shift: Shift) {
        self.0.moved(shift);
        self.1.moved(shift);
    }
}

/// Parts without a place.
macro_rules! placeless {
    ($($type:ty),* $(,)?) => {
        $(impl Moved for $type {
            fn moved(&mut self, _: Shift) {}
        })*
    };
}

placeless!(bool, u8, u32, i32, char, f64, String, str, super::ast::Word, super::ast::CompareOp);

/// Structs, with all their fields: a field that is added must be listed here.
macro_rules! structs {
    ($($type:ident { $($field:ident),* $(,)? })*) => {
        $(impl Moved for $type {
            fn moved(&mut self, shift: Shift) {
                let $type { $($field),* } = self;
                $($field.moved(shift);)*
            }
        })*
    };
}

structs! {
    Name { text, span }
    Import { path }
    Constant { name, dimension, value, doc }
    Dimension { factors, span }
    Entity { name, members, reads_start, doc, span }
    Behavior { name, parameters, members, reads_start, doc, span }
    Use { behavior, arguments, span }
    Chance { name, low, high, span }
    Reference { name, entity }
    Clamp { variable, low, high, span }
    Invariant { predicate, span }
    Condition { name, value, span }
    Signal { name, number, span }
    Follow { guard, updates, span }
    Continuous { name, dimension, initial }
    Discrete { name, domain, initial }
    Collider { kinematic, tags, shape, arguments, guard, span }
    Group { name, members, span }
    Mode { initial, name, members, doc, span }
    Spawn { into, entity, settings, span }
    Destroy { what, span }
    Send { to, signal, number, span }
    Edge { guard, target, updates, is_empty, span }
    Envelope { controlled, by, directions, ramps, complete, span }
    Ramp { kind, span }
    Expr { kind, span }
    Call { function, arguments, binding }
    Each { is_all, path }
    Nearest { entity, mode, within, binding }
    Dotted { segments, primes, span }
    Variable { text, primes, span }
    World { name, items, doc, span }
    Collide { left, right, response, span }
    Response { block, from_above, keep_velocity, carry, bounce, span }
    Tiles { name, width, height, tiles, span }
    Tile { symbol, symbol_span, tags, slope, breakable, spawn }
    Slope { ends, span }
    Breakable { restore, span }
    TileSpawn { entity, name, settings, span, whole }
    Look { appearance, span }
    TagLook { tags, appearance, span }
    Limit { entity, count, span }
    Space { name, items, span }
    Wrap { is_vertical, span }
    Solid { tags, rectangle }
    Rectangle { sides, span }
    Link { from, space, to, guard, span }
    Map { source, span }
    Kinds { tiles, kinds }
    Kind { name, tags, slope, breakable, spawn }
    Legend { path, width, height, tiles, span }
    Place { name, entity, x, y, settings, span }
    Player { number, instance, span }
    Question { name, predicate }
    Test { name, items, is_broken, span }
    TestInputs { text, is_file, span }
    Seed { number, span }
    Expect { predicate, moment, span }
    Search { kind, predicate, without, within, span }
    Without { is_needed, predicate }
}

placeless!(super::ast::SearchKind);

/// Enums, with the number of parts of each variant.
macro_rules! enums {
    ($($type:ident { $($variant:ident $(($($part:ident),*))?),* $(,)? })*) => {
        $(impl Moved for $type {
            fn moved(&mut self, shift: Shift) {
                match self {
                    $($type::$variant $(($($part),*))? => { $($($part.moved(shift);)*)? })*
                }
            }
        })*
    };
}

enums! {
    Item { Import(a), Constant(a), Entity(a), Behavior(a), World(a) }
    Member {
        Parameter(a), Continuous(a), Discrete(a), Buttons(a), Axes(a), Chance(a), Collider(a), Group(a), Mode(a),
        Flow(a), Reference(a), Clamp(a), Invariant(a), Condition(a), Signals(a), Look(a), Entry(a), Edge(a),
        Envelope(a), Follow(a), Use(a),
    }
    Domain { Int(a, b), Bool, Set(a) }
    Initial { Always, No, Plain, When(a) }
    Update { Assign(a), Spawn(a), Destroy(a), Send(a) }
    Receivers { One(a), All(a) }
    RampKind { Attack(a, b), Decay(a), Sustain(a), SustainFor(a), Release(a, b), ReleaseHold, While(a) }
    Rate { Instant, Accel(a), Over(a) }
    Path { Name(a, b, c), Dotted(a) }
    WorldItem {
        Step(a), Collide(a), Tiles(a), Space(a), Limit(a), Look(a), Player(a), Condition(a), Goal(a), Never(a), Test(a),
    }
    Appearance { Color(a), Picture(a) }
    SpaceItem { Map(a), Link(a), Place(a), Solid(a), Bounds(a), Wrap(a) }
    MapSource {
        Inline(a, b), Text(a, b), Vglc(a, b), Open(a), OpenLegend(a), Tiled(a, b), Ldtk(a, b, c), OpenAll(a),
    }
    TestItem { Inputs(a), Seed(a), Expect(a), Search(a) }
    Moment { At(a), By(a), Always, Never }
    PlaceHeight { At(a), Above(a) }
}

impl Moved for ExprKind {
    fn moved(&mut self, shift: Shift) {
        match self {
            ExprKind::Number(..)
            | ExprKind::Bool(_)
            | ExprKind::NoneRef
            | ExprKind::SelfRef
            | ExprKind::Timer
            | ExprKind::Text(_)
            | ExprKind::Name(..)
            | ExprKind::Else => {}
            ExprKind::Path(a) => a.moved(shift),
            ExprKind::Call(a) => a.moved(shift),
            ExprKind::InMode(a) => a.moved(shift),
            ExprKind::Any(a) | ExprKind::All(a) => a.moved(shift),
            ExprKind::Each(a) => a.moved(shift),
            ExprKind::Nearest(a) => a.moved(shift),
            ExprKind::Point(a) | ExprKind::Moved(a) | ExprKind::Binary(_, a) | ExprKind::Compare(_, a) => {
                a.moved(shift);
            }
            ExprKind::Paren(a) | ExprKind::Negate(a) | ExprKind::Not(a) => a.moved(shift),
            ExprKind::Chain(a) => a.moved(shift),
            ExprKind::In(a) => a.moved(shift),
            ExprKind::Is(a) => a.moved(shift),
            ExprKind::Touching(a) => a.moved(shift),
        }
    }
}

impl Moved for Assignment {
    fn moved(&mut self, shift: Shift) {
        self.variable.moved(shift);
        self.value.moved(shift);
        self.end = self.end.saturating_add_signed(shift.by as i32);
    }
}
