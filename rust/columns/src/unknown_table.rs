//! A table of the messages that the dialect does not define, for a later dialect to decode.

use std::sync::Arc;

use arrow::array::{
    ArrayRef, BinaryBuilder, RecordBatch, TimestampMicrosecondBuilder, UInt8Builder, UInt32Builder,
};
use arrow::datatypes::{DataType, Field, Schema};
use mavwire_core::frame::{Header, STX_V2};
use mavwire_core::unknown::UnknownKind;

use crate::error::Error;
use crate::layout::Column;
use crate::reader::{Batch, Limits};
use crate::scan::UNKNOWN;
use crate::tables::pieces;

/// The name of the table.
pub const NAME: &str = "mavwire.unknown";

/// The growing table.
#[derive(Debug, Default)]
pub(crate) struct UnknownTable {
    times: TimestampMicrosecondBuilder,
    /// `sysid`, `compid`, `seq`, `version`, `crc_extra`.
    small: [UInt8Builder; 5],
    ids: UInt32Builder,
    payloads: BinaryBuilder,
    rows: usize,
}

impl UnknownTable {
    /// Appends the message whose frame is at the front of some bytes.
    pub(crate) fn append(&mut self, time: Option<u64>, frame: &[u8]) {
        let (Some(header), Some(kind)) = (Header::parse(frame), UnknownKind::of(frame)) else {
            return;
        };
        self.times.append_option(time.map(|time| i64::try_from(time).unwrap_or(i64::MAX)));
        let version = if frame[0] == STX_V2 { 2 } else { 1 };
        let values = [header.sysid, header.compid, header.seq, version, kind.crc_extra];
        self.small.iter_mut().zip(values).for_each(|(column, value)| column.append_value(value));
        self.ids.append_value(header.msgid);
        self.payloads.append_value(&frame[header.len()..][..usize::from(header.payload_len)]);
        self.rows += 1;
    }

    /// The batches that are complete.
    pub(crate) fn complete(&mut self, limits: Limits) -> Result<Vec<Batch>, Error> {
        let bytes = self.payloads.values_slice().len();
        let is_due = self.rows >= limits.rows || bytes >= limits.bytes.min(limits.table_bytes);
        if is_due { self.take(limits) } else { Ok(Vec::new()) }
    }

    /// All rows that are not in a batch yet.
    pub(crate) fn take(&mut self, limits: Limits) -> Result<Vec<Batch>, Error> {
        if self.rows == 0 {
            return Ok(Vec::new());
        }
        let mut table = std::mem::take(self);
        let [sysid, compid, seq, version, crc_extra] =
            table.small.each_mut().map(|column| -> ArrayRef { Arc::new(column.finish()) });
        let columns = vec![
            Arc::new(table.times.finish().with_timezone("UTC")) as ArrayRef,
            sysid,
            compid,
            seq,
            version,
            Arc::new(table.ids.finish()),
            crc_extra,
            Arc::new(table.payloads.finish()),
        ];
        let rows = RecordBatch::try_new(Arc::new(schema()), columns)?;
        let batch = |rows| Batch { index: UNKNOWN, message: NAME.into(), rows, late: None };
        Ok(pieces(&rows, limits.rows).map(batch).collect())
    }
}

fn schema() -> Schema {
    let small = |name| Field::new(name, DataType::UInt8, false);
    Schema::new(vec![
        Column::timestamp().field,
        small("sysid"),
        small("compid"),
        small("seq"),
        small("version"),
        Field::new("msgid", DataType::UInt32, false),
        small("crc_extra"),
        Field::new("payload", DataType::Binary, false),
    ])
}
