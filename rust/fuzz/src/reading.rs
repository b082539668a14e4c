//! Logs in memory as tables, on any number of threads.

use std::collections::BTreeMap;
use std::io::{Cursor, Read};
use std::sync::LazyLock;

use mavwire_columns::arrow::array::RecordBatch;
use mavwire_columns::arrow::compute::concat_batches;
use mavwire_columns::input::Steps;
use mavwire_columns::reader::{Batch, Decode, Limits};
use rayon::{ThreadPool, ThreadPoolBuilder};

use crate::input::Input;

/// One thread, and several.
static POOLS: LazyLock<[ThreadPool; 2]> = LazyLock::new(|| {
    [1, 3].map(|count| ThreadPoolBuilder::new().num_threads(count).build().expect("threads"))
});

/// Runs `work` with its reading on one thread, or on several.
pub(crate) fn on_threads<T: Send>(several: bool, work: impl FnOnce() -> T + Send) -> T {
    POOLS[usize::from(several)].install(work)
}

/// Bytes to read from the start.
pub(crate) fn source(bytes: &[u8]) -> Box<dyn Read + Send> {
    Box::new(Cursor::new(bytes.to_vec()))
}

/// Whether it begins as a compressed log does, and is read as one.
pub(crate) fn looks_compressed(bytes: &[u8]) -> bool {
    matches!(
        bytes,
        [0x1F, 0x8B, 8, ..] | [0x28, 0xB5, 0x2F, 0xFD, ..] | [0x50..=0x5F, 0x2A, 0x4D, 0x18, ..]
    )
}

/// Small steps, in which a log of some hundred bytes is long; the first block has `least` bytes.
pub(crate) fn small_steps(input: &mut Input<'_>, least: usize) -> Steps {
    let block = least + usize::from(input.number() % 1024);
    Steps { block, stretch: 1 + usize::from(input.number() % 512) }
}

/// Limits that make many batches, and some rows over.
pub(crate) fn small_limits(input: &mut Input<'_>) -> Limits {
    Limits { rows: input.byte().into(), bytes: input.number().into(), ..Limits::NONE }
}

/// All batches to the end.
pub(crate) fn batches(reader: &mut dyn Decode) -> Vec<Batch> {
    let mut all = Vec::new();
    while let Some(some) = reader.advance().expect("memory does not fail") {
        all.extend(some);
    }
    all
}

/// The tables by index, whatever batches they came in.
pub(crate) fn whole_tables(reader: &mut dyn Decode) -> BTreeMap<u16, RecordBatch> {
    joined(batches(reader))
}

/// The same of batches.
pub(crate) fn joined(batches: Vec<Batch>) -> BTreeMap<u16, RecordBatch> {
    let mut by_index = BTreeMap::<u16, Vec<RecordBatch>>::new();
    for batch in batches {
        assert!(batch.rows.num_rows() > 0, "an empty batch of {}", batch.message);
        by_index.entry(batch.index).or_default().push(batch.rows);
    }
    let whole = |rows: Vec<RecordBatch>| {
        concat_batches(&rows[0].schema(), &rows).expect("batches of one schema")
    };
    by_index.into_iter().map(|(index, rows)| (index, whole(rows))).collect()
}
