//! Parquet files: a row group for each batch, its columns encoded on all processors.

use std::io::{self, Write};
use std::sync::{Arc, Mutex, PoisonError};

use arrow::array::{ArrayRef, RecordBatch};
use arrow::datatypes::{DataType, Field, Schema, SchemaRef};
use parquet::arrow::ArrowWriter;
use parquet::arrow::arrow_writer::{
    ArrowColumnChunk, ArrowColumnWriter, ArrowRowGroupWriterFactory, ArrowWriterOptions,
    compute_leaves,
};
use parquet::basic::{Compression as ParquetCompression, Encoding, ZstdLevel};
use parquet::errors::ParquetError;
use parquet::file::metadata::ParquetMetaData;
use parquet::file::properties::{EnabledStatistics, WriterProperties, WriterPropertiesBuilder};
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::types::ColumnPath;
use rayon::prelude::*;

use crate::convert::Compression;
use crate::error::Error;
use crate::pool;
use crate::tables::pieces;

/// Rows of a row group at most: readers that look for a time pass over whole groups.
pub(crate) const MOST_ROWS: usize = 65_536;

/// Values of a column of lists in a row group at most: each is encoded with levels that take several times its size.
const MOST_VALUES: usize = 1 << 22;

/// Rows below which columns are not worth handing to other threads.
const FEW_ROWS: usize = 2048;

/// Bytes of a column below which compressing costs more than it gives.
const FEW_BYTES: usize = 1024;

/// A Parquet file being written.
pub(crate) struct RowGroups<W: Write + Send> {
    schema: SchemaRef,
    compression: Compression,
    out: Shared<W>,
    /// The first batch tells how its columns are best written.
    file: Option<File<W>>,
    /// Rows of the file at least, as far as is known.
    rows: usize,
    /// The file says which Arrow types its columns have, beside those of Parquet.
    has_arrow_types: bool,
}

/// The output: parquet's writer, asked to give it back, does not say why it cannot write what is left.
struct Shared<W>(Arc<Mutex<W>>);

impl<W: Write> Write for Shared<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).flush()
    }
}

type File<W> = (SerializedFileWriter<Shared<W>>, ArrowRowGroupWriterFactory);

impl<W: Write + Send> RowGroups<W> {
    pub(crate) fn new(out: W, schema: SchemaRef, compression: Compression) -> Self {
        let out = Shared(Arc::new(Mutex::new(out)));
        let file = None;
        Self { schema, compression, out, file, rows: 0, has_arrow_types: true }
    }

    /// Says nothing of Arrow types. Readers of a table then see lists of any length and texts, as its schema says.
    pub(crate) fn without_arrow_types(mut self) -> Self {
        self.has_arrow_types = false;
        self
    }

    /// Says how many rows are to come.
    pub(crate) fn expect(&mut self, rows: usize) {
        self.rows = rows;
    }

    /// Writes a batch as a row group, or as some of about one size.
    pub(crate) fn write(&mut self, batch: &RecordBatch) -> Result<(), Error> {
        if batch.num_rows() == 0 {
            return Ok(());
        }
        pieces(batch, most_rows(&self.schema))
            .try_for_each(|rows| pool::run(|| self.write_group(&rows)))
    }

    fn write_group(&mut self, batch: &RecordBatch) -> Result<(), Error> {
        let schema = Arc::clone(&self.schema);
        let (file, factory) = self.open(batch.num_rows())?;
        let writers = factory.create_column_writers(file.flushed_row_groups().len())?;
        let least = if batch.num_rows() < FEW_ROWS { writers.len() } else { 1 };
        let columns = writers.into_par_iter().with_min_len(least.max(1));
        let columns = columns.zip(schema.fields().par_iter().zip(batch.columns()));
        let chunks: Vec<ArrowColumnChunk> = columns
            .map(|(writer, (field, array))| encoded(writer, field, array))
            .collect::<Result<_, _>>()?;
        let mut group = file.next_row_group()?;
        for chunk in chunks {
            chunk.append_to_row_group(&mut group)?;
        }
        group.close()?;
        Ok(())
    }

    /// Writes the end of the file.
    pub(crate) fn finish(self) -> Result<W, Error> {
        Ok(self.finish_with_footer()?.0)
    }

    /// Writes the end of the file, and tells what is in it.
    pub(crate) fn finish_with_footer(mut self) -> Result<(W, ParquetMetaData), Error> {
        let footer = self.open(0)?.0.finish()?;
        drop(self.file);
        let lost = || ParquetError::General("the output is in use".to_owned());
        let out = Arc::into_inner(self.out.0).ok_or_else(lost)?;
        Ok((out.into_inner().unwrap_or_else(PoisonError::into_inner), footer))
    }

    /// The columns.
    pub(crate) fn schema(&self) -> &SchemaRef {
        &self.schema
    }

