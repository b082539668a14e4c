//! Ports as links use them. No signal handler runs between a call of a port and its answer, so that the caller knows
//! whether an error is the port's or a handler's.

use std::io;
use std::time::Duration;

use mavwire_io::bytes::{NO_SIGNAL, read_some, write_some};
use mavwire_io::readiness;
use pyo3::create_exception;
use pyo3::exceptions::{
    PyBlockingIOError, PyBrokenPipeError, PyException, PyInterruptedError, PyOSError, PyValueError,
};
use pyo3::gc::{PyTraverseError, PyVisit};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyString, PyTuple};

use crate::port::answer::own_errors;
use crate::port::close_port::close;
use crate::port::tls_port::TlsPort;
use crate::python::calling::{Calling, Known};

/// The same number on all systems.
const EPIPE: i32 = 32;

static STRERROR: Known = Known::new("os", "strerror");
static SOCKET: Known = Known::new("socket", "socket");

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

/// Closes a port. Where that is an error the system has let go of the descriptor all the same.
#[pyfunction]
pub(crate) fn close_port(port: &Bound<'_, PyAny>) -> PyResult<()> {
    match port.cast::<TlsPort>() {
        Ok(tls) => tls.get().close_port(port.py()),
        Err(_) => close(port),
    }
}

/// `port.send(data)` as `ask_port` does it, without arguments in a tuple. A socket gives no SIGPIPE.
pub(crate) fn send<'py>(
    port: &Bound<'py, PyAny>,
    data: &Bound<'py, PyAny>,
) -> PyResult<Option<Bound<'py, PyAny>>> {
    let (py, name) = (port.py(), intern!(port.py(), "send"));
    let answer = match port.cast::<TlsPort>() {
        Ok(tls) => tls.get().act(name, (data,))?,
        Err(_) if port.get_type().is(SOCKET.get(py)?) => {
            own_errors(py, port.invoke_method1(name, (data, NO_SIGNAL)))?
        }
        Err(_) => own_errors(py, port.invoke_method_with(name, data))?,
    };
    judged(py, answer)
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
