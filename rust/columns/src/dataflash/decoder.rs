//! Records on their way into tables: sorted by table piece by piece, then gathered field by field.

use std::ops::Range;
use std::sync::Arc;
use std::vec::IntoIter;

use mavwire_core::log::dataflash::Layout;
use mavwire_core::log::dataflash::text::{Delimiter, trimmed, values};
use rayon::prelude::*;

use super::layout::{TableLayout, table_layout};
use super::record_index::Place;
use super::record_times::{RecordTimes, Stretch, Walked};
use super::survey::{Form, NO_TABLE, Survey};
use crate::error::Error;
use crate::gather::{NO_TIME, Rows};
use crate::layout::{Options, Source};
use crate::reader::{Batch, Plan, TakeIn};
use crate::row_block::{Chosen, RowBlock, Side, portions};
use crate::select::{Wanted, seconds};
use crate::table::{GROUP, TableBuilder};
use crate::tables::Tables;

/// Bytes that say where a line starts.
const LINE_PLACE: usize = size_of::<u32>();

/// How often tables that have rows are laid out anew because the log says more about their fields: a hostile log may do so
/// again and again.
const MOST_RENEWALS: usize = 16;

/// The growing tables of a log.
pub(super) struct Decoder {
    survey: Arc<Survey>,
    /// Where it is in the log.
    pub(super) walk: RecordTimes,
    /// Of the tables that have had rows.
    layouts: Vec<Option<TableLayout>>,
    tables: Tables,
    is_wanted: Vec<bool>,
    pieces: Vec<RowBlock>,
    /// Bytes of a row of each table while it is laid beside the others.
    strides: Vec<usize>,
    /// Bytes that a record of each layout takes there and in its table.
    row_lens: Vec<usize>,
    wanted: Wanted,
    options: Options,
    renewals: usize,
}

impl Decoder {
    /// At the start of a log that says this about itself.
    pub(super) fn new(survey: Arc<Survey>, plan: Plan) -> Self {
        let Plan { wanted, options, limits, .. } = plan;
        let walk = RecordTimes::new(Arc::clone(&survey));
        let (layouts, is_wanted, pieces, strides, row_lens) = Default::default();
        let tables = Tables::new(0, limits);
        let mut decoder = Self {
            survey: Arc::clone(&survey),
            walk,
            layouts,
            tables,
            is_wanted,
            pieces,
            strides,
            row_lens,
            wanted,
            options,
            renewals: 0,
        };
        decoder.adopt(survey);
        decoder
    }

    /// The log's description of itself, as far as the decoder knows it.
    pub(super) fn survey(&self) -> &Survey {
        &self.survey
    }

    /// Adds descriptions that were read later, by the same clock. False if they would change tables that have rows.
    pub(super) fn extend(&mut self, survey: Survey) -> bool {
        let survey = Arc::new(survey);
        let changed = self.survey.changed_by(&survey).into_iter();
        let mut changed = changed
            .filter_map(|table| Some((table, self.layouts.get(table)?.as_ref()?)))
            .peekable();
        self.renewals += usize::from(changed.peek().is_some());
        let fits = self.survey.clock == survey.clock
            && self.renewals <= MOST_RENEWALS
            && changed.all(|(table, layout)| {
                layout.is_same(&table_layout(&survey, table, &self.options))
            });
        if fits {
            self.walk.extend(Arc::clone(&survey));
            self.adopt(survey);
        }
        fits
    }

    /// Makes room for the tables that are new.
    fn adopt(&mut self, survey: Arc<Survey>) {
        let tables = &survey.tables;
        let new = tables[self.is_wanted.len()..].iter().map(|name| self.wanted.wants_name(name));
        self.is_wanted.extend(new);
        self.layouts.resize_with(tables.len(), || None);
        self.tables.builders.resize_with(tables.len(), || None);
        self.strides.clear();
        self.strides.resize(tables.len(), 0);
        for (layout, &table) in survey.form.layouts().iter().zip(&survey.table_of) {
            if table != NO_TABLE {
                let stride = &mut self.strides[usize::from(table)];
                *stride = (*stride).max(row_len(&survey.form, layout));
            }
        }
        let is_wanted = |table: usize| self.is_wanted.get(table).is_some_and(|wanted| *wanted);
        let of_table = |&table: &u16| match usize::from(table) {
            table if is_wanted(table) => self.strides[table] + survey.row_lens[table],
            _ => 0,
        };
        self.row_lens = survey.table_of.iter().map(of_table).collect();
        self.survey = survey;
    }

    fn append(&mut self, block: &[u8], stretches: &[Stretch], done: f64) {
        let Self { survey, walk, layouts, tables, is_wanted, pieces, strides, wanted, .. } = self;
        let sorter = Sorter { walk, survey, wanted, is_wanted, strides };
        sorter.sort_into(pieces, block, stretches);
        let has_rows = |table| pieces.iter().any(|piece| piece.rows(table) > 0);
        let new = layouts.iter_mut().enumerate();
        let new: Vec<_> = new.filter(|(table, one)| one.is_none() && has_rows(*table)).collect();
        new.into_par_iter().with_max_len(1).for_each(|(table, layout)| {
            *layout = Some(table_layout(survey, table, &self.options));
        });
        let layout = |table: usize| layouts[table].as_ref().expect("it has rows");
        let new = |table| TableBuilder::new(Arc::clone(&layout(table).layout));
        let append = |table: &mut TableBuilder, index: usize, piece: &RowBlock| {
            let (layout, side) = (layout(index), piece.of(index));
            match &survey.form {
                Form::Binary(_) => append_records(table, layout, side),
                Form::Text(form) => append_lines(table, layout, block, side, form.delimiter()),
            }
        };
        tables.append(pieces, done, new, append);
    }
}

