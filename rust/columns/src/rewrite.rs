//! A telemetry log made of others: their good records, or some of them, perhaps without what tells who flew where.

use std::cmp::Reverse;
use std::collections::BinaryHeap;
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

/// Counts of a log's bytes and records.
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

    /// The place and the corrected time of a record whose time disagrees with both neighbours, which agree.
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

/// Logs being rewritten as one, in the order of time.
pub struct Rewrite {
    logs: Vec<Input>,
    wanted: Wanted,
    anonymizer: Option<Anonymizer>,
}

/// One of the logs: what is kept of a block, and how many records of that were taken.
struct Input {
    blocks: Blocks,
    mender: Mender,
    bytes: Vec<u8>,
    /// Time, and where the record ends in `bytes`.
    records: Vec<(u64, usize)>,
    taken: usize,
    ended: bool,
    outcome: Outcome,
    in_damage: bool,
}

impl Rewrite {
    /// A run that keeps what is `wanted` of logs, perhaps compressed, or of logs that are known to be framed like this, and
    /// plain. Each is read in its own order, and of records of one time that of the first log comes first.
    ///
    /// # Errors
    /// Errors of reading.
    pub fn new(
        steps: Steps,
        sources: Vec<Box<dyn Read + Send>>,
        framing: Option<Framing>,
        registry: &Arc<Registry>,
        wanted: Wanted,
        anonymizer: Option<Anonymizer>,
    ) -> Result<Self, Error> {
        let input = |source| {
            let (blocks, framing) = Blocks::framed(source, framing, registry, steps.block)?;
            let mender = Mender::new(steps, Arc::clone(registry), framing);
            let (bytes, records, outcome) = Default::default();
            let (taken, ended, in_damage) = (0, false, false);
            Ok(Input { blocks, mender, bytes, records, taken, ended, outcome, in_damage })
        };
        let logs = sources.into_iter().map(input).collect::<Result<_, Error>>()?;
        Ok(Self { logs, wanted, anonymizer })
    }

    /// The place of the first log without time stamps, if there is one.
    pub fn raw_log(&self) -> Option<usize> {
        self.logs.iter().position(|log| log.mender.framing == Framing::Raw)
    }

    /// The counts of all logs so far.
    pub fn outcome(&self) -> Outcome {
        self.logs.iter().map(|log| log.outcome).sum()
    }

    /// Of each log, whether it holds something and no record as far as it was read, and the damage of a compressed file.
    pub fn faults(&self) -> impl Iterator<Item = (bool, Option<&str>)> {
        self.logs.iter().map(|log| {
            let (damage, Outcome { records, bytes, .. }) = (log.blocks.damage(), log.outcome);
            (records == 0 && (bytes > 0 || damage.is_some()), damage)
        })
    }

    /// Writes what can be ordered until the next block of a log is needed; false at the end.
    ///
    /// # Errors
    /// Errors of reading and writing.
    pub fn advance(&mut self, out: &mut dyn Write) -> Result<bool, Error> {
        let Self { logs, wanted, anonymizer } = self;
        for log in logs.iter_mut().filter(|log| log.needs_block()) {
            log.refill(wanted, anonymizer.as_ref())?;
        }
        if logs.iter().any(Input::needs_block) {
            return Ok(true);
        }
        let next = |(place, log): (usize, &Input)| Some(Reverse((log.time()?, place)));
        let mut fronts: BinaryHeap<_> = logs.iter().enumerate().filter_map(next).collect();
        let any = !fronts.is_empty();
        let mut merged = Vec::new();
        while let Some(Reverse((_, place))) = fronts.pop() {
            let other = fronts.peek().map(|&Reverse(front)| front);
            let log = &mut logs[place];
            merged.extend_from_slice(log.take_before(place, other));
            match log.time() {
                Some(time) => fronts.push(Reverse((time, place))),
                None if log.ended => {}
                None => break,
            }
        }
        out.write_all(&merged)?;
        Ok(any)
    }
}

impl Input {
    fn needs_block(&self) -> bool {
        self.taken == self.records.len() && !self.ended
    }

    /// The time of the next record, of those that are there.
    fn time(&self) -> Option<u64> {
        self.records.get(self.taken).map(|&(time, _)| time)
    }

    /// The records up to the first one behind that of another log: its time and the place of that log.
    fn take_before(&mut self, place: usize, other: Option<(u64, usize)>) -> &[u8] {
        let ends = |taken: usize| taken.checked_sub(1).map_or(0, |last| self.records[last].1);
        let left = self.records[self.taken..].iter();
        let is_due = |&&(time, _): &&(u64, usize)| other.is_none_or(|other| (time, place) < other);
        let count = left.take_while(is_due).count();
        let range = ends(self.taken)..ends(self.taken + count);
        self.taken += count;
        self.outcome.written += count as u64;
        &self.bytes[range]
    }

