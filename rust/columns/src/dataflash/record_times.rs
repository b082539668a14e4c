//! The records of a log with their times, block by block.

use std::ops::Range;
use std::sync::Arc;

use mavwire_core::codec::read;
use mavwire_core::log::dataflash::text::{nth_value, number};
use mavwire_core::log::dataflash::{FieldKind, HEAD_LEN, Layout, TimeRule, whole};

use super::lines::Lines;
use super::record_index::{Place, RecordIndex, hop};
use super::survey::{Form, Survey};
use crate::row_block::PIECE;

/// Walks through a log.
pub(super) struct RecordTimes {
    survey: Arc<Survey>,
    rules: Vec<TimeRule>,
    /// Where records of each layout have whole microseconds, if they do: nearly all.
    micros: Vec<Option<usize>>,
    /// Time of the newest record, microseconds since 1970.
    newest: i64,
    lines: Lines,
    offset: u64,
}

/// The records of a block.
pub(super) struct Walked {
    /// In the order of the log.
    pub(super) stretches: Vec<Stretch>,
    /// Bytes that belong to no record.
    pub(super) bad: Vec<Range<usize>>,
    /// Bytes consumed.
    pub(super) consumed: usize,
}

impl Walked {
    /// How many bytes belong to no record.
    pub(super) fn bad_bytes(&self) -> u64 {
        self.bad.iter().map(|range| range.len() as u64).sum()
    }
}

/// Records that follow each other.
pub(super) struct Stretch {
    places: Vec<Place>,
    /// The time of the record in front.
    before: i64,
}

impl Stretch {
    /// Index of the layout of each record.
    pub(super) fn layouts(&self) -> impl ExactSizeIterator<Item = usize> {
        self.places.iter().map(|place| usize::from(place.layout))
    }
}

impl RecordTimes {
    /// At the start of a log.
    pub(super) fn new(survey: Arc<Survey>) -> Self {
        let (rules, micros, lines) = Default::default();
        let newest = survey.clock.map_or(0, |clock| clock.first);
        let mut walk =
            Self { rules, micros, newest, lines, offset: 0, survey: Arc::clone(&survey) };
        walk.extend(survey);
        walk
    }

    /// Goes on with more layouts, by the same clock.
    pub(super) fn extend(&mut self, survey: Arc<Survey>) {
        let is_binary = matches!(survey.form, Form::Binary(_));
        for layout in &survey.form.layouts()[self.rules.len()..] {
            let rule = survey.clock.map_or(TimeRule::Before, |clock| clock.rule(layout));
            self.micros.push(micros_at(layout, rule).filter(|_| is_binary));
            self.rules.push(rule);
        }
        self.survey = survey;
    }

    /// Finds the records of a block, which starts where the last one was consumed to.
    pub(super) fn block(&mut self, block: &[u8], at_end: bool) -> Walked {
        let hops = match &self.survey.form {
            Form::Binary(all) => {
                hop(block, self.offset, block.len(), all, at_end, self.survey.steps.stretch)
            }
            Form::Text(_) => self.text(block, at_end),
        };
        self.offset += hops.consumed as u64;
        self.follow(block, hops)
    }

    /// Goes on with the next records of a block.
    pub(super) fn follow(&mut self, block: &[u8], hops: RecordIndex) -> Walked {
        let RecordIndex { stretches, bad, consumed } = hops;
        let with_time = |places: Vec<Place>| {
            let before = self.newest;
            self.newest = self.newest_of(block, &places);
            Stretch { places, before }
        };
        Walked { stretches: stretches.into_iter().map(with_time).collect(), bad, consumed }
    }

