//! Three-valued truth of predicates.

/// The possible outcomes of a guard.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::analysis) struct Truth {
    pub can_hold: bool,
    pub can_fail: bool,
}

impl Truth {
    pub const EITHER: Truth = Truth { can_hold: true, can_fail: true };

    pub fn of(holds: bool) -> Truth {
        Truth { can_hold: holds, can_fail: !holds }
    }

    pub fn not(self) -> Truth {
        Truth { can_hold: self.can_fail, can_fail: self.can_hold }
    }
}
