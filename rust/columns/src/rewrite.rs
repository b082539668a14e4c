//! A telemetry log made of another: its good records, or some of them, perhaps without what tells who flew where.

use std::cmp::Reverse;
use std::collections::BinaryHeap;
use std::collections::binary_heap::PeekMut;
use std::io::{Read, Write};
use std::iter::Sum;
use std::sync::Arc;

use mavwire_core::anonymize::Anonymizer;
use mavwire_core::log::tlog::{Located, STAMP_LEN, are_near, is_date};
use mavwire_core::registry::Registry;

use crate::error::Error;
use crate::input::{Blocks, Steps};
use crate::scan::{Framing, LogScanner, Scanned, header_at, stamp_at};
use crate::select::Wanted;

/// What became of a log.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Outcome {
    /// Bytes read, decompressed.
    pub bytes: u64,
    /// Good records in them.
    pub records: u64,
    /// Records that were written.
    pub written: u64,
    /// Bytes of no record.
    pub bad_bytes: u64,
    /// Places where such bytes are.
    pub bad_places: u64,
    /// Records whose time was not believed and is now that of the last good one.
    pub restamped: u64,
}

impl Outcome {
    /// Whether there is something, and no record in it.
    fn has_no_records(&self, blocks: &Blocks) -> bool {
        self.records == 0 && (self.bytes > 0 || blocks.damage().is_some())
    }

    /// Adds a block of a log; `in_damage` is whether the block before ended within bytes of no record.
    fn add(&mut self, scanned: &Scanned, in_damage: &mut bool) {
        let goes_on = *in_damage && scanned.bad.first().is_some_and(|range| range.start == 0);
        if scanned.consumed > 0 {
            *in_damage = scanned.bad.last().is_some_and(|range| range.end == scanned.consumed);
        }
        self.bytes += scanned.consumed as u64;
        self.records += scanned.records.len() as u64;
        self.bad_bytes += scanned.bad_bytes();
        self.bad_places += scanned.bad.len() as u64 - u64::from(goes_on);
        self.restamped += scanned.distrusted.len() as u64;
    }
}

impl Sum for Outcome {
    fn sum<I: Iterator<Item = Self>>(all: I) -> Self {
        all.fold(Self::default(), |sum, one| Self {
            bytes: sum.bytes + one.bytes,
            records: sum.records + one.records,
            written: sum.written + one.written,
            bad_bytes: sum.bad_bytes + one.bad_bytes,
            bad_places: sum.bad_places + one.bad_places,
            restamped: sum.restamped + one.restamped,
        })
    }
}

/// Finds the records of a log, and replaces a damaged time between good ones. Its frame may be intact, so that nothing else
/// shows the damage.
struct Mender {
    scanner: LogScanner,
    framing: Framing,
    /// The time of the last record.
    before: Option<u64>,
}

impl Mender {
    fn new(steps: Steps, registry: Arc<Registry>, framing: Framing) -> Self {
        let scanner = LogScanner::new(registry, framing).with_stretch(steps.stretch);
        Self { scanner, framing, before: None }
    }

    fn scan(&mut self, block: &[u8], at_end: bool) -> Scanned {
        if self.framing == Framing::Raw {
            return self.scanner.scan(block, at_end);
        }
        // Leaves the time behind the last record to be seen.
        let len = if at_end { block.len() } else { block.len().saturating_sub(STAMP_LEN) };
        let mut scanned = self.scanner.scan(&block[..len], at_end);
        let mut replaced: Vec<_> = scanned
            .records
            .iter()
            .filter_map(|record| self.judge(block, &scanned, *record))
            .collect();
        if !replaced.is_empty() {
            replaced.append(&mut scanned.distrusted);
            replaced.sort_by_key(|&(at, _)| at);
            replaced.dedup_by_key(|&mut (at, _)| at);
            scanned.distrusted = replaced;
        }
        scanned
    }

    /// What to take for the time of a record that those in front and behind contradict.
    fn judge(&mut self, block: &[u8], scanned: &Scanned, record: Located) -> Option<(u32, u64)> {
        let time = scanned.time(block, record.at)?;
        let before = *self.before.get_or_insert(time);
        if !are_near(time, before) {
            let lead = self.framing.lead();
            let len = lead + header_at(block, record.at, lead)?.frame_len();
            let behind = stamp_at(block, record.at + len as u32);
            if is_date(behind) && are_near(before, behind) && !are_near(time, behind) {
                return Some((record.at, before));
            }
        }
        self.before = Some(time);
        None
    }
}

