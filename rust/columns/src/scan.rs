//! Where the records of a block are, found on all processors.
//!
//! Each stretch of the block is searched for runs of good records by itself; the scanner that walks through the log passes
//! over the runs that it reaches. On a log without damage it walks a few steps for each block, on a damaged one through
//! the damage. Its outcome is that of one scanner over the whole log, whatever the blocks and the number of threads.

use std::iter;
use std::ops::Range;
use std::sync::Arc;

use mavwire_core::frame::{Header, MAX_FRAME_LEN, STX_V1, STX_V2};
use mavwire_core::log::tlog::{
    Before, FoundRecord, Located, RecordScanner, Runs, STAMP_LEN, Stamp, find_runs, is_date,
};
use mavwire_core::registry::Registry;
use rayon::prelude::*;

/// Bytes that are searched in one go: few enough for the last processor not to be waited for long.
pub(crate) const STRETCH: usize = 256 << 10;

/// Good records in a row that no other kind of log has.
const SURE_RECORDS: usize = 3;

/// Of so many dates one at most goes back.
const DATES_BACK: usize = 8;

/// [`Located::index`] of ids that the dialect does not know.
pub const UNKNOWN: u16 = u16::MAX;

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
        let is_dated = are_dated(stamped.iter().map(|record| stamp_at(head, record.start as u32)));
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
        [Self::Stamped, Self::Raw].into_iter().any(|framing| {
            let (mut end, mut in_a_row) = (0, 0);
            framing.records(head, registry).any(|record| {
                in_a_row = if record.start == end { in_a_row + 1 } else { 1 };
                end = record.end;
                in_a_row == SURE_RECORDS
            })
        })
    }

    /// Bytes that good records have in the form that gives more of them.
    pub(crate) fn bytes_in(head: &[u8], registry: &Registry) -> usize {
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

    fn scanner(self) -> RecordScanner {
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
fn are_dated(stamps: impl Iterator<Item = u64>) -> bool {
    let (mut frames, mut dates, mut back, mut last) = (0, 0, 0, 0);
    for stamp in stamps {
        frames += 1;
        if is_date(stamp) {
            dates += 1;
            back += usize::from(stamp < last);
            last = stamp;
        }
    }
    2 * dates > frames && DATES_BACK * back <= dates
}

/// The records of a block. Positions are counted from its start.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Scanned {
    /// Bytes dealt with.
    pub consumed: usize,
    /// Good records in the order of the log.
    pub records: Vec<Located>,
    /// Records whose time stamp is not believed, and what to take for it.
    pub distrusted: Vec<(u32, u64)>,
    /// Bytes that belong to no record; what touches is one range.
    pub bad: Vec<Range<usize>>,
}

/// Walks through a log, block by block.
#[derive(Debug, Clone)]
pub struct LogScanner {
    registry: Arc<Registry>,
    scanner: RecordScanner,
    before: Option<Before>,
    after_damage: bool,
    stretch: usize,
}

impl LogScanner {
    /// A scanner at the start of a log.
    pub fn new(registry: Arc<Registry>, framing: Framing) -> Self {
        let scanner = framing.scanner();
        Self { registry, scanner, before: None, after_damage: false, stretch: STRETCH }
    }

    /// Searches in stretches of another size.
    #[must_use]
    pub fn with_stretch(mut self, stretch: usize) -> Self {
        self.stretch = stretch.max(1);
        self
    }

    /// Bytes of a record in front of its frame.
    pub fn lead(&self) -> usize {
        self.scanner.lead()
    }

    /// The messages of the log.
    pub fn registry(&self) -> &Arc<Registry> {
        &self.registry
    }

    /// Finds the records of `block`, which starts where the last one was consumed to.
    pub fn scan(&mut self, block: &[u8], at_end: bool) -> Scanned {
        let lead = self.lead();
        let starts: Vec<usize> = (0..block.len()).step_by(self.stretch).collect();
        let found: Vec<Runs> = starts
            .par_iter()
            .with_max_len(1)
            .map(|&start| {
                let end = block.len().min(start + self.stretch);
                find_runs(block, start..end, lead, &self.registry)
            })
            .collect();
        self.put_together(block, at_end, &found)
    }

    fn put_together(&mut self, block: &[u8], at_end: bool, found: &[Runs]) -> Scanned {
        let count = found.iter().map(|runs| runs.records.len()).sum();
        let mut out = Scanned { records: Vec::with_capacity(count), ..Scanned::default() };
        let mut ahead = found
            .iter()
            .flat_map(|runs| runs.runs.iter().map(|run| (run, &runs.records[..])))
            .peekable();
        loop {
            while ahead.next_if(|(run, _)| run.bytes.end <= out.consumed).is_some() {}
            if let Some((run, records)) = ahead.peek()
                && let Some((rest, end)) = self.scanner.rest_of_run(out.consumed, run, records)
            {
                self.take_run(block, &records[rest], &mut out);
                self.scanner.pass_run(end - out.consumed);
                out.consumed = end;
            } else if !self.step(block, at_end, &mut out) {
                return out;
            }
        }
    }

    /// One step of the walk; false at the end of the block.
    fn step(&mut self, block: &[u8], at_end: bool, out: &mut Scanned) -> bool {
        let at = out.consumed;
        match self.scanner.next(&block[at..], &self.registry, at_end) {
            FoundRecord::Record { len, entry, .. } => {
                let index = entry.map_or(UNKNOWN, |entry| entry.index);
                self.take_run(block, &[Located { at: at as u32, index }], out);
                out.consumed += len;
            }
            FoundRecord::Junk { len } => {
                self.after_damage = true;
                match out.bad.last_mut().filter(|bad| bad.end == at) {
                    Some(bad) => bad.end += len,
                    None => out.bad.push(at..at + len),
                }
                out.consumed += len;
            }
            FoundRecord::Incomplete { .. } => return false,
        }
        true
    }

    fn take_run(&mut self, block: &[u8], records: &[Located], out: &mut Scanned) {
        let (Some(first), Some(last)) = (records.first(), records.last()) else { return };
        out.records.extend_from_slice(records);
        if self.lead() == 0 {
            return; // a raw stream has no times to believe
        }
        let mut before = Before::of(stamp_at(block, first.at));
        if self.after_damage
            && let Some(good) = self.before
            && !good.believes(before.stamp)
        {
            out.distrusted.push((first.at, good.time));
            before.time = good.time;
        }
        self.after_damage = false;
        self.before =
            Some(if records.len() > 1 { Before::of(stamp_at(block, last.at)) } else { before });
    }
}

/// The time stamp at a place in a block; 0 where it does not fit in.
pub fn stamp_at(block: &[u8], at: u32) -> u64 {
    block.get(at as usize..).and_then(Stamp::parse).map_or(0, Stamp::micros)
}

impl Scanned {
    /// The time of a record, microseconds since 1970.
    #[inline]
    pub fn time(&self, block: &[u8], at: u32) -> u64 {
        if !self.distrusted.is_empty()
            && let Ok(found) = self.distrusted.binary_search_by_key(&at, |&(at, _)| at)
        {
            return self.distrusted[found].1;
        }
        stamp_at(block, at)
    }
}

/// The header of the frame of a record.
#[inline]
pub fn header_at(block: &[u8], at: u32, lead: usize) -> Option<Header> {
    Header::parse(block.get(at as usize + lead..)?)
}
