//! All growing tables of a log, and when their rows become batches.

use crate::error::Error;
use crate::reader::{Batch, Limits};
use crate::table::TableBuilder;

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

    /// What is left at the end; `None` the second time.
    pub(crate) fn rest(&mut self) -> Result<Option<Vec<Batch>>, Error> {
        let batches: Vec<Batch> = self.take_where(|table| table.rows() > 0)?;
        Ok((!batches.is_empty()).then_some(batches))
    }

    /// The batches that are complete.
    pub(crate) fn complete(&mut self) -> Result<Vec<Batch>, Error> {
        let Limits { rows, bytes, table_bytes } = self.limits;
        let mut batches =
            self.take_where(|table| table.rows() >= rows || table.bytes() >= table_bytes)?;
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
        let mut batches = Vec::new();
        for (index, table) in (0..).zip(&mut self.builders) {
            if let Some(table) = table.as_mut().filter(|table| full(table)) {
                let message = table.layout().message.as_str().into();
                batches.push(Batch { index, message, rows: table.take()? });
            }
        }
        Ok(batches)
    }
}
