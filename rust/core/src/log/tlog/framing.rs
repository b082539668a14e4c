//! Whether the records of a telemetry log have time stamps, told by its first bytes.

use std::iter;
use std::ops::Range;

use super::{FoundRecord, RecordScanner, STAMP_LEN, Stamp, is_date};
use crate::frame::{MAX_FRAME_LEN, STX_V1, STX_V2};
use crate::registry::Registry;

/// Good records in a row that no other kind of log has.
const SURE_RECORDS: usize = 3;

/// Of so many dates one at most goes back.
const DATES_BACK: usize = 8;

/// What a log looks like.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Framing {
    /// Records of time stamp and frame.
    Stamped,
    /// Frames alone.
    Raw,
}

impl Framing {
    /// Bytes of a record in front of its frame.
    pub fn lead(self) -> usize {
        match self {
            Self::Stamped => STAMP_LEN,
            Self::Raw => 0,
        }
    }

    /// What a log is that begins with these bytes: the way in which more records follow each other, or failing that the one in
    /// which the first record is good, or the one of which frames have dates in front, in their order, or none.
    pub fn of(head: &[u8], registry: &Registry) -> Self {
        let stamped: Vec<_> = Self::Stamped.records(head, registry).collect();
        let is_dated = are_dated(stamped.iter().filter_map(|one| Stamp::parse(&head[one.start..])));
        if is_dated && !begins_with_frame(head) && is_whole(&stamped, head) {
            return Self::Stamped; // as nearly every log: frames alone need not be looked for
        }
        let raw: Vec<_> = Self::Raw.records(head, registry).collect();
        let begins = |found: &[Range<usize>]| found.first().is_some_and(|first| first.start == 0);
        let for_stamped = (following(&stamped), begins(&stamped), is_dated);
        let for_raw = (following(&raw), begins(&raw), !raw.is_empty() && !is_dated);
        if for_raw > for_stamped { Self::Raw } else { Self::Stamped }
    }

    /// Whether these bytes have good records one behind the other in either form: chance makes no three of them.
    pub fn is_in(head: &[u8], registry: &Registry) -> bool {
        [Self::Stamped, Self::Raw].into_iter().any(|framing| framing.has_row(head, registry))
    }

    /// The same of this form. Fewer records do where there is nothing else.
    pub fn is_sure(self, head: &[u8], registry: &Registry) -> bool {
        let bytes = || self.records(head, registry).map(|one| one.len()).sum::<usize>();
        self.has_row(head, registry) || !head.is_empty() && bytes() == head.len()
    }

    fn has_row(self, head: &[u8], registry: &Registry) -> bool {
        let (mut end, mut in_a_row) = (0, 0);
        self.records(head, registry).any(|record| {
            in_a_row = if record.start == end { in_a_row + 1 } else { 1 };
            end = record.end;
            in_a_row == SURE_RECORDS
        })
    }

    /// Bytes that good records have in the form that gives more of them.
    pub fn bytes_in(head: &[u8], registry: &Registry) -> usize {
        let bytes =
            |framing: Self| framing.records(head, registry).map(|one| one.len()).sum::<usize>();
        bytes(Self::Stamped).max(bytes(Self::Raw))
    }

    /// Where the good records of known messages are in these bytes.
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

    /// What finds its records.
    pub fn scanner(self) -> RecordScanner {
        match self {
            Self::Stamped => RecordScanner::new(),
            Self::Raw => RecordScanner::unstamped(),
        }
    }
}

fn begins_with_frame(head: &[u8]) -> bool {
    head.first().is_some_and(|first| matches!(*first, STX_V1 | STX_V2))
}

/// Whether these records are all that there is, but for one that goes on behind the head.
fn is_whole(records: &[Range<usize>], head: &[u8]) -> bool {
    let all = following(records) + 1 == records.len();
    let (first, last) = (records.first(), records.last());
    all && first.is_some_and(|first| first.start == 0)
        && last.is_some_and(|last| head.len() - last.end < STAMP_LEN + MAX_FRAME_LEN)
}

/// How many records begin where the one in front of them ends.
fn following(records: &[Range<usize>]) -> usize {
    records.windows(2).filter(|two| two[0].end == two[1].start).count()
}

/// Whether most of what stands in front of frames are dates, of which hardly one goes back: the ends of HEARTBEATs, which look
/// like dates as well, do half of the time.
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
