//! Parquet files are the same on any number of processors, and hold what was written.

mod common;

use std::io::Cursor;

use common::{damage, log, registry};
use mavwire_columns::arrow::array::RecordBatch;
use mavwire_columns::arrow::compute::concat_batches;
use mavwire_columns::convert::{Compression, Format, Sink};
use mavwire_columns::input::Steps;
use mavwire_columns::layout::Options;
use mavwire_columns::reader::{Plan, reader};
use parquet::arrow::arrow_reader::ParquetRecordBatchReaderBuilder;

/// Batches of a type each, some of few rows.
fn batches(records: usize, si: bool) -> Vec<RecordBatch> {
    let mut bytes = log(&registry(), 3, records, 8);
    damage(&mut bytes, 4, 3);
    let options = Options { si, enum_names: si, ..Options::default() };
    let source = Box::new(Cursor::new(bytes));
    let plan = Plan { options, ..Plan::default() };
    let mut reader = reader(Steps::default(), source, None, registry(), plan).expect("a reader");
    let mut found = Vec::new();
    while let Some(batches) = reader.advance().expect("batches") {
        found.extend(batches.into_iter().map(|batch| batch.rows));
    }
    found
}

/// A file with a row group for each half of the rows.
fn written(batch: &RecordBatch, compression: Compression, threads: usize) -> Vec<u8> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
    let half = batch.num_rows() / 2;
    pool.install(|| {
        let mut sink =
            Sink::new(Vec::new(), &batch.schema(), Format::Parquet, compression).expect("a file");
        sink.write(&batch.slice(0, half)).expect("writing");
        sink.write(&batch.slice(half, batch.num_rows() - half)).expect("writing");
        assert_eq!(sink.rows(), batch.num_rows() as u64);
        sink.finish().expect("the end")
    })
}

/// How many row groups there are, and the rows.
fn read_back(name: &str, file: &[u8]) -> (usize, Vec<RecordBatch>) {
    let path = std::env::temp_dir().join(format!("mavwire-{name}-{}", std::process::id()));
    std::fs::write(&path, file).expect("writing");
    let opened = std::fs::File::open(&path).expect("opening");
    std::fs::remove_file(&path).expect("removing");
    let builder = ParquetRecordBatchReaderBuilder::try_new(opened).expect("a file");
    let groups = builder.metadata().num_row_groups();
    let batches = builder.build().expect("a reader");
    (groups, batches.map(|batch| batch.expect("rows")).collect())
}

#[test]
fn files_hold_what_was_written_on_any_number_of_processors() {
    for (records, si) in [(40, false), (9000, true)] {
        for batch in batches(records, si) {
            for compression in [Compression::Zstd, Compression::Snappy, Compression::None] {
                let file = written(&batch, compression, 1);
                assert_eq!(file, written(&batch, compression, 3));
                let (groups, found) = read_back("rows", &file);
                assert_eq!(groups, 2);
                let rows: usize = found.iter().map(RecordBatch::num_rows).sum();
                assert_eq!(rows, batch.num_rows());
                let whole = concat_batches(&batch.schema(), &found).expect("one schema");
                assert_eq!(whole.columns(), batch.columns());
            }
        }
    }
}

#[test]
fn a_file_without_rows_is_a_file() {
    let schema = batches(40, false)[0].schema();
    let sink = Sink::new(Vec::new(), &schema, Format::Parquet, Compression::Zstd).expect("a file");
    let (groups, found) = read_back("empty", &sink.finish().expect("the end"));
    assert_eq!((groups, found.len()), (0, 0));
}
