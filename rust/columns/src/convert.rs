//! Record batches to files of other programs.

use std::borrow::Cow;
use std::io::{self, Write};
use std::sync::Arc;

use arrow::array::{
    Array, ArrayRef, FixedSizeListArray, RecordBatch, RecordBatchOptions, StringArray,
    TimestampMicrosecondArray, UInt32Array,
};
use arrow::compute::{cast, take};
use arrow::csv::WriterBuilder as CsvBuilder;
use arrow::datatypes::{DataType, Field, Schema, SchemaRef, TimestampMicrosecondType};
use arrow::ipc::writer::FileWriter;
use arrow::json::{LineDelimitedWriter, WriterBuilder as JsonBuilder};
use flate2::write::GzEncoder;
use rayon::prelude::*;

use crate::error::Error;
use crate::pool;
use crate::row_groups::{MOST_ROWS, RowGroups};
use crate::tables::pieces;

/// The first and last time that the text writers can show, microseconds since 1970: the years -262143 and 262142.
const SHOWN_MICROS: (i64, i64) = (-8_334_601_228_800_000_000, 8_210_266_876_799_999_999);

/// How times stand in texts: all with as many digits, else readers that look at some of them take others for no times.
const TIME_TEXT: &str = "%Y-%m-%dT%H:%M:%S%.6fZ";

const ZSTD_LEVEL: i32 = 1;

/// Of the bytes in which repetitions are looked for: a conversion has a file open for each of hundreds of types.
const ZSTD_WINDOW_LOG: u32 = 16;

/// Rows that become text in one go.
const TEXT_ROWS: usize = 4096;

/// A kind of file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    /// Apache Parquet, a row group for each batch.
    Parquet,
    /// Comma-separated values; array fields as a column for each element.
    Csv,
    /// The same, with an apostrophe in front of texts that a spreadsheet would take for formulas.
    SafeCsv,
    /// A JSON object on each line.
    JsonLines,
    /// Arrow IPC file, whose memory others can map.
    Arrow,
}

/// How a file is made smaller.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Compression {
    /// Not at all.
    None,
    /// Zstandard.
    Zstd,
    /// Snappy; Parquet only.
    Snappy,
    /// gzip; text formats only.
    Gzip,
    /// LZ4; MCAP only.
    Lz4,
}

impl Format {
    /// Whether it can be compressed like this.
    pub fn takes(self, compression: Compression) -> bool {
        match compression {
            Compression::None => true,
            Compression::Zstd => self != Self::Arrow,
            Compression::Snappy => self == Self::Parquet,
            Compression::Gzip => matches!(self, Self::Csv | Self::SafeCsv | Self::JsonLines),
            Compression::Lz4 => false,
        }
    }
}

/// A file being written.
pub struct Sink<W: Write + Send> {
    writer: Writer<W>,
    rows: u64,
}

enum Writer<W: Write + Send> {
    Parquet(Box<RowGroups<W>>),
    Csv(Box<Squeeze<W>>, SchemaRef, bool),
    JsonLines(Box<LineDelimitedWriter<Squeeze<W>>>),
    Arrow(Box<FileWriter<W>>, SchemaRef),
}

impl<W: Write + Send> Sink<W> {
    /// Begins a file of batches with this schema.
    ///
    /// # Errors
    /// Errors of the writers.
    pub fn new(
        out: W,
        schema: &SchemaRef,
        format: Format,
        compression: Compression,
    ) -> Result<Self, Error> {
        let writer = match format {
            Format::Parquet => {
                Writer::Parquet(Box::new(RowGroups::new(out, Arc::clone(schema), compression)))
            }
            Format::Csv | Format::SafeCsv => {
                let safe = format == Format::SafeCsv;
                let (mut out, flat) = (Squeeze::new(out, compression)?, flat_schema(schema, safe));
                // Write the header now: a table without rows has one, too.
                write_lines(&mut out, &RecordBatch::new_empty(Arc::clone(&flat)), true)?;
                Writer::Csv(Box::new(out), flat, safe)
            }
            Format::JsonLines => {
                let out = Squeeze::new(out, compression)?;
                let lines = JsonBuilder::new().with_timestamp_tz_format(TIME_TEXT.to_owned());
                Writer::JsonLines(Box::new(lines.build(out)))
            }
            Format::Arrow => {
                let plain = with_fields(schema, plain_text);
                Writer::Arrow(Box::new(FileWriter::try_new(out, &plain)?), plain)
            }
        };
        Ok(Self { writer, rows: 0 })
    }

    /// Says how many rows the file will have, which tells better than its first batch how its columns are best written.
    #[must_use]
    pub fn with_rows(mut self, rows: usize) -> Self {
        if let Writer::Parquet(writer) = &mut self.writer {
            writer.expect(rows);
        }
        self
    }

