//! The Python methods of `Link`.

use mavwire_core::sequence::SequenceTracker;
use pyo3::gc::{PyTraverseError, PyVisit};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyFloat, PyInt, PyString};

use crate::link::state::{Link, QUICK_METHODS};
use crate::link::system::forget_states;
use crate::link::tracking;
use crate::message::object::Message;
use crate::protocol::mavlink::MAVLink;
use crate::python::calling::truth;
use crate::python::instance_dict::generic_setattr;
use crate::python::own_methods::OwnMethods;

new! {
    Link: |_cls| -> Self {
        Self::new(OwnMethods::none())
    }
}

#[pymethods]
impl Link {
    #[classattr]
    const _QUICK_METHODS: [&'static str; QUICK_METHODS.len()] = QUICK_METHODS;

    fn __setattr__(
        slf: &Bound<'_, Self>,
        name: &Bound<'_, PyString>,
        value: &Bound<'_, PyAny>,
    ) -> PyResult<()> {
        slf.get().methods.set_attribute(slf.as_any(), name, value)
    }

    fn __delattr__(slf: &Bound<'_, Self>, name: &Bound<'_, PyString>) -> PyResult<()> {
        generic_setattr(slf, name, None)
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
        forget_states();
    }

    /// Functions called as `hook(link, message)` for every message.
    #[getter(message_hooks)]
    pub(crate) fn hooks<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyAny>> {
        self.state().message_hooks.as_ref().map(|hooks| hooks.bind(py).clone())
    }
    #[setter(message_hooks)]
    fn set_message_hooks(&self, value: Py<PyAny>) {
        self.replace(Some(value), |state| &mut state.message_hooks);
    }

    /// `{(sysid, compid): last sequence number}`, a copy.
    #[getter(last_seq)]
    fn get_last_seq<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let last: Vec<_> = self.state().reception.sequences.last().collect();
        let dict = PyDict::new(py);
        for (source, seq) in last {
            dict.set_item(source, seq)?;
        }
        Ok(dict)
    }
    #[setter(last_seq)]
    fn set_last_seq(&self, value: &Bound<'_, PyDict>) -> PyResult<()> {
        let mut sequences = SequenceTracker::default();
        for (source, seq) in value {
            let (sysid, compid) = source.extract()?;
            sequences.observe(sysid, compid, seq.extract()?);
        }
        self.state().reception.sequences = sequences;
        Ok(())
    }

    /// Time of the last message in seconds since 1970; 0 before the first.
    #[getter(timestamp)]
    fn get_timestamp<'py>(&self, py: Python<'py>) -> Bound<'py, PyAny> {
        match self.state().reception.time {
            Some(seconds) => PyFloat::new(py, seconds).into_any(),
            None => PyInt::new(py, 0).into_any(),
        }
    }
    #[setter(timestamp)]
    fn put_timestamp(&self, value: &Bound<'_, PyAny>) -> PyResult<()> {
        let seconds: f64 = value.extract()?;
        let is_unset = seconds == 0.0 && value.is_instance_of::<PyInt>();
        self.state().reception.time = (!is_unset).then_some(seconds);
        Ok(())
    }

    /// The protocol version of the link is still to be found out from its first byte.
    #[getter(first_byte)]
    fn get_first_byte(&self) -> bool {
        !self.state().knows_version
    }
    #[setter(first_byte)]
    fn set_first_byte(&self, #[pyo3(from_py_with = truth)] value: bool) {
        self.state().knows_version = !value;
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
        if let Some(heard) = self.state().systems.find(sysid) {
            heard.repeats.home_is_fixed = true;
        }
    }

    /// Takes a received message into the link's state, once, then calls the message hooks.
    fn post_message(slf: &Bound<'_, Self>, msg: &Bound<'_, Message>) -> PyResult<()> {
        slf.get().state().hear_raw(msg.get());
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
        visit.call(state.last.as_ref())?;
        state.systems.traverse(visit)
    }

    fn __clear__(&self) {
        let old = std::mem::take(&mut *self.state());
        drop(old);
    }
}

properties! {
    Link:

    /// Message types, instances, components and parameters that were not kept because there were too many already.
    names_refused: u64 = |link| (field link.state().room.refused);
    /// Messages are stamped with `uptime` instead of the time of their record.
    notimestamps, set_notimestamps as truth: bool = |link| (field link.state().reception.stamps_uptime);
    /// File that received messages are recorded to, or None.
    logfile, set_logfile: Option<Py<PyAny>> = |link| (object link.state().logfile);
    /// File that received bytes are recorded to, or None.
    logfile_raw, set_logfile_raw: Option<Py<PyAny>> = |link| (object link.state().logfile_raw);
    /// Time of the record being read from a log; None on live links.
    _timestamp, put_record_time: Option<f64> = |link| (field link.state().reception.record_time);
    /// Messages received, radio status, BAD_DATA and UNKNOWN not counted.
    mav_count, set_mav_count: u64 = |link| (field link.state().reception.received);
    /// Messages lost, by the gaps in sequence numbers.
    mav_loss, set_mav_loss: u64 = |link| (field link.state().reception.lost);
    /// Seconds since the vehicle booted, as its messages say.
    uptime, set_uptime: f64 = |link| (field link.state().reception.uptime);
}
