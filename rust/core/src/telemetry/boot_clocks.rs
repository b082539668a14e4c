//! Derives reboots, and several senders behind one id, from the clocks since boot (`time_boot_ms`) of a sender id.

/// A clock that goes back by more milliseconds is a reboot. It goes back by less when messages overtake each other. Times
/// this near belong to one clock.
const REBOOT_MS: u32 = 5000;
/// 32 bits of milliseconds wrap after 49.7 days. A jump from so near to the end is no reboot.
const WRAP_MS: u32 = 3_600_000;
/// The number of clocks that are remembered.
const CLOCKS: usize = 4;
/// So many returns to an older clock show that several senders share the id. A late message makes two returns.
const RETURNS: u64 = 3;

/// The clocks of one sender id.
#[derive(Debug, Clone, Copy, Default)]
pub struct BootClocks {
    /// The newest time of each clock. The clock heard last comes first.
    clocks: [Option<u32>; CLOCKS],
    starts: u64,
    returns: u64,
}

impl BootClocks {
    /// Adds the next `time_boot_ms`.
    #[inline]
    pub fn hear(&mut self, millis: u32) {
        match self.clocks[0] {
            Some(newest) if is_near(newest, millis) => self.clocks[0] = Some(millis),
            None => self.clocks[0] = Some(millis),
            Some(newest) => self.jump(newest, millis),
        }
    }

    fn jump(&mut self, newest: u32, millis: u32) {
        let is_known = |clock: &Option<u32>| clock.is_some_and(|clock| is_near(clock, millis));
        if let Some(place) = self.clocks.iter().position(is_known) {
            self.returns += 1;
            self.clocks[..=place].rotate_right(1);
        } else if is_start(newest, millis) {
            self.starts += 1;
            self.clocks.rotate_right(1);
        }
        self.clocks[0] = Some(millis);
    }

    /// Whether several senders send under this id.
    pub fn is_shared(&self) -> bool {
        self.returns >= RETURNS
    }

    /// The number of reboots; 0 if several senders share the id.
    pub fn reboots(&self) -> u64 {
        if self.is_shared() { 0 } else { self.starts }
    }
}

/// Whether a clock started anew between two of its times. Where it did not, `millis - newest` may wrap.
pub(super) fn is_start(newest: u32, millis: u32) -> bool {
    millis < newest && millis.wrapping_sub(newest) > WRAP_MS && !is_near(newest, millis)
}

pub(super) fn is_near(one: u32, other: u32) -> bool {
    one.wrapping_sub(other).min(other.wrapping_sub(one)) <= REBOOT_MS
}

#[cfg(test)]
mod tests {
    use super::*;

    fn heard(times: impl IntoIterator<Item = u32>) -> (u64, bool) {
        let mut clocks = BootClocks::default();
        times.into_iter().for_each(|time| clocks.hear(time));
        (clocks.reboots(), clocks.is_shared())
    }

    #[test]
    fn a_clock_that_starts_anew_is_a_reboot() {
        assert_eq!(heard([]), (0, false));
        assert_eq!(heard((1..99).map(|n| 100 * n)), (0, false));
        assert_eq!(heard([600_000, 700_000, 1000, 2000, 90_000, 500]), (2, false));
        assert_eq!(heard([600_000, 596_000, 601_000]), (0, false));
        // Uptimes beyond half of the range.
        assert_eq!(heard([4_000_000_000, 1000]), (1, false));
    }

    #[test]
    fn a_clock_that_wraps_is_no_reboot() {
        let wrapping = (0..200_u32).map(|n| 4_294_900_000_u32.wrapping_add(1000 * n));
        assert_eq!(heard(wrapping), (0, false));
        assert_eq!(heard([4_294_000_000, 60_000]), (0, false));
    }

    #[test]
    fn senders_by_turns_are_no_reboots() {
        for senders in 2..=CLOCKS as u32 {
            let turns = (0..100).map(|n| 100_000 * (senders - n % senders) + 50 * n);
            assert_eq!(heard(turns), (0, true), "{senders} senders");
        }
        // A message from before the reboot that came late.
        assert_eq!(heard([600_000, 1000, 600_100, 1100, 1200]), (1, false));
    }
}
