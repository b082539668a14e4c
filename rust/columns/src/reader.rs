//! A log as record batches: reading, scanning, sorting by type and gathering, block by block.

use std::io::Read;
use std::sync::Arc;

use arrow::array::RecordBatch;
use mavwire_core::frame::Header;
use mavwire_core::log::tlog::Located;
use mavwire_core::registry::Registry;
use rayon::prelude::*;

use crate::error::Error;
use crate::gather::{PAYLOAD, Rows};
use crate::input::{Blocks, Steps};
use crate::layout::{Layout, Options};
use crate::piece::{Chosen, PIECE, Piece};
use crate::pool;
use crate::scan::{Framing, LogScanner, Scanned};
use crate::select::Wanted;
use crate::table::{Expected, GROUP, TableBuilder};
use crate::tables::Tables;

/// When a table's rows become a record batch.
#[derive(Debug, Clone, Copy)]
pub struct Limits {
    /// Rows of a batch at most; a table waits until another block would bring more, or the end. 0 for those of each block.
    pub rows: usize,
    /// Bytes that all growing tables may hold together; beyond that the largest is taken.
    pub bytes: usize,
    /// Bytes of one table that make a batch of it whatever else is allowed: the offsets of a text array have 31 bits.
    pub table_bytes: usize,
}

impl Limits {
    /// One batch for each type, or some where one would be too large for arrow.
    pub const NONE: Self = Self { rows: usize::MAX, bytes: usize::MAX, table_bytes: 1 << 30 };

    /// What each of so many tables may come to. What they get ahead stays within what they may hold together: many large
    /// spans of memory, of which little is used before they are given back, leave it in pieces that nothing fits into.
    pub(crate) fn expected(self, growth: f64, tables: usize) -> Expected {
        let ahead = self.bytes / tables.max(1);
        Expected { growth, ahead, rows: self.rows, bytes: self.table_bytes }
    }
}

/// Rows of one message type.
#[derive(Debug, Clone)]
pub struct Batch {
    /// Index of the message, or of the table of a dataflash log.
    pub index: u16,
    /// Its name.
    pub message: Arc<str>,
    /// The rows.
    pub rows: RecordBatch,
}

/// A log of any kind being decoded.
pub trait Decode: Send {
    /// The batches that are complete after another block; `None` at the end, when the last ones were given.
    ///
    /// # Errors
    /// What reading says.
    fn advance(&mut self) -> Result<Option<Vec<Batch>>, Error>;

    /// The same after as many blocks as it takes, or as a while is enough for.
    ///
    /// # Errors
    /// What reading says.
    fn advance_a_while(&mut self) -> Result<Option<Vec<Batch>>, Error> {
        let mut batches = None;
        pool::a_while(|| {
            batches = self.advance()?;
            Ok::<_, Error>(batches.as_ref().is_some_and(Vec::is_empty))
        })?;
        Ok(batches)
    }

    /// Bytes of the log that are dealt with, decompressed.
    fn position(&self) -> u64;

    /// How many of them belong to no record.
    fn bad_bytes(&self) -> u64;

    /// Whether records have times.
    fn has_times(&self) -> bool;

    /// What is wrong with the compressed file, of which everything before that was read.
    fn damage(&self) -> Option<&str>;
}

/// A telemetry log being decoded.
pub struct Reader {
    blocks: Blocks,
    scanner: LogScanner,
    framing: Framing,
    wanted: Wanted,
    options: Options,
    tables: Tables,
    pieces: Vec<Piece>,
    /// Bytes of a row of each table while it is laid beside the others.
    strides: Vec<usize>,
    /// Bytes of the log, decompressed, that are dealt with.
    position: u64,
    bad_bytes: u64,
    size: u64,
}

impl Reader {
    /// A reader of a log, perhaps compressed, or of one that is known to be framed like this, and plain.
    ///
    /// # Errors
    /// What reading says.
    pub fn new(
        steps: Steps,
        source: Box<dyn Read + Send>,
        framing: Option<Framing>,
        registry: Arc<Registry>,
        wanted: Wanted,
        options: Options,
        limits: Limits,
    ) -> Result<Self, Error> {
        let (blocks, framing) = Blocks::framed(source, framing, &registry, steps.block)?;
        let messages = &registry.dialect().messages;
        let tables = Tables::new(messages.len(), limits);
        let strides = messages.iter().map(|one| PAYLOAD + usize::from(one.max_len)).collect();
        let scanner = LogScanner::new(registry, framing).with_stretch(steps.stretch);
        Ok(Self {
            blocks,
            scanner,
            framing,
            wanted,
            options,
            tables,
            pieces: Vec::new(),
            strides,
            position: 0,
            bad_bytes: 0,
            size: 0,
        })
    }

    /// Says how many bytes the log has, or may have: tables get room for the rows that are to be expected.
    #[must_use]
    pub fn with_size(mut self, bytes: u64) -> Self {
        self.size = bytes;
        self
    }
}

/// Lays the wanted records of a block side by side, piece by piece.
fn sort_into(
    pieces: &mut Vec<Piece>,
    strides: &[usize],
    block: &[u8],
    framing: Framing,
    scanned: &Scanned,
    wanted: &Wanted,
) {
    let lead = framing.lead();
    let wants = |record: &&Located| wanted.wants_row(block, lead, scanned, **record);
    pieces.resize_with(scanned.records.len().div_ceil(PIECE), Piece::default);
    let each = pieces.par_iter_mut().zip(scanned.records.par_chunks(PIECE)).with_max_len(1);
    each.for_each(|(piece, records)| {
        let chosen = records.iter().filter(wants).map(|&Located { at, index }| {
            let time = if lead == 0 { 0 } else { scanned.time(block, at) };
            let time = i64::try_from(time).unwrap_or(i64::MAX);
            Chosen { table: index, kind: 0, at, time }
        });
        piece.sort(chosen, strides, |record, row| fill(row, &block[record.at as usize + lead..]));
    });
}

/// Who sent a frame, and its payload as far as the message goes.
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
fn append(table: &mut TableBuilder, index: usize, piece: &Piece) {
    for side in piece.of(index).groups(GROUP) {
        table.append(&Rows { times: side.times, bytes: side.bytes, stride: side.stride });
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
        self.framing == Framing::Stamped
    }

    fn damage(&self) -> Option<&str> {
        self.blocks.damage()
    }

    fn advance(&mut self) -> Result<Option<Vec<Batch>>, Error> {
        let Self { blocks, scanner, framing, wanted, options, tables, pieces, strides, .. } = self;
        let (position, size) = (self.position, self.size);
        let read = blocks.next(|block, at_end| {
            let scanned = scanner.scan(block, at_end);
            sort_into(pieces, strides, block, *framing, &scanned, wanted);
            let new = |index| {
                let layout = Layout::new(scanner.registry(), index as u16, *framing, options);
                TableBuilder::new(Arc::new(layout))
            };
            let done = (position + scanned.consumed as u64) as f64 / size as f64;
            tables.append(pieces, done, new, append);
            let bad: usize = scanned.bad.iter().map(std::iter::ExactSizeIterator::len).sum();
            (scanned.consumed, (scanned.consumed, bad))
        })?;
        let Some((consumed, bad)) = read else { return self.tables.rest() };
        self.position += consumed as u64;
        self.bad_bytes += bad as u64;
        self.tables.complete().map(Some)
    }
}
