//! The table of one message type while it grows.

use std::sync::Arc;

use arrow::array::RecordBatch;
use arrow::error::ArrowError;

use crate::column::Growing;
use crate::gather::Rows;
use crate::layout::{Layout, Source};

/// Records that the gathers of all columns go over before the next ones: what stays in the first cache.
pub(crate) const GROUP: usize = 256;

/// A growing table.
#[derive(Debug)]
pub struct TableBuilder {
    layout: Arc<Layout>,
    columns: Vec<Growing>,
    rows: usize,
    /// Rows that there is room for.
    room: usize,
    /// Rows that room was asked for last.
    recent: usize,
}

impl TableBuilder {
    /// An empty table.
    pub fn new(layout: Arc<Layout>) -> Self {
        let stamped = layout.framing.lead() > 0;
        let columns = layout.columns.iter().map(|column| Growing::new(column, stamped)).collect();
        Self { layout, columns, rows: 0, room: 0, recent: 0 }
    }

    /// Its columns.
    pub fn layout(&self) -> &Arc<Layout> {
        &self.layout
    }

    /// Rows so far.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Whether it has so many rows, or would with as many more as came last.
    pub(crate) fn is_full(&self, most: usize) -> bool {
        self.rows.saturating_add(self.recent) > most
    }

    /// Bytes held; none without rows, though an empty text column has an offset.
    pub fn bytes(&self) -> usize {
        if self.rows == 0 {
            return 0;
        }
        self.columns.iter().map(Growing::bytes).sum()
    }

    /// Makes room for more rows, and for those that are to be expected: `growth` times what there is then, but no more
    /// than `most` rows or `most_bytes`. Memory that is never touched costs nothing, growing step by step does.
    pub(crate) fn reserve(&mut self, more: usize, growth: f64, most: usize, most_bytes: usize) {
        self.recent = more;
        let needed = self.rows + more;
        if needed <= self.room {
            return;
        }
        let width: usize = self.columns.iter().map(Growing::width).sum();
        let most = most.saturating_add(more).min(most_bytes / width.max(1));
        let expected = (needed as f64 * growth) as usize;
        self.room = expected.max(self.room + self.room / 2).min(most).max(needed);
        for column in &mut self.columns {
            column.reserve(self.room - self.rows);
        }
    }

    /// Appends records that are laid side by side.
    pub(crate) fn append(&mut self, rows: &Rows<'_>) {
        for (growing, column) in self.columns.iter_mut().zip(&self.layout.columns) {
            growing.append(rows, &column.source);
        }
        self.rows += rows.times.len();
    }

    /// The same where a column takes what another source says from each record, or null.
    pub(crate) fn append_from(&mut self, rows: &Rows<'_>, sources: &[Option<&Source>]) {
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
        let columns = self.columns.iter_mut().zip(&self.layout.columns);
        for ((growing, column), text) in columns.zip(texts) {
            match text {
                Some(text) => growing.append_text(text, &column.source),
                None => growing.append_missing(&[time]),
            }
        }
        self.rows += 1;
    }

    /// The rows so far; the table is empty then.
    ///
    /// # Errors
    /// What arrow says; a mistake of this crate.
    pub fn take(&mut self) -> Result<RecordBatch, ArrowError> {
        let arrays = self.columns.iter_mut().zip(&self.layout.columns);
        let arrays = arrays.map(|(growing, column)| growing.take(column)).collect();
        let rows = std::mem::take(&mut self.rows);
        self.room = 0;
        let options = arrow::array::RecordBatchOptions::new().with_row_count(Some(rows));
        RecordBatch::try_new_with_options(Arc::clone(&self.layout.schema), arrays, &options)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scan::Framing;
    use arrow::datatypes::Schema;

    #[test]
    fn a_table_is_full_before_the_rows_of_another_block_are_too_many() {
        let (columns, schema) = (Vec::new(), Arc::new(Schema::empty()));
        let (message, framing) = (String::new(), Framing::Raw);
        let layout = Layout { message, max_len: 0, framing, columns, schema };
        let mut table = TableBuilder::new(Arc::new(layout));
        let mut full = Vec::new();
        for _ in 0..6 {
            table.reserve(20, 1.0, 70, usize::MAX);
            table.append(&Rows { times: &[0; 20], bytes: &[], stride: 1 });
            full.push(table.is_full(70));
            if table.is_full(70) {
                assert_eq!(table.take().expect("rows").num_rows(), 60);
            }
        }
        assert_eq!(full, [false, false, true, false, false, true]);
        assert!(table.is_full(0) && !table.is_full(usize::MAX));
    }
}
