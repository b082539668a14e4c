//! Replacements of `mavutil.time` and `mavutil.add_message` by a program.
//!
//! Links are fast because they call neither as long as there is no replacement here.

use std::sync::OnceLock;

use mavwire_io::clock::unix_seconds;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::python::calling::Calling;
use crate::sync::slot::Slot;

/// `mavutil.time`
static TIME: Slot = Slot::new();
/// `mavutil.add_message`
static ADD_MESSAGE: Slot = Slot::new();

/// The namespace of the module `time`, and `time.time` as it was when mavwire was loaded.
static TIME_MODULE: OnceLock<(Py<PyDict>, Py<PyAny>)> = OnceLock::new();

/// Makes links use a replacement of `mavutil.time` or `mavutil.add_message`; None restores the original.
#[pyfunction]
pub(crate) fn replace_function(name: &str, value: Option<Py<PyAny>>) -> PyResult<()> {
    match name {
        "time" => TIME.set(value),
        "add_message" => ADD_MESSAGE.set(value),
        _ => {
            return Err(PyValueError::new_err(format!(
                "{name} cannot be replaced: use 'time' or 'add_message'"
            )));
        }
    }
    Ok(())
}

fn time_module(py: Python<'_>) -> PyResult<&(Py<PyDict>, Py<PyAny>)> {
    if let Some(found) = TIME_MODULE.get() {
        return Ok(found);
    }
    let name = intern!(py, "time");
    let module = py.import(name)?;
    let function = module.getattr(name)?;
    let names = module.getattr(intern!(py, "__dict__"))?.cast_into::<PyDict>()?;
    Ok(TIME_MODULE.get_or_init(|| (names.unbind(), function.unbind())))
}

/// Remembers the system's clock before a program can replace it.
pub(crate) fn prepare(py: Python<'_>) -> PyResult<()> {
    time_module(py).map(drop)
}

/// Seconds since 1970 by the program's clock: the program may have replaced `mavutil.time` or `time.time`.
#[inline]
pub(crate) fn now(py: Python<'_>) -> PyResult<f64> {
    let (names, original) = time_module(py)?;
    let name = intern!(py, "time");
    let function = match TIME.get(py) {
        Some(replaced) => replaced.getattr(name)?,
        None => names.bind(py).get_item(name)?.unwrap_or_else(|| original.bind(py).clone()),
    };
    if function.is(original) { Ok(unix_seconds()) } else { function.invoke1(())?.extract() }
}

/// The program's own `mavutil.add_message`.
#[inline]
pub(crate) fn add_message(py: Python<'_>) -> Option<Bound<'_, PyAny>> {
    ADD_MESSAGE.get(py)
}
