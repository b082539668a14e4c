//! Good records that follow each other, found from any place in a log.
//!
//! The result of a [`super::RecordScanner`] hardly ever depends on earlier bytes. At the start of a good record of a
//! known message, with no doubt left, it takes the record and is in the same state again. So threads can search for
//! runs of such records from any guessed start. The scanner never reaches a run that began with a wrong guess. Where it
//! reaches a record of a run, it would have found the same records, and it skips the rest of the run.

use std::ops::Range;

use super::RecordScanner;
use crate::frame::SIGNATURE_LEN;
use crate::registry::Registry;
use crate::scan::{Resync, Scanner, distance_to_stx};

/// Bytes that a failed guess costs at most: those of the frame that it claims to be.
const GUESS_COST: usize = 255 + SIGNATURE_LEN;

/// Bytes of few records: room for one in so many spares nearly every log the growing.
const SHORT_RECORD: usize = 32;

/// A good record of a known message.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Located {
    /// Where it starts in the bytes that were searched, stamp included.
    pub at: u32,
    /// Index of the message in its dialect.
    pub index: u16,
}

/// Records without a gap between them.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Run {
    /// Its bytes.
    pub bytes: Range<usize>,
    /// Its records in [`Runs::records`].
    pub records: Range<usize>,
}

/// The runs that were found in a stretch of a log.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Runs {
    /// The runs in the order of the log.
    pub runs: Vec<Run>,
    /// The records of all runs.
    pub records: Vec<Located>,
}

/// Finds the runs whose records start within `stretch`; the last record may reach beyond it.
///
/// `lead` is [`RecordScanner::lead`]. The work is linear in the length of the stretch: where many guesses fail, as in
/// bytes that an attacker made, the search ends early and leaves the rest to the scanner.
///
/// # Panics
/// Where `bytes` has 4 GiB or more.
pub fn find_runs(bytes: &[u8], stretch: Range<usize>, lead: usize, registry: &Registry) -> Runs {
    assert!(u32::try_from(bytes.len()).is_ok(), "a block is smaller than 4 GiB");
    let room = stretch.len().min(bytes.len()) / SHORT_RECORD;
    let mut found = Runs { records: Vec::with_capacity(room), ..Runs::default() };
    let mut scanner = Scanner::new(Resync::Skip);
    let mut guesses = stretch.len() / GUESS_COST + 1;
    let mut at = stretch.start;
    while at < stretch.end {
        let start = at;
        let first = found.records.len();
        while at < stretch.end
            && let Some(frame) = bytes.get(at + lead..)
            && let Some((len, entry)) = scanner.next_good(frame, registry)
        {
            found.records.push(Located { at: at as u32, index: entry.index });
            at += lead + len;
        }
        if at > start {
            let records = first..found.records.len();
            found.runs.push(Run { bytes: start..at, records });
            continue;
        }
        if guesses == 0 {
            break;
        }
        guesses -= 1;
        at = next_guess(bytes, at + 1, lead);
    }
    found
}

/// The next place from `at` on where a record may start.
fn next_guess(bytes: &[u8], at: usize, lead: usize) -> usize {
    bytes.get(at + lead..).map_or(bytes.len(), |rest| at + distance_to_stx(rest))
}

impl RecordScanner {
    /// The records of `run` that a scanner standing at `at` finds next, where it is sure to find them: their range in
    /// [`Runs::records`], and where they end.
    pub fn rest_of_run(
        &self,
        at: usize,
        run: &Run,
        records: &[Located],
    ) -> Option<(Range<usize>, usize)> {
        if !self.is_settled() || !run.bytes.contains(&at) {
            return None;
        }
        let Range { start, end } = run.records;
        let inside = records[start..end].binary_search_by_key(&at, |r| r.at as usize);
        Some((start + inside.ok()?..end, run.bytes.end))
    }
}
