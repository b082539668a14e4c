//! `align_tables`: several tables on one clock.

use mavwire_columns::align::{Method, align, clock_of, span_of, values_of, widest_gap};
use mavwire_columns::arrow::array::RecordBatch;
use mavwire_columns::arrow::error::ArrowError;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::python::error::Result;
use crate::python::lists::list;
use crate::tables::dates::jump_text;
use crate::tables::table::RecordBatches;

/// Values of an aligned table at most, some 4 GiB: what a mistaken rate, or a log made for it, may cost.
const MOST_VALUES: u64 = 1 << 29;

/// What ticks.
enum Clock {
    Table(RecordBatch),
    /// Microseconds between ticks.
    Step(i64),
}

impl Clock {
    fn ticks(&self, tables: &[(String, RecordBatch)]) -> Result<Vec<i64>, ArrowError> {
        let step = match self {
            Self::Table(table) => {
                let ticks = clock_of(table)?;
                check_size(ticks.len() as u64, tables)?;
                return Ok(ticks);
            }
            Self::Step(step) => *step,
        };
        let Some((first, last)) = span_of(tables)? else { return Ok(Vec::new()) };
        let count = last.saturating_sub(first) / step;
        check_size(count.unsigned_abs() + 1, tables)?;
        Ok((0..=count).map(|n| first + n * step).collect())
    }
}

fn check_size(ticks: u64, tables: &[(String, RecordBatch)]) -> Result<(), ArrowError> {
    let values = values_of(tables) as u64;
    if ticks.saturating_mul(values) <= MOST_VALUES {
        return Ok(());
    }
    let seconds = |time: i64| time as f64 * 1e-6;
    let gap = widest_gap(tables)?;
    let jump = gap.and_then(|(before, after)| jump_text(seconds(before), seconds(after)));
    let cause = jump.unwrap_or_else(|| "choose a longer rate or fewer types and fields".to_owned());
    let text = format!(
        "a clock of {ticks} ticks with {values} values at each is more than {MOST_VALUES} values: {cause}"
    );
    Err(ArrowError::InvalidArgumentError(text))
}

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
    let aligned =
        py.detach(|| align(&tables, clock.ticks(&tables)?, method, tolerance.unwrap_or(u64::MAX)))?;
    Ok(RecordBatches::new(aligned.schema(), vec![aligned]))
}
