//! Signing state as Python sees it, and the decision whether a received frame may pass.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU8, AtomicU64, Ordering::Relaxed};

use mavwire_core::frame::{FrameRef, SIGNATURE_LEN};
use mavwire_core::signing::{
    SecretKey, Sightings, SigningState, StreamId, StreamTable, Verdict, timestamp_from_unix_micros,
};
use pyo3::exceptions::PyValueError;
use pyo3::gc::{PyTraverseError, PyVisit};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};

use crate::python::calling::{Calling, truth};
use crate::python::error::{Error, Result};
use crate::python::lists::bytes_like;
use crate::sync::lock::{Guard, Lock};
use crate::sync::slot::Slot;

/// The streams that the links with a key have heard.
#[derive(Default)]
struct Streams {
    received: StreamTable,
    seen: Sightings,
}

/// Signing state of one link.
#[pyclass(frozen, subclass, module = "mavwire._native")]
pub(crate) struct Signing {
    /// Key and timestamp. Its own stream table is not used.
    state: Lock<SigningState>,
    /// One for all links with the same key, so that what was heard on one link cannot be replayed on another.
    streams: Lock<Arc<Lock<Streams>>>,
    /// Outgoing timestamps follow the clock.
    follows_clock: AtomicBool,
    /// Timestamps below this one may be used; reaching it calls `keep`.
    mark: AtomicU64,
    /// `keep(timestamp) -> mark` stores the timestamp for the time after a restart.
    keep: Slot,
    pub(super) has_key: AtomicBool,
    link_id: AtomicU8,
    sign_outgoing: AtomicBool,
    pub(super) allow_unsigned: Slot,
    pub(super) seen: AtomicU64,
    pub(super) good: AtomicU64,
    pub(super) bad: AtomicU64,
    pub(super) passed: AtomicU64,
    pub(super) rejected: AtomicU64,
}

fn secret_key(key: &Bound<'_, PyAny>) -> Result<SecretKey> {
    let bytes = bytes_like(key)?;
    Ok(SecretKey::new(bytes.cast::<PyBytes>().map_err(PyErr::from)?.as_bytes())?)
}

fn timestamp_of(value: &Bound<'_, PyAny>) -> PyResult<u64> {
    match value.extract::<u64>() {
        Ok(timestamp) => Ok(timestamp),
        Err(_) => value.invoke_method0(intern!(value.py(), "__int__"))?.extract(),
    }
}

impl Signing {
    fn state(&self) -> Guard<'_, SigningState> {
        // SAFETY: signing states are Python objects, whose methods run attached.
        self.state.lock(unsafe { Python::assume_attached() })
    }

    /// Does something with what the links with this key share.
    fn with_streams<T>(&self, act: impl FnOnce(&mut Streams) -> T) -> T {
        // SAFETY: as above.
        let py = unsafe { Python::assume_attached() };
        let shared = self.streams.lock(py);
        let mut streams = shared.lock(py);
        act(&mut streams)
    }

    pub(super) fn judge(&self, frame: &FrameRef<'_>) -> Verdict {
        let now = self.clock();
        self.with_streams(|streams| self.state().check_in(&mut streams.received, frame, now))
    }

    /// Whether a frame is genuine, and neither received nor looked at before. Receiving it later is not affected.
    pub(crate) fn look(&self, frame: &FrameRef<'_>) -> bool {
        let now = self.clock();
        let verdict = self.with_streams(|streams| {
            self.state().look(&mut streams.seen, &streams.received, frame, now)
        });
        verdict.is_verified()
    }

    /// The clock, if timestamps follow it.
    fn clock(&self) -> Option<u64> {
        self.follows_clock
            .load(Relaxed)
            .then(|| timestamp_from_unix_micros((mavwire_io::clock::unix_seconds() * 1.0e6) as u64))
    }

    fn use_streams(&self, py: Python<'_>, streams: Arc<Lock<Streams>>) {
        let old = std::mem::replace(&mut *self.streams.lock(py), streams);
        drop(old);
    }

    fn use_key(&self, py: Python<'_>, key: Option<SecretKey>) {
        self.has_key.store(key.is_some(), Relaxed);
        self.state().set_key(key);
        // The old table is shared with links of the old key.
        let streams = self.with_streams(|streams| Streams {
            received: streams.received.clone(),
            seen: streams.seen.begun_anew(),
        });
        self.use_streams(py, Arc::new(Lock::new(streams)));
    }

    /// Has the timestamp stored before it is used, if it reached the mark.
    pub(super) fn store_timestamp(&self) -> PyResult<()> {
        let timestamp = self.state().timestamp;
        if timestamp < self.mark.load(Relaxed) {
            return Ok(());
        }
        // SAFETY: as above.
        let py = unsafe { Python::assume_attached() };
        if let Some(keep) = self.keep.get(py) {
            let mark = keep.invoke1((timestamp,))?.extract()?;
            // Another store may have come in its place meanwhile.
            if self.keep.get(py).is_some_and(|now| now.is(&keep)) {
                self.mark.store(mark, Relaxed);
            }
        }
        Ok(())
    }

    pub(crate) fn has_key(&self) -> bool {
        self.has_key.load(Relaxed)
    }

    pub(crate) fn signs_outgoing(&self) -> bool {
        self.sign_outgoing.load(Relaxed)
    }

    /// The signature block for a frame that was made for it.
    pub(crate) fn sign(&self, frame: &[u8]) -> PyResult<[u8; SIGNATURE_LEN]> {
        let (link_id, now) = (self.link_id.load(Relaxed), self.clock());
        let (_, block) = self.state().sign(frame, link_id, now).map_err(Error::from)?;
        self.store_timestamp()?;
        Ok(block)
    }
}

