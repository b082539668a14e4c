//! `Converter`: the tables of a log into files without the interpreter; and `write_table` and `csv_safe`.

use std::borrow::Cow;
use std::path::PathBuf;
use std::sync::{Mutex, PoisonError};

use mavwire_columns::Error;
use mavwire_columns::arrow::array::RecordBatch;
use mavwire_columns::convert::{self, Compression, Format, Sink, moments};
use mavwire_columns::mcap::{self, Encoding, Settings};
use mavwire_columns::output::{self, Output};
use mavwire_columns::pool;
use mavwire_columns::reader::{Batch, Decode};
use mavwire_io::files::{Draft, commit_all};
use mavwire_io::memory::Freed;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::python::error::Result;
use crate::tables::columns::{LogColumns, Query, bytes_of};
use crate::tables::table::RecordBatches;

fn format_of(name: &str, csv_safe: bool) -> PyResult<Format> {
    Ok(match name {
        "parquet" => Format::Parquet,
        "csv" if csv_safe => Format::SafeCsv,
        "csv" => Format::Csv,
        "jsonl" => Format::JsonLines,
        "arrow" => Format::Arrow,
        _ => return Err(PyValueError::new_err(format!("no such format: {name:?}"))),
    })
}

fn compression_of(name: &str) -> PyResult<Compression> {
    Ok(match name {
        "none" => Compression::None,
        "zstd" => Compression::Zstd,
        "snappy" => Compression::Snappy,
        "gzip" => Compression::Gzip,
        "lz4" => Compression::Lz4,
        _ => return Err(PyValueError::new_err(format!("no such compression: {name:?}"))),
    })
}

fn check(takes: bool, format: &str, compression: &str) -> PyResult<()> {
    if takes {
        return Ok(());
    }
    Err(PyValueError::new_err(format!("{format} cannot be compressed with {compression}")))
}

/// The files that become of a log.
struct Work {
    output: Output<Draft>,
    /// Batches that were read and not written yet.
    batches: Vec<Batch>,
    freed: Freed,
}

impl Work {
    /// Writes what was read, while more of the log is; false at its end.
    fn step(&mut self, reader: &mut dyn Decode) -> Result<bool, Error> {
        let Self { output, batches, .. } = self;
        // Even in a raw stream all rows of a batch may have times.
        if matches!(output, Output::Mcap { .. }) && !batches.is_empty() && !reader.has_times() {
            return Err(Error::NoTimes);
        }
        let (written, read) = pool::both(|| output.write(batches), || reader.advance_a_while());
        written?;
        let written = std::mem::take(&mut self.batches);
        let bytes = bytes_of(&written);
        drop(written);
        self.freed.add(bytes);
        let more = read?;
        let is_end = more.is_none();
        self.batches = more.unwrap_or_default();
        Ok(!is_end)
    }
}

/// Writes the tables of a log to `folder/MESSAGE/file`, or all of them to `folder/file` where the format is `mcap` or `mcap-json`.
#[pyclass(frozen, module = "mavwire._native")]
pub(crate) struct Converter {
    log: Py<LogColumns>,
    work: Mutex<Option<Work>>,
}

impl Converter {
    fn with<T>(&self, take: impl FnOnce(&mut Option<Work>) -> T) -> T {
        take(&mut self.work.lock().unwrap_or_else(PoisonError::into_inner))
    }
}

#[pymethods]
impl Converter {
    #[new]
    fn new(
        log: Py<LogColumns>,
        query: Query,
        folder: PathBuf,
        file: String,
        format: &str,
        compression: &str,
    ) -> PyResult<Self> {
        let how = compression_of(compression)?;
        let encoding = match format {
            "mcap" => Some(Encoding::Protobuf),
            "mcap-json" => Some(Encoding::Json),
            _ => None,
        };
        let output = if let Some(encoding) = encoding {
            check(mcap::takes(how), format, compression)?;
            let descriptions = query.descriptions.unwrap_or_default();
            let settings = Settings { encoding, compression: how, descriptions };
            Output::mcap(folder.join(file), Draft::create, settings)
        } else {
            let kind = format_of(format, query.csv_safe)?;
            check(kind.takes(how), format, compression)?;
            Output::tables(folder, file, kind, how, Draft::create, query.names.is_some())
        };
        let work = Work { output, batches: Vec::new(), freed: Freed::default() };
        Ok(Self { log, work: Mutex::new(Some(work)) })
    }

    /// Converts some more blocks of the log; false at its end.
    fn step(&self, py: Python<'_>) -> Result<bool> {
        py.check_signals()?;
        let step = |work: &mut Option<Work>| match work {
            Some(work) => self.log.get().with(|reader| work.step(reader)),
            None => Ok(false),
        };
        Ok(py.detach(|| self.with(step))?)
    }

    /// Gives the files their names: `[(path, rows), ...]`. Without it nothing is left of them.
    fn commit(&self, py: Python<'_>) -> Result<Vec<(PathBuf, u64)>> {
        let commit = |work: &mut Option<Work>| -> Result<_, Error> {
            let Some(mut work) = work.take() else { return Ok(Vec::new()) };
            work.output.write(&work.batches)?;
            let (files, drafts) = work.output.finish()?;
            commit_all(drafts)?;
            Ok(files)
        };
        Ok(py.detach(|| self.with(commit))?)
    }

    /// Removes what was written.
    fn abandon(&self, py: Python<'_>) {
        py.detach(|| self.with(|work| drop(work.take())));
    }
}

/// Writes a table to a file, which appears when it is complete; Ctrl-C is heard until then.
#[pyfunction]
pub(crate) fn write_table(
    py: Python<'_>,
    table: &RecordBatches,
    path: PathBuf,
    format: &str,
    compression: &str,
    csv_safe: bool,
) -> Result<()> {
    let kind = format_of(format, csv_safe)?;
    let how = compression_of(compression)?;
    check(kind.takes(how), format, compression)?;
    let begin =
        || -> Result<_, Error> { Sink::new(Draft::create(&path)?, table.schema(), kind, how) };
    let rows = table.batches().iter().map(RecordBatch::num_rows).sum();
    let mut sink = py.detach(begin)?.with_rows(rows);
    for rows in table.batches().iter().flat_map(moments) {
        py.detach(|| sink.write(&rows))?;
        py.check_signals()?;
    }
    let end = || -> Result<_, Error> { Ok(sink.finish()?.commit()?) };
    Ok(py.detach(end)?)
}

/// A text as a cell of CSV of which no spreadsheet makes a formula.
#[pyfunction]
pub(crate) fn csv_safe(text: &str) -> Cow<'_, str> {
    convert::csv_safe(text)
}

/// Whether Windows treats the name of a file or folder as a device, such as `nul` or `COM1.txt`.
#[pyfunction]
pub(crate) fn is_device(name: &str) -> bool {
    output::is_device(name)
}

/// The folder of the table of a type.
#[pyfunction]
pub(crate) fn folder_of(name: &str) -> String {
    output::folder_of(name)
}
