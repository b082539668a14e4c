//! `TlsPort`: a TLS connection as a port of a link.

use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, Ordering::SeqCst};

use pyo3::exceptions::{PyBlockingIOError, PyConnectionAbortedError};
use pyo3::gc::{PyTraverseError, PyVisit};
use pyo3::prelude::*;
use pyo3::types::PyString;

use crate::port::ports::close_port;
use crate::python::calling::Calling;
use crate::sync::exclusive::Exclusive;

/// A TLS connection as the non-blocking socket that links read and write. Waiting for the peer is no error of its own kind,
/// and several threads may use it, which OpenSSL does not allow.
#[pyclass(frozen, module = "mavwire._native")]
pub(crate) struct TlsPort {
    port: Py<PyAny>,
    /// A signal handler may write in the middle of a read.
    using: Exclusive,
    /// Why nobody knows what was sent or received.
    torn: OnceLock<&'static str>,
    /// Closed, or about to be by the thread that is in the middle of a call.
    is_closed: AtomicBool,
}

impl TlsPort {
    /// `port.name(argument)`
    fn act<'py>(
        &self,
        name: &Bound<'py, PyString>,
        argument: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let answer = self.act_alone(name, argument);
        if self.is_closed.load(SeqCst) {
            self.close_unless_used(name.py())?;
        }
        answer
    }

    fn close_unless_used(&self, py: Python<'_>) -> PyResult<()> {
        let Some(_turn) = self.using.take() else { return Ok(()) };
        close_port(self.port.bind(py))
    }

    fn act_alone<'py>(
        &self,
        name: &Bound<'py, PyString>,
        argument: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let py = name.py();
        if self.using.free_after_fork() {
            let _ = self.torn.set("the TLS connection is the parent process's");
        }
        if self.is_closed.load(SeqCst) {
            let _ = self.torn.set("the TLS connection is closed");
        }
        if let Some(&reason) = self.torn.get() {
            return Err(PyConnectionAbortedError::new_err(reason));
        }
        let Some(_turn) = self.using.take() else {
            return Err(PyBlockingIOError::new_err("another thread uses the TLS connection"));
        };
        match self.port.bind(py).invoke_method_with(name, argument) {
            Err(error) if waits_for_peer(py, &error)? => {
                let waits = PyBlockingIOError::new_err("TLS waits for the peer");
                waits.set_cause(py, Some(error));
                Err(waits)
            }
            Err(error) => {
                let _ = self.torn.set("the TLS connection was interrupted by an error");
                Err(error)
            }
            answer => answer,
        }
    }
}

fn waits_for_peer(py: Python<'_>, error: &PyErr) -> PyResult<bool> {
    let ssl = py.import(intern!(py, "ssl"))?;
    let names = [intern!(py, "SSLWantReadError"), intern!(py, "SSLWantWriteError")];
    for name in names {
        if error.is_instance(py, &ssl.getattr(name)?) {
            return Ok(true);
        }
    }
    Ok(false)
}

#[pymethods]
impl TlsPort {
    #[new]
    fn new(port: Py<PyAny>) -> Self {
        let is_closed = AtomicBool::new(false);
        Self { port, using: Exclusive::free(), torn: OnceLock::new(), is_closed }
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

    /// Does not wait for a thread that uses it: that one may wait for this thread.
    fn close(&self, py: Python<'_>) -> PyResult<()> {
        self.is_closed.store(true, SeqCst);
        self.close_unless_used(py)
    }

    fn setblocking<'py>(&self, flag: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        self.port.bind(flag.py()).invoke_method_with(intern!(flag.py(), "setblocking"), flag)
    }

    fn __traverse__(&self, visit: PyVisit<'_>) -> Result<(), PyTraverseError> {
        visit.call(&self.port)
    }
}
