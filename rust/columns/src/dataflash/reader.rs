//! A dataflash log as record batches.

use std::sync::Arc;

use mavwire_core::log::dataflash::text::Delimiter;
use rayon::prelude::*;

use super::layout::{TableLayout, table_layout};
use super::survey::{Form, NO_TABLE, Open, Survey, begin};
use super::walk::{Place, Walk};
use crate::column::Rows;
use crate::error::Error;
use crate::input::Blocks;
use crate::layout::{Options, Source};
use crate::reader::{Batch, Decode, Limits};
use crate::select::seconds;
use crate::table::{GROUP, TableBuilder};
use crate::tables::Tables;

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
    layouts: Vec<TableLayout>,
    tables: Tables,
    sorted: Vec<Sorted>,
    wanted: Wanted,
    position: u64,
    bad_bytes: u64,
}

/// The records of a table in a block.
#[derive(Debug, Default)]
struct Sorted {
    is_wanted: bool,
    places: Vec<Place>,
    times: Vec<i64>,
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
        let (blocks, _) = begin(open)?;
        let count = survey.tables.len();
        let layouts = (0..count).map(|table| table_layout(&survey, table, options)).collect();
        let is_wanted = |name: &str| {
            wanted.names.as_ref().is_none_or(|some| some.iter().any(|one| one == name))
        };
        let sorted = survey
            .tables
            .iter()
            .map(|name| Sorted { is_wanted: is_wanted(name), ..Sorted::default() })
            .collect();
        let walk = Walk::new(Arc::clone(&survey));
        let tables = Tables::new(count, limits);
        Ok(Self {
            survey,
            blocks,
            walk,
            layouts,
            tables,
            sorted,
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
        let Self { survey, blocks, walk, layouts, tables, sorted, wanted, .. } = self;
        let read = blocks.next(|block, at_end| {
            let (consumed, bad) = sort(walk, survey, wanted, sorted, block, at_end);
            let delimiter = match &survey.form {
                Form::Binary(_) => None,
                Form::Text(definitions) => Some(definitions.delimiter()),
            };
            let each = tables.builders.par_iter_mut().zip(sorted.par_iter()).zip(layouts);
            each.filter(|((_, sorted), _)| !sorted.places.is_empty()).for_each(
                |((table, sorted), layout)| {
                    let new = || TableBuilder::new(Arc::clone(&layout.layout));
                    let table = table.get_or_insert_with(new);
                    match delimiter {
                        None => append_records(table, layout, block, sorted),
                        Some(delimiter) => append_lines(table, layout, block, sorted, delimiter),
                    }
                },
            );
            (consumed, (consumed, bad))
        })?;
        let Some((consumed, bad)) = read else { return self.tables.rest() };
        self.position += consumed as u64;
        self.bad_bytes += bad as u64;
        self.tables.complete().map(Some)
    }
}

/// Sorts the records of a block by table; bytes dealt with, and bytes of no record among them.
fn sort(
    walk: &mut Walk,
    survey: &Survey,
    wanted: &Wanted,
    sorted: &mut [Sorted],
    block: &[u8],
    at_end: bool,
) -> (usize, usize) {
    for one in &mut *sorted {
        one.places.clear();
        one.times.clear();
    }
    let any_time = survey.clock.is_none()
        || (wanted.start == f64::NEG_INFINITY && wanted.end == f64::INFINITY);
    let mut bad = 0;
    let record = |place: Place, time: i64| {
        let table = survey.table_of[usize::from(place.layout)];
        if table == NO_TABLE {
            return;
        }
        let one = &mut sorted[usize::from(table)];
        let in_time = || (wanted.start..wanted.end).contains(&seconds(time as f64));
        if one.is_wanted && (any_time || in_time()) {
            one.places.push(place);
            one.times.push(time);
        }
    };
    let consumed = walk.block(block, at_end, record, |range| bad += range.len());
    (consumed, bad)
}

fn append_records(table: &mut TableBuilder, layout: &TableLayout, block: &[u8], sorted: &Sorted) {
    let mut times = &sorted.times[..];
    let mut side_by_side = Vec::new();
    for same in sorted.places.chunk_by(|one, other| one.layout == other.layout) {
        let Some(of_layout) = layout.places.get(&same[0].layout) else { continue };
        let sources: Vec<Option<&Source>> =
            of_layout.iter().map(|place| place.as_ref().map(|(_, source)| source)).collect();
        for group in same.chunks(GROUP) {
            side_by_side.clear();
            for place in group {
                side_by_side.extend_from_slice(place.of(block));
            }
            let (now, rest) = times.split_at(group.len());
            times = rest;
            let stride = usize::from(group[0].len);
            table.append_rows(&Rows { times: now, bytes: &side_by_side, stride }, &sources);
        }
    }
}

fn append_lines(
    table: &mut TableBuilder,
    layout: &TableLayout,
    block: &[u8],
    sorted: &Sorted,
    delimiter: Delimiter,
) {
    let rest_is_one = layout.layout.message == "FMT";
    for (place, &time) in sorted.places.iter().zip(&sorted.times) {
        let Some(of_layout) = layout.places.get(&place.layout) else { continue };
        let values = values(place.of(block), delimiter, rest_is_one);
        let value = |place: &Option<(usize, Source)>| {
            place.as_ref().and_then(|(index, _)| values.get(*index).copied())
        };
        table.append_texts(time, of_layout.iter().map(value));
    }
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
