//! Recognises by the first bytes of a telemetry log whether its records have time stamps.

use std::iter;
use std::ops::Range;

use super::{FoundRecord, RecordScanner, STAMP_LEN, Stamp, is_date};
use crate::frame::{MAX_FRAME_LEN, STX_V1, STX_V2};
use crate::registry::Registry;

/// So many good records in a row occur in no other kind of file.
const SURE_RECORDS: usize = 3;

/// And so does one byte in so many that is in a good record: of 64 KiB of noise one in hundreds has a record at all.
const SURE_SHARE: usize = 16;

/// At most one of so many dates goes back.
const DATES_BACK: usize = 8;

/// Whether the records of a telemetry log have time stamps.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Framing {
    /// Records of time stamp and frame.
    #[default]
    Stamped,
    /// Each record is a frame: a raw stream.
    Raw,
}

impl Framing {
    /// Length of a record in front of its frame.
    pub fn lead(self) -> usize {
        match self {
            Self::Stamped => STAMP_LEN,
            Self::Raw => 0,
        }
    }

    /// The form of a log that begins with these bytes: the one in which more records follow each other. If both have as many,
    /// it is the form whose first record is good. After that, ordered dates in front of the frames decide.
    pub fn of(head: &[u8], registry: &Registry) -> Self {
        let stamped: Vec<_> = Self::Stamped.records(head, registry).collect();
        let is_dated = are_dated(stamped.iter().filter_map(|one| Stamp::parse(&head[one.start..])));
        if is_dated && !begins_with_frame(head) && is_whole(&stamped, head) {
            return Self::Stamped; // nearly every log: the search for frames alone is saved
        }
        let raw: Vec<_> = Self::Raw.records(head, registry).collect();
        let begins = |found: &[Range<usize>]| found.first().is_some_and(|first| first.start == 0);
        let for_stamped = (following(&stamped), begins(&stamped), is_dated);
        let for_raw = (following(&raw), begins(&raw), !raw.is_empty() && !is_dated);
        if for_raw > for_stamped { Self::Raw } else { Self::Stamped }
    }

    /// The form of a telemetry log that begins with these bytes; `None` where it is in doubt that they are one.
    pub fn sure(head: &[u8], registry: &Registry) -> Option<Self> {
        let framing = Self::of(head, registry);
        let (mut bytes, mut end, mut in_a_row) = (0, 0, 0);
        // A frame by itself may have lost its time stamp. At the start or behind another one it had none.
        let mut is_framed = framing == Self::Stamped;
        let is_sure = framing.records(head, registry).any(|record| {
            is_framed |= record.start == end;
            in_a_row = if record.start == end { in_a_row + 1 } else { 1 };
            bytes += record.len();
            end = record.end;
            in_a_row == SURE_RECORDS || is_framed && bytes * SURE_SHARE >= head.len()
        });
        is_sure.then_some(framing)
    }

    /// The ranges of good records of known messages.
    fn records(self, head: &[u8], registry: &Registry) -> impl Iterator<Item = Range<usize>> {
        let (mut scanner, mut at) = (self.scanner(), 0);
        iter::from_fn(move || {
            loop {
                let start = at;
                match scanner.next(&head[at..], registry, true) {
                    FoundRecord::Record { len, entry, .. } => {
                        at += len;
                        if entry.is_some() {
                            return Some(start..at);
                        }
                    }
                    FoundRecord::Junk { len } => at += len,
                    FoundRecord::Incomplete { .. } => return None,
                }
            }
        })
    }

    /// A scanner for records of this form.
    pub fn scanner(self) -> RecordScanner {
        RecordScanner::with_lead(self.lead())
    }
}

fn begins_with_frame(head: &[u8]) -> bool {
    head.first().is_some_and(|first| matches!(*first, STX_V1 | STX_V2))
}

/// Whether these records fill the head. The last one may be cut off.
fn is_whole(records: &[Range<usize>], head: &[u8]) -> bool {
    let all = following(records) + 1 == records.len();
    let (first, last) = (records.first(), records.last());
    all && first.is_some_and(|first| first.start == 0)
        && last.is_some_and(|last| head.len() - last.end < STAMP_LEN + MAX_FRAME_LEN)
}

/// The number of records that begin where the previous one ends.
fn following(records: &[Range<usize>]) -> usize {
    records.windows(2).filter(|two| two[0].end == two[1].start).count()
}

/// Whether most frames have a date in front, and hardly any date goes back. The ends of HEARTBEATs look like dates too, but
/// half of them go back.
fn are_dated(stamps: impl Iterator<Item = Stamp>) -> bool {
    let (mut frames, mut dates, mut back, mut last) = (0, 0, 0, 0);
    for stamp in stamps.map(Stamp::micros) {
        frames += 1;
        if is_date(stamp) {
            dates += 1;
            back += usize::from(stamp < last);
            last = stamp;
        }
    }
    2 * dates > frames && DATES_BACK * back <= dates
}
