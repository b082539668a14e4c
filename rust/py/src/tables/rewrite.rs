//! `LogRewrite`: a telemetry log made of others, without the interpreter.

use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

use mavwire_columns::input::Steps;
use mavwire_columns::rewrite::{Merge, Outcome, Rewrite};
use mavwire_columns::scan::Framing;
use mavwire_core::anonymize::{Anonymizer, Shift};
use mavwire_io::files::{self, Draft};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::dialect::registry::Dialect;
use crate::python::error::{Error, Result};
use crate::python::lists::list;
use crate::tables::columns::Query;

enum Run {
    One(Box<Rewrite>),
    Several(Merge),
}

impl Run {
    fn advance(&mut self, out: &mut dyn Write) -> Result<bool, mavwire_columns::Error> {
        match self {
            Self::One(rewrite) => rewrite.advance(out),
            Self::Several(merge) => merge.advance(out),
        }
    }

    fn without_records(&self) -> Vec<(usize, Option<&str>)> {
        match self {
            Self::One(rewrite) if rewrite.has_no_records() => vec![(0, rewrite.damage())],
            Self::One(_) => Vec::new(),
            Self::Several(merge) => merge.without_records(),
        }
    }

    fn outcome(&self) -> Outcome {
        match self {
            Self::One(rewrite) => rewrite.outcome(),
            Self::Several(merge) => merge.outcome(),
        }
    }

    fn damage(&self) -> Vec<(usize, &str)> {
        match self {
            Self::One(rewrite) => rewrite.damage().map(|damage| (0, damage)).into_iter().collect(),
            Self::Several(merge) => merge.damage(),
        }
    }
}

struct Work {
    run: Run,
    /// `None` when it was committed or abandoned.
    draft: Option<Draft>,
}

/// One run over logs that writes another, which appears when it is complete.
#[pyclass(frozen, module = "mavwire._native")]
pub(crate) struct LogRewrite {
    work: Mutex<Work>,
}

impl LogRewrite {
    fn new(run: Run, out: &Path) -> Result<Self> {
        let draft = Some(Draft::create(out)?);
        Ok(Self { work: Mutex::new(Work { run, draft }) })
    }

    fn with<T>(&self, take: impl FnOnce(&mut Work) -> T) -> T {
        take(&mut self.work.lock().unwrap_or_else(PoisonError::into_inner))
    }
}

#[pymethods]
impl LogRewrite {
    /// The records of `path` that `query` asks for to `out`; positions are shifted by `shift` degrees to the north and
    /// east, and identifiers emptied, unless that is None.
    #[staticmethod]
    #[pyo3(signature = (path, dialect, query, out, shift=None))]
    fn select(
        py: Python<'_>,
        path: PathBuf,
        dialect: &Dialect,
        query: Query,
        out: PathBuf,
        shift: Option<(f64, f64)>,
    ) -> Result<Self> {
        let registry = &dialect.registry;
        let wanted = query.wanted(dialect);
        let is_timed = query.start.is_some() || query.end.is_some();
        let anonymizer = shift.map(|(latitude, longitude)| {
            Anonymizer::new(registry.dialect(), Shift { latitude, longitude })
        });
        let rewrite = py.detach(|| {
            let (steps, source) = (Steps::default(), files::open(&path)?);
            Rewrite::new(steps, source, None, Arc::clone(registry), wanted, anonymizer)
        })?;
        if is_timed && rewrite.framing() == Framing::Raw {
            return Err(no_times(&path).into());
        }
        Self::new(Run::One(Box::new(rewrite)), &out)
    }

    /// All good records of several logs to `out`, in the order of time.
    #[staticmethod]
    fn merge(
        py: Python<'_>,
        #[pyo3(from_py_with = list)] paths: Vec<PathBuf>,
        dialect: &Dialect,
        out: PathBuf,
    ) -> Result<Self> {
        let merge = py.detach(|| -> Result<_> {
            let open = |path: &PathBuf| files::open(path).map_err(|error| named(path, error));
            let sources: Vec<_> = paths.iter().map(open).collect::<Result<_, _>>()?;
            Ok(Merge::new(Steps::shared_by(sources.len()), sources, &dialect.registry)?)
        });
        match merge? {
            Ok(merge) => Self::new(Run::Several(merge), &out),
            Err(place) => Err(no_times(&paths[place]).into()),
        }
    }

    /// Another block; false at the end.
    fn step(&self, py: Python<'_>) -> Result<bool> {
        py.check_signals()?;
        let step = |work: &mut Work| match &mut work.draft {
            Some(draft) => work.run.advance(draft),
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

    /// The places of the logs that hold something and no record, and what is wrong with such a compressed file; once all
    /// of them were read.
    fn without_records(&self, py: Python<'_>) -> Vec<(usize, Option<String>)> {
        let owned = |(place, damage): (usize, Option<&str>)| (place, damage.map(str::to_owned));
        py.detach(|| self.with(|work| work.run.without_records().into_iter().map(owned).collect()))
    }

    /// The places of the compressed logs that are damaged, as far as they were read, and what is wrong with them.
    fn damage(&self, py: Python<'_>) -> Vec<(usize, String)> {
        let owned = |(place, damage): (usize, &str)| (place, damage.to_owned());
        py.detach(|| self.with(|work| work.run.damage().into_iter().map(owned).collect()))
    }

    /// What became of the logs so far, as a dict of counts; see `mavwire.logs.rewriting`.
    fn outcome<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let outcome = py.detach(|| self.with(|work| work.run.outcome()));
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

/// The error of a log that cannot be opened beside the others.
fn named(path: &Path, error: io::Error) -> Error {
    let advice = match error.kind() {
        io::ErrorKind::NotFound | io::ErrorKind::PermissionDenied => "",
        _ => " (all logs are open at once: merge fewer of them, then what comes of that)",
    };
    Error::Opening { path: path.to_owned(), error, advice }
}

fn no_times(path: &Path) -> PyErr {
    PyValueError::new_err(format!(
        "{}: a raw stream has no time stamps, and this needs them",
        path.display()
    ))
}
