//! `LiveLink`: a link over a socket, a serial port or a pipe. The classes of `mavwire.links` derive from it.
//!
//! Native code reads and waits as long as no program replaced a method of the link or the parser, and no bytes
//! are recorded. Python does what is not simply data: the end of a stream, or a connection to accept. See
//! [`crate::link::receive`].

use mavwire_io::address::Address;
use pyo3::prelude::*;
use pyo3::types::PyType;

use crate::link::state::Link;
use crate::port::peers::to_python;
use crate::port::stream_writer::StreamWriter;
use crate::protocol::mavlink::MAVLink;
use crate::python::calling::Calling;
use crate::sync::lock::{Guard, Lock};
use crate::sync::slot::Slot;
use mavwire_io::live_source::{LiveSource, Transport};

/// Where the classes of ports are defined that are read natively.
const PLAIN_PORTS: [&str; 3] = ["socket", "_io", "serial.serialposix"];

/// A link that reads a descriptor.
#[pyclass(frozen, subclass, extends = Link, module = "mavwire._native")]
pub(crate) struct LiveLink {
    pub(super) source: Lock<LiveSource>,
    /// The class of port that was seen to be a plain one.
    pub(super) plain_port: Slot<PyType>,
    /// The writer of a stream link.
    pub(super) writer: Slot<StreamWriter>,
}

impl LiveLink {
    pub(crate) fn source(&self) -> Guard<'_, LiveSource> {
        // SAFETY: links are Python objects, whose methods run attached.
        self.source.lock(unsafe { Python::assume_attached() })
    }

    /// Bytes wait to be sent. Python sends them when it receives.
    pub(super) fn has_unsent(&self, py: Python<'_>) -> bool {
        self.writer.get(py).is_some_and(|writer| writer.get().is_waiting(py))
    }

    /// Native code can read the link: the parser is ours, no bytes are recorded or wait to be sent.
    pub(super) fn is_quick(slf: &Bound<'_, Self>) -> bool {
        let link = slf.as_super().get();
        let state = link.state();
        let source = slf.get().source();
        link.is_quick()
            && source.transport != Transport::Foreign
            && !slf.get().has_unsent(slf.py())
            && state.logfile_raw.is_none()
            && !state.has_own_parser()
            && state.knows_version
    }

    /// Reading the descriptor of `port` is all that reading it does: no TLS socket, nothing of the user's own.
    fn is_plain_port(slf: &Bound<'_, Self>, port: &Bound<'_, PyAny>) -> bool {
        let class = port.get_type();
        let this = slf.get();
        if this.plain_port.get(slf.py()).is_some_and(|known| known.is(&class)) {
            return true;
        }
        let module = class.module().map(|name| name.to_string_lossy().into_owned());
        let plain = module.is_ok_and(|name| PLAIN_PORTS.contains(&name.as_str()));
        if plain {
            this.plain_port.set(Some(class.unbind()));
        }
        plain
    }

    /// The descriptor of `port`, while that is an open socket, serial port or pipe.
    pub(crate) fn descriptor(slf: &Bound<'_, Self>) -> Option<i32> {
        let py = slf.py();
        let port = slf.getattr(intern!(py, "port")).ok()?;
        if port.is_none() || !Self::is_plain_port(slf, &port) {
            return None;
        }
        let fd = port.invoke_method0(intern!(py, "fileno")).ok()?.extract::<i32>().ok()?;
        (fd >= 0).then_some(fd)
    }

    /// Nothing waits, and the socket was empty when it was read last.
    pub(crate) fn is_drained(slf: &Bound<'_, Self>) -> bool {
        let state = slf.as_super().get().state();
        let source = slf.get().source();
        let empty = |mav: &Py<MAVLink>| mav.get().parser().unread().is_empty();
        source.drained && source.inbox.is_empty() && state.native_mav.as_ref().is_some_and(empty)
    }

    /// Announces a peer. `sent_message`: it has sent a valid message. `is_targeted`: that message has a target system.
    pub(crate) fn announce(
        slf: &Bound<'_, Self>,
        address: Address,
        sent_message: bool,
        is_targeted: bool,
    ) -> PyResult<()> {
        let py = slf.py();
        let shown = to_python(py, address)?;
        slf.setattr(intern!(py, "last_address"), &shown)?;
        if sent_message {
            slf.invoke_method1(intern!(py, "_heard"), (shown, is_targeted))?;
        }
        Ok(())
    }
}
