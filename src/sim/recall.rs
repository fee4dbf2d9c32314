//! What a step takes over from earlier ones: nothing, or what instances did that nothing touched (`recurring.rs`).

use std::ops::Range;

/// Steps of instances that are known.
pub(super) trait Recall {
    /// Whether there are any.
    const IS_ANY: bool;

    /// The slots whose edges and flows are not known, in order.
    fn awake(&self) -> &[u32];

    /// The slots whose boxes are not where they were.
    fn moving(&self) -> &[u32];

    /// The number of slots whose contacts are not known, and one of them: those that are awake, and those that meet others.
    fn unsettled(&self) -> usize;
    fn unsettled_slot(&self, nth: usize) -> usize;

    /// The numbers of the bodies of a slot.
    fn bodies(&self, slot: usize) -> Range<usize>;

    /// An instance acts in this step.
    fn acts(&mut self, slot: usize);

    /// Another one is near an instance; returns whether its contacts were known until then.
    fn meet(&mut self, slot: usize, state: &mut [u8]) -> bool;

    /// Work was done to find the contacts of a slot.
    fn add_work(&mut self, slot: usize, work: u64);

    /// An instance is destroyed in this step.
    fn lose(&mut self, slot: usize);

    /// Before the flows.
    fn note(&mut self, state: &[u8]);

    /// After the flows: what is known moves, too; `start` are the positions before that, px.
    fn move_known(&mut self, state: &mut [u8], start: &mut [(f64, f64)]);

    /// After all contacts; returns the work that was saved.
    fn end(&mut self, state: &mut [u8]) -> u64;
}

/// Nothing is known.
pub(super) struct Nothing;

impl Recall for Nothing {
    const IS_ANY: bool = false;

    fn awake(&self) -> &[u32] {
        &[]
    }

    fn moving(&self) -> &[u32] {
        &[]
    }

    fn unsettled(&self) -> usize {
        0
    }

    fn unsettled_slot(&self, _: usize) -> usize {
        0
    }

    fn bodies(&self, _: usize) -> Range<usize> {
        0..0
    }

    fn acts(&mut self, _: usize) {}

    fn meet(&mut self, _: usize, _: &mut [u8]) -> bool {
        false
    }

    fn add_work(&mut self, _: usize, _: u64) {}

    fn lose(&mut self, _: usize) {}

    fn note(&mut self, _: &[u8]) {}

    fn move_known(&mut self, _: &mut [u8], _: &mut [(f64, f64)]) {}

    fn end(&mut self, _: &mut [u8]) -> u64 {
        0
    }
}
