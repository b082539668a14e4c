//! `align_tables`: several tables on one clock.

use mavwire_columns::align::{Clock, Method, align};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::python::error::Result;
use crate::python::lists::list;
use crate::tables::table::RecordBatches;

/// One table of `[(name, table), ...]`: on the times of the table `on`, or every `step` microseconds from the first time
/// of all to the last. `method` is `ffill`, `nearest` or `linear`; `tolerance` in microseconds.
#[pyfunction]
#[pyo3(signature = (tables, on, step, method, tolerance))]
pub(crate) fn align_tables(
    py: Python<'_>,
    #[pyo3(from_py_with = list)] tables: Vec<(String, PyRef<'_, RecordBatches>)>,
    on: Option<PyRef<'_, RecordBatches>>,
    step: Option<i64>,
    method: &str,
    tolerance: Option<u64>,
) -> Result<RecordBatches> {
    let method = match method {
        "ffill" => Method::Ffill,
        "nearest" => Method::Nearest,
        "linear" => Method::Linear,
        _ => return Err(PyValueError::new_err(format!("no such method: {method:?}")).into()),
    };
    let clock = match (on, step) {
        (Some(on), None) => Clock::Table(on.whole(py)?.clone()),
        (None, Some(step)) if step > 0 => Clock::Step(step),
        _ => return Err(PyValueError::new_err("either a table to align on or a rate").into()),
    };
    let whole =
        |(name, table): (String, PyRef<'_, RecordBatches>)| Ok((name, table.whole(py)?.clone()));
    let tables = tables.into_iter().map(whole).collect::<Result<Vec<_>>>()?;
    let aligned = py.detach(|| align(&tables, &clock, method, tolerance.unwrap_or(u64::MAX)))?;
    Ok(RecordBatches::new(aligned.schema(), vec![aligned]))
}
