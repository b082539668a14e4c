//! A log as record batches: reading, scanning, sorting by type and gathering, block by block.

use std::io::Read;
use std::sync::Arc;

use arrow::array::RecordBatch;
use mavwire_core::registry::Registry;

use crate::decoder::Decoder;
use crate::error::Error;
use crate::input::{Blocks, Steps};
use crate::layout::Options;
use crate::pool;
use crate::row_block::Rest;
use crate::scan::{Framing, LogScanner, Scanned, UNKNOWN};
use crate::select::Wanted;
use crate::table::Expected;
use crate::unknown::{self, UnknownCounts};

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

    /// Whether a block is taken in by portions, as its rows are many times as large.
    fn is_within_block(&self) -> bool;

    /// Whether records have times.
    fn has_times(&self) -> bool;

    /// What is wrong with the compressed file, of which everything before that was read.
    fn damage(&self) -> Option<&str>;

    /// The wanted messages so far that the dialect does not define. A dataflash log defines its own.
    fn unknown(&self) -> UnknownCounts {
        UnknownCounts::default()
    }
}

/// A telemetry log being decoded.
pub struct Reader {
    blocks: Blocks,
    scanner: LogScanner,
    framing: Framing,
    decoder: Decoder,
    rest: Option<Rest<Scanned>>,
    /// Bytes of the log, decompressed, that are dealt with.
    position: u64,
    bad_bytes: u64,
    unknown: UnknownCounts,
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
        let decoder = Decoder::new(Arc::clone(&registry), framing, wanted, options, limits);
        let scanner = LogScanner::new(registry, framing).with_stretch(steps.stretch);
        let (rest, position, bad_bytes, unknown, size) = Default::default();
        Ok(Self { blocks, scanner, framing, decoder, rest, position, bad_bytes, unknown, size })
    }

    /// Says how many bytes the log has, or may have: tables get room for the rows that are to be expected.
    #[must_use]
    pub fn with_size(mut self, bytes: u64) -> Self {
        self.size = bytes;
        self
    }
}

impl Decode for Reader {
    fn position(&self) -> u64 {
        self.position
    }

    fn bad_bytes(&self) -> u64 {
        self.bad_bytes
    }

    fn unknown(&self) -> UnknownCounts {
        self.unknown.clone()
    }

    fn is_within_block(&self) -> bool {
        self.rest.is_some()
    }

    fn has_times(&self) -> bool {
        self.framing == Framing::Stamped
    }

    fn damage(&self) -> Option<&str> {
        self.blocks.damage()
    }

    fn advance(&mut self) -> Result<Option<Vec<Batch>>, Error> {
        if let Some(mut rest) = self.rest.take()
            && let Some(some) = rest.portions.next()
        {
            let batches = self.decoder.take_in(&rest.block, &rest.found, some, rest.done);
            self.rest = Some(rest);
            return batches.map(Some);
        }
        let Self { blocks, scanner, decoder, rest, unknown, .. } = self;
        let (position, size) = (self.position, self.size);
        let read = blocks.next(|block, at_end| {
            let scanned = scanner.scan(block, at_end);
            let consumed = scanned.consumed;
            for record in scanned.records.iter().filter(|record| record.index == UNKNOWN) {
                if decoder.wanted.wants(block, scanner.lead(), &scanned, *record) {
                    unknown::add(unknown, &block[record.at as usize + scanner.lead()..], None);
                }
            }
            let done = (position + consumed as u64) as f64 / size as f64;
            let mut portions = decoder.portions(&scanned);
            let first = portions.next();
            let batches =
                first.map_or(Ok(Vec::new()), |some| decoder.take_in(block, &scanned, some, done));
            let bad: usize = scanned.bad.iter().map(std::iter::ExactSizeIterator::len).sum();
            *rest = Rest::of(&block[..consumed], scanned, portions, done);
            (consumed, (consumed, bad, batches))
        })?;
        let Some((consumed, bad, batches)) = read else { return self.decoder.rest() };
        self.position += consumed as u64;
        self.bad_bytes += bad as u64;
        batches.map(Some)
    }
}