    /// The records of a stretch with their times.
    pub(super) fn timed<'a>(
        &'a self,
        block: &'a [u8],
        stretch: &'a Stretch,
    ) -> impl Iterator<Item = (Place, i64)> + 'a {
        let mut newest = stretch.before;
        stretch.places.iter().map(move |&place| {
            newest = self.stamp(block, place, newest);
            (place, newest)
        })
    }

    /// The time of the last one of these records. From the last that has a time of its own on, the others do not matter.
    fn newest_of(&self, block: &[u8], places: &[Place]) -> i64 {
        let has_own = |place: &Place| match self.rules[usize::from(place.layout)] {
            TimeRule::Field(index, micros) => self.count(block, *place, index, micros).is_some(),
            _ => false,
        };
        let from = places.iter().rposition(has_own).unwrap_or(0);
        places[from..].iter().fold(self.newest, |newest, &place| self.stamp(block, place, newest))
    }

    #[inline]
    fn stamp(&self, block: &[u8], place: Place, newest: i64) -> i64 {
        let Some(clock) = self.survey.clock else { return newest };
        if let Some(at) = self.micros[usize::from(place.layout)] {
            let micros = u64::from_le_bytes(read(block, place.at as usize + at));
            return clock.base.saturating_add(i64::try_from(micros).unwrap_or(i64::MAX));
        }
        let rule = self.rules[usize::from(place.layout)];
        clock.stamp(rule, newest, |index, micros| self.count(block, place, index, micros))
    }

    /// So many times the number in a field, as an integer.
    #[inline]
    fn count(&self, block: &[u8], place: Place, index: usize, times: i64) -> Option<i64> {
        let bytes = place.of(block);
        let layout = &self.survey.form.layouts()[usize::from(place.layout)];
        match &self.survey.form {
            Form::Binary(_) => layout.count(index, &bytes[HEAD_LEN..], times),
            Form::Text(definitions) => {
                let value = nth_value(bytes, definitions.delimiter(), index)?;
                whole(number(layout.fields.get(index)?.kind, value)? * times as f64)
            }
        }
    }

    fn text(&mut self, block: &[u8], at_end: bool) -> RecordIndex {
        let Self { survey, lines, offset, .. } = self;
        let Form::Text(definitions) = &survey.form else { return RecordIndex::default() };
        let (mut places, mut bad) = (Vec::new(), Vec::new());
        let consumed = lines.each(block, at_end, |line| {
            let layout =
                line.bytes.and_then(|bytes| definitions.of_line(bytes, *offset + line.at as u64));
            match (line.bytes, layout) {
                (Some(bytes), Some(layout)) => {
                    places.push(Place { at: line.at as u32, len: bytes.len() as u16, layout });
                }
                (Some([]), None) => {}
                _ => bad.push(line.at..line.next),
            }
        });
        let stretches = places.chunks(PIECE).map(<[Place]>::to_vec).collect();
        RecordIndex { stretches, bad, consumed }
    }
}

