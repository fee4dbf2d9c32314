//! A limit on the analysis of a world: worlds that take long are skipped in favour of others.

use std::sync::atomic::{AtomicU32, Ordering};

use hypedc::watch::Watch;

/// Stops an analysis after a number of polls.
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
