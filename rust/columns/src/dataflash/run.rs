//! A run over a log that finds what it says about itself. Once more over all of it where records stand in front of what
//! describes them, between bytes that belonged to no record until then.

use mavwire_core::log::dataflash::text::Delimiter;
use mavwire_core::log::dataflash::{ClockFinder, FMT_LAYOUT_LEN, HEAD_LEN, Layout, Record, Units};
use rayon::prelude::*;
use std::sync::Arc;

use super::lines::Lines;
use super::record_index::{Place, RecordIndex, hop};
use super::survey::{Form, Open, Survey, begin};
use crate::error::Error;
use crate::input::{Blocks, Steps};
use crate::pool;

/// Bytes of a description that may stand in front of the rest of it.
const CUT_OFF: usize = FMT_LAYOUT_LEN - 1;

/// A run over a log.
pub(super) struct Run {
    form: Form,
    units: Units,
    pub(super) finder: ClockFinder,
    /// Whether records of a layout say something.
    telling: Vec<bool>,
    lines: Lines,
    /// Bytes of the log that were gone through.
    pub(super) offset: u64,
    /// Bytes behind `offset` that are indexed already.
    ahead: usize,
    /// Where in the log the bytes end that were searched for descriptions: none may be taken in twice.
    searched: u64,
    /// All descriptions are known, from a run before.
    is_second: bool,
    /// Some bytes belonged to no record as far as was known then.
    junk: bool,
    /// More is known since: they may hold records.
    pub(super) missed: bool,
    steps: Steps,
}

/// The records found in a block.
pub(super) struct Seen<'a> {
    /// The part of a binary log's block in which `hops` are.
    pub(super) bytes: &'a [u8],
    /// The records of a binary log.
    pub(super) hops: RecordIndex,
    /// Bytes of the block that are consumed.
    pub(super) consumed: usize,
}

impl Run {
    pub(super) fn new(form: Form, steps: Steps) -> Self {
        Self {
            form,
            units: Units::default(),
            finder: ClockFinder::default(),
            telling: Vec::new(),
            lines: Lines::default(),
            offset: 0,
            ahead: 0,
            searched: 0,
            is_second: false,
            junk: false,
            missed: false,
            steps,
        }
    }

    /// Goes through what is left of the log; twice through all of it if it must be.
    pub(super) fn finish<E: From<Error>>(
        mut self,
        mut blocks: Blocks,
        open: Open<'_>,
        mut pulse: impl FnMut() -> Result<(), E>,
    ) -> Result<Survey, E> {
        self.go_on(&mut blocks, &mut pulse)?;
        if self.missed {
            (blocks, _) = begin(open, self.steps).map_err(Error::from)?;
            self = Self { is_second: true, ..Self::new(self.form, self.steps) };
            self.go_on(&mut blocks, &mut pulse)?;
        }
        Ok(self.survey())
    }

    fn go_on<E: From<Error>>(
        &mut self,
        blocks: &mut Blocks,
        pulse: &mut impl FnMut() -> Result<(), E>,
    ) -> Result<(), E> {
        let mut step = || {
            let more = blocks.next(|block, at_end| (self.add(block, at_end).consumed, ()))?;
            Ok::<_, Error>(more.is_some())
        };
        while pool::a_while(&mut step)? {
            pulse()?;
        }
        Ok(())
    }

