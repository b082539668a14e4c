//! `LakeFile`: rows of many logs to a Parquet file of a lake.

use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError};

use mavwire_columns::Error;
use mavwire_columns::gathered::{Gathered, Range};
use mavwire_io::files::Draft;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::python::error::Result;
use crate::tables::table::RecordBatches;

/// Rows, and the log they came from with its digest, or None where they have columns for these.
type Piece<'py> = (PyRef<'py, RecordBatches>, Option<(String, String)>);

/// A file under construction, which appears when it is complete. The first rows decide which columns it has.
#[pyclass(frozen, module = "mavwire._native")]
pub(crate) struct LakeFile {
    path: PathBuf,
    file: Mutex<Option<Gathered<Draft>>>,
}

/// A range as Python gets it: a pair of numbers or of texts.
#[derive(IntoPyObject)]
pub(crate) enum Pair {
    Numbers((i64, i64)),
    Texts((String, String)),
}

/// Rows, columns with their types, and columns with their ranges and nulls.
type Content = (u64, Vec<(String, String)>, Vec<(String, Option<Pair>, u64)>);

#[pymethods]
impl LakeFile {
    #[new]
    fn new(path: PathBuf) -> Self {
        Self { path, file: Mutex::new(None) }
    }

    /// Appends a row group of `[(table, (log, digest) | None), ...]`; the bytes of the file so far.
    fn write(&self, py: Python<'_>, pieces: Vec<Piece<'_>>) -> Result<usize> {
        py.check_signals()?;
        let Some((first, origin)) = pieces.first() else { return Ok(0) };
        let (schema, has_origin) = (Arc::clone(first.schema()), origin.is_some());
        let pieces: Vec<_> = pieces
            .iter()
            .map(|(table, origin)| {
                let origin = origin.as_ref().map(|(log, digest)| [log.as_str(), digest.as_str()]);
                (table.batches(), origin)
            })
            .collect();
        let write = || -> Result<usize, Error> {
            let mut kept = self.file.lock().unwrap_or_else(PoisonError::into_inner);
            let file = match &mut *kept {
                Some(file) => file,
                None => {
                    let out = Draft::create(&self.path)?;
                    kept.insert(Gathered::new(out, schema, has_origin))
                }
            };
            file.write(&pieces)?;
            Ok(file.bytes())
        };
        Ok(py.detach(write)?)
    }

    /// Gives the file its name: its rows, `[(column, type), ...]`, and `[(column, (least, largest) | None, nulls), ...]`.
    fn finish(&self, py: Python<'_>) -> Result<Content> {
        let file = self.file.lock().unwrap_or_else(PoisonError::into_inner).take();
        let file = file.ok_or_else(|| PyValueError::new_err("there is no row"))?;
        let finish = || -> Result<_, Error> {
            let (draft, content) = file.finish()?;
            draft.commit()?;
            Ok(content)
        };
        let content = py.detach(finish)?;
        let pair = |range| match range {
            Range::Numbers(least, largest) => Pair::Numbers((least, largest)),
            Range::Texts(least, largest) => Pair::Texts((least, largest)),
        };
        let ranges = content.ranges.into_iter();
        let ranges = ranges.map(|(name, range, nulls)| (name, range.map(pair), nulls));
        Ok((content.rows, content.columns, ranges.collect()))
    }
}
