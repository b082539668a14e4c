//! `Link`: the part of a mavfile's state that every message changes. `mavutil.mavfile` derives from it.
//!
//! All of it stands behind one lock that is taken once per message: a lock costs as much as decoding three fields. No
//! Python code runs while it is held.

use std::sync::atomic::{AtomicBool, Ordering::Relaxed};

use mavwire_core::sequence::SequenceTracker;
use pyo3::gc::{PyTraverseError, PyVisit};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyFloat, PyInt, PyList, PyString, PyTuple, PyType};

use crate::link::name_budget::Budget;
use crate::link::system::Senders;
use crate::link::tracking;
use crate::log::reader::LogReader;
use crate::message::object::Message;
use crate::protocol::mavlink::{MAVLink, overridden};
use crate::python::calling::{Calling, truth};
use crate::sync::lock::{Guard, Lock};

/// What changes with every message.
pub(crate) struct LinkState {
    mav: Option<Py<PyAny>>,
    /// `mav`, if it is what it should be.
    pub(crate) native_mav: Option<Py<MAVLink>>,
    pub(crate) sysid_state: Option<Py<PyDict>>,
    pub(crate) senders: Senders,
    message_hooks: Option<Py<PyAny>>,
    pub(crate) sequences: SequenceTracker,
    pub(crate) mav_loss: u64,
    pub(crate) mav_count: u64,
    /// Time of the last message; `None` before the first, which shows as the integer 0.
    pub(crate) timestamp: Option<f64>,
    pub(crate) uptime: f64,
    /// `_timestamp`: the time of the record being read, `None` on live links.
    pub(crate) record_time: Option<f64>,
    pub(crate) notimestamps: bool,
    /// The protocol version is not known yet.
    pub(crate) first_byte: bool,
    logfile: Option<Py<PyAny>>,
    logfile_raw: Option<Py<PyAny>>,
    /// The log being read, if the link is one.
    pub(crate) reader: Option<Box<LogReader>>,
    /// System and message index of the log's last message, if that was a plain one.
    pub(crate) last_fresh: Option<(u8, u16)>,
    pub(crate) percent: f64,
}

