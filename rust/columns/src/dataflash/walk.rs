//! The records of a log with their times, block by block.

use std::ops::Range;
use std::sync::Arc;

use mavwire_core::log::dataflash::text::nth_value;
use mavwire_core::log::dataflash::{HEAD_LEN, TimeRule, index};

use super::lines::Lines;
use super::survey::{Form, Survey, number};

/// A record in a block.
#[derive(Debug, Clone, Copy)]
pub(super) struct Place {
    /// Where it starts.
    pub(super) at: u32,
    /// Bytes of it, head included; of a line without its end.
    pub(super) len: u16,
    /// Index of its layout.
    pub(super) layout: u16,
}

impl Place {
    /// The bytes of the record.
    pub(super) fn of(self, block: &[u8]) -> &[u8] {
        &block[self.at as usize..][..usize::from(self.len)]
    }
}

/// Walks through a log.
pub(super) struct Walk {
    survey: Arc<Survey>,
    rules: Vec<TimeRule>,
    /// Time of the newest record, microseconds since 1970.
    newest: i64,
    lines: Lines,
    offset: u64,
}

impl Walk {
    /// At the start of a log.
    pub(super) fn new(survey: Arc<Survey>) -> Self {
        let rule = |layout| survey.clock.map_or(TimeRule::Before, |clock| clock.rule(layout));
        let rules = survey.form.layouts().iter().map(|layout| rule(layout)).collect();
        let newest = survey.clock.map_or(0, |clock| clock.first);
        Self { rules, newest, survey, lines: Lines::default(), offset: 0 }
    }

    /// Hands over the records of a block and their times, and the bytes that belong to none; bytes dealt with.
    pub(super) fn block(
        &mut self,
        block: &[u8],
        at_end: bool,
        record: impl FnMut(Place, i64),
        bad: impl FnMut(Range<usize>),
    ) -> usize {
        let done = match self.survey.form {
            Form::Binary(_) => self.binary(block, at_end, record, bad),
            Form::Text(_) => self.text(block, at_end, record, bad),
        };
        self.offset += done as u64;
        done
    }

    fn binary(
        &mut self,
        block: &[u8],
        at_end: bool,
        mut record: impl FnMut(Place, i64),
        mut bad: impl FnMut(Range<usize>),
    ) -> usize {
        let Form::Binary(definitions) = &self.survey.form else { return block.len() };
        let (clock, layouts) = (self.survey.clock, definitions.layouts());
        let (offset, rules, newest) = (self.offset, &self.rules, &mut self.newest);
        let mut expected = 0;
        let (done, _) = index(block, offset, usize::MAX, definitions, at_end, |entry, bytes| {
            let at = (entry.offset - offset) as usize;
            if at > expected {
                bad(expected..at);
            }
            expected = at + usize::from(entry.len);
            let layout = usize::from(entry.layout);
            if let Some(clock) = clock {
                let count = |index| layouts[layout].count(index, &bytes[HEAD_LEN..]);
                *newest = clock.stamp(rules[layout], *newest, count);
            }
            let len = u16::from(entry.len);
            record(Place { at: at as u32, len, layout: entry.layout }, *newest);
        });
        if done > expected {
            bad(expected..done);
        }
        done
    }

    fn text(
        &mut self,
        block: &[u8],
        at_end: bool,
        mut record: impl FnMut(Place, i64),
        mut bad: impl FnMut(Range<usize>),
    ) -> usize {
        let Form::Text(definitions) = &self.survey.form else { return block.len() };
        let (clock, delimiter) = (self.survey.clock, definitions.delimiter());
        let (offset, rules, newest) = (self.offset, &self.rules, &mut self.newest);
        self.lines.each(block, at_end, |line| {
            let Some(bytes) = line.bytes else { return bad(line.at..line.next) };
            let Some(layout) = definitions.of_line(bytes, offset + line.at as u64) else {
                if !bytes.is_empty() {
                    bad(line.at..line.next);
                }
                return;
            };
            if let Some(clock) = clock {
                let count = |index| number(nth_value(bytes, delimiter, index));
                let count = |index| count(index).map(|number| number.round() as i64);
                *newest = clock.stamp(rules[usize::from(layout)], *newest, count);
            }
            record(Place { at: line.at as u32, len: bytes.len() as u16, layout }, *newest);
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::Error;
    use proptest::prelude::*;
    use std::io::{Cursor, Read};

    type Outcome = (Vec<(usize, u16, u16, i64)>, Vec<Range<usize>>);

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

    fn walk(survey: &Arc<Survey>, log: &[u8], block: usize) -> Outcome {
        let mut walk = Walk::new(Arc::clone(survey));
        let (mut out, mut start, mut end) = (Outcome::default(), 0, 0);
        while start < log.len() {
            let at_end = end == log.len();
            end = (end + block).min(log.len());
            let (records, bad) = (&mut out.0, &mut out.1);
            let record = |place: Place, time| {
                records.push((start + place.at as usize, place.len, place.layout, time));
            };
            let done = walk.block(&log[start..end], at_end, record, |range| {
                let range = start + range.start..start + range.end;
                match bad.last_mut().filter(|last| last.end == range.start) {
                    Some(last) => last.end = range.end,
                    None => bad.push(range),
                }
            });
            start += done;
        }
        out
    }

    fn survey(log: &[u8]) -> Arc<Survey> {
        let open = || Ok(Box::new(Cursor::new(log.to_vec())) as Box<dyn Read + Send>);
        let survey = Survey::read(&open, || Ok::<_, Error>(()));
        Arc::new(survey.expect("reading").expect("a dataflash log"))
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(40))]

        #[test]
        fn any_blocks_give_the_same(
            noise in proptest::collection::vec(any::<u8>(), 1..200),
            damage in proptest::collection::vec((any::<u16>(), any::<u8>()), 0..12),
            block in 7..3000_usize,
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
            let survey = survey(&log);
            prop_assert_eq!(walk(&survey, &log, block), walk(&survey, &log, log.len()));
        }
    }

    #[test]
    fn records_without_a_time_have_that_of_the_record_in_front() {
        let log = log(&[2, 0, 1, 0, 3]);
        let survey = survey(&log);
        let (records, bad) = walk(&survey, &log, log.len());
        let base = survey.clock.map_or(0, |clock| clock.base);
        let times: Vec<_> = records[4..].iter().map(|&(.., time)| time - base).collect();
        assert_eq!(times, [0, 0, 2000, 2000, 4000]);
        assert!(bad.is_empty() && base > 1_500_000_000_000_000);
    }
}