    /// Reads the next block.
    fn refill(&mut self, wanted: &Wanted, anonymizer: Option<&Anonymizer>) -> Result<(), Error> {
        let Self { blocks, mender, bytes, records, taken, ended, outcome, in_damage } = self;
        bytes.clear();
        records.clear();
        *taken = 0;
        let lead = mender.framing.lead();
        let more = blocks.next(|block, at_end| {
            let scanned = mender.scan(block, at_end);
            for record in &scanned.records {
                let time = scanned.time(block, record.at).unwrap_or_default();
                if wanted.wants(block, lead, &scanned, *record)
                    && put(bytes, block, time, *record, &mender.scanner, anonymizer)
                {
                    records.push((time, bytes.len()));
                }
            }
            outcome.add(&scanned, in_damage);
            (scanned.consumed, ())
        })?;
        *ended = more.is_none();
        Ok(())
    }
}

/// Appends a record; false if nothing of it may be kept.
fn put(
    out: &mut Vec<u8>,
    block: &[u8],
    time: u64,
    record: Located,
    scanner: &LogScanner,
    anonymizer: Option<&Anonymizer>,
) -> bool {
    let lead = scanner.lead();
    let Some(header) = header_at(block, record.at, lead) else { return false };
    let (start, before) = (record.at as usize + lead, out.len());
    let frame = &block[start..start + header.frame_len()];
    out.extend_from_slice(&time.to_be_bytes()[..lead]);
    let Some(anonymizer) = anonymizer else {
        out.extend_from_slice(frame);
        return true;
    };
    let is_kept = anonymizer.apply(frame, &header, scanner.registry().entry(record.index), out);
    if !is_kept {
        out.truncate(before);
    }
    is_kept
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

    fn rewritten(steps: Steps, logs: &[&[u8]], framing: Option<Framing>) -> (Vec<u8>, Outcome) {
        let dialect = builtin::dialect("common", WireVersion::V2).expect("the dialect");
        let registry = Arc::new(Registry::new(dialect));
        let source =
            |log: &&[u8]| -> Box<dyn Read + Send> { Box::new(std::io::Cursor::new(log.to_vec())) };
        let sources = logs.iter().map(source).collect();
        let rewrite = Rewrite::new(steps, sources, framing, &registry, Wanted::default(), None);
        let (mut rewrite, mut out) = (rewrite.expect("reading"), Vec::new());
        while rewrite.advance(&mut out).expect("writing") {}
        (out, rewrite.outcome())
    }

    #[test]
    fn damage_that_goes_on_in_another_block_is_one_place() {
        let (front, rest) = (log(0..10, 1), log(20..30, 1));
        let bytes = [&front[..], &[7; 500], &rest, &[7; 300], &front].concat();
        for block in [40, 100, 333, 1 << 20] {
            let steps = Steps { block, ..Steps::default() };
            let (_, outcome) = rewritten(steps, &[&bytes], Some(Framing::Stamped));
            assert_eq!((outcome.written, outcome.bad_bytes), (30, 800), "blocks of {block}");
            assert_eq!(outcome.bad_places, 2, "blocks of {block}");
        }
    }

    #[test]
    fn a_wrong_time_between_good_ones_is_replaced_by_the_one_in_front() {
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
            let steps = Steps { block, ..Steps::default() };
            let (out, outcome) = rewritten(steps, &[&bytes], Some(Framing::Stamped));
            assert_eq!(out, expected, "blocks of {block}");
            assert_eq!(outcome.restamped, 2, "blocks of {block}");
        }
    }

    #[test]
    fn a_clock_that_is_set_in_front_of_zeros_is_no_damage() {
        let records = log([5_000_000, 6_000_000, 1_700_000_000_000_000].into_iter(), 1);
        let bytes = [&records[..], &[0; 40], &records[records.len() / 3 * 2..]].concat();
        for (bytes, count) in [(records, 3), (bytes, 4)] {
            let (_, outcome) = rewritten(Steps::default(), &[&bytes], Some(Framing::Stamped));
            assert_eq!((outcome.written, outcome.restamped), (count, 0));
        }
    }

    #[test]
    fn any_blocks_merge_to_the_same() {
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
            let steps = Steps { block, ..Steps::default() };
            let (out, outcome) = rewritten(steps, &logs.each_ref().map(Vec::as_slice), None);
            assert_eq!(out, expected.concat(), "blocks of {block}");
            assert_eq!((outcome.written, outcome.bad_bytes), (900, 0));
        }
    }
}
