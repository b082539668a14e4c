//! `Converter`: the tables of a log into files, one for each message type, without the interpreter.

use std::collections::BTreeMap;
use std::collections::btree_map::Entry;
use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use mavwire_columns::Error;
use mavwire_columns::arrow::array::RecordBatch;
use mavwire_columns::convert::{Compression, Format, Sink, write_all};
use mavwire_columns::reader::{Batch, Decode};
use mavwire_link::files::Draft;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::columns::Query;
use crate::dialect::Dialect;
use crate::table::{RecordBatches, columns_error};

fn format_of(name: &str) -> PyResult<Format> {
    Ok(match name {
        "parquet" => Format::Parquet,
        "csv" => Format::Csv,
        "jsonl" => Format::JsonLines,
        "arrow" => Format::Arrow,
        _ => return Err(PyValueError::new_err(format!("no such format: {name:?}"))),
    })
}

fn compression_of(name: &str, format: Format, format_name: &str) -> PyResult<Compression> {
    let compression = match name {
        "none" => Compression::None,
        "zstd" => Compression::Zstd,
        "snappy" => Compression::Snappy,
        "gzip" => Compression::Gzip,
        _ => return Err(PyValueError::new_err(format!("no such compression: {name:?}"))),
    };
    if format.takes(compression) {
        return Ok(compression);
    }
    Err(PyValueError::new_err(format!("{format_name} cannot be compressed with {name}")))
}

/// A log, and the files that become of it.
struct Work {
    reader: Box<dyn Decode>,
    folder: PathBuf,
    file: String,
    format: Format,
    compression: Compression,
    /// By message index.
    sinks: BTreeMap<u16, (PathBuf, Sink<Draft>)>,
}

impl Work {
    /// Begins the file of a batch where there is none yet.
    fn begin(&mut self, batch: &Batch) -> Result<(), Error> {
        if let Entry::Vacant(missing) = self.sinks.entry(batch.index) {
            let path = self.folder.join(folder_of(&batch.message)).join(&self.file);
            let draft = Draft::create(&path)?;
            let sink = Sink::new(draft, &batch.rows.schema(), self.format, self.compression)?;
            missing.insert((path, sink));
        }
        Ok(())
    }

    /// Another block of the log; false at its end.
    fn step(&mut self) -> Result<bool, Error> {
        let Some(batches) = self.reader.advance()? else { return Ok(false) };
        let mut by_type: BTreeMap<u16, Vec<&RecordBatch>> = BTreeMap::new();
        for batch in &batches {
            self.begin(batch)?;
            by_type.entry(batch.index).or_default().push(&batch.rows);
        }
        let sinks = self.sinks.iter_mut();
        let due = sinks.filter_map(|(index, (_, sink))| Some((sink, by_type.remove(index)?)));
        write_all(due.collect())?;
        Ok(true)
    }

    /// Gives all files their names.
    fn commit(self) -> Result<Vec<(PathBuf, u64)>, Error> {
        // All are finished before the first one is renamed.
        let mut drafts = Vec::new();
        for (path, sink) in self.sinks.into_values() {
            let rows = sink.rows();
            drafts.push((path, rows, sink.finish()?));
        }
        let mut files = Vec::new();
        for (path, rows, draft) in drafts {
            draft.commit()?;
            files.push((path, rows));
        }
        Ok(files)
    }
}

/// The folder of a type: a log names its types, and whoever made the log shall not choose where files go.
fn folder_of(name: &str) -> String {
    let mut folder = String::with_capacity(name.len());
    for byte in name.bytes() {
        if byte.is_ascii_alphanumeric() || matches!(byte, b'_' | b'-') {
            folder.push(char::from(byte));
        } else {
            let _ = write!(folder, "%{byte:02X}");
        }
    }
    folder
}

/// Writes the tables of a log to `folder/MESSAGE/file`.
#[pyclass(frozen, module = "mavwire._native")]
pub(crate) struct Converter {
    work: Mutex<Option<Work>>,
}

impl Converter {
    pub(crate) fn new(
        reader: Box<dyn Decode>,
        folder: PathBuf,
        file: String,
        format: &str,
        compression: &str,
    ) -> PyResult<Self> {
        let kind = format_of(format)?;
        let compression = compression_of(compression, kind, format)?;
        let work = Work { reader, folder, file, format: kind, compression, sinks: BTreeMap::new() };
        Ok(Self { work: Mutex::new(Some(work)) })
    }

    fn with<T>(&self, take: impl FnOnce(&mut Option<Work>) -> T) -> T {
        take(&mut self.work.lock().unwrap_or_else(PoisonError::into_inner))
    }
}

#[pymethods]
impl Converter {
    #[new]
    #[pyo3(signature = (path, dialect, query, folder, file, format, compression))]
    #[allow(clippy::too_many_arguments)] // one call, made in one place
    fn open(
        py: Python<'_>,
        path: PathBuf,
        dialect: &Dialect,
        query: Query,
        folder: PathBuf,
        file: String,
        format: &str,
        compression: &str,
    ) -> PyResult<Self> {
        let reader = py.detach(|| query.open(&path, dialect)).map_err(columns_error)?;
        Self::new(reader, folder, file, format, compression)
    }

    /// Converts another block of the log; false at its end.
    fn step(&self, py: Python<'_>) -> PyResult<bool> {
        py.check_signals()?;
        let step = |work: &mut Option<Work>| work.as_mut().map_or(Ok(false), Work::step);
        py.detach(|| self.with(step)).map_err(columns_error)
    }

    /// Gives the files their names: `[(path, rows), ...]`. Without it nothing is left of them.
    fn commit(&self, py: Python<'_>) -> PyResult<Vec<(PathBuf, u64)>> {
        let commit = |work: &mut Option<Work>| work.take().map_or(Ok(Vec::new()), Work::commit);
        py.detach(|| self.with(commit)).map_err(columns_error)
    }

    /// Removes what was written.
    fn abandon(&self, py: Python<'_>) {
        py.detach(|| self.with(|work| drop(work.take())));
    }

    /// Bytes of the log dealt with, bytes that belong to no record, and what is wrong with the compressed file.
    fn progress(&self, py: Python<'_>) -> (u64, u64, Option<String>) {
        py.detach(|| {
            self.with(|work| {
                work.as_ref().map_or((0, 0, None), |Work { reader, .. }| {
                    let damage = reader.damage().map(str::to_owned);
                    (reader.position(), reader.bad_bytes(), damage)
                })
            })
        })
    }
}

/// Writes a table to a file, which appears when it is complete.
#[pyfunction]
pub(crate) fn write_table(
    py: Python<'_>,
    table: &RecordBatches,
    path: PathBuf,
    format: &str,
    compression: &str,
) -> PyResult<()> {
    let kind = format_of(format)?;
    let compression = compression_of(compression, kind, format)?;
    py.detach(|| write_file(table, &path, kind, compression)).map_err(columns_error)
}

fn write_file(
    table: &RecordBatches,
    path: &Path,
    format: Format,
    compression: Compression,
) -> Result<(), Error> {
    let mut sink = Sink::new(Draft::create(path)?, table.schema(), format, compression)?;
    for batch in table.batches() {
        sink.write(batch)?;
    }
    Ok(sink.finish()?.commit()?)
}
