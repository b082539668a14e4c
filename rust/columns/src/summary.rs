//! The summary of a log, counted in one pass.

use std::collections::BTreeMap;
use std::io::Read;
use std::ops::Range;
use std::sync::Arc;

use mavwire_core::frame::Header;
use mavwire_core::registry::Registry;
use mavwire_core::telemetry::{BootClocks, SteadyTime, is_jump_forward};
use mavwire_schema::WireVersion;

use crate::error::Error;
use crate::input::{Blocks, Steps};
use crate::scan::{Framing, LogScanner, Scanned, UNKNOWN, header_at};
use crate::sequence::{Heard, Sequence};
use crate::unknown::{self, UnknownCounts};

/// Places that are listed. Further ones are only counted, since a hostile log chooses their number.
const MOST_LISTED: usize = 1000;

/// Microseconds. Smaller steps back are not counted: records of one moment can overtake each other.
const SMALLEST_STEP: u64 = 1000;

/// Messages of one type.
#[derive(Debug, Clone, Copy, Default)]
pub struct Count {
    /// How many.
    pub messages: u64,
    /// Time of the first message with a time, microseconds since 1970.
    pub first: u64,
    /// Time of the last.
    pub last: u64,
    /// Microseconds between the two on a clock that is never set.
    pub elapsed: u64,
    /// Steady time of the first message with a time.
    began: Option<u64>,
}

/// The time of a record.
#[derive(Debug, Clone, Copy)]
pub(crate) struct RecordTime {
    /// Its time stamp.
    time: u64,
    /// Its time on a clock that is never set.
    steady: u64,
}

impl Count {
    pub(crate) fn add(&mut self, moment: Option<RecordTime>) {
        self.messages += 1;
        let Some(RecordTime { time, steady }) = moment else { return };
        if self.began.is_none() {
            self.first = time;
        }
        self.last = time;
        self.elapsed = steady.saturating_sub(*self.began.get_or_insert(steady));
    }

    /// Adds other messages of the same log.
    pub(crate) fn merge(&mut self, other: &Self) {
        let end = |count: &Self| count.began.map(|began| began.saturating_add(count.elapsed));
        let (first, last) = (
            if self.began.is_none_or(|own| other.began.is_some_and(|began| began < own)) {
                other
            } else {
                &*self
            },
            if end(other) > end(self) { other } else { &*self },
        );
        let elapsed =
            end(last).zip(first.began).map_or(0, |(end, began)| end.saturating_sub(began));
        let messages = self.messages + other.messages;
        *self = Self { messages, last: last.last, elapsed, ..*first };
    }
}

/// One component of one system.
#[derive(Debug, Clone, Copy, Default)]
pub struct Sender {
    /// Its messages.
    pub count: Count,
    /// Messages lost by its sequence numbers.
    pub lost: u64,
    /// Messages that were there before, as where two links hear the same.
    pub repeated: u64,
    /// Its clocks since boot: reboots, and whether several senders share the id.
    pub clocks: BootClocks,
    sequence: Sequence,
}

/// The content of a log in figures.
#[derive(Debug, Clone, Default)]
pub struct Summary {
    /// Bytes, decompressed.
    pub bytes: u64,
    /// Records have times.
    pub stamped: bool,
    /// All good messages.
    pub count: Count,
    /// By message index.
    pub types: Vec<Count>,
    /// Messages that the dialect does not define.
    pub unknown: UnknownCounts,
    /// By system and component.
    pub senders: BTreeMap<(u8, u8), Sender>,
    /// Spans of time without a message.
    pub gaps: Vec<(u64, u64)>,
    /// Number of gaps, of which `gaps` lists the first ones.
    pub gap_count: u64,
    /// Records whose time is a millisecond or more before that of the record in front.
    pub times_back: u64,
    /// Turns time stamps into steady times.
    pub steady: SteadyTime,
    /// Records whose time was not believed.
    pub distrusted: u64,
    /// Bytes of no record, as places in the log.
    pub bad: Vec<Range<u64>>,
    /// Number of such places, of which `bad` lists the first ones.
    pub bad_count: u64,
    /// Bytes of no record in all such places.
    pub bad_bytes: u64,
    /// Messages of MAVLink 1.
    pub version1: u64,
    /// Messages that are signed.
    pub signed: u64,
    /// The damage of the compressed file.
    pub damage: Option<String>,
    /// Where the last of the places with bytes of no record ends, listed or not.
    pub(crate) bad_end: Option<u64>,
}

