//! The answers of ports.

use pyo3::exceptions::{PyOSError, PyOverflowError, PyValueError};
use pyo3::prelude::*;

/// What came of asking a port: `Err` is not the port's own.
pub(crate) type Answer<'py> = PyResult<PyResult<Bound<'py, PyAny>>>;

pub(crate) fn own_errors<'py>(py: Python<'py>, answer: PyResult<Bound<'py, PyAny>>) -> Answer<'py> {
    match answer {
        Err(error)
            if !error.is_instance_of::<PyOSError>(py)
                && !error.is_instance_of::<PyValueError>(py)
                && !error.is_instance_of::<PyOverflowError>(py) =>
        {
            Err(error)
        }
        answer => Ok(answer),
    }
}
