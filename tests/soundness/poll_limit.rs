//! Gives a world up that takes long to look at: thousands of others are looked at in that time.

use std::sync::atomic::{AtomicU32, Ordering};

use hypedc::watch::Watch;

/// Stops an analysis after so many looks at combinations of modes.
pub struct PollLimit(AtomicU32);

impl PollLimit {
    pub fn new(looks: u32) -> Self {
        PollLimit(AtomicU32::new(looks))
    }
}

impl Watch for PollLimit {
    fn stop(&self) -> bool {
        let before = self.0.fetch_update(Ordering::Relaxed, Ordering::Relaxed, |left| Some(left.saturating_sub(1)));
        before.is_ok_and(|left| left <= 1)
    }
}
