//! A table by the values of one of its columns, such as the one that tells instances apart.

use std::collections::HashMap;

use arrow::array::{Array, RecordBatch, StringArray, UInt32Array};
use arrow::compute::{cast, take_record_batch};
use arrow::datatypes::DataType;
use arrow::error::ArrowError;

/// Values at most: instances are few, and a hostile log may put anything there.
pub const MOST_INSTANCES: usize = 4096;

/// The rows of each value, by the text of the value, in the order in which values first come; rows without one are left out.
///
/// # Errors
/// More than [`MOST_INSTANCES`] values, or a column that has no text.
pub fn split(table: &RecordBatch, column: usize) -> Result<Vec<(String, RecordBatch)>, ArrowError> {
    let texts = cast(table.column(column), &DataType::Utf8)?;
    let texts: &StringArray = texts
        .as_any()
        .downcast_ref()
        .ok_or_else(|| ArrowError::CastError("no texts".to_owned()))?;
    let (mut order, mut rows) = (Vec::new(), HashMap::<&str, Vec<u32>>::new());
    for (row, text) in (0..).zip(texts).filter_map(|(row, text)| Some((row, text?))) {
        let known = rows.entry(text).or_insert_with(|| {
            order.push(text);
            Vec::new()
        });
        known.push(row);
        if order.len() > MOST_INSTANCES {
            let name = table.schema_ref().field(column).name();
            let text = format!("column {name:?} has more than {MOST_INSTANCES} different values");
            return Err(ArrowError::InvalidArgumentError(text));
        }
    }
    let mut parts = Vec::with_capacity(order.len());
    for text in order {
        let rows = UInt32Array::from(rows.remove(text).unwrap_or_default());
        parts.push((text.to_owned(), take_record_batch(table, &rows)?));
    }
    Ok(parts)
}
