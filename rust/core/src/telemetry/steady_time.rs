//! Makes a time that never goes back from the times of records.

/// A smaller step back is no change of the clock: messages of two links can overtake each other.
const CLOCK_STEP: u64 = 1_000_000;

/// The duration of a log, in spite of changes of its clock. A clock that was set back goes on from where it was.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct SteadyTime {
    before: Option<u64>,
    /// Microseconds that the clock was set back in all.
    pub set_back: u64,
}

impl SteadyTime {
    /// The steady time of the next record, in microseconds.
    #[inline]
    pub fn of(&mut self, time: u64) -> u64 {
        if let Some(before) = self.before.replace(time)
            && before.saturating_sub(time) > CLOCK_STEP
        {
            self.set_back = self.set_back.saturating_add(before - time);
        }
        time.saturating_add(self.set_back)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_step_back_takes_no_time() {
        let mut steady = SteadyTime::default();
        let seconds = [100, 101, 50, 51, 52, 49].map(|time| time * 1_000_000);
        let found = seconds.map(|time| steady.of(time) / 1_000_000);
        assert_eq!(found, [100, 101, 101, 102, 103, 103]);
        assert_eq!(steady.set_back, 54_000_000);
        assert_eq!(steady.of(48_500_000), 102_500_000);
        assert_eq!(steady.of(u64::MAX), u64::MAX);
    }
}
