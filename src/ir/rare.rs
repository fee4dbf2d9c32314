//! A table that is usually empty and then takes one word: a program may have many thousand entities, with a dozen such
//! tables each.

use std::fmt;
use std::ops::{Deref, DerefMut};

use serde::{Deserialize, Deserializer, Serialize, Serializer};

use super::{Id, IdVec};

/// A table keyed by an id that takes only one word while it is empty; otherwise an [`IdVec`].
#[derive(Clone)]
pub struct RareVec<I, T>(Option<Box<IdVec<I, T>>>);

impl<I: 'static, T: 'static> RareVec<I, T> {
    const EMPTY: &'static IdVec<I, T> = &IdVec::empty();
}

impl<I, T> RareVec<I, T> {
    /// An empty table.
    pub fn new() -> Self {
        Self::default()
    }

    /// Whether there is no table, which takes no place in a file.
    pub(super) fn is_none(&self) -> bool {
        self.0.is_none()
    }
}

// Operations that need no table if it is empty.
impl<I: Id, T> RareVec<I, T> {
    /// The entries in order, mutable.
    #[inline]
    pub fn iter_mut(&mut self) -> std::slice::IterMut<'_, T> {
        self.0.as_deref_mut().map_or_else(Default::default, IdVec::iter_mut)
    }

    /// Makes room for exactly `more` entries.
    pub fn reserve(&mut self, more: usize) {
        if more > 0 {
            self.0.get_or_insert_default().reserve(more);
        }
    }
}

impl<I: 'static, T: 'static> Deref for RareVec<I, T> {
    type Target = IdVec<I, T>;
    #[inline]
    fn deref(&self) -> &IdVec<I, T> {
        self.0.as_deref().unwrap_or(Self::EMPTY)
    }
}

impl<I: 'static, T: 'static> DerefMut for RareVec<I, T> {
    #[inline]
    fn deref_mut(&mut self) -> &mut IdVec<I, T> {
        self.0.get_or_insert_default()
    }
}

impl<I, T> Default for RareVec<I, T> {
    fn default() -> Self {
        RareVec(None)
    }
}

impl<I: Id, T> From<IdVec<I, T>> for RareVec<I, T> {
    fn from(table: IdVec<I, T>) -> Self {
        RareVec((!table.is_empty()).then(|| table.into()))
    }
}

impl<I: Id, T> FromIterator<T> for RareVec<I, T> {
    fn from_iter<A: IntoIterator<Item = T>>(entries: A) -> Self {
        entries.into_iter().collect::<IdVec<I, T>>().into()
    }
}

impl<I, T> IntoIterator for RareVec<I, T> {
    type Item = T;
    type IntoIter = std::vec::IntoIter<T>;

    fn into_iter(self) -> Self::IntoIter {
        self.0.map_or_else(IdVec::default, |table| *table).into_iter()
    }
}

impl<I: 'static, T: fmt::Debug + 'static> fmt::Debug for RareVec<I, T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        (**self).fmt(f)
    }
}

impl<I: 'static, T: Serialize + 'static> Serialize for RareVec<I, T> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        (**self).serialize(serializer)
    }
}

impl<'de, I: Id, T: Deserialize<'de>> Deserialize<'de> for RareVec<I, T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        IdVec::deserialize(deserializer).map(RareVec::from)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ir::EdgeId;

    #[test]
    fn an_empty_one_is_a_word() {
        assert_eq!(size_of::<RareVec<EdgeId, u64>>(), size_of::<usize>());
        let none: RareVec<EdgeId, u64> = std::iter::empty().collect();
        assert!(none.0.is_none() && none.is_empty() && none.get(EdgeId(0)).is_none());
        let mut some = none.clone();
        assert_eq!((some.push(7), some.push(8)), (EdgeId(0), EdgeId(1)));
        assert_eq!((some[EdgeId(1)], some.into_iter().sum::<u64>()), (8, 15));
    }
}
