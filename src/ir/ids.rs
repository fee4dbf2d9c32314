//! Dense ids, one type per kind, and tables keyed by them: a `VarId` cannot index modes.

use std::fmt;
use std::marker::PhantomData;
use std::ops::{Index, IndexMut};

use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// A dense index into the table of its kind.
pub trait Id: Copy {
    /// The id of the `index`-th entry.
    fn from_index(index: usize) -> Self;
    /// The entry's index.
    fn index(self) -> usize;
}

macro_rules! ids {
    ($($name:ident $prefix:literal $doc:literal)*) => {$(
        #[doc = $doc]
        #[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
        #[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
        pub struct $name(pub u32);

        impl Id for $name {
            #[inline]
            fn from_index(index: usize) -> Self {
                $name(index as u32)
            }
            #[inline]
            fn index(self) -> usize {
                self.0 as usize
            }
        }

        impl fmt::Debug for $name {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                write!(f, concat!($prefix, "{}"), self.0)
            }
        }

        impl fmt::Display for $name {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                fmt::Debug::fmt(self, f)
            }
        }
    )*};
}

ids! {
    EntityId "entity" "An entity of the program."
    WorldId "world" "A world of the program."
    TagId "tag" "A collision tag of the program."
    ParamId "param" "A parameter of one entity."
    VarId "var" "A continuous variable of one entity; 0 is `x`, 1 is `y`."
    DiscreteId "discrete" "A discrete variable of one entity."
    RefId "ref" "A reference of one entity."
    SpawnId "spawn" "A `spawn` of one entity."
    SignalId "signal" "A signal that one entity receives: one bit of the state."
    SendId "send" "A `send` of one entity."
    FollowId "follow" "A `follow links` of one entity."
    ButtonId "button" "A button that one entity reads."
    AxisId "axis" "An axis that one entity reads."
    ChanceId "chance" "A whole number that one entity draws in each step."
    ColliderId "collider" "A collider of one entity."
    GroupId "group" "A group of concurrent modes of one entity."
    ModeId "mode" "A mode of one entity, numbered in preorder."
    EdgeId "edge" "An edge of one entity, in source order."
    EnvelopeId "envelope" "An envelope of one entity."
    SpaceId "space" "A space of one world."
    SlotId "slot" "A place for an instance in one world."
    PlayerId "player" "A player of one world, from 0."
    GoalId "goal" "A `goal` of one world."
    NeverId "never" "A `never` of one world."
    ExprId "expr" "An expression of the program's arena."
    LeafId "leaf" "A mode without modes inside, of one entity, in preorder."
    TouchId "touch" "A distinct contact query of one entity: one bit of the state."
    ProbeId "probe" "A probe of one entity that names the instance it finds."
    TileId "tile" "A tile of one world that can be broken: one bit of the state."
    TimerId "timer" "A mode whose time is read, of one entity: one counter of the state."
}

impl VarId {
    /// The variable `x`.
    pub const X: VarId = VarId(0);
    /// The variable `y`.
    pub const Y: VarId = VarId(1);
    /// Both, by axis.
    pub const XY: [VarId; 2] = [VarId::X, VarId::Y];

    /// Whether it is `x` or `y`.
    #[inline]
    pub fn is_position(self) -> bool {
        self <= VarId::Y
    }
}

/// Neighbours in a table: all ids from one to before another.
#[derive(Clone, Copy, PartialEq, Eq)]
pub struct IdRange<I> {
    /// The first.
    pub from: I,
    /// The one after the last.
    pub to: I,
}

impl<I: Id + Ord> IdRange<I> {
    /// All from the first to before the second.
    pub fn new(from: I, to: I) -> Self {
        IdRange { from, to }
    }

    /// Whether an id is one of them.
    #[inline]
    pub fn contains(self, id: I) -> bool {
        self.from <= id && id < self.to
    }

    /// How many there are.
    #[inline]
    pub fn len(self) -> usize {
        self.to.index().saturating_sub(self.from.index())
    }

    /// Whether there are none.
    #[inline]
    pub fn is_empty(self) -> bool {
        self.to <= self.from
    }

    /// The ids in order.
    #[inline]
    pub fn ids(self) -> impl DoubleEndedIterator<Item = I> + ExactSizeIterator {
        (self.from.index()..self.to.index().max(self.from.index())).map(I::from_index)
    }
}

impl<I: fmt::Debug> fmt::Debug for IdRange<I> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:?}..{:?}", self.from, self.to)
    }
}

impl<I: Serialize> Serialize for IdRange<I> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        (&self.from, &self.to).serialize(serializer)
    }
}

impl<'de, I: Deserialize<'de>> Deserialize<'de> for IdRange<I> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        Deserialize::deserialize(deserializer).map(|(from, to)| IdRange { from, to })
    }
}

/// A table keyed by an id.
#[derive(Clone, PartialEq)]
pub struct IdVec<I, T> {
    entries: Vec<T>,
    kind: PhantomData<fn() -> I>,
}

