//! Tables as files of other programs: each file can be read back, and holds the rows that were written.

use std::collections::{BTreeMap, HashMap};
use std::io::{Cursor, Read};
use std::sync::Arc;

use bytes::Bytes;
use mavwire_columns::arrow::array::RecordBatch;
use mavwire_columns::arrow::compute::{cast, concat_batches};
use mavwire_columns::arrow::ipc::reader::FileReader;
use mavwire_columns::convert::{Compression, Format, Sink, write_all};
use mavwire_columns::dataflash;
use mavwire_columns::input::{Steps, decompressed};
use mavwire_columns::layout::{Invalid, Options};
use mavwire_columns::mcap::{self as to_mcap, Encoding, McapSink, Settings};
use mavwire_columns::reader::{Batch, Decode, Limits, Plan, reader};
use mavwire_columns::scan::Framing;
use parquet::arrow::arrow_reader::ParquetRecordBatchReaderBuilder;

use crate::dataflash_tables::surveyed;
use crate::dialects::ALL;
use crate::input::Input;
use crate::logs::{any_dataflash, any_telemetry, any_text_log};
use crate::reading::{batches, on_threads, small_limits, source};

const FORMATS: [Option<Format>; 5] = [
    Some(Format::Parquet),
    Some(Format::Csv),
    Some(Format::JsonLines),
    Some(Format::Arrow),
    None, // MCAP
];
const COMPRESSIONS: [Compression; 5] = [
    Compression::None,
    Compression::Zstd,
    Compression::Snappy,
    Compression::Gzip,
    Compression::Lz4,
];

/// Any log of any kind to any format.
pub fn converters(data: &[u8]) {
    let mut input = Input::new(data);
    let format = FORMATS[usize::from(input.byte()) % FORMATS.len()];
    let compression = COMPRESSIONS[usize::from(input.byte()) % COMPRESSIONS.len()];
    let flags = input.byte();
    let options = Options {
        si: flags & 1 != 0,
        enum_names: flags & 2 != 0,
        invalid: if flags & 8 == 0 { Invalid::Keep } else { Invalid::Null },
        ..Options::default()
    };
    let limits = small_limits(&mut input);
    on_threads(flags & 4 != 0, || {
        let Some(mut reader) = any_reader(flags >> 4, input, &options, limits) else { return };
        let has_times = reader.has_times();
        let all = batches(&mut *reader);
        match format {
            Some(format) => files(&all, format, compression),
            None => [Encoding::Protobuf, Encoding::Json]
                .into_iter()
                .for_each(|encoding| mcap(&all, encoding, compression, has_times)),
        }
    });
}

fn any_reader(
    kind: u8,
    input: Input<'_>,
    options: &Options,
    limits: Limits,
) -> Option<Box<dyn Decode>> {
    let plan = Plan { options: options.clone(), limits, ..Plan::default() };
    let bytes = match kind % 4 {
        0 | 1 => {
            let framing = if kind.is_multiple_of(4) { Framing::Stamped } else { Framing::Raw };
            let bytes = any_telemetry(input, framing.lead());
            let (source, registry) = (source(&bytes), Arc::clone(&ALL));
            let reader = reader(Steps::default(), source, Some(framing), registry, plan);
            return Some(reader.expect("memory does not fail"));
        }
        2 => any_dataflash(input),
        _ => any_text_log(input),
    };
    let survey = surveyed(Steps::default(), &bytes)?;
    let open = || Ok(source(&bytes));
    let reader = dataflash::reader(survey, &open, plan);
    Some(reader.expect("memory does not fail"))
}

/// A file for each table.
fn files(all: &[Batch], format: Format, compression: Compression) {
    if !format.takes(compression) {
        return;
    }
    let mut tables = BTreeMap::<u16, Vec<&RecordBatch>>::new();
    for batch in all {
        tables.entry(batch.index).or_default().push(&batch.rows);
    }
    let new = |rows: &Vec<&RecordBatch>| {
        Sink::new(Vec::new(), &rows[0].schema(), format, compression).expect("a sink")
    };
    let mut sinks: Vec<Sink<Vec<u8>>> = tables.values().map(new).collect();
    write_all(sinks.iter_mut().zip(tables.values().cloned()).collect()).expect("memory");
    for (sink, rows) in sinks.into_iter().zip(tables.values()) {
        let schema = rows[0].schema();
        let rows = concat_batches(&schema, rows.iter().copied()).expect("one schema");
        assert_eq!(sink.rows(), rows.num_rows() as u64);
        let file = sink.finish().expect("memory does not fail");
        match format {
            Format::Parquet => parquet(file, &rows),
            Format::Arrow => arrow(file, &rows),
            Format::Csv => csv(&text(file), &rows),
            Format::SafeCsv => drop(text(file)),
            Format::JsonLines => json_lines(&text(file), &rows),
        }
    }
}

