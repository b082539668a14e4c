//! Losses and duplicates of a sender, by the sequence numbers of its messages.

use mavwire_core::telemetry::is_jump_forward;

/// Numbers ahead of the newest that are a loss; beyond that they are behind it.
const FAR: u8 = 128;
/// Without a message for this long, nobody can tell how often the numbers went round. Microseconds.
const SILENCE: u64 = 3_000_000;

/// The newest sequence numbers of a sender, on all links together.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Sequence {
    newest: Option<Newest>,
}

#[derive(Debug, Clone, Copy)]
struct Newest {
    number: u8,
    time: u64,
    /// Bit `n`: the number `n` before the newest is lost so far.
    missing: u128,
}

impl Newest {
    /// Whether a time is before it, or too far behind it for one flight: the clock was set, or the time is damaged.
    fn is_on_another_clock(self, time: u64) -> bool {
        self.time.saturating_sub(time) > SILENCE || is_jump_forward(self.time, time)
    }
}

/// How the counts change by a message.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Heard {
    /// This number of messages before it were lost.
    After(u8),
    /// It arrived late, after it was counted as lost.
    Late,
    /// Another copy of it arrived before, on another link.
    Again,
}

impl Sequence {
    /// Takes in the number of a message; `time` in microseconds, or 0.
    pub(crate) fn add(&mut self, number: u8, time: u64) -> Heard {
        let Some(newest) = &mut self.newest else {
            self.newest = Some(Newest { number, time, missing: 0 });
            return Heard::After(0);
        };
        let ahead = number.wrapping_sub(newest.number);
        if newest.is_on_another_clock(time) {
            // Such a time says nothing of a silence. Numbers that go on do so, others are those of another flight.
            if ahead > FAR {
                *newest = Newest { number, time, missing: 0 };
                return Heard::After(0);
            }
        } else if time.abs_diff(newest.time) > SILENCE {
            *newest = Newest { number, time, missing: 0 };
            return Heard::After(ahead.wrapping_sub(1));
        }
        if ahead == 0 || ahead > FAR {
            let bit = 1 << ahead.wrapping_neg();
            let heard = if newest.missing & bit == 0 { Heard::Again } else { Heard::Late };
            newest.missing &= !bit;
            return heard;
        }
        let before = newest.missing.checked_shl(ahead.into()).unwrap_or(0);
        let between = 1_u128.checked_shl(ahead.into()).unwrap_or(0).wrapping_sub(1) & !1;
        *newest = Newest { number, time, missing: before | between };
        Heard::After(ahead - 1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Messages lost, and messages that came again.
    fn counts(numbers: impl IntoIterator<Item = u8>) -> (u64, u64) {
        let (mut sequence, mut lost, mut again) = (Sequence::default(), 0, 0);
        for number in numbers {
            match sequence.add(number, 0) {
                Heard::After(count) => lost += u64::from(count),
                Heard::Late => lost -= 1,
                Heard::Again => again += 1,
            }
        }
        (lost, again)
    }

    #[test]
    fn numbers_go_round() {
        assert_eq!(counts((0..1000).map(|n| n as u8)), (0, 0));
        assert_eq!(counts((0..1000).map(|n| (3 * n) as u8)), (1998, 0));
        assert_eq!(counts([0, FAR]), (127, 0));
    }

    #[test]
    fn what_came_before_is_no_loss() {
        let twice = (0..1000).flat_map(|n| [n as u8, n as u8]);
        assert_eq!(counts(twice), (0, 1000));
        let behind = (50..1000).flat_map(|n| [n as u8, (n - 50) as u8]);
        assert_eq!(counts(behind), (0, 950));
        assert_eq!(counts([1, 3, 2, 4, 4, 2]), (0, 2));
        assert_eq!(counts([0, FAR, 1, 1]), (126, 1));
    }

    #[test]
    fn after_a_silence_it_begins_anew() {
        let mut sequence = Sequence::default();
        sequence.add(200, 0);
        assert_eq!(sequence.add(199, SILENCE), Heard::Again);
        assert_eq!(sequence.add(199, SILENCE + 1), Heard::After(254));
        assert_eq!(sequence.add(198, SILENCE + 2), Heard::Again);
    }

    #[test]
    fn a_wrong_time_is_no_silence() {
        for wrong in [0, u64::MAX] {
            let mut sequence = Sequence::default();
            let time = 1_700_000_000_000_000;
            sequence.add(8, time);
            assert_eq!(sequence.add(10, time), Heard::After(1));
            assert_eq!(sequence.add(10, wrong), Heard::Again);
            assert_eq!(sequence.add(11, wrong), Heard::After(0));
            assert_eq!(sequence.add(11, time), Heard::Again);
            assert_eq!(sequence.add(13, time), Heard::After(1));
            assert_eq!(sequence.add(12, time), Heard::Late);
            // Another flight.
            assert_eq!(sequence.add(240, wrong), Heard::After(0));
            assert_eq!(sequence.add(241, wrong), Heard::After(0));
        }
    }
}