    /// Takes in the next block, which starts where the last one was consumed to.
    pub(super) fn add<'a>(&mut self, block: &'a [u8], at_end: bool) -> Seen<'a> {
        let seen = match self.form {
            Form::Binary(_) => self.add_binary(block, at_end),
            Form::Text(_) => {
                let consumed = self.add_text(block, at_end);
                Seen { bytes: block, hops: RecordIndex::default(), consumed }
            }
        };
        self.offset += seen.consumed as u64;
        seen
    }

    fn add_binary<'a>(&mut self, block: &'a [u8], at_end: bool) -> Seen<'a> {
        self.describe(block);
        // A description may begin behind this and end in the next block, and it holds from where it begins.
        let described = block.len() - if at_end { 0 } else { CUT_OFF.min(block.len()) };
        let from = self.ahead;
        let bytes = &block[from..];
        let hops = self.hop(bytes, from, described.saturating_sub(from), at_end);
        self.junk |= !hops.bad.is_empty();
        let done = from + hops.consumed;
        let consumed = done.min(described);
        self.ahead = done - consumed;
        Seen { bytes, hops, consumed }
    }

    /// Looks for descriptions in a block of a binary log, where it was not searched yet.
    fn describe(&mut self, block: &[u8]) {
        let Form::Binary(definitions) = &mut self.form else { return };
        if self.is_second {
            return;
        }
        let known = definitions.layouts().len();
        let new = self.searched.saturating_sub(CUT_OFF as u64).saturating_sub(self.offset) as usize;
        definitions.collect(&block[new..], self.offset + new as u64);
        self.searched = self.offset + block.len() as u64;
        self.missed |= self.junk && definitions.layouts().len() > known;
    }

    /// Finds the records, from so far into a block up to a limit behind that, and takes in those that say something.
    fn hop(&mut self, bytes: &[u8], from: usize, limit: usize, at_end: bool) -> RecordIndex {
        let offset = self.offset + from as u64;
        let Self { form, units, finder, telling, steps, .. } = self;
        let Form::Binary(definitions) = form else { return RecordIndex::default() };
        let hops = hop(bytes, offset, limit, definitions, at_end, steps.stretch);
        let layouts = definitions.layouts();
        let mut teller = Teller::new(units, finder, telling, layouts);
        let telling = &*teller.telling;
        let is_telling = |place: &&Place| telling[usize::from(place.layout)];
        let few = hops.stretches.par_iter().flat_map_iter(|some| some.iter().filter(is_telling));
        for place in few.collect::<Vec<_>>() {
            let body = &place.of(bytes)[HEAD_LEN..];
            teller.add(place.layout, offset + u64::from(place.at), body, None);
        }
        hops
    }

    fn add_text(&mut self, block: &[u8], at_end: bool) -> usize {
        let (offset, is_second) = (self.offset, self.is_second);
        let Self { form, units, finder, telling, lines, junk, missed, .. } = self;
        let Form::Text(definitions) = form else { return block.len() };
        lines.each(block, at_end, |line| {
            let Some(bytes) = line.bytes.filter(|bytes| !bytes.is_empty()) else { return };
            let place = offset + line.at as u64;
            if !is_second {
                let known = definitions.layouts().len();
                definitions.collect(bytes, place);
                *missed |= *junk && definitions.layouts().len() > known;
            }
            let Some(layout) = definitions.of_line(bytes, place) else {
                *junk = true;
                return;
            };
            let delimiter = definitions.delimiter();
            let layouts = definitions.layouts();
            let mut teller = Teller::new(units, finder, telling, layouts);
            teller.add(layout, place, bytes, Some(delimiter));
        })
    }

    /// Whether more is known than this says.
    pub(super) fn knows_more_than(&self, survey: &Survey) -> bool {
        self.form.layouts().len() != survey.form.layouts().len()
            || self.units != survey.units
            || self.finder.clone().finish() != survey.clock
    }

    /// The log's description of itself, as far as it was read.
    pub(super) fn survey(&self) -> Survey {
        let (form, units) = (self.form.clone(), self.units.clone());
        Survey::new(form, units, self.finder.clone().finish(), self.offset, self.steps)
    }
}

/// Takes in the records that say something about others.
struct Teller<'a> {
    units: &'a mut Units,
    finder: &'a mut ClockFinder,
    telling: &'a mut Vec<bool>,
    layouts: &'a [Arc<Layout>],
}

impl<'a> Teller<'a> {
    /// Looks at layouts that are new.
    fn new(
        units: &'a mut Units,
        finder: &'a mut ClockFinder,
        telling: &'a mut Vec<bool>,
        layouts: &'a [Arc<Layout>],
    ) -> Self {
        for layout in &layouts[telling.len().min(layouts.len())..] {
            telling.push(tells(finder, layout));
        }
        Self { units, finder, telling, layouts }
    }

    #[inline]
    fn add(&mut self, layout: u16, at: u64, bytes: &[u8], delimiter: Option<Delimiter>) {
        if !self.telling[usize::from(layout)] {
            return;
        }
        let layout = &*self.layouts[usize::from(layout)];
        let record = Record { layout, bytes, delimiter };
        record.tell_units(self.units);
        if self.finder.add(layout, at, |index| record.number(index)) {
            for (telling, layout) in self.telling.iter_mut().zip(self.layouts) {
                *telling = tells(self.finder, layout);
            }
        }
    }
}

fn tells(finder: &ClockFinder, layout: &Layout) -> bool {
    matches!(layout.name.as_str(), "UNIT" | "MULT" | "FMTU") || finder.wants(layout)
}
