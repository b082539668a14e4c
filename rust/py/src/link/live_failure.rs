//! The error with which a native read ended. Systems hand it over once, so it is kept until Python asks for it.

use pyo3::gc::{PyTraverseError, PyVisit};
use pyo3::prelude::*;

use crate::port::ports::os_error;
use crate::sync::lock::Lock;

/// The port that was read, and the number of the error.
pub(crate) struct Failure(Lock<Option<(Py<PyAny>, i32)>>);

impl Failure {
    pub(crate) const fn none() -> Self {
        Self(Lock::new(None))
    }

    pub(crate) fn set(&self, port: Bound<'_, PyAny>, number: i32) {
        let py = port.py();
        let old = self.0.lock(py).replace((port.unbind(), number));
        drop(old);
    }

    fn take(&self, py: Python<'_>) -> Option<(Py<PyAny>, i32)> {
        self.0.lock(py).take()
    }

    pub(crate) fn clear(&self) {
        Python::attach(|py| drop(self.take(py)));
    }

    /// The error, if it is one of `port` and not of a connection before it.
    pub(crate) fn raise(&self, port: &Bound<'_, PyAny>) -> PyResult<()> {
        let py = port.py();
        match self.take(py) {
            Some((failed, number)) if failed.is(port) => Err(os_error(py, number)),
            _ => Ok(()),
        }
    }

    pub(crate) fn traverse(&self, visit: &PyVisit<'_>) -> Result<(), PyTraverseError> {
        // SAFETY: the garbage collector runs attached.
        match unsafe { self.0.try_lock() } {
            Some(failure) => visit.call(failure.as_ref().map(|(port, _)| port)),
            None => Ok(()),
        }
    }
}
