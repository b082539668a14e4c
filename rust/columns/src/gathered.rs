//! Rows of many logs in one Parquet file, with the types that Delta Lake has: no unsigned numbers.
//!
//! An unsigned number takes the next wider type. Those of 64 bits keep their bits, so that values from 2^63 on become negative.
//! Numbers of dataflash logs, whose widths differ from log to log, take the widest type.

use std::io::Write;
use std::sync::Arc;

use arrow::array::{
    Array, ArrayRef, AsArray, FixedSizeListArray, PrimitiveArray, RecordBatch,
    StringDictionaryBuilder,
};
use arrow::buffer::ScalarBuffer;
use arrow::compute::{cast, concat};
use arrow::datatypes::{DataType, Field, Int64Type, Schema, SchemaRef, UInt32Type, UInt64Type};
use arrow::error::ArrowError;
use parquet::file::metadata::ParquetMetaData;
use parquet::file::statistics::Statistics;
use rayon::prelude::*;

use crate::convert::Compression;
use crate::error::Error;
use crate::pool;
use crate::row_groups::RowGroups;

/// The columns that tell where a row came from.
pub const ORIGIN: [&str; 2] = ["log", "digest"];

/// Columns by whose ranges readers choose files.
const RANGED: [&str; 4] = ["timestamp", "sysid", "compid", "log"];

