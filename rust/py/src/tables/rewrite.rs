//! `LogRewrite`: a telemetry log made of others, without the interpreter.

use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use mavwire_columns::input::Steps;
use mavwire_columns::rewrite::Rewrite;
use mavwire_core::anonymize::{Anonymizer, Shift};
use mavwire_io::files::{self, Draft};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::dialect::registry::Dialect;
use crate::python::error::{Error, Result};
use crate::python::lists::list;
use crate::tables::columns::Query;

struct Work {
    rewrite: Rewrite,
    /// `None` when it was committed or abandoned.
    draft: Option<Draft>,
}

/// One run over logs that writes another, which appears when it is complete.
#[pyclass(frozen, module = "mavwire._native")]
pub(crate) struct LogRewrite {
    work: Mutex<Work>,
}

impl LogRewrite {
    fn with<T>(&self, take: impl FnOnce(&mut Work) -> T) -> T {
        take(&mut self.work.lock().unwrap_or_else(PoisonError::into_inner))
    }
}

#[pymethods]
impl LogRewrite {
    /// The records of `paths` to `out` that `query` asks for, or all in the order of time. Positions are shifted by `shift`
    /// degrees to the north and east, and identifiers emptied, unless that is None.
    #[new]
    #[pyo3(signature = (paths, dialect, out, query=None, shift=None))]
    fn new(
        py: Python<'_>,
        #[pyo3(from_py_with = list)] paths: Vec<PathBuf>,
        dialect: &Dialect,
        out: PathBuf,
        query: Option<Query>,
        shift: Option<(f64, f64)>,
    ) -> Result<Self> {
        let registry = &dialect.registry;
        let needs_times = query.as_ref().is_none_or(Query::is_timed);
        let wanted = query.unwrap_or_default().wanted(Some(dialect));
        let anonymizer = shift.map(|(latitude, longitude)| {
            Anonymizer::new(registry.dialect(), Shift { latitude, longitude })
        });
        let rewrite = py.detach(|| -> Result<_> {
            let open = |path: &PathBuf| {
                files::open(path).map_err(|error| opening(path, paths.len(), error))
            };
            let sources: Vec<_> = paths.iter().map(open).collect::<Result<_>>()?;
            let steps = Steps::shared_by(sources.len());
            Ok(Rewrite::new(steps, sources, None, registry, wanted, anonymizer)?)
        })?;
        if let Some(raw) = rewrite.raw_log().filter(|_| needs_times) {
            return Err(no_times(&paths[raw]).into());
        }
        let draft = Some(Draft::create(&out)?);
        Ok(Self { work: Mutex::new(Work { rewrite, draft }) })
    }

    /// Another block; false at the end.
    fn step(&self, py: Python<'_>) -> Result<bool> {
        py.check_signals()?;
        let step = |work: &mut Work| match &mut work.draft {
            Some(draft) => work.rewrite.advance(draft),
            None => Ok(false),
        };
        Ok(py.detach(|| self.with(step))?)
    }

    /// Gives the file its name. Without it nothing is left of it.
    fn commit(&self, py: Python<'_>) -> Result<()> {
        let commit = |work: &mut Work| work.draft.take().map_or(Ok(()), Draft::commit);
        Ok(py.detach(|| self.with(commit))?)
    }

    /// Removes what was written and not committed.
    fn abandon(&self, py: Python<'_>) {
        py.detach(|| self.with(|work| drop(work.draft.take())));
    }

    /// Of each log, whether it holds something and no record as far as it was read, and the damage of a compressed file.
    fn faults(&self, py: Python<'_>) -> Vec<(bool, Option<String>)> {
        let owned =
            |(is_empty, damage): (bool, Option<&str>)| (is_empty, damage.map(str::to_owned));
        py.detach(|| self.with(|work| work.rewrite.faults().map(owned).collect()))
    }

    /// The counts of all logs so far, as a dict; see `mavwire.logs.rewriting`.
    fn outcome<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let outcome = py.detach(|| self.with(|work| work.rewrite.outcome()));
        let dict = PyDict::new(py);
        dict.set_item("bytes", outcome.bytes)?;
        dict.set_item("records", outcome.records)?;
        dict.set_item("written", outcome.written)?;
        dict.set_item("bad_bytes", outcome.bad_bytes)?;
        dict.set_item("bad_places", outcome.bad_places)?;
        dict.set_item("restamped", outcome.restamped)?;
        Ok(dict)
    }
}

/// The error of one of some logs that cannot be opened.
fn opening(path: &Path, logs: usize, error: io::Error) -> Error {
    let advice = match error.kind() {
        io::ErrorKind::NotFound | io::ErrorKind::PermissionDenied => "",
        _ if logs == 1 => "",
        _ => " (merge opens all logs at once: merge fewer logs, then merge the results)",
    };
    Error::Opening { path: path.to_owned(), error, advice }
}

fn no_times(path: &Path) -> PyErr {
    PyValueError::new_err(format!(
        "{}: a raw stream has no time stamps: use a .tlog file, or leave start and end out",
        path.display()
    ))
}
