//! What a log says about itself: record types, units, clock. One run over it, or two where records stand in front of what
//! describes them.

use std::collections::HashMap;
use std::io::{self, Read};
use std::sync::{Arc, LazyLock};

use mavwire_core::builtin;
use mavwire_core::log::dataflash::text::{Delimiter, TextDefinitions, decode_line, nth_value};
use mavwire_core::log::dataflash::{
    Clock, ClockFinder, Definitions, FMT_LAYOUT_LEN, FieldKind, HEAD_LEN, Layout, Units,
};
use mavwire_core::registry::Registry;
use mavwire_schema::WireVersion;
use rayon::prelude::*;

use super::headless;
use super::hop::{Place, hop};
use super::lines::Lines;
use crate::error::Error;
use crate::input::{Blocks, Steps, decompressed};
use crate::pool;
use crate::scan::Framing;

/// Opens the log from its start; a log is read more than once.
pub type Open<'a> = &'a (dyn Fn() -> io::Result<Box<dyn Read + Send>> + 'a);

/// Bytes that show whether it is a dataflash log.
const HEAD: u64 = 64 << 10;
/// Bytes of a text log that show what it is and how values are separated.
const PROBE: usize = 8000;
/// How binary logs begin.
const BINARY: &[u8] = b"\xA3\x95\x80";
/// What describes a record in a text log.
const TEXT: &[u8] = b"FMT,";
/// Descriptions in the head of a binary log that lacks its first bytes.
const ENOUGH_LAYOUTS: usize = 3;
/// Bytes of a type's name at most; binary logs have 4.
const MAX_NAME_LEN: usize = 64;

/// Descriptions of one name that have rows in its table, as many as a type has: whoever makes a log chooses the names.
const MAX_OF_NAME: usize = 16;

/// What tells a telemetry log from a dataflash log that lacks its first bytes.
static TELEMETRY: LazyLock<Registry> = LazyLock::new(|| {
    Registry::new(builtin::dialect("all", WireVersion::V2).expect("it comes with the crate"))
});

/// [`Survey::table_of`] a layout that has no table.
pub(super) const NO_TABLE: u16 = u16::MAX;

/// How records are written.
#[derive(Debug, Clone)]
pub enum Form {
    /// Records of bytes.
    Binary(Box<Definitions>),
    /// A line for each record.
    Text(TextDefinitions),
}

/// Whether a log that begins like this ends before that is over.
fn is_cut_off_in(log: &[u8], start: &[u8]) -> bool {
    !log.is_empty() && log.len() < start.len() && start.starts_with(log)
}

impl Form {
    /// The form of a log that begins with these bytes, perhaps one of which nothing can be read; `None` for something else,
    /// such as a telemetry log of a flight on which a dataflash log was downloaded: its messages carry descriptions whole.
    pub fn of(head: &[u8]) -> Option<Self> {
        if head.starts_with(BINARY) || is_cut_off_in(head, BINARY) {
            return Some(Self::Binary(Box::default()));
        }
        if is_cut_off_in(head, TEXT) {
            return Some(Self::Text(TextDefinitions::new(Delimiter::of(head))));
        }
        let described = Self::without_start(head);
        let form = described
            .or_else(|| headless::is_in(head, &TELEMETRY).then(|| Self::Binary(Box::default())))?;
        (!Framing::is_in(head, &TELEMETRY)).then_some(form)
    }

    /// The same by descriptions anywhere in the head.
    fn without_start(head: &[u8]) -> Option<Self> {
        let mut definitions = Definitions::new();
        definitions.collect(head, 0);
        if definitions.layouts().len() > ENOUGH_LAYOUTS {
            return Some(Self::Binary(Box::default()));
        }
        let head = &head[..head.len().min(PROBE)];
        let text = memchr::memmem::find(head, TEXT).is_some_and(|at| at < 1000)
            && head[..head.len().min(100)].is_ascii();
        text.then(|| Self::Text(TextDefinitions::new(Delimiter::of(head))))
    }

    /// The layouts of the records.
    pub fn layouts(&self) -> &[Arc<Layout>] {
        match self {
            Self::Binary(definitions) => definitions.layouts(),
            Self::Text(definitions) => definitions.layouts(),
        }
    }
}

/// What a log says about itself.
#[derive(Debug, Clone)]
pub struct Survey {
    /// The layouts of its records.
    pub form: Form,
    /// What fields are measured in.
    pub units: Units,
    /// What gives records their times; `None` where nothing does.
    pub clock: Option<Clock>,
    /// Names of the tables, in the order in which the log describes them.
    pub tables: Vec<Arc<str>>,
    /// Table of each layout.
    pub(super) table_of: Vec<u16>,
    /// Bytes of the log, decompressed.
    pub(super) bytes: u64,
    /// In what steps it is read.
    pub(super) steps: Steps,
}

impl Survey {
    /// Goes through a log; `None` if it is no dataflash log. It is read in the same steps afterwards. `pulse` is asked
    /// now and then whether to go on.
    ///
    /// # Errors
    /// What reading says, and what `pulse` answers.
    pub fn read<E: From<Error>>(
        steps: Steps,
        open: Open<'_>,
        mut pulse: impl FnMut() -> Result<(), E>,
    ) -> Result<Option<Self>, E> {
        let (mut blocks, form) = begin(open, steps).map_err(Error::from)?;
        let Some(form) = form else { return Ok(None) };
        let mut run = Run::new(form, steps);
        while pool::a_while(|| run.advance(&mut blocks)).map_err(Error::from)? {
            pulse()?;
        }
        if run.missed {
            run = Run::new(run.form, steps);
            let (mut blocks, _) = begin(open, steps).map_err(Error::from)?;
            while pool::a_while(|| run.advance(&mut blocks)).map_err(Error::from)? {
                pulse()?;
            }
        }
        Ok(Some(run.finish()))
    }

    /// Index of a table.
    pub fn table(&self, name: &str) -> Option<usize> {
        self.tables.iter().position(|one| **one == *name)
    }

    /// The layouts of a table, by their indices; one, unless the log describes a type anew.
    pub fn layouts_of(&self, table: usize) -> impl Iterator<Item = (usize, &Arc<Layout>)> {
        let all = self.form.layouts().iter().enumerate();
        all.filter(move |&(index, _)| usize::from(self.table_of[index]) == table)
    }
}

/// Whether a source, perhaps compressed, begins as a dataflash log does.
///
/// # Errors
/// What reading says.
pub fn recognise(source: Box<dyn Read + Send>) -> io::Result<bool> {
    let mut head = Vec::new();
    // What is damaged further on is still what it is.
    let read = decompressed(source)?.take(HEAD).read_to_end(&mut head);
    match read {
        Err(error) if head.is_empty() && error.raw_os_error().is_some() => Err(error),
        _ => Ok(Form::of(&head).is_some()),
    }
}

pub(super) fn begin(open: Open<'_>, steps: Steps) -> io::Result<(Blocks, Option<Form>)> {
    Blocks::of_size(decompressed(open()?)?, steps.block).with_head(Form::of)
}

/// A run over a log.
struct Run {
    form: Form,
    units: Units,
    finder: ClockFinder,
    /// Whether records of a layout say something.
    telling: Vec<bool>,
    lines: Lines,
    offset: u64,
    /// Bytes behind `offset` that are indexed already.
    ahead: usize,
    /// Where in the log the bytes end that were searched for descriptions: none may be taken in twice.
    searched: u64,
    /// Some bytes belong to no record as far as was known then.
    missed: bool,
    steps: Steps,
}

impl Run {
    fn new(form: Form, steps: Steps) -> Self {
        Self {
            form,
            units: Units::default(),
            finder: ClockFinder::default(),
            telling: Vec::new(),
            lines: Lines::default(),
            offset: 0,
            ahead: 0,
            searched: 0,
            missed: false,
            steps,
        }
    }

    fn advance(&mut self, blocks: &mut Blocks) -> io::Result<bool> {
        let more = blocks.next(|block, at_end| {
            let done = match self.form {
                Form::Binary(_) => self.add_binary(block, at_end),
                Form::Text(_) => self.add_text(block, at_end),
            };
            self.offset += done as u64;
            (done, ())
        })?;
        Ok(more.is_some())
    }

    fn add_binary(&mut self, block: &[u8], at_end: bool) -> usize {
        let Form::Binary(definitions) = &mut self.form else { return block.len() };
        let again = (FMT_LAYOUT_LEN - 1) as u64;
        let new = self.searched.saturating_sub(again).saturating_sub(self.offset) as usize;
        definitions.collect(&block[new..], self.offset + new as u64);
        self.searched = self.offset + block.len() as u64;
        let teller = &mut Teller {
            units: &mut self.units,
            finder: &mut self.finder,
            telling: &mut self.telling,
            layouts: definitions.layouts(),
        };
        teller.refresh();
        let from = self.ahead.min(block.len());
        let place = self.offset + from as u64;
        let bytes = &block[from..];
        let hops = hop(bytes, place, definitions, at_end, self.steps.stretch);
        let telling = &*teller.telling;
        let is_telling = |place: &&Place| telling[usize::from(place.layout)];
        let few = hops.stretches.par_iter().flat_map_iter(|some| some.iter().filter(is_telling));
        for place in few.collect::<Vec<_>>() {
            let body = &place.of(bytes)[HEAD_LEN..];
            teller.add(
                place.layout,
                |units, layout| _ = units.add(layout, body),
                |layout, i| layout.number(i, body),
            );
        }
        self.missed |= !hops.bad.is_empty();
        if at_end {
            return block.len();
        }
        // A description may begin here and end in the next block.
        let consumed = (from + hops.consumed).min(block.len().saturating_sub(FMT_LAYOUT_LEN - 1));
        self.ahead = from + hops.consumed - consumed;
        consumed
    }

    fn add_text(&mut self, block: &[u8], at_end: bool) -> usize {
        let Self { form: Form::Text(definitions), lines, missed, .. } = self else {
            return block.len();
        };
        let offset = self.offset;
        lines.each(block, at_end, |line| {
            let Some(bytes) = line.bytes.filter(|bytes| !bytes.is_empty()) else { return };
            let place = offset + line.at as u64;
            definitions.collect(bytes, place);
            let Some(layout) = definitions.of_line(bytes, place) else {
                *missed = true;
                return;
            };
            let delimiter = definitions.delimiter();
            let teller = &mut Teller {
                units: &mut self.units,
                finder: &mut self.finder,
                telling: &mut self.telling,
                layouts: definitions.layouts(),
            };
            teller.refresh();
            let value = |i| nth_value(bytes, delimiter, i);
            let text =
                |layout: &Layout, name: &str| value(layout.field_index(name)?).map(decode_line);
            teller.add(
                layout,
                |units, layout| _ = units.add_values(&layout.name, |name| text(layout, name)),
                |layout, i| number(value(i)).filter(|_| is_whole(layout, value)),
            );
        })
    }

    fn finish(self) -> Survey {
        let Self { form, units, finder, offset: bytes, steps, .. } = self;
        let (mut tables, mut known) = (Vec::<Arc<str>>::new(), HashMap::new());
        let mut table_of = Vec::new();
        for layout in form.layouts() {
            if layout.name.len() > MAX_NAME_LEN {
                table_of.push(NO_TABLE);
                continue;
            }
            let next = tables.len() as u16;
            let (table, layouts) = known.entry(layout.name.as_str()).or_insert((next, 0));
            if *table == next {
                tables.push(layout.name.as_str().into());
            }
            *layouts += 1;
            table_of.push(if *layouts > MAX_OF_NAME { NO_TABLE } else { *table });
        }
        Survey { clock: finder.finish(), units, tables, table_of, bytes, steps, form }
    }
}

/// The number in a value of a text log.
pub(super) fn number(text: Option<&[u8]>) -> Option<f64> {
    std::str::from_utf8(text?).ok()?.trim().parse().ok()
}

/// Whether a line has numbers where it should; a GPS record with a word there does not tell when the log began.
fn is_whole<'a>(layout: &Layout, value: impl Fn(usize) -> Option<&'a [u8]>) -> bool {
    let is_text = |kind| matches!(kind, FieldKind::Text(_) | FieldKind::Mode | FieldKind::Array);
    let mut fields = layout.fields.iter().enumerate();
    !layout.name.starts_with("GPS")
        || fields.all(|(index, field)| is_text(field.kind) || number(value(index)).is_some())
}

/// Takes in the records that say something about others.
struct Teller<'a> {
    units: &'a mut Units,
    finder: &'a mut ClockFinder,
    telling: &'a mut Vec<bool>,
    layouts: &'a [Arc<Layout>],
}

impl Teller<'_> {
    /// Looks at layouts that are new.
    fn refresh(&mut self) {
        for layout in &self.layouts[self.telling.len().min(self.layouts.len())..] {
            self.telling.push(tells(self.finder, layout));
        }
    }

    #[inline]
    fn add(
        &mut self,
        layout: u16,
        units: impl FnOnce(&mut Units, &Layout),
        number: impl Fn(&Layout, usize) -> Option<f64>,
    ) {
        if !self.telling[usize::from(layout)] {
            return;
        }
        let layout = &self.layouts[usize::from(layout)];
        units(self.units, layout);
        if self.finder.add(layout, |index| number(layout, index)) {
            for (telling, layout) in self.telling.iter_mut().zip(self.layouts) {
                *telling = tells(self.finder, layout);
            }
        }
    }
}

fn tells(finder: &ClockFinder, layout: &Layout) -> bool {
    matches!(layout.name.as_str(), "UNIT" | "MULT" | "FMTU") || finder.wants(layout)
}
