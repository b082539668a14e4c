//! Where the records of a block are, found on all processors.
//!
//! Each stretch of the block is searched for runs of good records by itself; the scanner that walks through the log passes
//! over the runs that it reaches. On a log without damage it walks a few steps for each block, on a damaged one through
//! the damage. Its outcome is that of one scanner over the whole log, for any blocks and any number of threads.

use std::ops::Range;
use std::sync::Arc;

use mavwire_core::frame::Header;
pub use mavwire_core::log::tlog::Framing;
use mavwire_core::log::tlog::{
    Before, FoundRecord, Located, RecordScanner, Runs, Stamp, find_runs,
};
use mavwire_core::registry::Registry;
use mavwire_core::telemetry::StreamClock;
use rayon::prelude::*;

/// Bytes that are searched in one go: few enough for the last processor not to be waited for long.
pub(crate) const STRETCH: usize = 256 << 10;

/// [`Located::index`] of messages that the dialect does not define.
pub const UNKNOWN: u16 = u16::MAX;

/// The records of a block. Positions are counted from its start.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Scanned {
    /// Bytes consumed.
    pub consumed: usize,
    /// Good records in the order of the log.
    pub records: Vec<Located>,
    /// Records whose time stamp is not believed, and what to take for it.
    pub distrusted: Vec<(u32, u64)>,
    /// In a raw stream, the records at which the time of the stream's clock changes.
    clock: Option<Vec<(u32, u64)>>,
    /// Bytes that belong to no record; what touches is one range.
    pub bad: Vec<Range<usize>>,
}

/// Walks through a log, block by block.
#[derive(Debug, Clone)]
pub struct LogScanner {
    registry: Arc<Registry>,
    scanner: RecordScanner,
    /// Of a raw stream.
    clock: Option<StreamClock>,
    before: Option<Before>,
    after_damage: bool,
    stretch: usize,
}

impl LogScanner {
    /// A scanner at the start of a log.
    pub fn new(registry: Arc<Registry>, framing: Framing) -> Self {
        let scanner = framing.scanner();
        let clock = (framing == Framing::Raw).then(StreamClock::default);
        Self { registry, scanner, clock, before: None, after_damage: false, stretch: STRETCH }
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
        let clock = self.clock.as_ref().map(|clock| clock.now().map(|now| (0, now)).into_iter());
        let clock = clock.map(Iterator::collect);
        let mut out = Scanned { records: Vec::with_capacity(count), clock, ..Scanned::default() };
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
        if let (Some(clock), Some(times)) = (&mut self.clock, &mut out.clock) {
            return hear(clock, &self.registry, block, records, times);
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
    /// How many bytes belong to no record.
    pub(crate) fn bad_bytes(&self) -> u64 {
        self.bad.iter().map(|range| range.len() as u64).sum()
    }

    /// The time of a record in microseconds: since 1970, or in a raw stream that of [`StreamClock`].
    #[inline]
    pub fn time(&self, block: &[u8], at: u32) -> Option<u64> {
        if let Some(clock) = &self.clock {
            let past = clock.partition_point(|&(since, _)| since <= at);
            return past.checked_sub(1).map(|last| clock[last].1);
        }
        if !self.distrusted.is_empty()
            && let Ok(found) = self.distrusted.binary_search_by_key(&at, |&(at, _)| at)
        {
            return Some(self.distrusted[found].1);
        }
        Some(stamp_at(block, at))
    }
}

/// Notes the records of a raw stream at which its clock shows another time.
fn hear(
    clock: &mut StreamClock,
    registry: &Registry,
    block: &[u8],
    records: &[Located],
    times: &mut Vec<(u32, u64)>,
) {
    for &Located { at, index } in records {
        let before = clock.now();
        let now = clock.hear(registry, index, &block[at as usize..]);
        times.extend(now.filter(|_| now != before).map(|now| (at, now)));
    }
}

/// The header of the frame of a record.
#[inline]
pub fn header_at(block: &[u8], at: u32, lead: usize) -> Option<Header> {
    Header::parse(block.get(at as usize + lead..)?)
}
