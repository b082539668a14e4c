//! `BridgeCore`: a running bridge, and `BridgeTap`: the frames that come by. `mavwire.bridge` is their face.
//!
//! The bridge's thread never attaches to the interpreter: what Python wants to know is asked for or fetched in batches.

use std::sync::mpsc::{RecvTimeoutError, sync_channel};
use std::time::{Duration, Instant};

use mavwire_core::router::{Filter, Part, Settings};
use mavwire_core::telemetry::STATUSTEXT;
use mavwire_io::bridge::{Bridge, BridgeError, Kind, Tap};
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};

use crate::bridge::batch::FrameBatch;
use crate::bridge::options::seconds;
use crate::bridge::{options, stats};
use crate::dialect::registry::Dialect;
use crate::message::object::Message;
use crate::python::error::{Error, Result};
use crate::python::lists::{bytes, optional_list};
use mavwire_core::frame::FrameBytes;

/// How long one wait may last before the user's signals are looked at.
const WAIT_SLICE: Duration = Duration::from_millis(200);

/// Message id, name, system, component, frames, time and link of the last one.
type KindRow = (u32, String, u8, u8, u64, f64, String);

/// Does what nothing interrupts, such as looking a name up, on a thread that is left to itself if the user's signals end
/// the wait for it.
fn interruptibly<T: Send + 'static>(
    py: Python<'_>,
    work: impl FnOnce() -> T + Send + 'static,
) -> PyResult<T> {
    let (answer, mut answered) = sync_channel(1);
    let work = move || drop(answer.send(work()));
    std::thread::Builder::new().name("mavwire-open".into()).spawn(work)?;
    loop {
        let outcome;
        (outcome, answered) = py.detach(move || (answered.recv_timeout(WAIT_SLICE), answered));
        match outcome {
            Ok(done) => return Ok(done),
            Err(RecvTimeoutError::Timeout) => py.check_signals()?,
            Err(RecvTimeoutError::Disconnected) => {
                return Err(PyRuntimeError::new_err("the thread that opens a link has ended"));
            }
        }
    }
}

/// A bridge on a thread of its own.
#[pyclass(frozen, module = "mavwire._native")]
pub(crate) struct BridgeCore {
    dialect: Py<Dialect>,
    bridge: Bridge,
}

#[pymethods]
impl BridgeCore {
    /// Starts a bridge without links; the arguments are a dialect, `mavwire.bridge.options.Settings` and, to record,
    /// `Recording`.
    #[new]
    fn new(
        py: Python<'_>,
        dialect: Py<Dialect>,
        #[pyo3(from_py_with = options::settings)] settings: Settings,
        recording: Option<Bound<'_, PyAny>>,
    ) -> Result<Self> {
        let recording = recording.as_ref().map(options::recording).transpose()?;
        let registry = dialect.get().registry.clone();
        let where_to = recording.as_ref().map(|recording| recording.directory.clone());
        let bridge = py.detach(|| Bridge::start(registry, settings, recording));
        let bridge = bridge.map_err(|error| {
            let link = where_to.unwrap_or_default().display().to_string();
            BridgeError::Io { link, error }
        })?;
        Ok(Self { dialect, bridge })
    }

    /// Adds a link: `mavwire.bridge.options.EndpointOptions`.
    fn add(&self, py: Python<'_>, link: &Bound<'_, PyAny>) -> Result<()> {
        let spec = options::link_spec(link)?;
        let open = interruptibly(py, move || spec.open())??;
        py.detach(|| self.bridge.attach(open)).map_err(Error::from)
    }

    /// Removes a link by its name.
    fn remove(&self, py: Python<'_>, name: &str) -> Result<()> {
        py.detach(|| self.bridge.remove(name)).map_err(Error::from)
    }

