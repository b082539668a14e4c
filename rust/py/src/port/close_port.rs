//! Closing ports, which no signal handler interrupts.
//!
//! Python's own sockets and pyserial's ports are closed by methods that are written in Python, in which signal handlers run.
//! One that raises there would leave the port open, or half closed with the number of a descriptor that may be somebody
//! else's by then. So what these methods do is done here.

use pyo3::exceptions::PyOSError;
use pyo3::prelude::*;
use pyo3::types::PyString;

use crate::port::answer::own_errors;
use crate::python::calling::{Calling, Known};

static CLOSE: Known = Known::new("os", "close");
static SOCKET: Known = Known::new("_socket", "socket");

/// What pyserial's ports hold open: the device, and pipes to interrupt those who wait for it.
const SERIAL_DESCRIPTORS: [&str; 5] =
    ["fd", "pipe_abort_read_r", "pipe_abort_read_w", "pipe_abort_write_r", "pipe_abort_write_w"];

/// Closes a port that is no `TlsPort`.
pub(crate) fn close(port: &Bound<'_, PyAny>) -> PyResult<()> {
    let py = port.py();
    let module = port.get_type().getattr(intern!(py, "__module__"))?;
    match module.cast::<PyString>().map(|name| name.to_string_lossy()).as_deref() {
        Ok("socket" | "ssl") => close_socket(port),
        Ok("serial.serialposix") => close_serial(port),
        _ => own_errors(py, port.invoke_method0(intern!(py, "close")))?.map(drop).or(Ok(())),
    }
}

/// Closes one of Python's own sockets, TLS or not.
fn close_socket(port: &Bound<'_, PyAny>) -> PyResult<()> {
    let py = port.py();
    port.setattr(intern!(py, "_closed"), true)?;
    if port.getattr_opt(intern!(py, "_sslobj"))?.is_some() {
        port.setattr(intern!(py, "_sslobj"), py.None())?;
    }
    let close = SOCKET.get(py)?.getattr(intern!(py, "close"))?;
    unless_of_system(py, close.invoke1((port,)))
}

fn close_serial(port: &Bound<'_, PyAny>) -> PyResult<()> {
    let py = port.py();
    port.setattr(intern!(py, "is_open"), false)?;
    // Otherwise its finalizer closes it once more, in Python code whose exceptions nobody gets.
    port.setattr(intern!(py, "__IOBase_closed"), true)?;
    for name in SERIAL_DESCRIPTORS {
        let name = PyString::new(py, name);
        if let Some(fd) = port.getattr_opt(&name)?
            && !fd.is_none()
        {
            port.setattr(&name, py.None())?;
            unless_of_system(py, CLOSE.get(py)?.invoke1((fd,)))?;
        }
    }
    Ok(())
}

fn unless_of_system(py: Python<'_>, answer: PyResult<Bound<'_, PyAny>>) -> PyResult<()> {
    match answer {
        Err(error) if !error.is_instance_of::<PyOSError>(py) => Err(error),
        _ => Ok(()),
    }
}
