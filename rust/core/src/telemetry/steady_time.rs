//! Makes a time without steps from the times of records.

use crate::log::tlog::are_near;

/// A smaller step back is no change of the clock: messages of two links can overtake each other.
const CLOCK_STEP: u64 = 1_000_000;

/// The duration of a log, in spite of changes of its clock. A clock that is set goes on from where it was.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct SteadyTime {
    before: Option<u64>,
    now: u64,
    /// Microseconds that the clock was set back in all.
    pub set_back: u64,
    /// Records that are further behind the record in front than those of one flight.
    pub times_forward: u64,
    /// Microseconds that the clock was set forward in all.
    pub set_forward: u64,
}

impl SteadyTime {
    /// The steady time of the next record, in microseconds.
    #[inline]
    pub fn of(&mut self, time: u64) -> u64 {
        let Some(before) = self.before.replace(time) else {
            self.now = time;
            return time;
        };
        if before.saturating_sub(time) > CLOCK_STEP {
            self.set_back = self.set_back.saturating_add(before - time);
        } else if is_jump_forward(before, time) {
            self.times_forward += 1;
            self.set_forward = self.set_forward.saturating_add(time - before);
        } else {
            self.now = self.now.saturating_add(time).saturating_sub(before);
        }
        self.now
    }
}

/// Whether a time is too far behind the one in front for records of one flight.
#[inline]
pub fn is_jump_forward(before: u64, time: u64) -> bool {
    time > before && !are_near(before, time)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::log::tlog::MAX_JUMP;

    #[test]
    fn a_step_back_takes_no_time() {
        let mut steady = SteadyTime::default();
        let seconds = [100, 101, 50, 51, 52, 49].map(|time| time * 1_000_000);
        let found = seconds.map(|time| steady.of(time) / 1_000_000);
        assert_eq!(found, [100, 101, 101, 102, 103, 103]);
        assert_eq!(steady.set_back, 54_000_000);
        assert_eq!(steady.of(48_500_000), 102_500_000);
    }

    #[test]
    fn a_jump_forward_takes_no_time() {
        let mut steady = SteadyTime::default();
        let found = [5, 6, 6 + MAX_JUMP, 7 + MAX_JUMP, u64::MAX, 8 + MAX_JUMP, 6 + 2 * MAX_JUMP];
        let steady_times = [5, 6, 6, 7, 7, 7, 5 + MAX_JUMP];
        assert_eq!(found.map(|time| steady.of(time)), steady_times);
        assert_eq!((steady.times_forward, steady.set_forward), (2, u64::MAX - 7));
    }
}