#[pymethods]
impl Signing {
    #[new]
    fn new() -> Self {
        Self {
            state: Lock::new(SigningState::default()),
            streams: Lock::new(Arc::new(Lock::new(Streams::default()))),
            mark: AtomicU64::new(u64::MAX),
            keep: Slot::new(),
            follows_clock: AtomicBool::new(false),
            has_key: AtomicBool::new(false),
            link_id: AtomicU8::new(0),
            sign_outgoing: AtomicBool::new(false),
            allow_unsigned: Slot::new(),
            seen: AtomicU64::new(0),
            good: AtomicU64::new(0),
            bad: AtomicU64::new(0),
            passed: AtomicU64::new(0),
            rejected: AtomicU64::new(0),
        }
    }

    /// The secret key: 32 bytes, or None. Any other length is a `ValueError`.
    #[getter]
    fn secret_key<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyBytes>> {
        let key = self.state().key().map(|key| *key.expose());
        key.map(|key| PyBytes::new(py, &key))
    }
    #[setter]
    fn set_secret_key(&self, py: Python<'_>, key: Option<&Bound<'_, PyAny>>) -> PyResult<()> {
        self.use_key(py, key.map(secret_key).transpose()?);
        Ok(())
    }

    /// Timestamp of the next signed frame, in 10 us since 2015-01-01.
    #[getter]
    fn timestamp(&self) -> u64 {
        self.state().timestamp
    }
    #[setter]
    fn set_timestamp(&self, value: &Bound<'_, PyAny>) -> PyResult<()> {
        let timestamp = timestamp_of(value)?;
        self.state().timestamp = timestamp;
        Ok(())
    }

    /// Key, policy and timestamps at once, so that no other thread sees some of them without the rest. Timestamps follow
    /// the clock or count up, and `keep(timestamp) -> mark` is called before those from the mark on are used.
    /// Received timestamps may be `max_ahead` units ahead of the clock, or any number where it is None.
    #[allow(clippy::too_many_arguments)] // each is a part of what must change at once
    fn _set_up(
        &self,
        py: Python<'_>,
        key: Option<&Bound<'_, PyAny>>,
        #[pyo3(from_py_with = truth)] sign_outgoing: bool,
        allow_unsigned_callback: Option<Py<PyAny>>,
        link_id: u8,
        #[pyo3(from_py_with = timestamp_of)] timestamp: u64,
        follows_clock: bool,
        keep: Option<Py<PyAny>>,
        max_ahead: Option<u64>,
    ) -> PyResult<()> {
        let key = key.map(secret_key).transpose()?;
        // Dropped at the end: that may run Python code.
        let _old = (self.allow_unsigned.get(py), self.keep.get(py));
        self.use_key(py, key);
        self.sign_outgoing.store(sign_outgoing, Relaxed);
        self.link_id.store(link_id, Relaxed);
        self.follows_clock.store(follows_clock, Relaxed);
        let mut state = self.state();
        (state.timestamp, state.max_ahead) = (timestamp, max_ahead);
        drop(state);
        self.mark.store(if keep.is_some() { 0 } else { u64::MAX }, Relaxed);
        self.allow_unsigned.set(allow_unsigned_callback);
        self.keep.set(keep);
        self.store_timestamp()
    }

