//! Binary logs that lack their first bytes, and with them what describes their records.
//!
//! Nothing can be read of them, but they are no telemetry logs: some megabytes of any bytes have a telemetry record or two
//! by chance. What tells them is that records of a type are all of one length, so that from a head to the next one it is as
//! far as it was the last time.

use std::mem;

use mavwire_core::log::dataflash::HEAD_LEN;
use mavwire_core::registry::Registry;

use crate::scan::Framing;

/// How the head of a record begins; the type is its third byte.
const MARK: &[u8] = b"\xA3\x95";
/// Bytes of a record at most.
const MOST_LEN: usize = 255;
/// One byte in this many at least is in records of known length. Of 64 KiB of a flight all but a thirtieth are, of the last
/// kilobytes half; of anything else none.
const SHARE: usize = 4;
/// Bytes of such records for each byte that telemetry records may have among them, which carry pieces of a dataflash log where
/// one was downloaded.
const OVER_TELEMETRY: usize = 16;

/// Whether a log that begins like this has binary records, and hardly any telemetry.
pub(super) fn is_in(head: &[u8], telemetry: &Registry) -> bool {
    let steady = steady_bytes(head);
    let is_binary = steady > 0 && steady >= head.len() / SHARE;
    is_binary && Framing::bytes_in(head, telemetry) * OVER_TELEMETRY < steady
}

/// Bytes of what begins as a record and is as long as the one of its type before.
fn steady_bytes(head: &[u8]) -> usize {
    let mut lens = [0; 256];
    let mut steady = 0;
    let mut last = None;
    for place in memchr::memmem::find_iter(head, MARK) {
        let Some(before) = last.replace(place) else { continue };
        let len = place - before;
        if (HEAD_LEN..=MOST_LEN).contains(&len)
            && mem::replace(&mut lens[usize::from(head[before + 2])], len) == len
        {
            steady += len;
        }
    }
    steady
}

#[cfg(test)]
mod tests {
    use std::sync::LazyLock;

    use mavwire_core::builtin;
    use mavwire_schema::WireVersion;
    use proptest::prelude::*;

    use super::*;

    static ALL: LazyLock<Registry> = LazyLock::new(|| {
        Registry::new(builtin::dialect("all", WireVersion::V2).expect("it is built in"))
    });

    /// Records of three types in turn.
    fn records(count: usize) -> Vec<u8> {
        let of =
            |n: usize| [MARK, &[b'A' + (n % 3) as u8], &vec![n as u8; 20 + n % 3 * 9]].concat();
        (0..count).flat_map(of).collect()
    }

    #[test]
    fn records_are_told_by_their_lengths() {
        let log = records(400);
        for cut in 0..200 {
            assert!(is_in(&log[cut..], &ALL), "{cut}");
            assert!(is_in(&log[cut..2000 + cut], &ALL), "{cut}");
        }
        let zeros = [&vec![0; 2 * log.len()], &log[..]].concat();
        assert!(is_in(&zeros, &ALL));
    }

    #[test]
    fn a_few_bytes_or_marks_alone_are_no_log() {
        assert!(!is_in(b"", &ALL));
        assert!(!is_in(&records(3), &ALL));
        assert!(!is_in(&MARK.repeat(500), &ALL));
        assert!(!is_in(&MARK[..1].repeat(500), &ALL));
    }

    proptest! {
        #[test]
        fn noise_is_no_log(noise in proptest::collection::vec(any::<u8>(), 0..5000)) {
            prop_assert!(!is_in(&noise, &ALL));
        }
    }
}
