//! `Link`: the part of a mavfile's state that every message changes. `mavutil.mavfile` derives from it.
//!
//! One lock guards all of it and is taken once per message: a lock costs as much as decoding three fields. No
//! Python code runs while it is held.

use mavwire_core::telemetry::{Reception, Room};
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList, PyType};

use crate::link::system::Systems;
use crate::message::object::{Message, Origin};
use crate::protocol::mavlink::{MAVLink, overridden};
use crate::python::error::Result;
use crate::python::own_methods::OwnMethods;
use crate::sync::lock::{Guard, Lock};
use mavwire_io::log_reader::LogReader;

/// Methods of links that native code does not call, unless a program replaced one.
pub(super) const QUICK_METHODS: [&str; 7] = [
    "recv",
    "recv_msg",
    "pre_message",
    "post_message",
    "auto_mavlink_version",
    "select",
    "skip_to_type",
];

/// The state that every message changes.
#[derive(Default)]
pub(crate) struct LinkState {
    pub(super) mav: Option<Py<PyAny>>,
    /// `mav`, if it is what it should be.
    pub(crate) native_mav: Option<Py<MAVLink>>,
    pub(crate) sysid_state: Option<Py<PyDict>>,
    pub(crate) systems: Systems,
    pub(super) message_hooks: Option<Py<PyAny>>,
    pub(crate) reception: Reception,
    /// Room for names that senders choose.
    pub(crate) room: Room,
    /// The first byte has told the protocol version.
    pub(crate) knows_version: bool,
    /// Messages are written to it.
    pub(super) logfile: Option<Py<PyAny>>,
    /// Received bytes are written to it.
    pub(super) logfile_raw: Option<Py<PyAny>>,
    /// The log being read, if the link is one.
    pub(crate) reader: Option<Box<LogReader>>,
    /// System and message index of the log's last message, if that was a plain one.
    pub(crate) last_fresh: Option<(u8, u16)>,
    /// The log's last message, if that was another one.
    pub(crate) last: Option<Py<Message>>,
    /// Where the log's last message began, in percent.
    pub(crate) percent: f64,
}

impl LinkState {
    /// Received bytes have to be shown to `mav`: it is none of ours, or what takes them was replaced, which may happen at
    /// any time.
    pub(crate) fn has_own_parser(&self) -> bool {
        self.native_mav.as_ref().is_none_or(|mav| mav.get().is_overridden(overridden::PARSER))
    }

    /// The link is a log that native code can read: nothing is recorded, and the parser is ours.
    pub(crate) fn reads_log(&self) -> bool {
        self.reader.is_some() && !self.is_recording() && !self.has_own_parser()
    }

    /// Something is written for every message received.
    pub(crate) fn is_recording(&self) -> bool {
        self.logfile.is_some() || self.logfile_raw.is_some()
    }

    /// Takes the time from a message of a raw stream that a program parsed itself.
    pub(super) fn hear_raw(&mut self, message: &Message) {
        if let (Some(reader), Some(mav), Some(info)) =
            (self.reader.as_mut(), self.native_mav.as_ref(), message.info)
            && let registry = &mav.get().dialect.get().registry
            && let Some(entry) = registry.lookup(info.definition.id)
        {
            reader.hear_raw(registry, entry.index, &message.frame);
            self.reception.record_time = Some(reader.time);
        }
    }

    /// Ends the log record that `message` came from. Returns the number of its link, `None` on live links.
    pub(super) fn end_record(&mut self, message: &Message) -> Option<u8> {
        let reader = self.reader.as_mut()?;
        // A frame that signing rejected is BAD_DATA too.
        reader.end_record(message.origin == Origin::Bad);
        Some(reader.link)
    }

    /// Hooks are to be called.
    pub(crate) fn has_hooks(&self, py: Python<'_>) -> bool {
        self.message_hooks.as_ref().is_some_and(|hooks| {
            hooks.bind(py).cast_exact::<PyList>().map_or(true, |list| !list.is_empty())
        })
    }
}

/// State of one link that is touched for every message.
#[pyclass(frozen, subclass, module = "mavwire._native")]
pub(crate) struct Link {
    pub(super) state: Lock<LinkState>,
    /// Those of `QUICK_METHODS`.
    pub(super) methods: OwnMethods,
}

impl Link {
    pub(crate) fn new(methods: OwnMethods) -> Self {
        Self { state: Lock::new(LinkState::default()), methods }
    }

    /// A link of `class`, which native code can read.
    pub(crate) fn of_class(class: &Bound<'_, PyType>) -> PyResult<Self> {
        Ok(Self::new(OwnMethods::of_class(&QUICK_METHODS, class)?))
    }

    /// Native code reads without calling the methods of the link.
    #[inline]
    pub(crate) fn is_quick(&self) -> bool {
        self.methods.are_intact()
    }

    pub(crate) fn state(&self) -> Guard<'_, LinkState> {
        // SAFETY: links are Python objects, whose methods run attached.
        self.state.lock(unsafe { Python::assume_attached() })
    }

    /// Puts a Python object in place of another, which is dropped after the lock is released.
    pub(super) fn replace<T>(
        &self,
        value: Option<Py<T>>,
        place: impl FnOnce(&mut LinkState) -> &mut Option<Py<T>>,
    ) {
        let old = std::mem::replace(place(&mut self.state()), value);
        drop(old);
    }

    /// Does something with the reader of a log; `None` while no log is open for reading.
    pub(crate) fn with_reader<T>(
        &self,
        act: impl FnOnce(&mut LogReader) -> std::io::Result<T>,
    ) -> Result<Option<T>> {
        Ok(self.state().reader.as_mut().map(|reader| act(reader)).transpose()?)
    }

    /// The `MAVLink` object; `RuntimeError` if there is none of ours.
    pub(crate) fn mav<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, MAVLink>> {
        let mav = self.state().native_mav.as_ref().map(|mav| mav.bind(py).clone());
        mav.ok_or_else(|| PyRuntimeError::new_err("the link has no MAVLink object"))
    }
}
