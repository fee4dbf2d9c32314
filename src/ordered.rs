//! Stable sorts whose code is compiled once, for lists that are short or sorted seldom: those of the standard library are
//! compiled anew for each kind of item, some 3 KB each in WebAssembly.

use std::cmp::Ordering;

/// A list that can be put into order.
pub trait Ordered<T> {
    /// As [`slice::sort_by`].
    fn order_by(&mut self, compare: impl Fn(&T, &T) -> Ordering);

    /// As [`slice::sort_by_key`].
    fn order_by_key<K: Ord>(&mut self, key: impl Fn(&T) -> K) {
        self.order_by(|a, b| key(a).cmp(&key(b)));
    }
}

impl<T> Ordered<T> for [T] {
    fn order_by(&mut self, compare: impl Fn(&T, &T) -> Ordering) {
        let mut place = places(self.len(), &|a, b| compare(&self[a], &self[b]));
        for at in 0..place.len() {
            while place[at] != at {
                let to = place[at];
                self.swap(at, to);
                place.swap(at, to);
            }
        }
    }
}

/// For each item, its place in a stable order.
fn places(count: usize, compare: &dyn Fn(usize, usize) -> Ordering) -> Vec<usize> {
    let mut order: Vec<usize> = (0..count).collect();
    order.sort_by(|a, b| compare(*a, *b));
    let mut places = vec![0; count];
    order.into_iter().enumerate().for_each(|(place, item)| places[item] = place);
    places
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::Ordered;

    proptest! {
        #[test]
        fn lists_are_ordered_as_by_the_standard_library(keys in prop::collection::vec(0u8..20, 0..200)) {
            let mut ordered: Vec<(u8, usize)> = keys.into_iter().zip(0..).collect();
            let mut sorted = ordered.clone();
            sorted.sort_by_key(|(key, _)| *key);
            ordered.order_by_key(|(key, _)| *key);
            prop_assert_eq!(ordered, sorted);
        }
    }
}
