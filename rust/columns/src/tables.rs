//! All growing tables of a log, and when their rows become batches.

use std::cmp::Reverse;
use std::sync::Arc;

use arrow::array::RecordBatch;
use rayon::prelude::*;

use crate::error::Error;
use crate::pool;
use crate::reader::{Batch, Limits};
use crate::row_block::RowBlock;
use crate::table::TableBuilder;

/// Rows are expected to come as often as so far, and a little more often.
const MARGIN: f64 = 1.02;

/// The growing tables, by index.
pub(crate) struct Tables {
    /// `None` for those without a row so far.
    pub(crate) builders: Vec<Option<TableBuilder>>,
    limits: Limits,
}

impl Tables {
    pub(crate) fn new(count: usize, limits: Limits) -> Self {
        Self { builders: (0..count).map(|_| None).collect(), limits }
    }

    /// Appends the records of all pieces to their tables, on all processors; `done` says which share of the log that
    /// makes, `new` begins a table.
    pub(crate) fn append(
        &mut self,
        pieces: &[RowBlock],
        done: f64,
        new: impl Fn(usize) -> TableBuilder + Sync,
        append: impl Fn(&mut TableBuilder, usize, &RowBlock) + Sync,
    ) {
        let limits = self.limits;
        let growth = if done > 0.0 && done < 1.0 { MARGIN / done } else { 1.0 };
        let rows = |index| pieces.iter().map(|piece| piece.rows(index)).sum::<usize>();
        let due = self.builders.iter_mut().enumerate().map(|(at, table)| (rows(at), at, table));
        let mut due = begun(due.filter(|&(rows, ..)| rows > 0).collect(), new);
        let expected = limits.expected(growth, due.len());
        // The largest first, and one by one: then no processor is left alone with the rest.
        due.sort_unstable_by_key(|&(rows, ..)| Reverse(rows));
        // All of them by one thread: the allocator has a store for each, which gives back to the system what is freed, and
        // from two stores twice as many pages of fresh memory are touched.
        for (rows, _, table) in &mut due {
            table.reserve(*rows, &expected);
        }
        due.into_par_iter().with_max_len(1).for_each(|(_, index, table)| {
            for piece in pieces.iter().filter(|piece| piece.rows(index) > 0) {
                append(table, index, piece);
            }
        });
    }

    /// The last batches, at the end of the log; `None` the second time.
    pub(crate) fn rest(&mut self) -> Result<Option<Vec<Batch>>, Error> {
        self.builders.iter_mut().flatten().for_each(TableBuilder::finish);
        let batches: Vec<Batch> = self.take_where(|table| table.rows() > 0)?;
        Ok((!batches.is_empty()).then_some(batches))
    }

    /// The batches that are complete.
    pub(crate) fn complete(&mut self) -> Result<Vec<Batch>, Error> {
        let Limits { rows, bytes, table_bytes } = self.limits;
        let is_full = |table: &TableBuilder| table.is_full(rows) || table.bytes() >= table_bytes;
        let mut batches = self.take_where(|table| table.rows() > 0 && is_full(table))?;
        loop {
            let sizes = self.builders.iter().flatten().map(TableBuilder::bytes);
            let (total, most) = sizes.fold((0, 0), |(sum, most), n| (sum + n, most.max(n)));
            if total <= bytes || most == 0 {
                return Ok(batches);
            }
            batches.extend(self.take_where(|table| table.bytes() == most)?);
        }
    }

    fn take_where(&mut self, full: impl Fn(&TableBuilder) -> bool) -> Result<Vec<Batch>, Error> {
        let tables = (0..).zip(&mut self.builders);
        let tables = tables.filter_map(|(index, table)| Some((index, table.as_mut()?)));
        let due: Vec<(u16, &mut TableBuilder)> = tables.filter(|(_, table)| full(table)).collect();
        let most = self.limits.rows;
        let taken = |(index, table): (u16, &mut TableBuilder)| {
            let rows = table.take()?;
            let layout = table.layout();
            let message: Arc<str> = layout.message.as_str().into();
            let batch = |rows| {
                let (message, late) = (Arc::clone(&message), layout.late.clone());
                Batch { index, message, rows, late }
            };
            Ok(pieces(&rows, most).map(batch).collect::<Vec<_>>())
        };
        let taken = pool::run(|| due.into_par_iter().map(taken).collect::<Result<Vec<_>, Error>>());
        Ok(taken?.into_iter().flatten().collect())
    }
}

/// A table that rows are to be appended to: how many, its index.
type Due<'a, T> = (usize, usize, &'a mut T);

/// The same tables, those without a row so far begun, on all processors.
fn begun<'a>(
    due: Vec<Due<'a, Option<TableBuilder>>>,
    new: impl Fn(usize) -> TableBuilder + Sync,
) -> Vec<Due<'a, TableBuilder>> {
    let begin = |(rows, index, table): Due<'a, Option<TableBuilder>>| {
        (rows, index, table.get_or_insert_with(|| new(index)))
    };
    if due.iter().all(|(.., table)| table.is_some()) {
        return due.into_iter().map(begin).collect();
    }
    due.into_par_iter().with_max_len(1).map(begin).collect()
}

/// The rows in as few pieces of at most so many as there can be, of about one size; in one if that is 0.
pub(crate) fn pieces(rows: &RecordBatch, most: usize) -> impl Iterator<Item = RecordBatch> {
    let all = rows.num_rows();
    let count = if most == 0 { 1 } else { all.div_ceil(most).max(1) };
    (0..count).map(move |n| {
        let (start, end) = (n * all / count, (n + 1) * all / count);
        if count == 1 { rows.clone() } else { rows.slice(start, end - start) }
    })
}