/// A log being rewritten.
pub struct Rewrite {
    blocks: Blocks,
    mender: Mender,
    framing: Framing,
    wanted: Wanted,
    anonymizer: Option<Anonymizer>,
    outcome: Outcome,
    in_damage: bool,
}

impl Rewrite {
    /// A run that keeps what is `wanted` of a log, perhaps compressed, or of one that is known to be framed like this, and
    /// plain.
    ///
    /// # Errors
    /// What reading says.
    pub fn new(
        steps: Steps,
        source: Box<dyn Read + Send>,
        framing: Option<Framing>,
        registry: Arc<Registry>,
        wanted: Wanted,
        anonymizer: Option<Anonymizer>,
    ) -> Result<Self, Error> {
        let (blocks, framing) = Blocks::framed(source, framing, &registry, steps.block)?;
        let mender = Mender::new(steps, registry, framing);
        let (outcome, in_damage) = Default::default();
        Ok(Self { blocks, mender, framing, wanted, anonymizer, outcome, in_damage })
    }

    /// Whether records have times.
    pub fn framing(&self) -> Framing {
        self.framing
    }

    /// What became of the log so far.
    pub fn outcome(&self) -> Outcome {
        self.outcome
    }

    /// What is wrong with the compressed file, of which everything before that was read.
    pub fn damage(&self) -> Option<&str> {
        self.blocks.damage()
    }

    /// Whether the log, which was read to its end, holds something and no record.
    pub fn has_no_records(&self) -> bool {
        self.outcome.has_no_records(&self.blocks)
    }

    /// Writes what is kept of another block; false at the end.
    ///
    /// # Errors
    /// What reading and writing say.
    pub fn advance(&mut self, out: &mut dyn Write) -> Result<bool, Error> {
        let Self { blocks, mender, framing, wanted, anonymizer, outcome, in_damage } = self;
        let kept = blocks.next(|block, at_end| {
            let scanned = mender.scan(block, at_end);
            let mut kept = Vec::with_capacity(scanned.consumed);
            for record in &scanned.records {
                let is_kept = wanted.wants(block, framing.lead(), &scanned, *record)
                    && put(
                        &mut kept,
                        block,
                        *framing,
                        &scanned,
                        *record,
                        mender.scanner.registry(),
                        anonymizer.as_ref(),
                    );
                outcome.written += u64::from(is_kept);
            }
            outcome.add(&scanned, in_damage);
            (scanned.consumed, kept)
        })?;
        let Some(kept) = kept else { return Ok(false) };
        out.write_all(&kept)?;
        Ok(true)
    }
}

/// Appends a record; false if nothing of it may be kept.
fn put(
    out: &mut Vec<u8>,
    block: &[u8],
    framing: Framing,
    scanned: &Scanned,
    record: Located,
    registry: &Registry,
    anonymizer: Option<&Anonymizer>,
) -> bool {
    let lead = framing.lead();
    let Some(header) = header_at(block, record.at, lead) else { return false };
    let (start, before) = (record.at as usize + lead, out.len());
    let frame = &block[start..start + header.frame_len()];
    if framing == Framing::Stamped {
        out.extend_from_slice(&time_of(scanned, block, record).to_be_bytes());
    }
    match anonymizer {
        None => out.extend_from_slice(frame),
        Some(anonymizer) => {
            let entry = registry.entry(record.index);
            if !anonymizer.apply(frame, &header, entry, out) {
                out.truncate(before);
                return false;
            }
        }
    }
    true
}

/// The time of a record of a log that has time stamps.
fn time_of(scanned: &Scanned, block: &[u8], record: Located) -> u64 {
    scanned.time(block, record.at).unwrap_or_default()
}

/// Several logs being merged in the order of time.
pub struct Merge {
    logs: Vec<Input>,
}

/// One of them: the records of a block, and how many of them were taken.
struct Input {
    blocks: Blocks,
    mender: Mender,
    bytes: Vec<u8>,
    /// Time, and where it ends in `bytes`.
    records: Vec<(u64, usize)>,
    taken: usize,
    ended: bool,
    outcome: Outcome,
    in_damage: bool,
}

impl Merge {
    /// A run over logs; each is read in its own order, and of records of one time that of the first log comes first.
    ///
    /// # Errors
    /// What reading says; a raw stream, which has no time stamps, with its place among the logs.
    pub fn new(
        steps: Steps,
        sources: Vec<Box<dyn Read + Send>>,
        registry: &Arc<Registry>,
    ) -> Result<Result<Self, usize>, Error> {
        let mut logs = Vec::new();
        for (place, source) in sources.into_iter().enumerate() {
            let (blocks, framing) = Blocks::framed(source, None, registry, steps.block)?;
            if framing == Framing::Raw {
                return Ok(Err(place));
            }
            let mender = Mender::new(steps, Arc::clone(registry), framing);
            let (bytes, records) = (Vec::new(), Vec::new());
            logs.push(Input {
                blocks,
                mender,
                bytes,
                records,
                taken: 0,
                ended: false,
                outcome: Outcome::default(),
                in_damage: false,
            });
        }
        Ok(Ok(Self { logs }))
    }