impl<I: Id, T> IdVec<I, T> {
    /// An empty table.
    pub fn new() -> Self {
        Self::default()
    }

    /// Appends an entry and returns its id.
    pub fn push(&mut self, entry: T) -> I {
        if self.entries.len() == self.entries.capacity() {
            // Tables of large programs are large: they do not double, to limit unused capacity.
            self.entries.reserve_exact(2.max(self.entries.len() / 4));
        }
        self.entries.push(entry);
        I::from_index(self.entries.len() - 1)
    }

    /// Removes the last entry.
    pub fn pop(&mut self) -> Option<T> {
        self.entries.pop()
    }

    /// Makes room for exactly `more` entries.
    pub fn reserve(&mut self, more: usize) {
        self.entries.reserve_exact(more);
    }

    /// The number of entries.
    #[inline]
    pub fn len(&self) -> usize {
        self.entries.len()
    }

    /// Whether there are none.
    #[inline]
    pub fn is_empty(&self) -> bool {
        self.entries.is_empty()
    }

    /// The entry of an id, if it is of this table.
    #[inline]
    pub fn get(&self, id: I) -> Option<&T> {
        self.entries.get(id.index())
    }

    /// The entries in order.
    #[inline]
    pub fn iter(&self) -> std::slice::Iter<'_, T> {
        self.entries.iter()
    }

    /// The entries in order, mutable.
    #[inline]
    pub fn iter_mut(&mut self) -> std::slice::IterMut<'_, T> {
        self.entries.iter_mut()
    }

    /// The ids in order.
    #[inline]
    pub fn ids(&self) -> impl DoubleEndedIterator<Item = I> + ExactSizeIterator + use<I, T> {
        (0..self.entries.len()).map(I::from_index)
    }

    /// Ids and entries in order.
    #[inline]
    pub fn pairs(&self) -> impl DoubleEndedIterator<Item = (I, &T)> + ExactSizeIterator {
        self.entries.iter().enumerate().map(|(i, e)| (I::from_index(i), e))
    }

    /// The id of the first entry that satisfies `test`.
    pub fn find(&self, test: impl FnMut(&T) -> bool) -> Option<I> {
        self.entries.iter().position(test).map(I::from_index)
    }
}

impl<I, T> IntoIterator for IdVec<I, T> {
    type Item = T;
    type IntoIter = std::vec::IntoIter<T>;

    fn into_iter(self) -> Self::IntoIter {
        self.entries.into_iter()
    }
}

impl<I, T> IdVec<I, T> {
    /// An empty table, as a constant.
    pub(super) const fn empty() -> Self {
        IdVec { entries: Vec::new(), kind: PhantomData }
    }
}

impl<I, T> Default for IdVec<I, T> {
    fn default() -> Self {
        IdVec::empty()
    }
}

impl<I: Id, T> FromIterator<T> for IdVec<I, T> {
    fn from_iter<A: IntoIterator<Item = T>>(iter: A) -> Self {
        IdVec { entries: iter.into_iter().collect(), kind: PhantomData }
    }
}

impl<I: Id, T> Index<I> for IdVec<I, T> {
    type Output = T;
    #[inline]
    fn index(&self, id: I) -> &T {
        &self.entries[id.index()]
    }
}

impl<I: Id, T> IndexMut<I> for IdVec<I, T> {
    #[inline]
    fn index_mut(&mut self, id: I) -> &mut T {
        &mut self.entries[id.index()]
    }
}

impl<I, T: fmt::Debug> fmt::Debug for IdVec<I, T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.entries.fmt(f)
    }
}

impl<I, T: Serialize> Serialize for IdVec<I, T> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        self.entries.serialize(serializer)
    }
}

impl<'de, I, T: Deserialize<'de>> Deserialize<'de> for IdVec<I, T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        Deserialize::deserialize(deserializer).map(|entries| IdVec { entries, kind: PhantomData })
    }
}

#[cfg(feature = "testing")]
mod schema {
    //! Ranges and tables, as JSON has them.

    use std::borrow::Cow;

    use schemars::{JsonSchema, Schema, SchemaGenerator};

    use super::{IdRange, IdVec};
    use crate::ir::{Arena, RareVec};

    impl<I: JsonSchema> JsonSchema for IdRange<I> {
        fn inline_schema() -> bool {
            true
        }

        fn schema_name() -> Cow<'static, str> {
            format!("Range_of_{}", I::schema_name()).into()
        }

        fn json_schema(generator: &mut SchemaGenerator) -> Schema {
            <(I, I)>::json_schema(generator)
        }
    }

    macro_rules! tables {
        ($($table:ident)*) => {$(
            impl<I, T: JsonSchema> JsonSchema for $table<I, T> {
                fn inline_schema() -> bool {
                    true
                }

                fn schema_name() -> Cow<'static, str> {
                    format!("Table_of_{}", T::schema_name()).into()
                }

                fn json_schema(generator: &mut SchemaGenerator) -> Schema {
                    Vec::<T>::json_schema(generator)
                }
            }
        )*};
    }

    tables! { IdVec RareVec Arena }
}