    /// Rows so far.
    pub fn rows(&self) -> u64 {
        self.rows
    }

    /// Writes a batch.
    ///
    /// # Errors
    /// Errors of the writers.
    pub fn write(&mut self, batch: &RecordBatch) -> Result<(), Error> {
        match &mut self.writer {
            Writer::Parquet(writer) => writer.write(batch)?,
            Writer::Csv(out, schema, safe) => {
                write_lines(out, &flat(batch, schema, *safe)?, false)?;
            }
            Writer::JsonLines(writer) => writer.write(&with_plain_times(batch)?)?,
            Writer::Arrow(writer, schema) => writer.write(&cast_all(batch, schema)?)?,
        }
        self.rows += batch.num_rows() as u64;
        Ok(())
    }

    /// Writes what belongs at the end, and gives the output back.
    ///
    /// # Errors
    /// Errors of the writers.
    pub fn finish(self) -> Result<W, Error> {
        Ok(match self.writer {
            Writer::Parquet(writer) => writer.finish()?,
            Writer::Csv(out, ..) => out.finish()?,
            Writer::JsonLines(mut writer) => {
                writer.finish()?;
                writer.into_inner().finish()?
            }
            Writer::Arrow(writer, _) => writer.into_inner()?,
        })
    }
}

/// A batch in pieces of rows that are written within a moment each: between two the caller may end the writing.
pub fn moments(batch: &RecordBatch) -> impl Iterator<Item = RecordBatch> {
    pieces(batch, MOST_ROWS)
}

/// Writes to many files on all processors, to each its batches in order.
///
/// # Errors
/// Errors of the writers.
pub fn write_all<W: Write + Send>(
    work: Vec<(&mut Sink<W>, Vec<&RecordBatch>)>,
) -> Result<(), Error> {
    let each = work.into_par_iter().with_max_len(1);
    let write = |(sink, batches): (&mut Sink<W>, Vec<&RecordBatch>)| {
        batches.into_iter().try_for_each(|one| sink.write(one))
    };
    pool::run(|| each.try_for_each(write))
}

/// Writes rows as lines of CSV. They are made in memory: the writer of arrow does not say why it cannot write to a file.
fn write_lines(out: &mut impl Write, rows: &RecordBatch, header: bool) -> Result<(), Error> {
    let mut text = Vec::new();
    for rows in pieces(rows, TEXT_ROWS) {
        text.clear();
        let lines = CsvBuilder::new().with_header(header);
        let lines = lines.with_timestamp_tz_format(TIME_TEXT.to_owned());
        lines.build(&mut text).write(&rows)?;
        out.write_all(&text)?;
    }
    Ok(())
}

/// A text as a cell of CSV of which no spreadsheet makes a formula. Texts that are numbers stay numbers.
pub fn csv_safe(text: &str) -> Cow<'_, str> {
    let is_formula = text.starts_with(['=', '+', '-', '@', '\t', '\r', '\n']);
    if is_formula && text.parse::<f64>().is_err() { format!("'{text}").into() } else { text.into() }
}

/// A schema without lists: a column for each element.
fn flat_schema(schema: &Schema, safe: bool) -> SchemaRef {
    let mut fields: Vec<Field> = Vec::new();
    for field in schema.fields() {
        if let DataType::FixedSizeList(item, length) = field.data_type() {
            fields.extend((0..*length).map(|n| {
                let name = format!("{}[{n}]", field.name());
                Field::new(name, item.data_type().clone(), true)
            }));
        } else {
            fields.push(plain_time(field));
        }
    }
    if safe {
        fields = fields
            .into_iter()
            .map(|field| {
                let name = csv_safe(field.name()).into_owned();
                field.with_name(name)
            })
            .collect();
    }
    Arc::new(Schema::new(fields))
}

/// A field of times in UTC by its offset: the text writers know no names of zones.
fn plain_time(field: &Field) -> Field {
    match field.data_type() {
        DataType::Timestamp(unit, Some(_)) => {
            let by_offset = DataType::Timestamp(*unit, Some("+00:00".into()));
            field.clone().with_data_type(by_offset)
        }
        _ => field.clone(),
    }
}

/// A field of names as texts: an Arrow file has one dictionary for a column, and names may come with each batch.
fn plain_text(field: &Field) -> Field {
    match field.data_type() {
        DataType::Dictionary(_, text) => field.clone().with_data_type((**text).clone()),
        DataType::FixedSizeList(item, length) => {
            let list = DataType::FixedSizeList(Arc::new(plain_text(item)), *length);
            field.clone().with_data_type(list)
        }
        _ => field.clone(),
    }
}

fn with_fields(schema: &Schema, change: fn(&Field) -> Field) -> SchemaRef {
    let fields: Vec<Field> = schema.fields().iter().map(|field| change(field)).collect();
    Arc::new(Schema::new_with_metadata(fields, schema.metadata().clone()))
}