    /// Bytes so far.
    pub(crate) fn bytes(&self) -> usize {
        self.file.as_ref().map_or(0, |(file, _)| file.bytes_written())
    }

    fn open(&mut self, rows: usize) -> Result<&mut File<W>, Error> {
        match &mut self.file {
            Some(file) => Ok(file),
            file @ None => {
                let out = Shared(Arc::clone(&self.out.0));
                let rows = rows.max(self.rows);
                let properties = properties(&self.schema, self.compression, rows)?;
                let schema = Arc::clone(&self.schema);
                let options = ArrowWriterOptions::new()
                    .with_properties(properties)
                    .with_skip_arrow_metadata(!self.has_arrow_types);
                let writer = ArrowWriter::try_new_with_options(out, schema, options)?;
                Ok(file.insert(writer.into_serialized_writer()?))
            }
        }
    }
}

/// Rows of a row group of such a table at most.
fn most_rows(schema: &Schema) -> usize {
    let elements = |field: &Arc<Field>| match field.data_type() {
        DataType::FixedSizeList(_, elements) => usize::try_from(*elements).unwrap_or(1),
        _ => 1,
    };
    let widest = schema.fields().iter().map(elements).max();
    MOST_ROWS.min(MOST_VALUES / widest.unwrap_or(1).max(1))
}

fn encoded(
    mut writer: ArrowColumnWriter,
    field: &Field,
    array: &ArrayRef,
) -> Result<ArrowColumnChunk, ParquetError> {
    for leaf in compute_leaves(field, array)? {
        writer.write(&leaf)?;
    }
    writer.close()
}

/// How the columns of a table are written that has so many rows, as far as is known. A row group has statistics and
/// pages no index: readers skip whole row groups.
fn properties(
    schema: &Schema,
    compression: Compression,
    rows: usize,
) -> Result<WriterProperties, Error> {
    let compression = match compression {
        Compression::Zstd => ParquetCompression::ZSTD(ZstdLevel::try_new(1)?),
        Compression::Snappy => ParquetCompression::SNAPPY,
        Compression::None | Compression::Gzip | Compression::Lz4 => {
            ParquetCompression::UNCOMPRESSED
        }
    };
    let mut properties = WriterProperties::builder()
        .set_compression(compression)
        .set_dictionary_enabled(false)
        .set_statistics_enabled(EnabledStatistics::Chunk)
        .set_offset_index_disabled(true)
        .set_data_page_row_count_limit(usize::MAX)
        .set_max_row_group_row_count(None);
    for field in schema.fields() {
        properties = with_column(properties, field, rows);
    }
    Ok(properties.build())
}

fn with_column(
    properties: WriterPropertiesBuilder,
    field: &Field,
    rows: usize,
) -> WriterPropertiesBuilder {
    let (path, leaf) = (path_of(field), leaf_type(field));
    let properties = if repeats(field) {
        properties.set_column_dictionary_enabled(path.clone(), true)
    } else if let Some(encoding) = encoding_of(leaf) {
        properties.set_column_encoding(path.clone(), encoding)
    } else {
        properties
    };
    let is_small = leaf.primitive_width().is_some_and(|width| width * rows < FEW_BYTES);
    if is_small || is_sender(field) {
        return properties.set_column_compression(path, ParquetCompression::UNCOMPRESSED);
    }
    properties
}

/// The encoding that compresses best: measured values change little from one to the next.
fn encoding_of(leaf: &DataType) -> Option<Encoding> {
    match leaf {
        leaf if leaf.is_floating() => Some(Encoding::BYTE_STREAM_SPLIT),
        DataType::Timestamp(..) => Some(Encoding::DELTA_BINARY_PACKED),
        leaf if leaf.is_integer() => Some(Encoding::DELTA_BINARY_PACKED),
        _ => None,
    }
}

fn leaf_type(field: &Field) -> &DataType {
    match field.data_type() {
        DataType::FixedSizeList(item, _) | DataType::List(item) => item.data_type(),
        other => other,
    }
}

/// Where parquet has the values of a field.
fn path_of(field: &Field) -> ColumnPath {
    match field.data_type() {
        DataType::FixedSizeList(item, _) | DataType::List(item) => {
            ColumnPath::new(vec![field.name().clone(), "list".to_owned(), item.name().clone()])
        }
        _ => ColumnPath::from(field.name().as_str()),
    }
}

/// Few values, many times: who sent it, texts, enums.
fn repeats(field: &Field) -> bool {
    let text = matches!(leaf_type(field), DataType::Utf8 | DataType::Dictionary(..));
    is_sender(field) || text || field.metadata().contains_key("enum")
}

fn is_sender(field: &Field) -> bool {
    matches!(field.name().as_str(), "sysid" | "compid")
}