impl TakeIn for Decoder {
    type Found = Walked;

    fn find(&mut self, block: &[u8], at_end: bool) -> Walked {
        self.walk.block(block, at_end)
    }

    fn extent(walked: &Walked) -> (usize, u64) {
        (walked.consumed, walked.bad_bytes())
    }

    fn portions(&self, walked: &Walked) -> IntoIter<Range<usize>> {
        let rows_len = |stretch: &Stretch| stretch.layouts().map(|one| self.row_lens[one]).sum();
        portions(&walked.stretches, rows_len).into_iter()
    }

    fn take_in(
        &mut self,
        block: &[u8],
        walked: &Walked,
        some: Range<usize>,
        done: f64,
    ) -> Result<Vec<Batch>, Error> {
        self.append(block, &walked.stretches[some], done);
        self.tables.complete()
    }

    fn rest(&mut self) -> Result<Option<Vec<Batch>>, Error> {
        self.tables.rest()
    }
}

/// Bytes of a record beside others of its table; of a line those of its place.
fn row_len(form: &Form, layout: &Layout) -> usize {
    match form {
        Form::Binary(_) => layout.len.into(),
        Form::Text(_) => LINE_PLACE,
    }
}

/// Lays the wanted records of a block side by side.
struct Sorter<'a> {
    walk: &'a RecordTimes,
    survey: &'a Survey,
    wanted: &'a Wanted,
    is_wanted: &'a [bool],
    strides: &'a [usize],
}

impl Sorter<'_> {
    fn sort_into(&self, pieces: &mut Vec<RowBlock>, block: &[u8], stretches: &[Stretch]) {
        pieces.resize_with(stretches.len(), RowBlock::default);
        let is_binary = matches!(self.survey.form, Form::Binary(_));
        let each = pieces.par_iter_mut().zip(stretches).with_max_len(1);
        each.for_each(|(piece, stretch)| {
            let all = self.walk.timed(block, stretch);
            let chosen = all.filter_map(|(place, time)| self.choose(place, time));
            piece.sort(chosen, self.strides, |chosen, row| {
                if is_binary {
                    // With what follows a record shorter than others of its table, where no column looks.
                    let rest = &block[chosen.at as usize..];
                    let len = row.len().min(rest.len());
                    row[..len].copy_from_slice(&rest[..len]);
                } else {
                    row.copy_from_slice(&chosen.at.to_le_bytes());
                }
            });
        });
    }

    #[inline]
    fn choose(&self, place: Place, time: i64) -> Option<Chosen> {
        let table = self.survey.table_of[usize::from(place.layout)];
        if table == NO_TABLE || !self.is_wanted[usize::from(table)] {
            return None;
        }
        let Wanted { start, end, .. } = *self.wanted;
        let has_time = self.survey.clock.is_some();
        let any_time = start == f64::NEG_INFINITY && end == f64::INFINITY;
        let is_in_time = any_time || !has_time || (start..end).contains(&seconds(time as f64));
        let time = if has_time { time } else { NO_TIME };
        is_in_time.then_some(Chosen { table, kind: place.layout, at: place.at, time })
    }
}

fn append_records(table: &mut TableBuilder, layout: &TableLayout, side: Side<'_>) {
    for same in side.runs() {
        let Some(of_layout) = layout.places.get(&same.kinds[0]) else { continue };
        let sources: Vec<Option<&Source>> = of_layout.sources().collect();
        for Side { times, bytes, stride, .. } in same.groups(GROUP) {
            let rows = Rows { times, bytes, stride, texts: &[] };
            match layout.layout.late {
                Some(_) => table.append(&rows),
                None => table.append_from(&rows, &sources),
            }
        }
    }
}

fn append_lines(
    table: &mut TableBuilder,
    layout: &TableLayout,
    block: &[u8],
    side: Side<'_>,
    delimiter: Delimiter,
) {
    let name = &layout.layout.message;
    let (places, _) = side.bytes.as_chunks::<LINE_PLACE>();
    for ((place, kind), &time) in places.iter().zip(side.kinds).zip(side.times) {
        let Some(of_layout) = layout.places.get(kind) else { continue };
        let values = values(line_at(block, *place), delimiter, name);
        let value = |field: &Option<u16>| values.get(usize::from((*field)?)).copied();
        table.append_texts(time, of_layout.fields.iter().map(value));
    }
}

/// The line that starts at a place.
fn line_at(block: &[u8], place: [u8; LINE_PLACE]) -> &[u8] {
    let rest = &block[u32::from_le_bytes(place) as usize..];
    trimmed(&rest[..memchr::memchr(b'\n', rest).unwrap_or(rest.len())])
}
