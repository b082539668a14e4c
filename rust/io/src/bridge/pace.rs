//! How long to let frames gather. Waking up for each frame and sending it alone costs several times what routing it
//! does, so a bridge that is busy looks at its links a few thousand times a second and not for each frame.

use std::time::Duration;

/// The least time between the beginnings of two rounds while frames come fast, microseconds. A frame waits half of it
/// in the mean.
const DWELL: u64 = 250;
/// The time over which frames are counted to tell, microseconds.
const WINDOW: u64 = 2_000;
/// Frames in a dwell from which on it pays to wait: 8,000 a second.
const WORTHWHILE: u64 = 2;

/// Whether frames come fast. All times in microseconds since the bridge started.
#[derive(Debug, Default)]
pub(super) struct Pace {
    window_start: u64,
    frames: u64,
    busy: bool,
}

impl Pace {
    /// Notes how many frames came in a round that began at `now`.
    pub(super) fn note(&mut self, now: u64, frames: usize) {
        self.frames += frames as u64;
        let elapsed = now.saturating_sub(self.window_start);
        if elapsed >= WINDOW {
            self.busy = self.frames * DWELL >= WORTHWHILE * elapsed;
            (self.window_start, self.frames) = (now, 0);
        }
    }

    /// How long to wait before links are looked at again, after a round that began at `began`.
    pub(super) fn rest(&self, began: u64, now: u64) -> Option<Duration> {
        let left = (began + DWELL).checked_sub(now).filter(|&left| self.busy && left > 0);
        left.map(Duration::from_micros)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Whether it rests after rounds that are so far apart, with so many frames each.
    fn rests(apart: u64, frames: usize) -> bool {
        let mut pace = Pace::default();
        (1..10_000).for_each(|n| pace.note(n * apart, frames));
        pace.rest(10_000 * apart, 10_000 * apart).is_some()
    }

    #[test]
    fn it_rests_from_8_000_frames_a_second_on() {
        assert!(!rests(1_000, 7) && rests(1_000, 8) && rests(1_000, 100));
        assert!(!rests(130, 1) && rests(125, 1) && rests(10, 1));
        assert!(!rests(1_000_000, 7_999) && rests(1_000_000, 8_000));
    }

    #[test]
    fn it_rests_until_a_dwell_after_the_round_began() {
        let mut pace = Pace::default();
        assert_eq!(pace.rest(0, 0), None);
        pace.note(5_000, 1_000);
        assert_eq!(pace.rest(5_000, 5_100), Some(Duration::from_micros(150)));
        assert_eq!(pace.rest(5_000, 5_250), None, "it took longer than that");
        pace.note(1_000_000, 10);
        assert_eq!(pace.rest(1_000_000, 1_000_000), None, "few came since");
    }
}