    /// Everything that is counted, as dictionaries and lists.
    fn stats<'py>(&self, py: Python<'py>) -> Result<Bound<'py, PyDict>> {
        let stats = py.detach(|| self.bridge.stats())?;
        Ok(stats::to_dict(py, &stats)?)
    }

    /// Routes whole frames as if they came over a link of their own. Called so that a `MAVLink` can send to it.
    fn write(&self, py: Python<'_>, #[pyo3(from_py_with = bytes)] frames: Vec<u8>) -> Result<()> {
        py.detach(|| self.bridge.send(&frames)).map_err(Error::from)
    }

    /// The newest message of an id, from a system and a component or from any; `None` if there was none.
    fn latest<'py>(
        &self,
        py: Python<'py>,
        msgid: u32,
        sysid: Option<u8>,
        compid: Option<u8>,
    ) -> Result<Option<Bound<'py, Message>>> {
        let hub = self.bridge.hub()?;
        let Some(latest) = py.detach(|| hub.latest(msgid, sysid, compid)) else { return Ok(None) };
        let frame = FrameBytes::from(&latest.frame[..]);
        let time = latest.info.time as f64 / 1e6;
        let stamped = |message: Message| message.stamped(time, Some(0));
        Ok(Some(self.dialect.get().message(py, latest.info.index, frame, stamped)?))
    }

    /// The last complete status text of a component; `None` if it has sent no text.
    fn latest_text<'py>(
        &self,
        py: Python<'py>,
        sysid: u8,
        compid: u8,
    ) -> Result<Option<Bound<'py, PyBytes>>> {
        let hub = self.bridge.hub()?;
        let latest = py.detach(|| hub.latest(STATUSTEXT, Some(sysid), Some(compid)));
        Ok(latest.and_then(|latest| latest.text).map(|text| PyBytes::new(py, &text)))
    }

    /// The frames from now on, of some message ids and systems or of all.
    fn tap(
        slf: Bound<'_, Self>,
        #[pyo3(from_py_with = optional_list)] messages: Option<Vec<u32>>,
        #[pyo3(from_py_with = optional_list)] systems: Option<Vec<u32>>,
    ) -> Result<BridgeTap> {
        let mut filter = Filter::default();
        for (part, ids) in [(Part::Messages, messages), (Part::Systems, systems)] {
            if let Some(ids) = ids {
                filter = filter.allow(part, ids);
            }
        }
        let bridge = &slf.get().bridge;
        let hub = bridge.hub()?;
        let tap = slf.py().detach(|| hub.tap(filter));
        Ok(BridgeTap { core: slf.unbind(), tap })
    }

    /// The kinds of messages that came last: message id, name, system, component, how many, when the last one came and over
    /// which link; and how many kinds there are besides these `most`.
    fn kinds(&self, py: Python<'_>, most: usize) -> Result<(Vec<KindRow>, usize)> {
        let registry = &self.dialect.get().registry;
        let list = || -> Result<_> {
            let (kinds, hidden) = self.bridge.hub()?.kinds(most);
            let row = |Kind { info, count, link }: Kind| {
                let name = info.index.map(|index| registry.message(index).name.clone());
                let time = info.time as f64 / 1e6;
                (info.msgid, name.unwrap_or_default(), info.sysid, info.compid, count, time, link)
            };
            Ok((kinds.into_iter().map(row).collect(), hidden))
        };
        py.detach(list)
    }

    /// Stops the bridge and waits for that.
    fn stop(&self, py: Python<'_>) {
        py.detach(|| self.bridge.stop());
    }
}

/// One that nobody stopped ends without the interpreter's lock: the last write of its recording may take long.
impl Drop for BridgeCore {
    fn drop(&mut self) {
        let _ = Python::try_attach(|py| self.stop(py));
    }
}

/// Frames that come by, until it is closed or the bridge stops.
#[pyclass(frozen, module = "mavwire._native")]
pub(crate) struct BridgeTap {
    core: Py<BridgeCore>,
    tap: Tap,
}

impl BridgeTap {
    /// Waits until so many frames are there; true if they are, or nothing will come any more.
    fn wait(&self, py: Python<'_>, wanted: usize, timeout: Option<Duration>) -> PyResult<bool> {
        let began = Instant::now();
        loop {
            let left = timeout.map(|timeout| timeout.saturating_sub(began.elapsed()));
            let slice = left.map_or(WAIT_SLICE, |left| left.min(WAIT_SLICE));
            let there = py.detach(|| self.tap.wait(wanted, slice));
            if there || left.is_some_and(|left| left <= slice) {
                return Ok(there);
            }
            py.check_signals()?;
        }
    }
}

#[pymethods]
impl BridgeTap {
    /// The next frames, empty after `timeout` seconds without any; `None` at the end. At most `max_batch` of them, the
    /// first of which waited for the others no longer than `max_latency` seconds.
    fn next(
        &self,
        py: Python<'_>,
        max_batch: usize,
        max_latency: f64,
        timeout: Option<f64>,
    ) -> Result<Option<FrameBatch>> {
        let latency = seconds("max_latency", max_latency)?;
        let timeout = timeout.map(|timeout| seconds("timeout", timeout)).transpose()?;
        let (max_batch, began) = (max_batch.max(1), Instant::now());
        loop {
            let left = timeout.map(|timeout| timeout.saturating_sub(began.elapsed()));
            let there = self.wait(py, 1, left)?;
            if there {
                self.wait(py, max_batch, Some(latency))?;
            }
            let Some(frames) = py.detach(|| self.tap.take(max_batch)) else { return Ok(None) };
            // Another thread may have been quicker.
            if frames.infos.is_empty() && there && left.is_none_or(|left| !left.is_zero()) {
                continue;
            }
            let core = self.core.get();
            let hub = core.bridge.hub()?;
            return Ok(Some(FrameBatch::new(core.dialect.clone_ref(py), frames, hub)));
        }
    }

    /// Frames that were dropped because nobody fetched them in time.
    #[getter]
    fn dropped(&self, py: Python<'_>) -> u64 {
        py.detach(|| self.tap.dropped())
    }

    /// Ends it; a thread that waits in `next` gets `None`.
    fn close(&self, py: Python<'_>) {
        py.detach(|| self.tap.close());
    }
}
