//! A log as record batches: reading, scanning, sorting by type and gathering, block by block.

use std::io::Read;
use std::sync::Arc;

use arrow::array::RecordBatch;
use mavwire_core::registry::Registry;
use rayon::prelude::*;

use crate::error::Error;
use crate::input::Blocks;
use crate::layout::{Layout, Options};
use crate::scan::{Framing, LogScanner};
use crate::select::{Grouped, Wanted};
use crate::table::{Found, TableBuilder};
use crate::tables::Tables;

/// When a table's rows become a record batch.
#[derive(Debug, Clone, Copy)]
pub struct Limits {
    /// Rows of a batch: at least these many, except at the end.
    pub rows: usize,
    /// Bytes that all growing tables may hold together; beyond that the largest is taken.
    pub bytes: usize,
    /// Bytes of one table that make a batch of it whatever else is allowed: the offsets of a text array have 31 bits.
    pub table_bytes: usize,
}

impl Limits {
    /// One batch for each type, or some where one would be too large for arrow.
    pub const NONE: Self = Self { rows: usize::MAX, bytes: usize::MAX, table_bytes: 1 << 30 };
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
    /// Bytes of the log, decompressed, that are dealt with.
    position: u64,
    bad_bytes: u64,
}

impl Reader {
    /// A reader of a log that `head` are the first bytes of.
    ///
    /// # Errors
    /// What reading says.
    pub fn new(
        source: Box<dyn Read + Send>,
        registry: Arc<Registry>,
        wanted: Wanted,
        options: Options,
        limits: Limits,
    ) -> Result<Self, Error> {
        let (blocks, framing) = Blocks::new(source)?.with_framing(&registry)?;
        let tables = Tables::new(registry.dialect().messages.len(), limits);
        let scanner = LogScanner::new(registry, framing);
        Ok(Self { blocks, scanner, framing, wanted, options, tables, position: 0, bad_bytes: 0 })
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
        let Self { blocks, scanner, framing, wanted, options, tables, .. } = self;
        let builders = &mut tables.builders;
        let read = blocks.next(|block, at_end| {
            let scanned = scanner.scan(block, at_end);
            let grouped = Grouped::new(block, *framing, &scanned, wanted, builders.len());
            let found = Found { block, scanned: &scanned };
            let registry = scanner.registry();
            builders.par_iter_mut().enumerate().for_each(|(index, table)| {
                let records = grouped.of(index);
                if !records.is_empty() {
                    let new = || {
                        let layout = Layout::new(registry, index as u16, *framing, options);
                        TableBuilder::new(Arc::new(layout))
                    };
                    table.get_or_insert_with(new).append(found, records);
                }
            });
            let bad: usize = scanned.bad.iter().map(std::iter::ExactSizeIterator::len).sum();
            (scanned.consumed, (scanned.consumed, bad))
        })?;
        let Some((consumed, bad)) = read else { return self.tables.rest() };
        self.position += consumed as u64;
        self.bad_bytes += bad as u64;
        self.tables.complete().map(Some)
    }
}
