//! The table of one message type while it grows.

use std::sync::Arc;

use arrow::array::RecordBatch;
use arrow::error::ArrowError;
use mavwire_core::frame::Header;

use crate::column::{Growing, PAYLOAD, Rows};
use crate::layout::{Layout, Source};
use crate::scan::Scanned;

/// Records that are laid side by side before the gathers go over them: what stays in the first cache.
pub(crate) const GROUP: usize = 256;

/// A block with its records.
#[derive(Debug, Clone, Copy)]
pub struct Found<'a> {
    /// The bytes.
    pub block: &'a [u8],
    /// What is in them.
    pub scanned: &'a Scanned,
}

/// A growing table.
#[derive(Debug)]
pub struct TableBuilder {
    layout: Arc<Layout>,
    columns: Vec<Growing>,
    rows: usize,
    /// Records side by side, and their times.
    side_by_side: Vec<u8>,
    times: Vec<i64>,
}

impl TableBuilder {
    /// An empty table.
    pub fn new(layout: Arc<Layout>) -> Self {
        let stamped = layout.framing.lead() > 0;
        let columns = layout.columns.iter().map(|column| Growing::new(column, stamped)).collect();
        Self { layout, columns, rows: 0, side_by_side: Vec::new(), times: Vec::new() }
    }

    /// Its columns.
    pub fn layout(&self) -> &Arc<Layout> {
        &self.layout
    }

    /// Rows so far.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Bytes held; none without rows, though an empty text column has an offset.
    pub fn bytes(&self) -> usize {
        if self.rows == 0 {
            return 0;
        }
        self.columns.iter().map(Growing::bytes).sum()
    }

    /// Appends the records of a block that start at `records`.
    pub fn append(&mut self, found: Found<'_>, records: &[u32]) {
        for group in records.chunks(GROUP) {
            self.lay_out(found, group);
            let stride = PAYLOAD + self.layout.max_len;
            let rows = Rows { times: &self.times, bytes: &self.side_by_side, stride };
            for (growing, column) in self.columns.iter_mut().zip(&self.layout.columns) {
                growing.append(&rows, &column.source);
            }
        }
        self.rows += records.len();
    }

    /// Appends records that are laid side by side already; a column takes what its source says from each, or null.
    pub(crate) fn append_rows(&mut self, rows: &Rows<'_>, sources: &[Option<&Source>]) {
        for (growing, source) in self.columns.iter_mut().zip(sources) {
            match source {
                Some(source) => growing.append(rows, source),
                None => growing.append_missing(rows.times),
            }
        }
        self.rows += rows.times.len();
    }

    /// Appends a row of values as they are written in a text log, one for each column; what is no value of its column is
    /// null.
    pub(crate) fn append_texts<'t>(
        &mut self,
        time: i64,
        texts: impl Iterator<Item = Option<&'t [u8]>>,
    ) {
        for (growing, text) in self.columns.iter_mut().zip(texts) {
            match text {
                Some(text) => growing.append_text(text),
                None => growing.append_missing(&[time]),
            }
        }
        self.rows += 1;
    }

    fn lay_out(&mut self, found: Found<'_>, records: &[u32]) {
        let lead = self.layout.framing.lead();
        let stride = PAYLOAD + self.layout.max_len;
        self.side_by_side.clear();
        self.side_by_side.resize(records.len() * stride, 0);
        self.times.clear();
        for (&at, row) in records.iter().zip(self.side_by_side.chunks_exact_mut(stride)) {
            let time = if lead == 0 { 0 } else { found.scanned.time(found.block, at) };
            self.times.push(i64::try_from(time).unwrap_or(i64::MAX));
            let frame = &found.block[at as usize + lead..];
            let Some(header) = Header::parse(frame) else { continue };
            (row[0], row[1], row[2]) = (header.sysid, header.compid, header.seq);
            let sent = &frame[header.len()..][..usize::from(header.payload_len)];
            let kept = sent.len().min(self.layout.max_len);
            row[PAYLOAD..PAYLOAD + kept].copy_from_slice(&sent[..kept]);
        }
    }

    /// The rows so far; the table is empty then.
    ///
    /// # Errors
    /// What arrow says; a mistake of this crate.
    pub fn take(&mut self) -> Result<RecordBatch, ArrowError> {
        let arrays = self.columns.iter_mut().zip(&self.layout.columns);
        let arrays = arrays.map(|(growing, column)| growing.take(column)).collect();
        let rows = std::mem::take(&mut self.rows);
        let options = arrow::array::RecordBatchOptions::new().with_row_count(Some(rows));
        RecordBatch::try_new_with_options(Arc::clone(&self.layout.schema), arrays, &options)
    }
}
