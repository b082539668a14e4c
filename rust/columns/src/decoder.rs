//! Records of a telemetry log on their way into tables: sorted by type piece by piece, then gathered field by field.

use std::ops::Range;
use std::sync::Arc;
use std::vec::IntoIter;

use mavwire_core::frame::Header;
use mavwire_core::log::tlog::Located;
use mavwire_core::registry::Registry;
use mavwire_core::telemetry::TextFields;
use rayon::prelude::*;

use crate::error::Error;
use crate::gather::{NO_TIME, PAYLOAD, Rows};
use crate::input::Steps;
use crate::layout::{Layouts, Options, names_len};
use crate::reader::{Batch, Limits, Plan, TakeIn};
use crate::row_block::{Chosen, PIECE, RowBlock, Side, portions};
use crate::scan::{Framing, LogScanner, Scanned, UNKNOWN};
use crate::select::Wanted;
use crate::table::{GROUP, TableBuilder};
use crate::tables::Tables;
use crate::unknown::{self, UnknownCounts};
use crate::unknown_table::UnknownTable;

/// The growing tables of a log.
pub(crate) struct Decoder {
    scanner: LogScanner,
    registry: Arc<Registry>,
    framing: Framing,
    wanted: Wanted,
    unknown: UnknownCounts,
    unknown_table: Option<UnknownTable>,
    limits: Limits,
    options: Options,
    layouts: Arc<Layouts>,
    tables: Tables,
    pieces: Vec<RowBlock>,
    /// Bytes of a row of each table while it is laid beside the others.
    strides: Vec<usize>,
    /// Bytes that a record of each message takes there and in its table.
    row_lens: Vec<usize>,
}

impl Decoder {
    pub(crate) fn new(registry: Arc<Registry>, framing: Framing, steps: Steps, plan: Plan) -> Self {
        let Plan { wanted, options, layouts, limits, unknown_table, .. } = plan;
        let layouts = layouts.unwrap_or_else(|| Arc::new(Layouts::new(&registry, options.clone())));
        let scanner = LogScanner::new(Arc::clone(&registry), framing).with_stretch(steps.stretch);
        let messages = &registry.dialect().messages;
        let tables = Tables::new(messages.len(), limits);
        let strides: Vec<usize> =
            messages.iter().map(|one| PAYLOAD + usize::from(one.max_len)).collect();
        // Scaled values take 8 bytes for each element.
        let widened = if options.si { size_of::<f64>() } else { 1 };
        let names_len =
            |one| if options.enum_names { names_len(one, registry.dialect()) } else { 0 };
        let row_lens = messages.iter().zip(&strides);
        let row_lens: Vec<_> =
            row_lens.map(|(one, stride)| stride * (1 + widened) + names_len(one)).collect();
        let (pieces, unknown) = Default::default();
        Self {
            scanner,
            registry,
            framing,
            wanted,
            unknown,
            unknown_table: unknown_table.then(UnknownTable::default),
            limits,
            options,
            layouts,
            tables,
            pieces,
            strides,
            row_lens,
        }
    }
}

impl TakeIn for Decoder {
    type Found = Scanned;

    fn find(&mut self, block: &[u8], at_end: bool) -> Scanned {
        let (scanned, lead) = (self.scanner.scan(block, at_end), self.framing.lead());
        for record in scanned.records.iter().filter(|record| record.index == UNKNOWN) {
            if self.wanted.wants(block, lead, &scanned, *record) {
                let frame = &block[record.at as usize + lead..];
                unknown::add(&mut self.unknown, frame, None);
                if let Some(table) = &mut self.unknown_table {
                    table.append(scanned.time(block, record.at), frame);
                }
            }
        }
        scanned
    }

    fn unknown(&self) -> UnknownCounts {
        self.unknown.clone()
    }

    fn extent(scanned: &Scanned) -> (usize, u64) {
        (scanned.consumed, scanned.bad_bytes())
    }

    fn portions(&self, scanned: &Scanned) -> IntoIter<Range<usize>> {
        let own = |record: &Located| self.row_lens.get(usize::from(record.index));
        let rows_len = |records: &&[Located]| records.iter().filter_map(own).sum();
        let chunks: Vec<_> = scanned.records.chunks(PIECE).collect();
        let records =
            |some: Range<usize>| some.start * PIECE..(some.end * PIECE).min(scanned.records.len());
        let portions: Vec<_> = portions(&chunks, rows_len).into_iter().map(records).collect();
        portions.into_iter()
    }

    fn take_in(
        &mut self,
        block: &[u8],
        scanned: &Scanned,
        some: Range<usize>,
        done: f64,
    ) -> Result<Vec<Batch>, Error> {
        self.sort(block, scanned, some);
        let Self { registry, options, layouts, tables, pieces, unknown_table, limits, .. } = self;
        let new = |index| {
            let layout = layouts.of(registry, index as u16);
            let fields = TextFields::of(registry.message(index as u16));
            let fields = fields.filter(|_| !options.text_parts);
            TableBuilder::new(layout).with_long_texts(fields)
        };
        tables.append(pieces, done, new, append);
        let mut batches = tables.complete()?;
        if let Some(table) = unknown_table {
            batches.extend(table.complete(*limits)?);
        }
        Ok(batches)
    }

    fn rest(&mut self) -> Result<Option<Vec<Batch>>, Error> {
        let mut batches = self.tables.rest()?.unwrap_or_default();
        if let Some(table) = &mut self.unknown_table {
            batches.extend(table.take(self.limits)?);
        }
        Ok((!batches.is_empty()).then_some(batches))
    }
}

impl Decoder {
    /// Lays the wanted ones of some records side by side, piece by piece.
    fn sort(&mut self, block: &[u8], scanned: &Scanned, some: Range<usize>) {
        let Self { framing, wanted, pieces, strides, .. } = self;
        let (lead, records) = (framing.lead(), &scanned.records[some]);
        let wants = |record: &&Located| {
            record.index != UNKNOWN && wanted.wants(block, lead, scanned, **record)
        };
        pieces.resize_with(records.len().div_ceil(PIECE), RowBlock::default);
        let each = pieces.par_iter_mut().zip(records.par_chunks(PIECE)).with_max_len(1);
        each.for_each(|(piece, records)| {
            let chosen = records.iter().filter(wants).map(|&Located { at, index }| {
                let time = scanned.time(block, at);
                let time = time.map_or(NO_TIME, |time| i64::try_from(time).unwrap_or(i64::MAX));
                Chosen { table: index, kind: 0, at, time }
            });
            let fill = |record: Chosen, row: &mut [u8]| {
                fill(row, &block[record.at as usize + lead..]);
            };
            piece.sort(chosen, strides, fill);
        });
    }
}

/// Fills a row with the sender and payload of a frame, and zeros where the payload is shorter than the message.
fn fill(row: &mut [u8], frame: &[u8]) {
    let Some(header) = Header::parse(frame) else { return row.fill(0) };
    (row[0], row[1], row[2]) = (header.sysid, header.compid, header.seq);
    let sent = &frame[header.len()..][..usize::from(header.payload_len)];
    let kept = sent.len().min(row.len() - PAYLOAD);
    let (there, cut) = row[PAYLOAD..].split_at_mut(kept);
    there.copy_from_slice(&sent[..kept]);
    cut.fill(0);
}

/// Appends the records of a type in a piece to its table.
fn append(table: &mut TableBuilder, index: usize, piece: &RowBlock) {
    for Side { times, bytes, stride, .. } in piece.of(index).groups(GROUP) {
        table.append(&Rows { times, bytes, stride, texts: &[] });
    }
}
