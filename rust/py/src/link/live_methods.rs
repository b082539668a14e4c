//! The Python methods of `LiveLink`.

use pyo3::exceptions::PyAttributeError;
use pyo3::gc::{PyTraverseError, PyVisit};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyTuple};

use crate::link::live_link::LiveLink;
use crate::link::state::Link;
use crate::port::peers::{from_python, to_python};
use crate::port::ports::{close_port, os_error};
use crate::port::stream_writer::StreamWriter;
use crate::protocol::mavlink::MAVLink;
use crate::python::own_methods::OwnMethods;
use crate::sync::lock::Lock;
use crate::sync::slot::Slot;
use mavwire_io::live_source::{LiveSource, Transport};

new! {
    LiveLink: |cls| -> PyResult<PyClassInitializer<Self>> {
        let link = Self {
            source: Lock::new(LiveSource::default()),
            plain_port: Slot::new(),
            writer: Slot::new(),
        };
        let base = if cfg!(unix) { Link::of_class(cls)? } else { Link::new(OwnMethods::none()) };
        Ok(PyClassInitializer::from(base).add_subclass(link))
    }
}

#[pymethods]
impl LiveLink {
    fn __traverse__(&self, visit: PyVisit<'_>) -> Result<(), PyTraverseError> {
        self.writer.traverse(visit)?;
        self.plain_port.traverse(visit)
    }

    fn __clear__(&self) {
        self.plain_port.set(None);
        self.writer.set(None);
    }

    /// From now on `port` may be read natively, as a stream. Servers for one client at a time look after it while nothing
    /// arrives.
    #[pyo3(signature = (serves_one = false))]
    fn _read_stream(&self, serves_one: bool) {
        let mut source = self.source();
        source.transport = Transport::Stream;
        source.serves_one = serves_one;
    }

    /// From now on `port` may be read natively, as datagrams. Those from `own` address are left out.
    #[pyo3(signature = (own = None))]
    fn _read_datagrams(&self, own: Option<&Bound<'_, PyAny>>) {
        let own = own.and_then(from_python);
        self.source().transport = Transport::Datagrams(own);
    }

    /// Raises the error with which reading the connection natively ended; the system does not say it again.
    fn _raise_read_error(&self, py: Python<'_>) -> PyResult<()> {
        let number = self.source().read_error.take();
        number.map_or(Ok(()), |number| Err(os_error(py, number)))
    }

    /// The writer of a stream link.
    #[getter(_writer)]
    fn get_writer<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, StreamWriter>> {
        self.writer.get(py).ok_or_else(|| PyAttributeError::new_err("_writer"))
    }
    #[setter(_writer)]
    fn set_writer(&self, value: Bound<'_, StreamWriter>) {
        self.writer.set(Some(value.unbind()));
    }

    /// Closes the connection `port`, and waits on `fd` from then on. Bytes that wait to be sent and the start of a frame are
    /// dropped. False if that was done before.
    fn _end_connection(
        slf: &Bound<'_, Self>,
        port: &Bound<'_, PyAny>,
        fd: Option<i32>,
    ) -> PyResult<bool> {
        let py = slf.py();
        if port.is_none() || !slf.getattr(intern!(py, "port"))?.is(port) {
            return Ok(false);
        }
        // Dropped when the link has no port any more.
        let _before = slf.get().get_writer(py)?.get().end(port);
        slf.as_super().get().drop_partial();
        slf.get().source().read_error = None;
        slf.setattr(intern!(py, "fd"), fd)?;
        slf.setattr(intern!(py, "port"), py.None())?;
        close_port(port)?;
        Ok(true)
    }

    /// Whether data that was read ahead is buffered. The descriptor does not show such data.
    #[getter]
    fn _has_read_ahead(slf: &Bound<'_, Self>) -> bool {
        let state = slf.as_super().get().state();
        let waits = |mav: &Py<MAVLink>| mav.get().parser().may_hold_frame();
        !slf.get().source().inbox.is_empty() || state.native_mav.as_ref().is_some_and(waits)
    }

    /// A datagram that was read ahead, or the rest of one, with its sender; None if there is none.
    fn _take_datagram<'py>(
        slf: &Bound<'py, Self>,
    ) -> PyResult<Option<(Bound<'py, PyBytes>, Bound<'py, PyTuple>)>> {
        let py = slf.py();
        let Some((bytes, from)) =
            slf.get().source().inbox.front().map(|(bytes, from)| (bytes.to_vec(), from))
        else {
            return Ok(None);
        };
        slf.get().source().inbox.advance(bytes.len());
        Ok(Some((PyBytes::new(py, &bytes), to_python(py, from)?)))
    }

    /// The next bytes come from `address`: bytes of another peer's frame are put aside.
    fn _switch_peer(slf: &Bound<'_, Self>, address: &Bound<'_, PyAny>) {
        let Some(from) = from_python(address) else { return };
        let state = slf.as_super().get().state();
        if let Some(mav) = &state.native_mav {
            let mut source = slf.get().source();
            source.peers.switch(&mut mav.get().parser(), from);
        }
    }
}

properties! {
    LiveLink:

    /// Bytes wait to be sent, so that receiving has to go through Python, which sends them.
    _has_unsent: bool = |link, py| (field link.has_unsent(py));
    /// Peers that had to make room for others.
    peers_forgotten: u64 = |link| (field link.source().peers.forgotten);
}