/// Where in a record microseconds since the start are, as an unsigned number of 64 bits.
fn micros_at(layout: &Layout, rule: TimeRule) -> Option<usize> {
    let TimeRule::Field(index, 1) = rule else { return None };
    let field = layout.fields.get(index).filter(|field| field.kind == FieldKind::U64)?;
    Some(HEAD_LEN + usize::from(field.offset))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::Error;
    use crate::input::Steps;
    use mavwire_core::log::dataflash::{Clock, index};
    use proptest::prelude::*;
    use std::io::{Cursor, Read};

    /// Place, length, layout and time of each record, and places of bytes that belong to none.
    #[derive(Debug, Default, PartialEq)]
    struct Outcome(Vec<(usize, u16, u16, i64)>, Vec<Range<usize>>);

    impl Outcome {
        fn add_bad(&mut self, range: Range<usize>) {
            match self.1.last_mut().filter(|last| last.end == range.start) {
                Some(last) => last.end = range.end,
                None => self.1.push(range),
            }
        }
    }

    fn fmt(type_id: u8, len: u8, name: &str, format: &str, columns: &str) -> Vec<u8> {
        let mut record = vec![0xA3, 0x95, 0x80, type_id, len];
        for (text, room) in [(name, 4), (format, 16), (columns, 64)] {
            let end = record.len() + room;
            record.extend_from_slice(text.as_bytes());
            record.resize(end, 0);
        }
        record
    }

    /// A log of two types, of which one has no time, and a GPS record.
    fn log(noise: &[u8]) -> Vec<u8> {
        let mut log = fmt(128, 89, "FMT", "BBnNZ", "Type,Length,Name,Format,Columns");
        log.extend(fmt(1, 15, "A", "QI", "TimeUS,X"));
        log.extend(fmt(2, 4, "B", "B", "X"));
        log.extend(fmt(3, 17, "GPS", "QIH", "TimeUS,GMS,GWk"));
        for (n, &byte) in noise.iter().enumerate() {
            let time = 1000 * n as u64;
            match byte % 8 {
                0 => log.extend_from_slice(&[0xA3, 0x95, 2, byte]),
                1 => {
                    log.extend_from_slice(&[0xA3, 0x95, 3]);
                    log.extend_from_slice(&time.to_le_bytes());
                    log.extend_from_slice(&[1, 0, 0, 0, 0x98, 8]);
                }
                _ => {
                    log.extend_from_slice(&[0xA3, 0x95, 1]);
                    log.extend_from_slice(&time.to_le_bytes());
                    log.extend_from_slice(&[byte; 4]);
                }
            }
        }
        log
    }

    /// Block by block and stretch by stretch.
    fn walk(survey: &Arc<Survey>, log: &[u8], block: usize) -> Outcome {
        let mut walk = RecordTimes::new(Arc::clone(survey));
        let (mut out, mut start, mut end) = (Outcome::default(), 0, 0);
        while start < log.len() {
            let at_end = end == log.len();
            end = (end + block).min(log.len());
            let bytes = &log[start..end];
            let walked = walk.block(bytes, at_end);
            for (place, time) in walked.stretches.iter().flat_map(|some| walk.timed(bytes, some)) {
                out.0.push((start + place.at as usize, place.len, place.layout, time));
            }
            for range in walked.bad {
                out.add_bad(start + range.start..start + range.end);
            }
            start += walked.consumed;
        }
        out
    }

    /// By one walk over all bytes.
    fn sequential(survey: &Survey, log: &[u8]) -> Outcome {
        let Form::Binary(definitions) = &survey.form else { return Outcome::default() };
        let mut newest = survey.clock.map_or(0, |clock| clock.first);
        let (mut out, mut expected) = (Outcome::default(), 0);
        index(log, 0, usize::MAX, definitions, true, |entry, bytes| {
            let at = entry.offset as usize;
            if at > expected {
                out.add_bad(expected..at);
            }
            expected = at + bytes.len();
            let layout = &definitions.layouts()[usize::from(entry.layout)];
            let count = |index, times| layout.count(index, &bytes[HEAD_LEN..], times);
            let stamp = |clock: Clock| clock.stamp(clock.rule(layout), newest, count);
            newest = survey.clock.map_or(newest, stamp);
            out.0.push((at, bytes.len() as u16, entry.layout, newest));
        });
        if expected < log.len() {
            out.add_bad(expected..log.len());
        }
        out
    }

    fn survey(log: &[u8], steps: Steps) -> Arc<Survey> {
        let open = || Ok(Box::new(Cursor::new(log.to_vec())) as Box<dyn Read + Send>);
        let survey = Survey::read(steps, &open, || Ok::<_, Error>(()));
        Arc::new(survey.expect("reading").expect("a dataflash log"))
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(150))]

        #[test]
        fn any_blocks_stretches_and_threads_give_the_same(
            noise in proptest::collection::vec(any::<u8>(), 1..400),
            damage in proptest::collection::vec((any::<u16>(), any::<u8>()), 0..40),
            block in 7..3000_usize,
            stretch in 1..900_usize,
            threads in 1..5_usize,
        ) {
            let mut log = log(&noise);
            for (at, byte) in damage {
                // Behind what makes it a dataflash log.
                let at = 4 * 89 + usize::from(at) % (log.len() - 4 * 89);
                match byte % 3 {
                    0 => log[at] = byte,
                    1 => drop(log.drain(at..(at + usize::from(byte) / 8).min(log.len() - 1).max(at))),
                    _ => drop(log.splice(at..at, [0xA3, 0x95, byte])),
                }
            }
            // The survey needs more for its head than a block of the walk has.
            let survey = survey(&log, Steps { stretch, ..Steps::default() });
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
            let found = pool.install(|| walk(&survey, &log, block));
            prop_assert_eq!(found, sequential(&survey, &log));
        }
    }

    #[test]
    fn a_description_counts_once_in_whatever_blocks_it_stands() {
        let mut log = log(&[2, 0, 1]);
        for n in 0..6 {
            let (len, format, columns) = [(15, "QI", "TimeUS,X"), (11, "Q", "TimeUS")][n % 2];
            // The record in front of what is no record is looked at again with the next block.
            log.extend_from_slice(b"\xA3\x95\x02\x01 junk");
            log.extend(fmt(1, len, "A", format, columns));
        }
        let whole = survey(&log, Steps::default());
        assert_eq!(whole.form.layouts().len(), 4 + 5);
        for block in (100..1400).step_by(90) {
            let found = survey(&log, Steps { block, ..Steps::default() });
            assert_eq!(found.form.layouts(), whole.form.layouts(), "blocks of {block}");
        }
    }

    #[test]
    fn records_without_a_time_have_that_of_the_record_in_front() {
        let log = log(&[2, 0, 1, 0, 3]);
        let survey = survey(&log, Steps::default());
        let Outcome(records, bad) = walk(&survey, &log, log.len());
        let base = survey.clock.map_or(0, |clock| clock.base);
        let times: Vec<_> = records[4..].iter().map(|&(.., time)| time - base).collect();
        assert_eq!(times, [0, 0, 2000, 2000, 4000]);
        assert!(bad.is_empty() && base > 1_500_000_000_000_000);
    }
}
