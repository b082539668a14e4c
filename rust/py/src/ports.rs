//! Ports as links use them: what they answer, and whether an error is theirs or a signal handler's, is known to whoever
//! called them, since no handler runs in between.

use std::io;
use std::sync::OnceLock;
use std::time::Duration;

use mavwire_link::bytes::{read_some, write_some};
use mavwire_link::readiness;
use pyo3::create_exception;
use pyo3::exceptions::{
    PyBlockingIOError, PyBrokenPipeError, PyConnectionAbortedError, PyException,
    PyInterruptedError, PyOSError, PyOverflowError, PyValueError,
};
use pyo3::gc::{PyTraverseError, PyVisit};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyString, PyTuple};

use crate::calling::{Calling, Known, import};
use crate::thread_lock::ThreadLock;

/// The same number on all systems.
const EPIPE: i32 = 32;

static STRERROR: Known = Known::new("os", "strerror");

create_exception!(
    mavwire._native,
    PortError,
    PyException,
    "`PortError(error)`: what a port raised itself, and no signal handler did meanwhile."
);

/// `port.name(*args)`; `None` where it would have to wait. Its own errors come as `PortError`.
#[pyfunction]
#[pyo3(signature = (port, name, *args))]
pub(crate) fn ask_port<'py>(
    port: &Bound<'py, PyAny>,
    name: &Bound<'py, PyString>,
    args: Bound<'py, PyTuple>,
) -> PyResult<Option<Bound<'py, PyAny>>> {
    let answer = match port.cast::<TlsPort>() {
        Ok(tls) => tls.get().act(name, args)?,
        Err(_) => own_errors(port.py(), port.invoke_method1(name, args))?,
    };
    judged(port.py(), answer)
}

/// `one.name(*args)`, whose own errors come as `PortError`.
#[pyfunction]
#[pyo3(signature = (one, name, *args))]
pub(crate) fn ask<'py>(
    one: &Bound<'py, PyAny>,
    name: &Bound<'py, PyString>,
    args: Bound<'py, PyTuple>,
) -> PyResult<Bound<'py, PyAny>> {
    own_errors(one.py(), one.invoke_method1(name, args))?
        .map_err(|error| PortError::new_err((error,)))
}

/// `port.send(data)` as `ask_port` does it.
pub(crate) fn send<'py>(
    port: &Bound<'py, PyAny>,
    data: &Bound<'py, PyAny>,
) -> PyResult<Option<Bound<'py, PyAny>>> {
    let (py, name) = (port.py(), intern!(port.py(), "send"));
    let answer = match port.cast::<TlsPort>() {
        Ok(tls) => tls.get().act(name, (data,))?,
        Err(_) => own_errors(py, port.invoke_method_with(name, data))?,
    };
    judged(py, answer)
}

/// What came of asking a port: `Err` is not the port's own.
type Answer<'py> = PyResult<PyResult<Bound<'py, PyAny>>>;

fn own_errors<'py>(py: Python<'py>, answer: PyResult<Bound<'py, PyAny>>) -> Answer<'py> {
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

fn judged<'py>(
    py: Python<'py>,
    answer: PyResult<Bound<'py, PyAny>>,
) -> PyResult<Option<Bound<'py, PyAny>>> {
    match answer {
        Ok(answer) => Ok(Some(answer)),
        Err(error)
            if error.is_instance_of::<PyBlockingIOError>(py)
                || error.is_instance_of::<PyInterruptedError>(py) =>
        {
            Ok(None)
        }
        Err(error) => Err(PortError::new_err((error,))),
    }
}

/// A file, pipe or serial port of this system to use as a socket: it takes what there is room for.
#[pyclass(frozen, module = "mavwire._native")]
pub(crate) struct DescriptorPort {
    file: Py<PyAny>,
    /// It has its descriptor as an attribute, as pyserial's ports do: signal handlers run in their `fileno`, which is
    /// written in Python.
    has_fd: bool,
}

#[pymethods]
impl DescriptorPort {
    #[new]
    fn new(file: Bound<'_, PyAny>) -> PyResult<Self> {
        let has_fd = file.attribute_opt(intern!(file.py(), "fd"))?.is_some();
        Ok(Self { file: file.unbind(), has_fd })
    }

    /// How many of the bytes it took.
    fn send(&self, data: &Bound<'_, PyBytes>) -> PyResult<usize> {
        let py = data.py();
        // Python's own functions run signal handlers where a signal interrupts them.
        write_some(self.descriptor(py)?, data.as_bytes()).map_err(|error| failed(py, &error))
    }

    /// Up to `n` bytes.
    fn recv<'py>(&self, py: Python<'py>, n: usize) -> PyResult<Bound<'py, PyBytes>> {
        let fd = self.descriptor(py)?;
        // Serial ports give nothing both where there is nothing and where they are gone.
        if let Ok(false) = readiness::ready(fd, false, Duration::ZERO) {
            return Err(PyBlockingIOError::new_err("nothing to read"));
        }
        let data = read_some(fd, n).map_err(|error| failed(py, &error))?;
        if data.is_empty() { Err(broken()) } else { Ok(PyBytes::new(py, &data)) }
    }

    fn __traverse__(&self, visit: PyVisit<'_>) -> Result<(), PyTraverseError> {
        visit.call(&self.file)
    }
}

impl DescriptorPort {
    fn descriptor(&self, py: Python<'_>) -> PyResult<i32> {
        let file = self.file.bind(py);
        let fd = if self.has_fd {
            file.attribute(intern!(py, "fd"))?.extract()?
        } else {
            match file.invoke_method0(intern!(py, "fileno")) {
                Err(error) if error.is_instance_of::<PyValueError>(py) => None,
                fd => Some(fd?.extract::<i32>()?),
            }
        };
        fd.ok_or_else(broken)
    }
}

/// The error of the system with a `number`.
pub(crate) fn os_error(py: Python<'_>, number: i32) -> PyErr {
    match STRERROR.get(py).and_then(|strerror| strerror.invoke1((number,))) {
        Ok(text) => PyOSError::new_err((number, text.unbind())),
        Err(error) => error,
    }
}

fn failed(py: Python<'_>, error: &io::Error) -> PyErr {
    error.raw_os_error().map_or_else(broken, |number| os_error(py, number))
}

fn broken() -> PyErr {
    PyBrokenPipeError::new_err((EPIPE, "Broken pipe"))
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
        args: impl IntoPyObject<'py, Target = PyTuple>,
    ) -> Answer<'py> {
        let py = name.py();
        let guard = self.lock.lock(py)?;
        if guard.is_inherited() {
            let _ = self.torn.set("the TLS connection is the parent process's");
        }
        if let Some(&reason) = self.torn.get() {
            return Ok(Err(PyConnectionAbortedError::new_err(reason)));
        }
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
    let number = error.value(py).attribute_opt(intern!(py, "errno"));
    error.is_instance_of::<PyOSError>(py) && matches!(number, Ok(Some(number)) if !number.is_none())
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
        self.act(intern!(n.py(), "recv"), (n,))?
    }

    /// How many of the bytes it took.
    fn send<'py>(&self, data: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        self.act(intern!(data.py(), "send"), (data,))?
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