    /// What became of the logs so far.
    pub fn outcome(&self) -> Outcome {
        self.logs.iter().map(|log| log.outcome).sum()
    }

    /// The places of the logs, which were read to their ends, that hold something and no record, and what is wrong with such
    /// a compressed file.
    pub fn without_records(&self) -> Vec<(usize, Option<&str>)> {
        let logs = self.logs.iter().enumerate();
        let without_records = logs.filter(|(_, log)| log.outcome.has_no_records(&log.blocks));
        without_records.map(|(place, log)| (place, log.blocks.damage())).collect()
    }

    /// The places of the logs whose compressed files are damaged, and what is wrong with them.
    pub fn damage(&self) -> Vec<(usize, &str)> {
        let logs = self.logs.iter().enumerate();
        logs.filter_map(|(place, log)| Some((place, log.blocks.damage()?))).collect()
    }

    /// Writes what can be ordered until the next block of a log is needed; false at the end.
    ///
    /// # Errors
    /// What reading and writing say.
    pub fn advance(&mut self, out: &mut dyn Write) -> Result<bool, Error> {
        for log in &mut self.logs {
            while log.taken == log.records.len() && !log.ended {
                log.refill()?;
            }
        }
        let next = |(place, log): (usize, &Input)| Some(Reverse((log.time()?, place)));
        let mut fronts: BinaryHeap<_> = self.logs.iter().enumerate().filter_map(next).collect();
        let mut any = false;
        let mut merged = Vec::new();
        while let Some(mut front) = fronts.peek_mut() {
            let log = &mut self.logs[front.0.1];
            merged.extend_from_slice(log.take());
            any = true;
            match log.time() {
                Some(time) => front.0.0 = time,
                None if log.ended => drop(PeekMut::pop(front)),
                None => break,
            }
        }
        out.write_all(&merged)?;
        Ok(any)
    }
}

impl Input {
    /// The time of the next record, of those that are there.
    fn time(&self) -> Option<u64> {
        self.records.get(self.taken).map(|&(time, _)| time)
    }

    fn take(&mut self) -> &[u8] {
        let start = if self.taken == 0 { 0 } else { self.records[self.taken - 1].1 };
        let end = self.records[self.taken].1;
        self.taken += 1;
        self.outcome.written += 1;
        &self.bytes[start..end]
    }

