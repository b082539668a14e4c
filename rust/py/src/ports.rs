//! Ports that are written to as a socket: what they say they sent is known to whoever called them, since no signal handler
//! runs in between.

use std::sync::OnceLock;

use pyo3::exceptions::{
    PyBlockingIOError, PyBrokenPipeError, PyConnectionAbortedError, PyOSError, PyValueError,
};
use pyo3::gc::{PyTraverseError, PyVisit};
use pyo3::prelude::*;
use pyo3::types::PyString;

use crate::calling::{Calling, Known, import};
use crate::thread_lock::ThreadLock;

/// The same number on all systems.
const EPIPE: i32 = 32;

static WRITE: Known = Known::new("os", "write");

/// A file, pipe or serial port of this system to write to as a socket: it takes what there is room for.
#[pyclass(frozen, module = "mavwire._native")]
pub(crate) struct DescriptorPort {
    file: Py<PyAny>,
}

#[pymethods]
impl DescriptorPort {
    #[new]
    fn new(file: Py<PyAny>) -> Self {
        Self { file }
    }

    /// How many of the bytes it took.
    fn send<'py>(&self, data: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        let py = data.py();
        let fd = self.file.bind(py).invoke_method0(intern!(py, "fileno")).map_err(|error| {
            let is_closed = error.is_instance_of::<PyValueError>(py);
            if is_closed { PyBrokenPipeError::new_err((EPIPE, "Broken pipe")) } else { error }
        })?;
        WRITE.get(py)?.invoke1((fd, data))
    }

    fn __traverse__(&self, visit: PyVisit<'_>) -> Result<(), PyTraverseError> {
        visit.call(&self.file)
    }
}

/// A TLS connection as the non-blocking socket that links read and write. Waiting for the peer is no error of its own kind,
/// and several threads may use it, which OpenSSL does not allow.
#[pyclass(frozen, module = "mavwire._native")]
pub(crate) struct TlsPort {
    port: Py<PyAny>,
    /// A signal handler may write in the middle of a read.
    lock: ThreadLock,
    /// Why nobody knows what was sent or received.
    torn: OnceLock<&'static str>,
}

impl TlsPort {
    fn act<'py>(
        &self,
        name: &Bound<'py, PyString>,
        argument: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let py = name.py();
        let guard = self.lock.lock(py)?;
        if guard.is_inherited() {
            let _ = self.torn.set("the TLS connection is the parent process's");
        }
        if let Some(&reason) = self.torn.get() {
            return Err(PyConnectionAbortedError::new_err(reason));
        }
        let done = self.port.bind(py).invoke_method_with(name, argument);
        done.map_err(|error| self.judged(py, error))
    }

    fn judged(&self, py: Python<'_>, error: PyErr) -> PyErr {
        if !error.is_instance_of::<PyOSError>(py) {
            let _ = self.torn.set("the TLS connection was interrupted by a signal");
            return error;
        }
        match waits_for_peer(py, &error) {
            Ok(true) => {
                let waits = PyBlockingIOError::new_err("TLS waits for the peer");
                waits.set_cause(py, Some(error));
                waits
            }
            Ok(false) => error,
            Err(error) => error,
        }
    }
}

fn waits_for_peer(py: Python<'_>, error: &PyErr) -> PyResult<bool> {
    let ssl = import(py, intern!(py, "ssl"))?;
    let names = [intern!(py, "SSLWantReadError"), intern!(py, "SSLWantWriteError")];
    for name in names {
        if error.is_instance(py, &ssl.attribute(name)?) {
            return Ok(true);
        }
    }
    Ok(false)
}

#[pymethods]
impl TlsPort {
    #[new]
    fn new(port: Py<PyAny>) -> Self {
        Self { port, lock: ThreadLock::new(), torn: OnceLock::new() }
    }

    /// Up to `n` bytes.
    fn recv<'py>(&self, n: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        self.act(intern!(n.py(), "recv"), n)
    }

    /// How many of the bytes it took.
    fn send<'py>(&self, data: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        self.act(intern!(data.py(), "send"), data)
    }

    fn fileno<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.port.bind(py).invoke_method0(intern!(py, "fileno"))
    }

    fn close<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.port.bind(py).invoke_method0(intern!(py, "close"))
    }

    fn setblocking<'py>(&self, flag: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        self.port.bind(flag.py()).invoke_method_with(intern!(flag.py(), "setblocking"), flag)
    }

    fn __traverse__(&self, visit: PyVisit<'_>) -> Result<(), PyTraverseError> {
        visit.call(&self.port)
    }
}
