//! `Section`: what only one thread may do at a time.

use pyo3::prelude::*;
use pyo3::types::PyTuple;

use crate::python::calling::Calling;
use crate::sync::thread_lock::ThreadLock;

/// A critical section. A thread may enter it again, and no fork or signal handler leaves it locked.
#[pyclass(frozen, module = "mavwire._native")]
pub(crate) struct Section {
    lock: ThreadLock,
}

#[pymethods]
impl Section {
    #[new]
    fn new() -> Self {
        Self { lock: ThreadLock::new() }
    }

    /// `act(*args)`, once no other thread is in the section.
    #[pyo3(signature = (act, *args))]
    fn run<'py>(
        &self,
        act: &Bound<'py, PyAny>,
        args: Bound<'py, PyTuple>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let _guard = self.lock.lock(act.py())?;
        act.invoke1(args)
    }
}