    fn refill(&mut self) -> Result<(), Error> {
        let Self { blocks, mender, bytes, records, taken, ended, outcome, in_damage } = self;
        bytes.clear();
        records.clear();
        *taken = 0;
        let more = blocks.next(|block, at_end| {
            let scanned = mender.scan(block, at_end);
            for record in &scanned.records {
                let framing = Framing::Stamped;
                if put(bytes, block, framing, &scanned, *record, mender.scanner.registry(), None) {
                    records.push((time_of(&scanned, block, *record), bytes.len()));
                }
            }
            outcome.add(&scanned, in_damage);
            (scanned.consumed, ())
        })?;
        *ended = more.is_none();
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use mavwire_core::builtin;
    use mavwire_core::frame::{self, Header};
    use mavwire_schema::WireVersion;

    /// Messages of a system at these times.
    fn log(times: impl Iterator<Item = u64>, sysid: u8) -> Vec<u8> {
        let mut log = Vec::new();
        for (seq, time) in times.enumerate() {
            let header = Header {
                version: WireVersion::V2,
                payload_len: 0,
                incompat_flags: 0,
                compat_flags: 0,
                seq: seq as u8,
                sysid,
                compid: 1,
                msgid: 0,
            };
            log.extend_from_slice(&time.to_be_bytes());
            frame::encode(&mut log, header, &[1; 9], 50).expect("a frame");
        }
        log
    }

    #[test]
    fn damage_that_goes_on_in_another_block_is_one_place() {
        let dialect = builtin::dialect("common", WireVersion::V2).expect("the dialect");
        let registry = Arc::new(Registry::new(dialect));
        let (front, rest) = (log(0..10, 1), log(20..30, 1));
        let bytes = [&front[..], &[7; 500], &rest, &[7; 300], &front].concat();
        let source = || -> Box<dyn Read + Send> { Box::new(std::io::Cursor::new(bytes.clone())) };
        for block in [40, 100, 333, 1 << 20] {
            let (steps, registry) = (Steps { block, ..Steps::default() }, Arc::clone(&registry));
            let framing = Some(Framing::Stamped);
            let wanted = Wanted::default();
            let rewrite = Rewrite::new(steps, source(), framing, registry, wanted, None);
            let (mut rewrite, mut out) = (rewrite.expect("reading"), Vec::new());
            while rewrite.advance(&mut out).expect("writing") {}
            let outcome = rewrite.outcome();
            assert_eq!((outcome.written, outcome.bad_bytes), (30, 800), "blocks of {block}");
            assert_eq!(outcome.bad_places, 2, "blocks of {block}");
        }
    }

    #[test]
    fn a_wrong_time_between_good_ones_is_replaced_by_the_one_in_front() {
        let dialect = builtin::dialect("common", WireVersion::V2).expect("the dialect");
        let registry = Arc::new(Registry::new(dialect));
        let day = 24 * 3600 * 1_000_000;
        let start = 20_000 * day;
        // The clock is set twice, which is no damage; a single time at either end is contradicted by one other.
        let times =
            [9 * day, 1, 2, start, start + 1, start + 2, 0, start + 3, u64::MAX, start + 4, 7];
        let mended = [
            9 * day,
            1,
            2,
            start,
            start + 1,
            start + 2,
            start + 2,
            start + 3,
            start + 3,
            start + 4,
            7,
        ];
        let (bytes, expected) = (log(times.into_iter(), 1), log(mended.into_iter(), 1));
        for block in [1, 8, 29, 40, 100, 1 << 20] {
            let source = Box::new(std::io::Cursor::new(bytes.clone()));
            let (steps, framing) = (Steps { block, ..Steps::default() }, Some(Framing::Stamped));
            let registry = Arc::clone(&registry);
            let rewrite = Rewrite::new(steps, source, framing, registry, Wanted::default(), None);
            let (mut rewrite, mut out) = (rewrite.expect("reading"), Vec::new());
            while rewrite.advance(&mut out).expect("writing") {}
            assert_eq!(out, expected, "blocks of {block}");
            assert_eq!(rewrite.outcome().restamped, 2, "blocks of {block}");
        }
    }

    #[test]
    fn a_clock_that_is_set_in_front_of_zeros_is_no_damage() {
        let dialect = builtin::dialect("common", WireVersion::V2).expect("the dialect");
        let registry = Arc::new(Registry::new(dialect));
        let records = log([5_000_000, 6_000_000, 1_700_000_000_000_000].into_iter(), 1);
        let bytes = [&records[..], &[0; 40], &records[records.len() / 3 * 2..]].concat();
        for (bytes, count) in [(records, 3), (bytes, 4)] {
            let source = Box::new(std::io::Cursor::new(bytes));
            let (steps, framing) = (Steps::default(), Some(Framing::Stamped));
            let registry = Arc::clone(&registry);
            let rewrite = Rewrite::new(steps, source, framing, registry, Wanted::default(), None);
            let (mut rewrite, mut out) = (rewrite.expect("reading"), Vec::new());
            while rewrite.advance(&mut out).expect("writing") {}
            assert_eq!((rewrite.outcome().written, rewrite.outcome().restamped), (count, 0));
        }
    }

    #[test]
    fn any_blocks_merge_to_the_same() {
        let dialect = builtin::dialect("common", WireVersion::V2).expect("the dialect");
        let registry = Arc::new(Registry::new(dialect));
        let logs = [
            log((0..300).map(|n| 1000 + 7 * n), 1),
            log((0..100).map(|n| 1000 + 21 * n), 2),
            log((0..500).map(|n| 400 + 3 * n), 3),
            Vec::new(),
        ];
        let mut expected: Vec<&[u8]> = logs.iter().flat_map(|log| log.chunks(29)).collect();
        // Stable: of one time, the first log's comes first.
        expected.sort_by_key(|record| record[..8].to_vec());
        for block in [40, 1000, 1 << 20] {
            let source = |log: &Vec<u8>| -> Box<dyn Read + Send> {
                Box::new(std::io::Cursor::new(log.clone()))
            };
            let sources = logs.iter().map(source).collect();
            let steps = Steps { block, ..Steps::default() };
            let merge = Merge::new(steps, sources, &registry).expect("reading");
            let (mut merge, mut out) = (merge.expect("times"), Vec::new());
            while merge.advance(&mut out).expect("merging") {}
            assert_eq!(out, expected.concat(), "blocks of {block}");
            assert_eq!((merge.outcome().written, merge.outcome().bad_bytes), (900, 0));
        }
    }
}