    /// Shares the stream table of `other` if that has the same key; whether it has.
    fn _share(slf: &Bound<'_, Self>, other: &Bound<'_, Self>) -> bool {
        if slf.is(other) {
            return false;
        }
        let (this, that) = (slf.get(), other.get());
        // One lock at a time: another thread may compare the other way round.
        let others = that.state().key().and_then(|key| SecretKey::new(key.expose()).ok());
        let state = this.state();
        let same = state.key().zip(others.as_ref()).is_some_and(|(own, key)| own.equals(key));
        drop(state);
        if same {
            let streams = Arc::clone(&that.streams.lock(slf.py()));
            this.use_streams(slf.py(), streams);
        }
        same
    }

    /// Last timestamp of each verified stream: `{(link_id, sysid, compid): timestamp}`, a copy.
    #[getter]
    fn stream_timestamps<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let rows: Vec<_> = self.with_streams(|streams| streams.received.iter().collect());
        let dict = PyDict::new(py);
        for (id, timestamp) in rows {
            dict.set_item((id.link_id, id.sysid, id.compid), timestamp)?;
        }
        Ok(dict)
    }
    #[setter]
    fn set_stream_timestamps(&self, value: &Bound<'_, PyDict>) -> PyResult<()> {
        let mut rows = Vec::new();
        for (key, timestamp) in value {
            let (link_id, sysid, compid) = key.extract()?;
            rows.push((StreamId { link_id, sysid, compid }, timestamp.extract()?));
        }
        self.with_streams(|streams| {
            let room = streams.received.capacity();
            if rows.len() > room {
                let message = format!("stream_timestamps holds {room} streams, not {}", rows.len());
                return Err(PyValueError::new_err(message));
            }
            streams.received.clear();
            streams.seen = Sightings::default();
            for (id, timestamp) in rows {
                streams.received.set(id, timestamp);
            }
            Ok(())
        })
    }

    fn __traverse__(&self, visit: PyVisit<'_>) -> Result<(), PyTraverseError> {
        self.keep.traverse(visit)?;
        self.allow_unsigned.traverse(visit)
    }

    fn __clear__(&self) {
        self.keep.set(None);
        self.allow_unsigned.set(None);
    }
}

properties! {
    Signing:

    /// Sign what is sent.
    sign_outgoing, set_sign_outgoing as truth: bool = |signing| (atomic signing.sign_outgoing);
    /// Link id that outgoing signatures carry, 0 to 255.
    link_id, set_link_id: u8 = |signing| (atomic signing.link_id);
    /// `callback(mav, msgId) -> bool` decides about frames that are not signed, or not well.
    allow_unsigned_callback, set_allow_unsigned_callback: Option<Py<PyAny>> = |signing| (slot signing.allow_unsigned);
    /// Signed frames received.
    sig_count, set_sig_count: u64 = |signing| (atomic signing.seen);
    /// Good signatures.
    goodsig_count, set_goodsig_count: u64 = |signing| (atomic signing.good);
    /// Bad signatures.
    badsig_count, set_badsig_count: u64 = |signing| (atomic signing.bad);
    /// Frames that the callback let pass.
    unsigned_count, set_unsigned_count: u64 = |signing| (atomic signing.passed);
    /// Frames that the callback rejected.
    reject_count, set_reject_count: u64 = |signing| (atomic signing.rejected);
}