/// Times by their offset, and none beyond what the text writers can show.
fn with_plain_times(batch: &RecordBatch) -> Result<RecordBatch, Error> {
    let (schema, mut arrays) = (batch.schema(), batch.columns().to_vec());
    for array in &mut arrays {
        if let Some(times) = array.as_any().downcast_ref::<TimestampMicrosecondArray>() {
            let shown = times.unary::<_, TimestampMicrosecondType>(|time| {
                time.clamp(SHOWN_MICROS.0, SHOWN_MICROS.1)
            });
            *array = Arc::new(shown.with_data_type(array.data_type().clone()));
        }
    }
    let options = RecordBatchOptions::new().with_row_count(Some(batch.num_rows()));
    let shown = RecordBatch::try_new_with_options(Arc::clone(&schema), arrays, &options)?;
    cast_all(&shown, &with_fields(&schema, plain_time))
}

/// The batch with columns of these types.
fn cast_all(batch: &RecordBatch, schema: &SchemaRef) -> Result<RecordBatch, Error> {
    let arrays = batch.columns().iter().zip(schema.fields()).map(|(array, field)| {
        if array.data_type() == field.data_type() {
            return Ok(Arc::clone(array));
        }
        cast(array, field.data_type())
    });
    let arrays = arrays.collect::<Result<Vec<_>, _>>()?;
    let options = RecordBatchOptions::new().with_row_count(Some(batch.num_rows()));
    Ok(RecordBatch::try_new_with_options(Arc::clone(schema), arrays, &options)?)
}

fn flat(batch: &RecordBatch, schema: &SchemaRef, safe: bool) -> Result<RecordBatch, Error> {
    let batch = with_plain_times(batch)?;
    let mut arrays: Vec<ArrayRef> = Vec::new();
    for array in batch.columns() {
        match array.as_any().downcast_ref::<FixedSizeListArray>() {
            Some(lists) => {
                for element in 0..lists.value_length() {
                    arrays.push(element_of(lists, element)?);
                }
            }
            None => arrays.push(Arc::clone(array)),
        }
    }
    for array in arrays.iter_mut().filter(|_| safe) {
        if let Some(texts) = array.as_any().downcast_ref::<StringArray>() {
            *array = Arc::new(texts.iter().map(|text| text.map(csv_safe)).collect::<StringArray>());
        }
    }
    let options = RecordBatchOptions::new().with_row_count(Some(batch.num_rows()));
    Ok(RecordBatch::try_new_with_options(Arc::clone(schema), arrays, &options)?)
}

/// The elements at one place of all lists.
fn element_of(lists: &FixedSizeListArray, element: i32) -> Result<ArrayRef, Error> {
    let places: UInt32Array = (0..lists.len())
        .map(|row| {
            lists.is_valid(row).then(|| (lists.value_offset_at(row) + element as usize) as u32)
        })
        .collect();
    Ok(take(lists.values(), &places, None)?)
}

/// An output that compresses, perhaps.
enum Squeeze<W: Write> {
    Plain(W),
    Gzip(GzEncoder<W>),
    Zstd(zstd::stream::write::Encoder<'static, W>),
}

impl<W: Write> Squeeze<W> {
    fn new(out: W, compression: Compression) -> io::Result<Self> {
        Ok(match compression {
            Compression::Gzip => Self::Gzip(GzEncoder::new(out, flate2::Compression::fast())),
            Compression::Zstd => {
                let mut encoder = zstd::stream::write::Encoder::new(out, ZSTD_LEVEL)?;
                encoder.window_log(ZSTD_WINDOW_LOG)?;
                Self::Zstd(encoder)
            }
            Compression::None | Compression::Snappy | Compression::Lz4 => Self::Plain(out),
        })
    }

    fn finish(self) -> io::Result<W> {
        match self {
            Self::Plain(out) => Ok(out),
            Self::Gzip(out) => out.finish(),
            Self::Zstd(out) => out.finish(),
        }
    }
}

impl<W: Write> Write for Squeeze<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match self {
            Self::Plain(out) => out.write(bytes),
            Self::Gzip(out) => out.write(bytes),
            Self::Zstd(out) => out.write(bytes),
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        match self {
            Self::Plain(out) => out.flush(),
            Self::Gzip(out) => out.flush(),
            Self::Zstd(out) => out.flush(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::csv_safe;

    #[test]
    fn formulas_become_texts_and_numbers_stay() {
        for text in ["=1+1", "+a", "-a", "@a", "\ta", "\ra", "\na", "=", "-1+cmd|' /C calc'!A0"] {
            assert_eq!(csv_safe(text), format!("'{text}"));
        }
        for text in ["", "a=1", "-1", "+1.5e3", "-inf", "1+1", " =1", "'=1"] {
            assert_eq!(csv_safe(text), text);
        }
    }
}
