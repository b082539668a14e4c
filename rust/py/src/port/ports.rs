//! Ports as links use them.

use std::io;
use std::time::Duration;

use mavwire_io::bytes::{NO_SIGNAL, read_some, write_some};
use mavwire_io::readiness;
use pyo3::exceptions::{
    PyBlockingIOError, PyBrokenPipeError, PyInterruptedError, PyOSError, PyValueError,
};
use pyo3::gc::{PyTraverseError, PyVisit};
use pyo3::prelude::*;
use pyo3::types::PyBytes;

use crate::python::calling::{Calling, Known};

/// The same number on all systems.
const EPIPE: i32 = 32;

static STRERROR: Known = Known::new("os", "strerror");
static SOCKET: Known = Known::new("socket", "socket");

/// Closes a port. Where that is an error the system has let go of the descriptor all the same.
pub(crate) fn close_port(port: &Bound<'_, PyAny>) -> PyResult<()> {
    match port.invoke_method0(intern!(port.py(), "close")) {
        Err(error) if !error.is_instance_of::<PyOSError>(port.py()) => Err(error),
        _ => Ok(()),
    }
}

/// `port.send(data)`, or `None` where it would have to wait. A socket raises no SIGPIPE on Linux.
pub(crate) fn send<'py>(
    port: &Bound<'py, PyAny>,
    data: &Bound<'py, PyAny>,
) -> PyResult<Option<Bound<'py, PyAny>>> {
    let (py, name) = (port.py(), intern!(port.py(), "send"));
    let sent = if port.get_type().is(SOCKET.get(py)?) {
        port.invoke_method1(name, (data, NO_SIGNAL))
    } else {
        port.invoke_method_with(name, data)
    };
    match sent {
        Err(error)
            if error.is_instance_of::<PyBlockingIOError>(py)
                || error.is_instance_of::<PyInterruptedError>(py) =>
        {
            Ok(None)
        }
        sent => sent.map(Some),
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
        let has_fd = file.getattr_opt(intern!(file.py(), "fd"))?.is_some();
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
            file.getattr(intern!(py, "fd"))?.extract()?
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
