//! Binary logs that lack their first bytes, and with them what describes their records.
//!
//! Nothing can be read of them, but they are no telemetry logs: some megabytes of any bytes have a telemetry record or
//! two by chance. They are recognised by the distance between records: all records of a type have one length, so the
//! distance from one head to the next repeats.

use std::mem;

use crate::log::dataflash::{HEAD, HEAD_LEN, MAX_RECORD_LEN};

/// One byte in this many at least is in records of known length. Of 64 KiB of a flight all but a thirtieth are, of the last
/// kilobytes half; of anything else none.
const SHARE: usize = 4;

/// Whether a log that begins like this has binary records.
pub(super) fn is_in(head: &[u8]) -> bool {
    let steady = steady_bytes(head);
    steady > 0 && steady >= head.len() / SHARE
}

/// Bytes of what begins as a record and is as long as the one of its type before.
fn steady_bytes(head: &[u8]) -> usize {
    let mut lens = [0; 256];
    let mut steady = 0;
    let mut last = None;
    for place in memchr::memmem::find_iter(head, &HEAD) {
        let Some(before) = last.replace(place) else { continue };
        let len = place - before;
        if (HEAD_LEN..=MAX_RECORD_LEN).contains(&len)
            && mem::replace(&mut lens[usize::from(head[before + 2])], len) == len
        {
            steady += len;
        }
    }
    steady
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// Records of three types in turn.
    fn records(count: usize) -> Vec<u8> {
        let of = |n: usize| {
            [&HEAD[..], &[b'A' + (n % 3) as u8], &vec![n as u8; 20 + n % 3 * 9]].concat()
        };
        (0..count).flat_map(of).collect()
    }

    #[test]
    fn records_are_told_by_their_lengths() {
        let log = records(400);
        for cut in 0..200 {
            assert!(is_in(&log[cut..]), "{cut}");
            assert!(is_in(&log[cut..2000 + cut]), "{cut}");
        }
        let zeros = [&vec![0; 2 * log.len()], &log[..]].concat();
        assert!(is_in(&zeros));
    }

    #[test]
    fn a_few_bytes_or_marks_alone_are_no_log() {
        assert!(!is_in(b""));
        assert!(!is_in(&records(3)));
        assert!(!is_in(&HEAD.repeat(500)));
        assert!(!is_in(&HEAD[..1].repeat(500)));
    }

    proptest! {
        #[test]
        fn noise_is_no_log(noise in proptest::collection::vec(any::<u8>(), 0..5000)) {
            prop_assert!(!is_in(&noise));
        }
    }
}