/// Some rows of a table, and the log they came from with its digest, or `None` where they have columns for these.
pub type Piece<'a> = (&'a [RecordBatch], Option<[&'a str; 2]>);

/// A Parquet file that grows by rows of many logs.
pub struct Gathered<W: Write + Send> {
    file: Box<RowGroups<W>>,
    plain: SchemaRef,
    rows: u64,
}

/// The least and the largest value of a column.
#[derive(Debug, Clone, PartialEq)]
pub enum Range {
    /// Of integers and times.
    Numbers(i64, i64),
    /// Of texts, perhaps shortened.
    Texts(String, String),
}

/// `(column, range, nulls)`, for columns that readers choose files by.
pub type Ranges = Vec<(String, Option<Range>, u64)>;

/// Rows, columns and ranges of a file.
pub struct Content {
    /// Its rows.
    pub rows: u64,
    /// Columns and their types, as Delta Lake calls them.
    pub columns: Vec<(String, String)>,
    /// The values of some columns.
    pub ranges: Ranges,
}

impl<W: Write + Send> Gathered<W> {
    /// Begins a file of such rows; `with_origin` adds the columns that say where they came from.
    pub fn new(out: W, plain: SchemaRef, with_origin: bool) -> Self {
        let schema = stored_schema(&plain, with_origin);
        let file = RowGroups::new(out, schema, Compression::Zstd).without_arrow_types();
        Self { file: Box::new(file), plain, rows: 0 }
    }

    /// Appends a row group.
    ///
    /// # Errors
    /// Rows have other columns than the first ones, or the file cannot be written.
    pub fn write(&mut self, pieces: &[Piece<'_>]) -> Result<(), Error> {
        let batches: Vec<&RecordBatch> = pieces.iter().flat_map(|(rows, _)| *rows).collect();
        if batches.iter().any(|batch| batch.num_columns() != self.plain.fields().len()) {
            return Err(ArrowError::SchemaError("the tables have different columns".into()).into());
        }
        let schema = Arc::clone(self.file.schema());
        let column = |index: usize| match batches.first() {
            Some(first) if index < first.num_columns() => {
                let parts: Vec<&dyn Array> =
                    batches.iter().map(|batch| batch.column(index).as_ref()).collect();
                stored(&concat(&parts)?, schema.field(index).data_type())
            }
            _ => origins(pieces, index - self.plain.fields().len()),
        };
        let columns: Result<Vec<ArrayRef>, ArrowError> =
            pool::run(|| (0..schema.fields().len()).into_par_iter().map(column).collect());
        let rows = RecordBatch::try_new(Arc::clone(&schema), columns?)?;
        self.file.write(&rows)?;
        self.rows += rows.num_rows() as u64;
        Ok(())
    }

    /// Bytes so far.
    pub fn bytes(&self) -> usize {
        self.file.bytes()
    }

    /// Writes the end of the file, and tells what is in it.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn finish(self) -> Result<(W, Content), Error> {
        let fields = self.file.schema().fields().iter();
        let columns =
            fields.map(|field| (field.name().clone(), delta_type(field.data_type()))).collect();
        let (out, footer) = self.file.finish_with_footer()?;
        Ok((out, Content { rows: self.rows, columns, ranges: ranges(&footer) }))
    }
}

/// The log or the digest of each row. As a dictionary, a text is not copied for each of them.
fn origins(pieces: &[Piece<'_>], which: usize) -> Result<ArrayRef, ArrowError> {
    let mut texts = StringDictionaryBuilder::<UInt32Type>::new();
    for (batches, origin) in pieces {
        let rows = batches.iter().map(RecordBatch::num_rows).sum();
        match origin {
            Some(origin) => texts.append_n(origin[which], rows).map(drop)?,
            None => texts.append_nulls(rows),
        }
    }
    Ok(Arc::new(texts.finish()))
}

/// The columns as they are stored.
fn stored_schema(plain: &Schema, with_origin: bool) -> SchemaRef {
    // The dialect gives the widths of telemetry.
    let widest = with_origin && !plain.metadata().contains_key("msgid");
    let field = |field: &Arc<Field>| {
        let data_type = stored_type(field.data_type(), widest);
        field.as_ref().clone().with_data_type(data_type)
    };
    let mut fields: Vec<Field> = plain.fields().iter().map(field).collect();
    if with_origin {
        let text = DataType::Dictionary(Box::new(DataType::UInt32), Box::new(DataType::Utf8));
        fields.extend(ORIGIN.map(|name| Field::new(name, text.clone(), false)));
    }
    Arc::new(Schema::new_with_metadata(fields, plain.metadata().clone()))
}

fn stored_type(plain: &DataType, widest: bool) -> DataType {
    match plain {
        DataType::FixedSizeList(item, length) => {
            let item_type = stored_type(item.data_type(), widest);
            let item = item.as_ref().clone().with_data_type(item_type);
            DataType::FixedSizeList(Arc::new(item), *length)
        }
        number if widest && number.is_integer() => DataType::Int64,
        number if widest && number.is_floating() => DataType::Float64,
        DataType::UInt8 => DataType::Int16,
        DataType::UInt16 => DataType::Int32,
        DataType::UInt32 | DataType::UInt64 => DataType::Int64,
        other => other.clone(),
    }
}

/// The name of a type in Delta Lake. An array is `array<...>` of its elements' name.
fn delta_type(stored: &DataType) -> String {
    let name = match stored {
        DataType::Int8 => "byte",
        DataType::Int16 => "short",
        DataType::Int32 => "integer",
        DataType::Int64 => "long",
        DataType::Float32 => "float",
        DataType::Float64 => "double",
        DataType::Boolean => "boolean",
        DataType::Date32 => "date",
        DataType::Timestamp(..) => "timestamp",
        DataType::Binary => "binary",
        DataType::FixedSizeList(item, _) | DataType::List(item) => {
            return format!("array<{}>", delta_type(item.data_type()));
        }
        _ => "string",
    };
    name.to_owned()
}

fn stored(array: &ArrayRef, wanted: &DataType) -> Result<ArrayRef, ArrowError> {
    match (array.data_type(), wanted) {
        (own, wanted) if own == wanted => Ok(Arc::clone(array)),
        (DataType::UInt64, DataType::Int64) => {
            let numbers = array.as_primitive::<UInt64Type>();
            let bits = ScalarBuffer::<i64>::from(numbers.values().inner().clone());
            Ok(Arc::new(PrimitiveArray::<Int64Type>::new(bits, numbers.nulls().cloned())))
        }
        (DataType::FixedSizeList(..), DataType::FixedSizeList(item, length)) => {
            let lists = array.as_fixed_size_list();
            let values = stored(lists.values(), item.data_type())?;
            let nulls = lists.nulls().cloned();
            let lists = FixedSizeListArray::try_new(Arc::clone(item), *length, values, nulls)?;
            Ok(Arc::new(lists))
        }
        _ => cast(array, wanted),
    }
}

fn ranges(footer: &ParquetMetaData) -> Ranges {
    let columns = footer.file_metadata().schema_descr().columns().iter().enumerate();
    let chosen = columns
        .filter(|(_, column)| column.path().parts().len() == 1 && RANGED.contains(&column.name()));
    let of_column = |(index, name): (usize, String)| {
        let (mut range, mut nulls) = (None, 0);
        for group in footer.row_groups() {
            let found = group.column(index).statistics();
            nulls += found.and_then(Statistics::null_count_opt).unwrap_or(0);
            range = wider(range, found.and_then(range_of));
        }
        (name, range, nulls)
    };
    chosen.map(|(index, column)| of_column((index, column.name().to_owned()))).collect()
}

fn range_of(found: &Statistics) -> Option<Range> {
    let text = |bytes: &parquet::data_type::ByteArray| {
        std::str::from_utf8(bytes.data()).ok().map(str::to_owned)
    };
    Some(match found {
        Statistics::Int32(found) => {
            Range::Numbers(i64::from(*found.min_opt()?), i64::from(*found.max_opt()?))
        }
        Statistics::Int64(found) => Range::Numbers(*found.min_opt()?, *found.max_opt()?),
        Statistics::ByteArray(found) => {
            Range::Texts(text(found.min_opt()?)?, text(found.max_opt()?)?)
        }
        _ => return None,
    })
}

fn wider(one: Option<Range>, other: Option<Range>) -> Option<Range> {
    match (one, other) {
        (Some(Range::Numbers(a, b)), Some(Range::Numbers(c, d))) => {
            Some(Range::Numbers(a.min(c), b.max(d)))
        }
        (Some(Range::Texts(a, b)), Some(Range::Texts(c, d))) => {
            Some(Range::Texts(a.min(c), b.max(d)))
        }
        (one, other) => one.or(other),
    }
}

#[cfg(test)]
mod tests {
    use std::collections::HashMap;

    use arrow::array::{UInt8Array, UInt64Array};

    use super::*;

    fn batch(numbers: &[u64], is_telemetry: bool) -> RecordBatch {
        let fields = vec![
            Field::new("sysid", DataType::UInt8, false),
            Field::new("uid", DataType::UInt64, false),
        ];
        let msgid = is_telemetry.then(|| ("msgid".to_owned(), "1".to_owned()));
        let metadata: HashMap<_, _> = msgid.into_iter().collect();
        let systems = UInt8Array::from(vec![255; numbers.len()]);
        RecordBatch::try_new(
            Arc::new(Schema::new_with_metadata(fields, metadata)),
            vec![Arc::new(systems), Arc::new(UInt64Array::from(numbers.to_vec()))],
        )
        .expect("a batch")
    }

    #[test]
    fn a_file_has_the_rows_of_many_logs() {
        let (one, other) = ([batch(&[1, u64::MAX], true)], [batch(&[7], true)]);
        let mut file = Gathered::new(Vec::new(), one[0].schema(), true);
        file.write(&[(&one, Some(["b", "x"])), (&other, Some(["a", "y"]))]).expect("writing");
        file.write(&[(&other, Some(["c", "z"]))]).expect("writing");
        let (bytes, content) = file.finish().expect("writing");
        assert!(bytes.starts_with(b"PAR1"));
        let columns = content.columns.iter().map(|(_, kind)| kind.as_str()).collect::<Vec<_>>();
        assert_eq!((content.rows, columns), (4, vec!["short", "long", "string", "string"]));
        let texts = Range::Texts("a".to_owned(), "c".to_owned());
        let expected = [("sysid", Range::Numbers(255, 255)), ("log", texts)];
        let expected = expected.map(|(name, range)| (name.to_owned(), Some(range), 0));
        assert_eq!(content.ranges, expected);
    }

    #[test]
    fn numbers_of_dataflash_logs_have_64_bits() {
        let rows = [batch(&[u64::MAX], false)];
        let mut file = Gathered::new(Vec::new(), rows[0].schema(), true);
        file.write(&[(&rows, Some(["a", "x"]))]).expect("writing");
        let wrong = RecordBatch::new_empty(Arc::new(Schema::empty()));
        file.write(&[(&[wrong], Some(["a", "x"]))]).expect_err("other columns");
        let (_, content) = file.finish().expect("writing");
        assert!(content.columns[..2].iter().all(|(_, kind)| kind == "long"));
    }

    #[test]
    fn large_numbers_keep_their_bits() {
        let numbers: ArrayRef = Arc::new(UInt64Array::from(vec![Some(u64::MAX), None, Some(3)]));
        let found = stored(&numbers, &DataType::Int64).expect("as many bits");
        let found: Vec<_> = found.as_primitive::<Int64Type>().iter().collect();
        assert_eq!(found, [Some(-1), None, Some(3)]);
    }
}
