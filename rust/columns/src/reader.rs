//! A log as record batches: reading, scanning, sorting by type and gathering, block by block.

use std::io::Read;
use std::ops::Range;
use std::sync::Arc;
use std::vec::IntoIter;

use arrow::array::{Array, RecordBatch};
use arrow::compute::take_record_batch;
use mavwire_core::registry::Registry;

use crate::decoder::Decoder;
use crate::error::Error;
use crate::input::{Blocks, Steps};
use crate::layout::{Layout, Layouts, Options};
use crate::pool;
use crate::row_block::Rest;
use crate::scan::Framing;
use crate::select::Wanted;
use crate::table::{Expected, TableBuilder};
use crate::unknown::UnknownCounts;

/// When a table's rows become a record batch.
#[derive(Debug, Clone, Copy)]
pub struct Limits {
    /// Rows of a batch at most; a table waits until another block would bring more, or the end. 0 for those of each block.
    pub rows: usize,
    /// Bytes that all growing tables may hold together; beyond that the largest is taken.
    pub bytes: usize,
    /// Bytes of one table that make a batch of it in any case: the offsets of a text array have 31 bits.
    pub table_bytes: usize,
}

impl Default for Limits {
    fn default() -> Self {
        Self::NONE
    }
}

impl Limits {
    /// One batch for each type, or some where one would be too large for arrow.
    pub const NONE: Self = Self { rows: usize::MAX, bytes: usize::MAX, table_bytes: 1 << 30 };

    /// The expected size of each of so many tables. They share the memory that they get ahead: many large blocks that
    /// are freed nearly unused would fragment the memory.
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
    /// The layout that the rows get which a predicate keeps.
    pub late: Option<Arc<Layout>>,
}

impl Batch {
    /// The rows with these numbers, with all columns that are wanted.
    ///
    /// # Errors
    /// A number is not that of a row.
    pub fn kept(self, numbers: &dyn Array) -> Result<Self, Error> {
        let are_all = numbers.len() == self.rows.num_rows();
        let mut rows = if are_all { self.rows } else { take_record_batch(&self.rows, numbers)? };
        if let Some(layout) = &self.late {
            rows = TableBuilder::new(Arc::clone(layout)).decode(&rows)?;
        }
        Ok(Self { rows, late: None, ..self })
    }
}

/// A log of any kind being decoded.
pub trait Decode: Send {
    /// The batches that are complete after another block; `None` at the end, when the last ones were given.
    ///
    /// # Errors
    /// Errors of reading.
    fn advance(&mut self) -> Result<Option<Vec<Batch>>, Error>;

    /// The same after as many blocks as it takes, or as a while is enough for.
    ///
    /// # Errors
    /// Errors of reading.
    fn advance_a_while(&mut self) -> Result<Option<Vec<Batch>>, Error> {
        let mut batches = None;
        pool::a_while(|| {
            batches = self.advance()?;
            Ok::<_, Error>(batches.as_ref().is_some_and(Vec::is_empty))
        })?;
        Ok(batches)
    }

    /// Bytes of the log that are consumed, decompressed.
    fn position(&self) -> u64;

    /// How many of them belong to no record.
    fn bad_bytes(&self) -> u64;

    /// Whether a block is taken in by portions, as its rows are many times as large.
    fn is_within_block(&self) -> bool;

    /// Whether records have times.
    fn has_times(&self) -> bool;

    /// The damage of a compressed file. Everything before it was read.
    fn damage(&self) -> Option<&str>;

    /// The wanted messages so far that the dialect does not define. A dataflash log defines its own.
    fn unknown(&self) -> UnknownCounts {
        UnknownCounts::default()
    }
}

/// The wanted records of a log, and the tables that they become.
#[derive(Debug, Clone, Default)]
pub struct Plan {
    /// The records to read.
    pub wanted: Wanted,
    /// The columns that they become.
    pub options: Options,
    /// The columns of messages with these options, where other logs were read with them.
    pub layouts: Option<Arc<Layouts>>,
    /// The limits of a batch.
    pub limits: Limits,
    /// Whether messages that the dialect does not define become a table.
    pub unknown_table: bool,
    /// Bytes that the log has, or may have; 0 if that is not known. Tables get room for the rows that are to be expected.
    pub size: u64,
}

