//! A dataflash log as record batches.

use std::collections::HashMap;
use std::sync::Arc;

use mavwire_core::log::dataflash::text::{Delimiter, trimmed};
use rayon::prelude::*;

use super::hop::Place;
use super::layout::{TableLayout, table_layout};
use super::survey::{Form, NO_TABLE, Open, Survey, begin};
use super::walk::{Walk, Walked};
use crate::error::Error;
use crate::gather::Rows;
use crate::input::Blocks;
use crate::layout::{Options, Source};
use crate::piece::{Chosen, Piece, Side};
use crate::reader::{Batch, Decode, Limits};
use crate::select::seconds;
use crate::table::{GROUP, TableBuilder};
use crate::tables::Tables;

/// Bytes that say where a line starts.
const LINE_PLACE: usize = size_of::<u32>();

/// Which records are wanted.
#[derive(Debug, Clone)]
pub struct Wanted {
    /// Names of tables; `None` for all.
    pub names: Option<Vec<String>>,
    /// Seconds since 1970: the first that is wanted.
    pub start: f64,
    /// The first that is not any more.
    pub end: f64,
}

/// A log being decoded.
pub struct Reader {
    survey: Arc<Survey>,
    blocks: Blocks,
    walk: Walk,
    /// Of the tables that are wanted.
    layouts: HashMap<usize, TableLayout>,
    tables: Tables,
    is_wanted: Vec<bool>,
    pieces: Vec<Piece>,
    /// Bytes of a row of each table while it is laid beside the others.
    strides: Vec<usize>,
    wanted: Wanted,
    position: u64,
    bad_bytes: u64,
}

impl Reader {
    /// A reader of a log that was surveyed.
    ///
    /// # Errors
    /// What reading says.
    pub fn new(
        survey: Arc<Survey>,
        open: Open<'_>,
        wanted: Wanted,
        options: &Options,
        limits: Limits,
    ) -> Result<Self, Error> {
        let (blocks, _) = begin(open, survey.steps)?;
        let count = survey.tables.len();
        let is_wanted = |name: &str| {
            wanted.names.as_ref().is_none_or(|some| some.iter().any(|one| one == name))
        };
        let is_wanted: Vec<bool> = survey.tables.iter().map(|name| is_wanted(name)).collect();
        let tables_wanted = (0..count).filter(|&table| is_wanted[table]);
        let layouts =
            tables_wanted.map(|table| (table, table_layout(&survey, table, options))).collect();
        let strides = (0..count).map(|table| stride(&survey, table)).collect();
        let walk = Walk::new(Arc::clone(&survey));
        let tables = Tables::new(count, limits);
        Ok(Self {
            survey,
            blocks,
            walk,
            layouts,
            tables,
            is_wanted,
            pieces: Vec::new(),
            strides,
            wanted,
            position: 0,
            bad_bytes: 0,
        })
    }
}

impl Decode for Reader {
    fn position(&self) -> u64 {
        self.position
    }

    fn bad_bytes(&self) -> u64 {
        self.bad_bytes
    }

    fn has_times(&self) -> bool {
        self.survey.clock.is_some()
    }

    fn damage(&self) -> Option<&str> {
        self.blocks.damage()
    }

    fn advance(&mut self) -> Result<Option<Vec<Batch>>, Error> {
        let position = self.position;
        let Self { blocks, walk, layouts, tables, pieces, .. } = self;
        let (survey, wanted, flags, strides) =
            (&*self.survey, &self.wanted, &self.is_wanted, &self.strides);
        let read = blocks.next(|block, at_end| {
            let walked = walk.block(block, at_end);
            let sorter = Sorter { walk, survey, wanted, is_wanted: flags, strides };
            sorter.sort_into(pieces, block, &walked);
            let new = |table: usize| TableBuilder::new(Arc::clone(&layouts[&table].layout));
            let append = |table: &mut TableBuilder, index: usize, piece: &Piece| {
                let (layout, side) = (&layouts[&index], piece.of(index));
                match &survey.form {
                    Form::Binary(_) => append_records(table, layout, side),
                    Form::Text(form) => append_lines(table, layout, block, side, form.delimiter()),
                }
            };
            let done = (position + walked.consumed as u64) as f64 / survey.bytes as f64;
            tables.append(pieces, done, new, append);
            let bad: usize = walked.bad.iter().map(ExactSizeIterator::len).sum();
            (walked.consumed, (walked.consumed, bad))
        })?;
        let Some((consumed, bad)) = read else { return self.tables.rest() };
        self.position += consumed as u64;
        self.bad_bytes += bad as u64;
        self.tables.complete().map(Some)
    }
}

