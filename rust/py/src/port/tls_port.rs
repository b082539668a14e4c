//! `TlsPort`: a TLS connection as a port of a link.

use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, Ordering::SeqCst};

use pyo3::exceptions::{PyBlockingIOError, PyConnectionAbortedError, PyOSError};
use pyo3::gc::{PyTraverseError, PyVisit};
use pyo3::prelude::*;
use pyo3::types::{PyString, PyTuple};

use crate::port::answer::Answer;
use crate::port::close_port::close;
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
    /// `port.name(*args)`
    pub(crate) fn act<'py>(
        &self,
        name: &Bound<'py, PyString>,
        args: impl IntoPyObject<'py, Target = PyTuple>,
    ) -> Answer<'py> {
        let answer = self.act_alone(name, args);
        if self.is_closed.load(SeqCst) {
            self.close_unless_used(name.py())?;
        }
        answer
    }

    /// Does not wait for who uses it: that one may wait for this thread.
    pub(crate) fn close_port(&self, py: Python<'_>) -> PyResult<()> {
        self.is_closed.store(true, SeqCst);
        self.close_unless_used(py)
    }

    fn close_unless_used(&self, py: Python<'_>) -> PyResult<()> {
        let Some(_turn) = self.using.take() else { return Ok(()) };
        close(self.port.bind(py))
    }

    fn act_alone<'py>(
        &self,
        name: &Bound<'py, PyString>,
        args: impl IntoPyObject<'py, Target = PyTuple>,
    ) -> Answer<'py> {
        let py = name.py();
        if self.using.free_after_fork() {
            let _ = self.torn.set("the TLS connection is the parent process's");
        }
        if self.is_closed.load(SeqCst) {
            let _ = self.torn.set("the TLS connection is closed");
        }
        if let Some(&reason) = self.torn.get() {
            return Ok(Err(PyConnectionAbortedError::new_err(reason)));
        }
        let Some(_turn) = self.using.take() else {
            return Ok(Err(PyBlockingIOError::new_err("another thread uses the TLS connection")));
        };
        match self.port.bind(py).invoke_method1(name, args) {
            Err(error) if waits_for_peer(py, &error)? => {
                let waits = PyBlockingIOError::new_err("TLS waits for the peer");
                waits.set_cause(py, Some(error));
                Ok(Err(waits))
            }
            Err(error) if is_of_system(py, &error) => Ok(Err(error)),
            Err(error) => {
                let _ = self.torn.set("the TLS connection was interrupted by a signal");
                Err(error)
            }
            answer => Ok(answer),
        }
    }
}

/// Signal handlers run inside of the methods of TLS sockets, but hardly any names a number of the system.
fn is_of_system(py: Python<'_>, error: &PyErr) -> bool {
    let number = error.value(py).getattr_opt(intern!(py, "errno"));
    error.is_instance_of::<PyOSError>(py) && matches!(number, Ok(Some(number)) if !number.is_none())
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
        self.act(intern!(n.py(), "recv"), (n,))?
    }

    /// How many of the bytes it took.
    fn send<'py>(&self, data: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        self.act(intern!(data.py(), "send"), (data,))?
    }

    fn fileno<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.port.bind(py).invoke_method0(intern!(py, "fileno"))
    }

    fn close(&self, py: Python<'_>) -> PyResult<()> {
        self.close_port(py)
    }

    fn setblocking<'py>(&self, flag: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        self.port.bind(flag.py()).invoke_method_with(intern!(flag.py(), "setblocking"), flag)
    }

    fn __traverse__(&self, visit: PyVisit<'_>) -> Result<(), PyTraverseError> {
        visit.call(&self.port)
    }
}
