//! Tables with the columns of several logs. A column that a log does not have is null in its rows. So is a value that does
//! not fit its column.

use std::sync::Arc;

use arrow::array::{
    Array, ArrayRef, AsArray, BooleanArray, RecordBatch, RecordBatchOptions, new_null_array,
};
use arrow::compute::{CastOptions, cast_with_options, nullif};
use arrow::datatypes::{DataType, FieldRef, Float32Type, Float64Type, SchemaRef};
use arrow::error::ArrowError;

/// A table with the columns of `schema`, which [`CommonSchema`](crate::common_schema::CommonSchema) made.
///
/// # Errors
/// A column that may not lack values lacks some.
pub fn fit(table: &RecordBatch, schema: &SchemaRef) -> Result<RecordBatch, ArrowError> {
    let rows = table.num_rows();
    let column = |field: &FieldRef| match table.column_by_name(field.name()) {
        Some(column) => fit_column(column, field.data_type()),
        None => Ok(new_null_array(field.data_type(), rows)),
    };
    let columns = schema.fields().iter().map(column).collect::<Result<Vec<_>, _>>()?;
    // Of no columns the rows have to be told.
    let options = RecordBatchOptions::new().with_row_count(Some(rows));
    RecordBatch::try_new_with_options(Arc::clone(schema), columns, &options)
}

/// Values as those of another type, null where they would be others: no number is cut off. Floats are the closest that there is.
fn fit_column(column: &ArrayRef, wanted: &DataType) -> Result<ArrayRef, ArrowError> {
    let own = column.data_type();
    if own == wanted {
        return Ok(Arc::clone(column));
    }
    if !(own.is_numeric() && wanted.is_numeric()) {
        return Ok(new_null_array(wanted, column.len()));
    }
    let options = CastOptions { safe: true, ..CastOptions::default() };
    if wanted.is_integer()
        && let Some(broken) = fractions(column)
    {
        return cast_with_options(&nullif(column, &broken)?, wanted, &options);
    }
    cast_with_options(column, wanted, &options)
}

/// Where floats are no integers; None of other columns.
fn fractions(column: &dyn Array) -> Option<BooleanArray> {
    match column.data_type() {
        DataType::Float32 => {
            let floats = column.as_primitive::<Float32Type>();
            Some(BooleanArray::from_unary(floats, |value| value.fract() != 0.0))
        }
        DataType::Float64 => {
            let floats = column.as_primitive::<Float64Type>();
            Some(BooleanArray::from_unary(floats, |value| value.fract() != 0.0))
        }
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use arrow::array::{
        FixedSizeListArray, Float32Array, Float64Array, Int8Array, Int64Array, StringArray,
        UInt64Array,
    };
    use arrow::datatypes::{Field, Int32Type, Schema};

    use super::*;

    fn fitted(column: ArrayRef, wanted: DataType) -> ArrayRef {
        let one: SchemaRef = Arc::new(Schema::new(vec![Field::new("x", wanted, true)]));
        let table = RecordBatch::try_from_iter([("x", column)]).expect("a column");
        Arc::clone(fit(&table, &one).expect("fits").column(0))
    }

    #[test]
    fn integers_beyond_the_column_are_null() {
        let column = fitted(Arc::new(Int64Array::from(vec![127, 128, -128, -129])), DataType::Int8);
        assert_eq!(column.as_ref(), &Int8Array::from(vec![Some(127), None, Some(-128), None]));
        let column = fitted(Arc::new(UInt64Array::from(vec![u64::MAX, 5])), DataType::Int64);
        assert_eq!(column.as_ref(), &Int64Array::from(vec![None, Some(5)]));
    }

    #[test]
    fn floats_that_are_no_integers_are_null() {
        let floats = vec![1.0, 1.5, f64::NAN, f64::INFINITY, 9.3e18, -0.0];
        let column = fitted(Arc::new(Float64Array::from(floats)), DataType::Int64);
        let integers = vec![Some(1), None, None, None, None, Some(0)];
        assert_eq!(column.as_ref(), &Int64Array::from(integers));
        let column = fitted(Arc::new(Float32Array::from(vec![2.0, 2.25])), DataType::Int8);
        assert_eq!(column.as_ref(), &Int8Array::from(vec![Some(2), None]));
    }

    #[test]
    fn floats_are_the_closest() {
        let column = fitted(Arc::new(Int64Array::from(vec![16_777_217])), DataType::Float32);
        assert_eq!(column.as_ref(), &Float32Array::from(vec![16_777_216.0]));
    }

    #[test]
    fn kinds_that_are_no_numbers_are_not_read_as_such() {
        let column = fitted(Arc::new(StringArray::from(vec!["12"])), DataType::Int64);
        assert_eq!(column.as_ref(), &Int64Array::from(vec![None]));
    }

    #[test]
    fn columns_that_are_missing_are_null() {
        let item = Arc::new(Field::new("item", DataType::Int32, false));
        let list = DataType::FixedSizeList(item, 2);
        let one: SchemaRef = Arc::new(Schema::new(vec![Field::new("list", list, true)]));
        let lists =
            FixedSizeListArray::from_iter_primitive::<Int32Type, _, _>([Some([Some(1)])], 1);
        let table =
            RecordBatch::try_from_iter([("other", Arc::new(lists) as ArrayRef)]).expect("a column");
        let found = fit(&table, &one).expect("fits");
        assert_eq!((found.num_rows(), found.column(0).null_count()), (1, 1));
    }
}