impl Summary {
    /// Reads a log to its end. `gap` is what counts as a gap, in microseconds; `pulse` is asked now and then whether to
    /// go on, and is told how far it is.
    ///
    /// # Errors
    /// Errors of reading, and the error that `pulse` returns.
    pub fn read<E: From<Error>>(
        source: Box<dyn Read + Send>,
        registry: Arc<Registry>,
        gap: u64,
        mut pulse: impl FnMut(u64) -> Result<(), E>,
    ) -> Result<Self, E> {
        let (mut blocks, framing) =
            Blocks::framed(source, None, &registry, Steps::default().block).map_err(Error::from)?;
        let mut scanner = LogScanner::new(Arc::clone(&registry), framing);
        let types = vec![Count::default(); registry.dialect().messages.len()];
        let mut sum = Self { stamped: framing == Framing::Stamped, types, ..Self::default() };
        loop {
            let next = blocks.next(|block, at_end| {
                let found = scanner.scan(block, at_end);
                sum.add(block, framing.lead(), &found, gap, &registry);
                (found.consumed, ())
            });
            if next.map_err(Error::from)?.is_none() {
                sum.damage = blocks.damage().map(str::to_owned);
                return Ok(sum);
            }
            pulse(sum.bytes)?;
        }
    }

    fn add(&mut self, block: &[u8], lead: usize, scanned: &Scanned, gap: u64, registry: &Registry) {
        for record in &scanned.records {
            let Some(header) = header_at(block, record.at, lead) else { continue };
            let moment = self.add_time(scanned.time(block, record.at), gap);
            let frame = &block[record.at as usize + lead..];
            if record.index == UNKNOWN {
                unknown::add(&mut self.unknown, frame, moment);
            } else {
                self.types[usize::from(record.index)].add(moment);
            }
            let payload = &frame[header.len()..][..usize::from(header.payload_len)];
            let boot = registry.boot_times().millis(record.index, payload);
            self.add_record(&header, moment, boot);
        }
        self.distrusted += scanned.distrusted.len() as u64;
        self.add_bad(&scanned.bad);
        self.bytes += scanned.consumed as u64;
    }

    /// Counts a record.
    pub(crate) fn add_time(&mut self, time: Option<u64>, gap: u64) -> Option<RecordTime> {
        if let (Some(time), Some(_)) = (time, self.count.began) {
            let before = self.count.last;
            self.times_back += u64::from(before.saturating_sub(time) >= SMALLEST_STEP);
            if time.saturating_sub(before) > gap && !is_jump_forward(before, time) {
                self.gap_count += 1;
                if self.gaps.len() < MOST_LISTED {
                    self.gaps.push((before, time));
                }
            }
        }
        let moment = time.map(|time| RecordTime { time, steady: self.steady.of(time) });
        self.count.add(moment);
        moment
    }

    fn add_record(&mut self, header: &Header, moment: Option<RecordTime>, boot: Option<u32>) {
        self.version1 += u64::from(header.version == WireVersion::V1);
        self.signed += u64::from(header.is_signed());
        let sender = self.senders.entry((header.sysid, header.compid)).or_default();
        sender.count.add(moment);
        match sender.sequence.add(header.seq, moment.map_or(0, |moment| moment.time)) {
            Heard::After(lost) => sender.lost += u64::from(lost),
            Heard::Late => sender.lost -= 1,
            Heard::Again => sender.repeated += 1,
        }
        if let Some(boot) = boot {
            sender.clocks.hear(boot);
        }
    }

    pub(crate) fn add_bad(&mut self, bad: &[Range<usize>]) {
        for range in bad {
            let range = self.bytes + range.start as u64..self.bytes + range.end as u64;
            self.bad_bytes += range.end - range.start;
            let goes_on = self.bad_end.replace(range.end) == Some(range.start);
            self.bad_count += u64::from(!goes_on);
            if self.bad_count > MOST_LISTED as u64 {
                continue;
            }
            match self.bad.last_mut() {
                Some(last) if goes_on => last.end = range.end,
                _ => self.bad.push(range),
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_that_adjoin_are_one_beyond_those_that_are_listed_too() {
        let mut sum = Summary::default();
        let bad: Vec<_> = (0..MOST_LISTED + 5).map(|n| 10 * n..10 * n + 3).collect();
        sum.add_bad(&bad);
        let last = bad.last().map_or(0, |range| range.end);
        // The next block begins in the same place.
        sum.bytes = last as u64;
        sum.add_bad(&[0..4, 8..9]);
        assert_eq!(sum.bad_count, MOST_LISTED as u64 + 6);
        assert_eq!(sum.bad.len(), MOST_LISTED);
        assert_eq!(sum.bad.last(), Some(&(9990..9993)));
        assert_eq!(sum.bad_bytes, 3 * (MOST_LISTED as u64 + 5) + 5);
    }

    #[test]
    fn the_last_place_that_is_listed_grows() {
        let mut sum = Summary::default();
        sum.add_bad(&[0..2, 5..7]);
        sum.bytes = 7;
        sum.add_bad(&[0..4, 8..9]);
        assert_eq!((sum.bad_count, &sum.bad[..]), (3, &[0..2, 5..11, 15..16][..]));
    }
}