impl LinkState {
    fn new() -> Self {
        Self {
            mav: None,
            native_mav: None,
            sysid_state: None,
            senders: Senders::default(),
            message_hooks: None,
            sequences: SequenceTracker::new(),
            mav_loss: 0,
            mav_count: 0,
            timestamp: None,
            uptime: 0.0,
            record_time: None,
            notimestamps: false,
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

    /// Counts a message and the gap before it.
    pub(crate) fn count(&mut self, sysid: u8, compid: u8, seq: u8) {
        self.mav_loss += u64::from(self.sequences.observe(sysid, compid, seq));
        self.mav_count += 1;
    }

    /// The time that a message is stamped with; `None` for the clock.
    pub(crate) fn message_time(&self) -> Option<f64> {
        self.record_time.map(|time| if self.notimestamps { self.uptime } else { time })
    }
}

/// State of one link that is touched for every message.
#[pyclass(frozen, subclass, module = "mavwire._native")]
pub(crate) struct Link {
    state: Lock<LinkState>,
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
    fn replace<T>(
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

#[pymethods]
impl Link {
    #[new]
    #[pyo3(signature = (*_args, **_kwargs))]
    fn new(_args: &Bound<'_, PyTuple>, _kwargs: Option<&Bound<'_, PyDict>>) -> Self {
        Self::empty()
    }

    /// The `MAVLink` object of the current dialect.
    #[getter(mav)]
    fn get_mav(&self, py: Python<'_>) -> Option<Py<PyAny>> {
        self.state().mav.as_ref().map(|mav| mav.clone_ref(py))
    }
    #[setter(mav)]
    fn set_mav(&self, value: &Bound<'_, PyAny>) {
        let native = value.cast::<MAVLink>().ok().map(|mav| mav.clone().unbind());
        self.replace(native, |state| &mut state.native_mav);
        self.replace(Some(value.clone().unbind()), |state| &mut state.mav);
    }

    /// System id -> `mavfile_state`.
    #[getter(sysid_state)]
    fn get_sysid_state(&self, py: Python<'_>) -> Option<Py<PyDict>> {
        self.state().sysid_state.as_ref().map(|states| states.clone_ref(py))
    }
    #[setter(sysid_state)]
    fn set_sysid_state(&self, value: Bound<'_, PyDict>) {
        self.replace(Some(value.unbind()), |state| &mut state.sysid_state);
        crate::link::system::forget_states();
    }

    /// Functions called as `hook(link, message)` for every message.
    #[getter(message_hooks)]
    fn get_message_hooks<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyAny>> {
        self.hooks(py)
    }
    #[setter(message_hooks)]
    fn set_message_hooks(&self, value: Py<PyAny>) {
        self.replace(Some(value), |state| &mut state.message_hooks);
    }

    /// Messages received, radio status, BAD_DATA and UNKNOWN not counted.
    #[getter(mav_count)]
    fn get_mav_count(&self) -> u64 {
        self.state().mav_count
    }
    #[setter(mav_count)]
    fn set_mav_count(&self, value: u64) {
        self.state().mav_count = value;
    }

    /// Messages lost, by the gaps in sequence numbers.
    #[getter(mav_loss)]
    fn get_mav_loss(&self) -> u64 {
        self.state().mav_loss
    }
    #[setter(mav_loss)]
    fn set_mav_loss(&self, value: u64) {
        self.state().mav_loss = value;
    }

    /// Message types, instances, components and parameters that were not kept because there were too many already.
    #[getter]
    fn names_refused(&self) -> u64 {
        self.budget.refused()
    }

    /// `{(sysid, compid): last sequence number}`, a copy.
    #[getter(last_seq)]
    fn get_last_seq<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let last: Vec<_> = self.state().sequences.last().collect();
        let dict = PyDict::new(py);
        for (source, seq) in last {
            dict.set_item(source, seq)?;
        }
        Ok(dict)
    }
    #[setter(last_seq)]
    fn set_last_seq(&self, value: &Bound<'_, PyDict>) -> PyResult<()> {
        let mut sequences = SequenceTracker::new();
        for (source, seq) in value {
            let (sysid, compid) = source.extract()?;
            sequences.observe(sysid, compid, seq.extract()?);
        }
        self.state().sequences = sequences;
        Ok(())
    }

    /// Time of the last message in seconds since 1970; 0 before the first.
    #[getter(timestamp)]
    fn get_timestamp<'py>(&self, py: Python<'py>) -> Bound<'py, PyAny> {
        match self.state().timestamp {
            Some(seconds) => PyFloat::new(py, seconds).into_any(),
            None => PyInt::new(py, 0).into_any(),
        }
    }
    #[setter(timestamp)]
    fn put_timestamp(&self, value: &Bound<'_, PyAny>) -> PyResult<()> {
        let seconds: f64 = value.extract()?;
        let is_unset = seconds == 0.0 && value.is_instance_of::<PyInt>();
        self.state().timestamp = (!is_unset).then_some(seconds);
        Ok(())
    }

    /// Seconds since the vehicle booted, as its messages say.
    #[getter(uptime)]
    fn get_uptime(&self) -> f64 {
        self.state().uptime
    }
    #[setter(uptime)]
    fn put_uptime(&self, value: f64) {
        self.state().uptime = value;
    }

    /// Time of the record being read from a log; None on live links.
    #[getter(_timestamp)]
    fn get_record_time(&self) -> Option<f64> {
        self.state().record_time
    }
    #[setter(_timestamp)]
    fn put_record_time(&self, value: Option<f64>) {
        self.state().record_time = value;
    }

    /// Messages are stamped with `uptime` instead of the time of their record.
    #[getter(notimestamps)]
    fn get_notimestamps(&self) -> bool {
        self.state().notimestamps
    }
    #[setter(notimestamps)]
    fn set_notimestamps(&self, value: &Bound<'_, PyAny>) -> PyResult<()> {
        let value = value.truth()?;
        self.state().notimestamps = value;
        Ok(())
    }

    /// The protocol version of the link is still to be found out from its first byte.
    #[getter(first_byte)]
    fn get_first_byte(&self) -> bool {
        self.state().first_byte
    }
    #[setter(first_byte)]
    fn set_first_byte(&self, #[pyo3(from_py_with = truth)] value: bool) {
        self.state().first_byte = value;
    }

    /// File that received messages are recorded to, or None.
    #[getter(logfile)]
    fn get_logfile(&self, py: Python<'_>) -> Option<Py<PyAny>> {
        self.state().logfile.as_ref().map(|file| file.clone_ref(py))
    }
    #[setter(logfile)]
    fn set_logfile(&self, value: Option<Py<PyAny>>) {
        self.replace(value, |state| &mut state.logfile);
    }

    /// File that received bytes are recorded to, or None.
    #[getter(logfile_raw)]
    fn get_logfile_raw(&self, py: Python<'_>) -> Option<Py<PyAny>> {
        self.state().logfile_raw.as_ref().map(|file| file.clone_ref(py))
    }
    #[setter(logfile_raw)]
    fn set_logfile_raw(&self, value: Option<Py<PyAny>>) {
        self.replace(value, |state| &mut state.logfile_raw);
    }

    /// Forgets a frame whose rest will not come: the peer is gone.
    #[pyo3(name = "_drop_partial")]
    pub(crate) fn drop_partial(&self) {
        if let Some(mav) = &self.state().native_mav {
            let mav = mav.get();
            mav.drop_unread(&mut mav.parser());
        }
    }

    /// The home position of a system is known for good.
    fn _fix_home(&self, sysid: u8) {
        self.state().senders.fix_home(sysid);
    }

    /// Takes a received message into the link's state, once, then calls the message hooks.
    fn post_message(slf: &Bound<'_, Self>, msg: &Bound<'_, Message>) -> PyResult<()> {
        tracking::post(slf, msg)
    }

    fn __traverse__(&self, visit: PyVisit<'_>) -> Result<(), PyTraverseError> {
        // SAFETY: the garbage collector runs in an attached thread.
        let Some(state) = (unsafe { self.state.try_lock() }) else { return Ok(()) };
        visit.call(state.mav.as_ref())?;
        visit.call(state.native_mav.as_ref())?;
        visit.call(state.sysid_state.as_ref())?;
        visit.call(state.message_hooks.as_ref())?;
        visit.call(state.logfile.as_ref())?;
        visit.call(state.logfile_raw.as_ref())?;
        state.senders.traverse(visit)
    }

    fn __clear__(&self) {
        let old = std::mem::replace(&mut *self.state(), LinkState::new());
        drop(old);
    }
}

/// The instance's own dictionary, for classes that show a `__dict__` of their own making.
#[pyfunction]
pub(crate) fn instance_dict<'py>(object: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyDict>> {
    crate::python::instance_dict::generic_dict(object)
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
