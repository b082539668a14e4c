//! `Link`: the part of a mavfile's state that every message changes. `mavutil.mavfile` derives from it.
//!
//! All of it stands behind one lock that is taken once per message: a lock costs as much as decoding three fields. No
//! Python code runs while it is held.

use std::sync::atomic::{AtomicBool, Ordering::Relaxed};

use mavwire_core::telemetry::Reception;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList, PyString, PyType};

use crate::link::name_budget::{Budget, OWN_NAMES, SharedTables};
use crate::link::system::{Senders, SystemState};
use crate::log::reader::LogReader;
use crate::protocol::mavlink::{MAVLink, overridden};
use crate::python::calling::Calling;
use crate::sync::lock::{Guard, Lock};

/// What changes with every message.
pub(crate) struct LinkState {
    pub(super) mav: Option<Py<PyAny>>,
    /// `mav`, if it is what it should be.
    pub(crate) native_mav: Option<Py<MAVLink>>,
    pub(crate) sysid_state: Option<Py<PyDict>>,
    pub(crate) senders: Senders,
    pub(super) message_hooks: Option<Py<PyAny>>,
    pub(crate) reception: Reception,
    /// The protocol version is not known yet.
    pub(crate) first_byte: bool,
    pub(super) logfile: Option<Py<PyAny>>,
    pub(super) logfile_raw: Option<Py<PyAny>>,
    /// The log being read, if the link is one.
    pub(crate) reader: Option<Box<LogReader>>,
    /// System and message index of the log's last message, if that was a plain one.
    pub(crate) last_fresh: Option<(u8, u16)>,
    pub(crate) percent: f64,
}

impl LinkState {
    pub(super) fn new() -> Self {
        Self {
            mav: None,
            native_mav: None,
            sysid_state: None,
            senders: Senders::default(),
            message_hooks: None,
            reception: Reception::default(),
            first_byte: true,
            logfile: None,
            logfile_raw: None,
            reader: None,
            last_fresh: None,
            percent: 0.0,
        }
    }

    /// Received bytes have to be shown to `mav`: it is none of ours, or what takes them was replaced, which may happen at
    /// any time.
    pub(crate) fn has_own_parser(&self) -> bool {
        self.native_mav.as_ref().is_none_or(|mav| mav.get().is_overridden(overridden::PARSER))
    }

    /// Something is written for every message received.
    pub(crate) fn is_recording(&self) -> bool {
        self.logfile.is_some() || self.logfile_raw.is_some()
    }

    /// Something is written for every message.
    pub(crate) fn records_messages(&self) -> bool {
        self.logfile.is_some()
    }

    /// Something is written for every read.
    pub(crate) fn records_bytes(&self) -> bool {
        self.logfile_raw.is_some()
    }

    /// Hooks are to be called.
    pub(crate) fn has_hooks(&self, py: Python<'_>) -> bool {
        self.message_hooks.as_ref().is_some_and(|hooks| {
            hooks.bind(py).cast::<PyList>().map_or(true, |list| !list.is_empty())
        })
    }
}

/// State of one link that is touched for every message.
#[pyclass(frozen, subclass, module = "mavwire._native")]
pub(crate) struct Link {
    pub(super) state: Lock<LinkState>,
    /// Room for names that whoever sends has chosen.
    pub(crate) budget: Budget,
}

impl Link {
    pub(crate) fn empty() -> Self {
        Self { state: Lock::new(LinkState::new()), budget: Budget::default() }
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

    pub(crate) fn hooks<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyAny>> {
        self.state().message_hooks.as_ref().map(|hooks| hooks.bind(py).clone())
    }
}

impl SharedTables for Bound<'_, Link> {
    fn budget(&self) -> &Budget {
        &self.get().budget
    }

    fn shared_names(&self) -> PyResult<usize> {
        let py = self.py();
        let states = self.get().state().sysid_state.as_ref().map(|states| states.bind(py).clone());
        let mut total = 0;
        for (_, state) in states.iter().flatten() {
            let state = state.cast::<SystemState>()?.get();
            total += state.messages(py)?.len().saturating_sub(OWN_NAMES);
            total += state.components.shared_names(py)?;
        }
        Ok(total)
    }
}

/// True if `class` has its own version of a method that the fast path skips. `_quick_methods` of the class lists each method
/// with its class (None for `class` itself) and its original. A program may replace a method in a subclass or in our class.
pub(crate) fn overrides(class: &Bound<'_, PyType>) -> PyResult<bool> {
    let methods = class.attribute(intern!(class.py(), "_quick_methods"))?;
    for method in methods.items()? {
        let (owner, name, original): (
            Option<Bound<'_, PyAny>>,
            Bound<'_, PyString>,
            Bound<'_, PyAny>,
        ) = method?.extract()?;
        if !owner.as_ref().unwrap_or(class).attribute(name)?.is(&original) {
            return Ok(true);
        }
    }
    Ok(false)
}

/// Sets an attribute of a link; one of the `methods` that the quick paths stand for turns these off for good.
pub(crate) fn set_attr(
    link: &Bound<'_, PyAny>,
    name: &Bound<'_, PyString>,
    value: &Bound<'_, PyAny>,
    methods: &[&str],
    quick: &AtomicBool,
) -> PyResult<()> {
    if methods.contains(&name.to_str()?) {
        quick.store(false, Relaxed);
    }
    link.set_generic_attribute(name, Some(value))
}
