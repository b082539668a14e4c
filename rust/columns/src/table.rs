//! The table of one message type while it grows.

use std::sync::Arc;

use arrow::array::{AsArray, RecordBatch};
use arrow::datatypes::TimestampMicrosecondType;
use arrow::error::ArrowError;
use mavwire_core::telemetry::{StatusTexts, TextFields};

use crate::column::Growing;
use crate::gather::{NO_TIME, PAYLOAD, Rows};
use crate::layout::{Layout, Source};

/// Records that the gathers of all columns go over before the next ones: what stays in the first cache.
pub(crate) const GROUP: usize = 256;

/// The expected size of a table, and its limits.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Expected {
    /// The factor from its present rows to the expected ones.
    pub growth: f64,
    /// Bytes that it reserves at once for rows that may never come.
    pub ahead: usize,
    /// Rows at most, beside those of one block.
    pub rows: usize,
    /// Bytes at most.
    pub bytes: usize,
}

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
    long_texts: Option<LongTexts>,
}

/// A row with its time and text.
type TextRow = (i64, Vec<u8>);

/// Parts of long texts that are not complete yet.
#[derive(Debug)]
struct LongTexts {
    fields: TextFields,
    texts: StatusTexts<TextRow>,
}

impl TableBuilder {
    /// An empty table.
    pub fn new(layout: Arc<Layout>) -> Self {
        let columns = layout.columns.iter().map(Growing::new).collect();
        Self { layout, columns, rows: 0, room: 0, recent: 0, long_texts: None }
    }

    /// Joins the parts of long texts: one row for each text.
    #[must_use]
    pub(crate) fn with_long_texts(mut self, fields: Option<TextFields>) -> Self {
        let long_texts = |fields| LongTexts { fields, texts: StatusTexts::default() };
        self.long_texts = fields.map(long_texts);
        self
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

    /// Makes room for more rows, and for those that are to be expected. Growing step by step costs time.
    pub(crate) fn reserve(&mut self, more: usize, expected: &Expected) {
        self.recent = more;
        let needed = self.rows + more;
        if needed <= self.room {
            return;
        }
        let width: usize = self.columns.iter().map(Growing::width).sum();
        let rows_in = |bytes: usize| bytes / width.max(1);
        let most = expected.rows.saturating_add(more).min(rows_in(expected.bytes));
        let ahead = ((needed as f64 * expected.growth) as usize).min(rows_in(expected.ahead));
        self.room = ahead.max(self.room + self.room / 2).min(most).max(needed);
        for column in &mut self.columns {
            column.reserve(self.room - self.rows);
        }
    }

    /// Appends records that are laid side by side.
    pub(crate) fn append(&mut self, rows: &Rows<'_>) {
        match self.long_texts.take() {
            None => self.append_whole(rows),
            Some(mut long) => {
                self.append_joined(rows, &mut long);
                self.long_texts = Some(long);
            }
        }
    }

    /// The same with a row for each text, when it is complete. Nearly all texts are whole: they are appended together.
    fn append_joined(&mut self, rows: &Rows<'_>, long: &mut LongTexts) {
        let LongTexts { fields, texts } = long;
        let mut start = 0;
        for (number, row) in rows.bytes.chunks_exact(rows.stride).enumerate() {
            let payload = &row[PAYLOAD..];
            if fields.is_whole(payload) {
                continue;
            }
            self.append_whole(&rows.part(start..number));
            start = number + 1;
            let first = || (rows.times[number], row.to_vec());
            let found = texts.receive(*fields, (row[0], row[1]), payload, first);
            self.append_texts_of(found, *fields);
        }
        self.append_whole(&rows.part(start..rows.times.len()));
    }

    fn append_texts_of(&mut self, found: Vec<(TextRow, Vec<u8>)>, fields: TextFields) {
        for ((time, row), text) in found {
            let (times, bytes, stride) = (&[time][..], &row[..], row.len());
            // The bytes behind the NUL of a whole text are in its row only.
            let is_own = fields.text(&row[PAYLOAD..]) == text;
            let texts = if is_own { &[][..] } else { &[text] };
            self.append_whole(&Rows { times, bytes, stride, texts });
        }
    }

    /// Appends the incomplete texts at the end of the log.
    pub(crate) fn finish(&mut self) {
        if let Some(LongTexts { fields, texts }) = &mut self.long_texts {
            let (left, fields) = (texts.finish(), *fields);
            self.append_texts_of(left, fields);
        }
    }

    fn append_whole(&mut self, rows: &Rows<'_>) {
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

    /// The rows of records that are in the last column of a table, behind their times in the first one.
    pub(crate) fn decode(mut self, table: &RecordBatch) -> Result<RecordBatch, ArrowError> {
        let times = table.column(0).as_primitive::<TimestampMicrosecondType>().iter();
        let times: Vec<i64> = times.map(|time| time.unwrap_or(NO_TIME)).collect();
        let records = table.column(table.num_columns() - 1).as_fixed_size_binary();
        let stride = records.value_length() as usize;
        let bytes = records.value_data().chunks(GROUP * stride);
        for (times, bytes) in times.chunks(GROUP).zip(bytes) {
            self.append(&Rows { times, bytes, stride, texts: &[] });
        }
        self.take()
    }

    /// The rows so far; the table is empty then.
    ///
    /// # Errors
    /// Errors of arrow, which only a mistake of this crate causes.
    pub fn take(&mut self) -> Result<RecordBatch, ArrowError> {
        let arrays = self.columns.iter_mut().zip(&self.layout.columns);
        let arrays =
            arrays.map(|(growing, column)| growing.take(column)).collect::<Result<_, _>>()?;
        let rows = std::mem::take(&mut self.rows);
        self.room = 0;
        let options = arrow::array::RecordBatchOptions::new().with_row_count(Some(rows));
        RecordBatch::try_new_with_options(Arc::clone(&self.layout.schema), arrays, &options)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::layout::Column;

    #[test]
    fn no_more_room_is_made_ahead_than_is_allowed() {
        let layout = Layout::of(String::new(), vec![Column::timestamp()], []);
        let mut table = TableBuilder::new(Arc::new(layout));
        let expected = Expected { growth: 1e6, ahead: 800, rows: 65_536, bytes: 1 << 30 };
        table.reserve(20, &expected);
        assert_eq!(table.room, 100);
        table.append(&Rows { times: &[0; 20], bytes: &[], stride: 1, texts: &[] });
        table.reserve(100, &expected);
        assert_eq!(table.room, 150);
    }

    #[test]
    fn a_table_is_full_before_the_rows_of_another_block_are_too_many() {
        let layout = Layout::of(String::new(), Vec::new(), []);
        let mut table = TableBuilder::new(Arc::new(layout));
        let mut full = Vec::new();
        let expected = Expected { growth: 1.0, ahead: usize::MAX, rows: 70, bytes: usize::MAX };
        for _ in 0..6 {
            table.reserve(20, &expected);
            table.append(&Rows { times: &[0; 20], bytes: &[], stride: 1, texts: &[] });
            full.push(table.is_full(70));
            if table.is_full(70) {
                assert_eq!(table.take().expect("rows").num_rows(), 60);
            }
        }
        assert_eq!(full, [false, false, true, false, false, true]);
        assert!(table.is_full(0) && !table.is_full(usize::MAX));
    }
}
