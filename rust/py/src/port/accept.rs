//! Accepting clients, which no signal handler interrupts.
//!
//! `socket.accept` is written in Python: a handler that raises in it, between the system's answer and the socket that is made
//! of it, would leave the client connected to nobody.

use pyo3::prelude::*;

use crate::python::calling::{Calling, Known};

static SOCKET: Known = Known::new("socket", "socket");
static NATIVE_SOCKET: Known = Known::new("_socket", "socket");
static CLOSE: Known = Known::new("_socket", "close");

/// The socket of the next client of `listener`; as `accept`, what the system says otherwise.
#[pyfunction]
pub(crate) fn accept<'py>(listener: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
    let py = listener.py();
    if !listener.get_type().is(SOCKET.get(py)?) {
        return listener.invoke_method0(intern!(py, "accept"))?.get_item(0);
    }
    let accept = NATIVE_SOCKET.get(py)?.getattr(intern!(py, "_accept"))?;
    let (fd, _): (Bound<'py, PyAny>, Bound<'py, PyAny>) = accept.invoke1((listener,))?.extract()?;
    socket_of(listener, &fd).or_else(|error| {
        CLOSE.get(py)?.invoke1((fd,))?;
        Err(error)
    })
}

/// The socket of a descriptor that was accepted; no Python code runs here.
fn socket_of<'py>(
    listener: &Bound<'py, PyAny>,
    fd: &Bound<'py, PyAny>,
) -> PyResult<Bound<'py, PyAny>> {
    let py = listener.py();
    let (class, native) = (SOCKET.get(py)?, NATIVE_SOCKET.get(py)?);
    let of_listener =
        |name| native.getattr(name)?.invoke_method1(intern!(py, "__get__"), (listener,));
    let family = of_listener(intern!(py, "family"))?;
    let kind = of_listener(intern!(py, "type"))?;
    let protocol = of_listener(intern!(py, "proto"))?;
    let port = class.invoke_method1(intern!(py, "__new__"), (class,))?;
    port.setattr(intern!(py, "_io_refs"), 0)?;
    port.setattr(intern!(py, "_closed"), false)?;
    native.getattr(intern!(py, "__init__"))?.invoke1((&port, family, kind, protocol, fd))?;
    Ok(port)
}
