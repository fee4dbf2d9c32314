//! A table whose entries never move: it grows by blocks. The expressions of a large program dominate its memory, and a
//! growing vector would briefly hold them twice.

use std::fmt;
use std::marker::PhantomData;
use std::ops::{Index, IndexMut};

use serde::{Deserialize, Deserializer, Serialize, Serializer};

use super::Id;

/// The number of entries in a block.
const BLOCK: usize = 1 << 14;

/// A table keyed by an id, in blocks.
#[derive(Clone, PartialEq)]
pub struct Arena<I, T> {
    /// The first block, the only one in most programs.
    first: Vec<T>,
    /// The others, all but the last of them full.
    rest: Vec<Vec<T>>,
    kind: PhantomData<fn() -> I>,
}

impl<I: Id, T> Arena<I, T> {
    /// Appends an entry and returns its id.
    pub fn push(&mut self, entry: T) -> I {
        let id = I::from_index(self.len());
        if self.first.len() < BLOCK {
            self.first.push(entry);
        } else if let Some(last) = self.rest.last_mut().filter(|last| last.len() < BLOCK) {
            last.push(entry);
        } else {
            let mut block = Vec::with_capacity(BLOCK);
            block.push(entry);
            self.rest.push(block);
        }
        id
    }

    /// The number of entries.
    pub fn len(&self) -> usize {
        let full = self.rest.len().saturating_sub(1) * BLOCK;
        self.first.len() + full + self.rest.last().map_or(0, Vec::len)
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.first.is_empty()
    }

    /// The entry of an id, if it is of this table.
    #[inline]
    pub fn get(&self, id: I) -> Option<&T> {
        match self.first.get(id.index()) {
            None => self.rest.get((id.index() / BLOCK).checked_sub(1)?)?.get(id.index() % BLOCK),
            entry => entry,
        }
    }

    /// The entries as one slice, if there is only one block, as in most programs.
    pub fn in_one_piece(&self) -> Option<&[T]> {
        self.rest.is_empty().then_some(&self.first)
    }

    /// The entries in order.
    pub fn iter(&self) -> impl Iterator<Item = &T> {
        self.first.iter().chain(self.rest.iter().flatten())
    }

    /// The ids in order.
    pub fn ids(&self) -> impl DoubleEndedIterator<Item = I> + ExactSizeIterator + use<I, T> {
        (0..self.len()).map(I::from_index)
    }

    /// Ids and entries in order.
    pub fn pairs(&self) -> impl Iterator<Item = (I, &T)> {
        self.iter().enumerate().map(|(i, e)| (I::from_index(i), e))
    }
}

impl<I, T> Default for Arena<I, T> {
    fn default() -> Self {
        Arena { first: Vec::new(), rest: Vec::new(), kind: PhantomData }
    }
}

impl<I: Id, T> Index<I> for Arena<I, T> {
    type Output = T;
    #[inline]
    fn index(&self, id: I) -> &T {
        match self.first.get(id.index()) {
            Some(entry) => entry,
            None => &self.rest[id.index() / BLOCK - 1][id.index() % BLOCK],
        }
    }
}

impl<I: Id, T> IndexMut<I> for Arena<I, T> {
    fn index_mut(&mut self, id: I) -> &mut T {
        if id.index() < BLOCK {
            return &mut self.first[id.index()];
        }
        &mut self.rest[id.index() / BLOCK - 1][id.index() % BLOCK]
    }
}

impl<I: Id, T> Extend<T> for Arena<I, T> {
    fn extend<A: IntoIterator<Item = T>>(&mut self, entries: A) {
        for entry in entries {
            self.push(entry);
        }
    }
}

impl<I: Id, T> FromIterator<T> for Arena<I, T> {
    fn from_iter<A: IntoIterator<Item = T>>(entries: A) -> Self {
        let mut arena = Arena::default();
        arena.extend(entries);
        arena
    }
}

impl<I: Id, T: fmt::Debug> fmt::Debug for Arena<I, T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_list().entries(self.iter()).finish()
    }
}

impl<I: Id, T: Serialize> Serialize for Arena<I, T> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_seq(self.iter())
    }
}

impl<'de, I: Id, T: Deserialize<'de>> Deserialize<'de> for Arena<I, T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        Vec::<T>::deserialize(deserializer).map(Arena::from_iter)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ir::ExprId;

    #[test]
    fn it_is_a_table_however_many_blocks_it_has() {
        for count in [0, 1, BLOCK - 1, BLOCK, BLOCK + 1, 3 * BLOCK, 3 * BLOCK + 7] {
            let mut arena: Arena<ExprId, usize> = (0..count).collect();
            assert!(arena.len() == count && arena.is_empty() == (count == 0));
            assert!(arena.iter().copied().eq(0..count));
            assert!(arena.ids().all(|id| arena[id] == id.index() && arena.get(id) == Some(&id.index())));
            assert!([0, 1, BLOCK, 4 * BLOCK].iter().all(|past| arena.get(ExprId((count + past) as u32)).is_none()));
            assert_eq!(arena.in_one_piece().is_some(), count <= BLOCK);
            assert!(arena.pairs().all(|(id, entry)| id.index() == *entry));
            for id in arena.ids() {
                arena[id] += 1;
            }
            assert!(arena.iter().copied().eq(1..=count));
            let json = serde_json::to_string(&arena).unwrap_or_default();
            assert!(serde_json::from_str::<Arena<ExprId, usize>>(&json).is_ok_and(|read| read == arena));
        }
    }
}