/// A reader of a telemetry log, perhaps compressed, or of one that is known to be framed like this, and plain.
///
/// # Errors
/// Errors of reading.
pub fn reader(
    steps: Steps,
    source: Box<dyn Read + Send>,
    framing: Option<Framing>,
    registry: Arc<Registry>,
    plan: Plan,
) -> Result<Box<dyn Decode>, Error> {
    let (blocks, framing) = Blocks::framed(source, framing, &registry, steps.block)?;
    let (has_times, size) = (framing == Framing::Stamped, plan.size);
    let decoder = Decoder::new(registry, framing, steps, plan);
    Ok(Box::new(Reader::new(blocks, decoder, has_times, size)))
}

/// Records of one kind of log on their way into tables.
pub(crate) trait TakeIn: Send {
    /// The records of a block.
    type Found: Send;

    /// Finds the records of a block.
    fn find(&mut self, block: &[u8], at_end: bool) -> Self::Found;

    /// Bytes of a block that are consumed, and how many of them belong to no record.
    fn extent(found: &Self::Found) -> (usize, u64);

    /// The parts of a block that are taken in one after the other.
    fn portions(&self, found: &Self::Found) -> IntoIter<Range<usize>>;

    /// Appends the wanted records of a part of a block to their tables; `done` is the share of the log that is consumed
    /// behind the block. Returns the batches that are complete.
    fn take_in(
        &mut self,
        block: &[u8],
        found: &Self::Found,
        some: Range<usize>,
        done: f64,
    ) -> Result<Vec<Batch>, Error>;

    /// The last batches, at the end of the log; `None` the second time.
    fn rest(&mut self) -> Result<Option<Vec<Batch>>, Error>;

    /// See [`Decode::unknown`].
    fn unknown(&self) -> UnknownCounts {
        UnknownCounts::default()
    }
}

/// A log being decoded.
pub(crate) struct Reader<D: TakeIn> {
    blocks: Blocks,
    decoder: D,
    rest: Option<Rest<D::Found>>,
    has_times: bool,
    size: u64,
    /// Bytes of the log, decompressed, that are consumed.
    position: u64,
    bad_bytes: u64,
}

impl<D: TakeIn> Reader<D> {
    pub(crate) fn new(blocks: Blocks, decoder: D, has_times: bool, size: u64) -> Self {
        Self { blocks, decoder, rest: None, has_times, size, position: 0, bad_bytes: 0 }
    }
}

impl<D: TakeIn> Decode for Reader<D> {
    fn position(&self) -> u64 {
        self.position
    }

    fn bad_bytes(&self) -> u64 {
        self.bad_bytes
    }

    fn unknown(&self) -> UnknownCounts {
        self.decoder.unknown()
    }

    fn is_within_block(&self) -> bool {
        self.rest.is_some()
    }

    fn has_times(&self) -> bool {
        self.has_times
    }

    fn damage(&self) -> Option<&str> {
        self.blocks.damage()
    }

    fn advance(&mut self) -> Result<Option<Vec<Batch>>, Error> {
        let Self { blocks, decoder, rest, size, position, .. } = self;
        if let Some(mut left) = rest.take()
            && let Some(some) = left.portions.next()
        {
            let batches = decoder.take_in(&left.block, &left.found, some, left.done);
            *rest = Some(left);
            return batches.map(Some);
        }
        let read = blocks.next(|block, at_end| {
            let found = decoder.find(block, at_end);
            let (consumed, bad) = D::extent(&found);
            let done = (*position + consumed as u64) as f64 / *size as f64;
            let mut portions = decoder.portions(&found);
            let first = portions.next();
            let batches =
                first.map_or(Ok(Vec::new()), |some| decoder.take_in(block, &found, some, done));
            *rest = Rest::of(&block[..consumed], found, portions, done);
            (consumed, (consumed, bad, batches))
        })?;
        let Some((consumed, bad, batches)) = read else { return self.decoder.rest() };
        self.position += consumed as u64;
        self.bad_bytes += bad;
        batches.map(Some)
    }
}
