//! Which times are plausible where there is damage.

use std::ops::Range;

/// Times of records that follow each other are no further apart, as a rule. Microseconds.
pub const MAX_JUMP: u64 = 3 * 24 * 3600 * 1_000_000;

/// From 2000 to 2100, in microseconds since 1970: of bytes that are no time one in thousands is among them.
const DATES: Range<u64> = 946_684_800_000_000..4_102_444_800_000_000;

/// Whether a time is a date by itself.
pub fn is_date(time: u64) -> bool {
    DATES.contains(&time)
}

/// Whether two times may be those of records that follow each other.
pub fn are_near(one: u64, other: u64) -> bool {
    one.abs_diff(other) < MAX_JUMP
}

/// The time of the previous record. It decides whether the stamp of a record after damage is believed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Before {
    /// The time that it was given.
    pub time: u64,
    /// Its time stamp in the log, which may be wrong.
    pub stamp: u64,
}

impl Before {
    /// A record whose stamp is its time.
    pub fn of(stamp: u64) -> Self {
        Self { time: stamp, stamp }
    }

    /// Whether a stamp is believed: one that is near, also to a stamp that was not believed itself, since it may have been the
    /// time before that was wrong; and a date where that time is none.
    pub fn believes(self, stamp: u64) -> bool {
        are_near(stamp, self.time)
            || are_near(stamp, self.stamp)
            || is_date(stamp) && !is_date(self.time)
    }
}
