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