/// Bytes that hold any record of a table; of a text log the place of its line.
fn stride(survey: &Survey, table: usize) -> usize {
    match &survey.form {
        Form::Binary(_) => {
            let lens = survey.layouts_of(table).map(|(_, layout)| usize::from(layout.len));
            lens.max().unwrap_or(0)
        }
        Form::Text(_) => LINE_PLACE,
    }
}

/// Lays the wanted records of a block side by side.
struct Sorter<'a> {
    walk: &'a Walk,
    survey: &'a Survey,
    wanted: &'a Wanted,
    is_wanted: &'a [bool],
    strides: &'a [usize],
}

impl Sorter<'_> {
    fn sort_into(&self, pieces: &mut Vec<Piece>, block: &[u8], walked: &Walked) {
        pieces.resize_with(walked.stretches.len(), Piece::default);
        let is_binary = matches!(self.survey.form, Form::Binary(_));
        let each = pieces.par_iter_mut().zip(&walked.stretches).with_max_len(1);
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
        let any_time = start == f64::NEG_INFINITY && end == f64::INFINITY;
        let is_in_time =
            any_time || self.survey.clock.is_none() || (start..end).contains(&seconds(time as f64));
        is_in_time.then_some(Chosen { table, kind: place.layout, at: place.at, time })
    }
}

fn append_records(table: &mut TableBuilder, layout: &TableLayout, side: Side<'_>) {
    for same in side.runs() {
        let Some(of_layout) = layout.places.get(&same.kinds[0]) else { continue };
        let sources: Vec<Option<&Source>> = of_layout.sources().collect();
        for Side { times, bytes, stride, .. } in same.groups(GROUP) {
            table.append_from(&Rows { times, bytes, stride }, &sources);
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
    let rest_is_one = layout.layout.message == "FMT";
    let (places, _) = side.bytes.as_chunks::<LINE_PLACE>();
    for ((place, kind), &time) in places.iter().zip(side.kinds).zip(side.times) {
        let Some(of_layout) = layout.places.get(kind) else { continue };
        let values = values(line_at(block, *place), delimiter, rest_is_one);
        let value = |field: &Option<u16>| values.get(usize::from((*field)?)).copied();
        table.append_texts(time, of_layout.fields.iter().map(value));
    }
}

/// The line that starts at a place.
fn line_at(block: &[u8], place: [u8; LINE_PLACE]) -> &[u8] {
    let rest = &block[u32::from_le_bytes(place) as usize..];
    trimmed(&rest[..memchr::memchr(b'\n', rest).unwrap_or(rest.len())])
}

/// The values of a line; the last column of FMT has commas in it.
fn values(line: &[u8], delimiter: Delimiter, rest_is_one: bool) -> Vec<&[u8]> {
    const FMT_COLUMNS: usize = 5;
    let separator = delimiter.text().as_bytes();
    let (mut values, mut start) = (Vec::new(), None);
    for at in memchr::memmem::find_iter(line, separator) {
        if let Some(start) = start {
            if rest_is_one && values.len() + 1 == FMT_COLUMNS {
                break;
            }
            values.push(&line[start..at]);
        }
        start = Some(at + separator.len());
    }
    values.extend(start.map(|start| &line[start..]));
    values
}