fn same_rows(found: &[RecordBatch], rows: &RecordBatch) {
    let schema = found.first().map_or(rows.schema(), RecordBatch::schema);
    let found = concat_batches(&schema, found).expect("one schema");
    assert_eq!((found.num_rows(), found.num_columns()), (rows.num_rows(), rows.num_columns()));
    for (one, other) in found.columns().iter().zip(rows.columns()) {
        let other = cast(other, one.data_type()).expect("names as texts");
        assert_eq!(one.to_data(), other.to_data());
    }
}

fn parquet(file: Vec<u8>, rows: &RecordBatch) {
    let builder = ParquetRecordBatchReaderBuilder::try_new(Bytes::from(file)).expect("a file");
    let found: Result<Vec<_>, _> = builder.build().expect("a reader").collect();
    same_rows(&found.expect("rows"), rows);
}

fn arrow(file: Vec<u8>, rows: &RecordBatch) {
    let found: Result<Vec<_>, _> =
        FileReader::try_new(Cursor::new(file), None).expect("a file").collect();
    same_rows(&found.expect("rows"), rows);
}

fn text(file: Vec<u8>) -> String {
    let mut text = String::new();
    let mut plain = decompressed(Box::new(Cursor::new(file))).expect("memory does not fail");
    plain.read_to_string(&mut text).expect("text");
    text
}

/// A header and a line for each row, all with as many values; line ends within quotes are none.
fn csv(text: &str, rows: &RecordBatch) {
    let (mut quoted, mut values, mut lines) = (false, 1, Vec::new());
    for character in text.chars() {
        match character {
            '"' => quoted = !quoted,
            ',' if !quoted => values += 1,
            '\n' if !quoted => lines.push(std::mem::replace(&mut values, 1)),
            _ => {}
        }
    }
    assert!(!quoted && values == 1, "the last line ends");
    assert_eq!(lines.len(), rows.num_rows() + 1);
    assert!(lines.iter().all(|&values| values == lines[0]));
    assert!(lines[0] >= rows.num_columns());
}

/// An object for each row, without keys that are no columns.
fn json_lines(text: &str, rows: &RecordBatch) {
    let mut count = 0;
    for line in text.lines() {
        let object: serde_json::Map<String, serde_json::Value> =
            serde_json::from_str(line).expect("JSON");
        assert!(object.keys().all(|key| rows.column_by_name(key).is_some()));
        count += 1;
    }
    assert_eq!(count, rows.num_rows());
}

/// One file of all messages.
fn mcap(all: &[Batch], encoding: Encoding, compression: Compression, has_times: bool) {
    if !to_mcap::takes(compression) {
        return;
    }
    let settings = Settings { encoding, compression, descriptions: HashMap::new() };
    let mut sink = McapSink::new(Vec::new(), settings).expect("memory does not fail");
    let written = sink.write(all);
    assert_eq!(written.is_ok(), has_times || all.is_empty());
    if written.is_err() {
        return;
    }
    let rows: usize = all.iter().map(|batch| batch.rows.num_rows()).sum();
    assert_eq!(sink.rows(), rows as u64);
    let file = sink.finish().expect("memory does not fail");
    let (mut count, mut newest) = (0, 0);
    for message in mcap::MessageStream::new(&file).expect("a file") {
        let message = message.expect("a message");
        assert!(message.log_time >= newest, "sorted by time");
        newest = message.log_time;
        if message.channel.message_encoding == "json" {
            let _: serde_json::Map<String, serde_json::Value> =
                serde_json::from_slice(&message.data).expect("JSON");
        }
        let schema = message.channel.schema.as_ref().expect("a schema");
        count += usize::from(!schema.name.starts_with("foxglove."));
    }
    assert_eq!(count, rows);
}
