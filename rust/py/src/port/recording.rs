//! The part of a frame that a recorded log may hold.

use std::borrow::Cow;

use mavwire_core::log::tlog;
use pyo3::prelude::*;
use pyo3::pybacked::PyBackedBytes;
use pyo3::types::PyBytes;

/// `frame` as a telemetry log may hold it: without signature, without a secret key. The same object where it has neither.
#[pyfunction]
pub(crate) fn recordable<'py>(frame: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
    let bytes: PyBackedBytes = frame.extract()?;
    Ok(match tlog::recordable(&bytes) {
        Cow::Borrowed(_) => frame.clone(),
        Cow::Owned(bytes) => PyBytes::new(frame.py(), &bytes).into_any(),
    })
}
