//! Lists of numbers of which most are short: those take no memory elsewhere.

use std::ops::Deref;

/// A list of numbers, as large as a vector.
#[derive(Debug, Clone)]
pub(super) enum Few {
    /// How many, and these.
    Short(u32, [u32; SHORT]),
    /// More than there is room for.
    Long(Vec<u32>),
}

const SHORT: usize = 3;

impl Default for Few {
    fn default() -> Self {
        Few::Short(0, [0; SHORT])
    }
}

impl Deref for Few {
    type Target = [u32];

    fn deref(&self) -> &[u32] {
        match self {
            Few::Short(count, numbers) => &numbers[..*count as usize],
            Few::Long(numbers) => numbers,
        }
    }
}

impl Few {
    /// Adds a number at the end.
    pub fn push(&mut self, number: u32) {
        match self {
            Few::Short(count, numbers) if (*count as usize) < SHORT => {
                numbers[*count as usize] = number;
                *count += 1;
            }
            Few::Short(_, numbers) => {
                let mut long = Vec::with_capacity(2 * SHORT);
                long.extend(&*numbers);
                long.push(number);
                *self = Few::Long(long);
            }
            Few::Long(numbers) => numbers.push(number),
        }
    }

    /// Removes the number at a place; the last one takes it.
    pub fn swap_remove(&mut self, place: usize) {
        match self {
            Few::Short(count, numbers) => {
                *count -= 1;
                numbers[place] = numbers[*count as usize];
            }
            Few::Long(numbers) => {
                numbers.swap_remove(place);
            }
        }
    }

    /// Removes all numbers.
    pub fn clear(&mut self) {
        *self = Few::default();
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::Few;

    proptest! {
        #[test]
        fn short_and_long_lists_hold_what_vectors_hold(changes in prop::collection::vec(any::<(u32, bool)>(), 0..40)) {
            let (mut few, mut numbers) = (Few::default(), Vec::new());
            for (number, is_new) in changes {
                if is_new || numbers.is_empty() {
                    few.push(number);
                    numbers.push(number);
                } else {
                    let place = number as usize % numbers.len();
                    few.swap_remove(place);
                    numbers.swap_remove(place);
                }
                prop_assert_eq!(&*few, &*numbers);
            }
            few.clear();
            prop_assert!(few.is_empty());
        }
    }

    #[test]
    fn a_list_is_as_large_as_a_vector() {
        assert_eq!(size_of::<Few>(), size_of::<Vec<u32>>());
    }
}
