//! The state of one system that a link hears, and finding it quickly.

use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

use mavwire_core::telemetry::{Kept, Newest, Repeats, Source};
use pyo3::exceptions::PyTypeError;
use pyo3::gc::{PyTraverseError, PyVisit};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyString};

use crate::link::instances::add_message;
use crate::message::info::Info;
use crate::message::object::Message;
use crate::python::instance_dict::{generic_setattr, instance_dict};
use crate::sync::lock::Lock;
use crate::sync::slot::Slot;

/// Moves on whenever a link's `sysid_state` or an attribute of a system's state changes.
static EPOCH: AtomicU64 = AtomicU64::new(0);

/// Makes every link look its systems' states up again: somebody replaced one.
#[pyfunction]
pub(crate) fn forget_states() {
    EPOCH.fetch_add(1, Relaxed);
}

/// Base of `mavutil.mavfile_state`: holds the newest messages.
///
/// A message that arrives goes into `newest` alone. The dictionary `messages` gets it when a program asks for the
/// dictionary, and at once while the program keeps that.
#[pyclass(frozen, subclass, module = "mavwire._native")]
pub(crate) struct SystemState {
    messages: Slot<PyDict>,
    newest: Lock<Newest<Py<Message>>>,
}

impl SystemState {
    /// Message type -> newest message.
    pub(crate) fn messages<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let missing = || PyTypeError::new_err("the system's state has no messages");
        let messages = self.messages.get(py).ok_or_else(missing)?;
        // Nothing is called while the lock is held.
        let unseen = self.newest.lock(py).take_unseen(|message| message.clone_ref(py));
        for message in unseen {
            keep_in(&messages, message.bind(py))?;
        }
        Ok(messages)
    }

    /// Keeps a received message. `has_room` is asked before the table of newest messages grows.
    #[inline]
    pub(crate) fn keep(
        &self,
        message: &Bound<'_, Message>,
        info: &Info,
        source: Source,
        has_room: impl FnOnce(usize) -> bool,
    ) -> PyResult<()> {
        let py = message.py();
        let handle = message.clone().unbind();
        let kept = self.newest.lock(py).keep(info.number, source, handle, has_room);
        // The dictionary's keys are in the order in which they came first.
        if matches!(kept, Kept::First) || self.messages.is_shared(py) {
            self.messages(py)?;
        }
        if let Kept::Renewed(old) = kept {
            drop(old.into_bound(py));
        }
        Ok(())
    }

    /// The newest messages with their components, in the order of arrival.
    fn in_order<'py>(&self, py: Python<'py>) -> Vec<(u8, Bound<'py, Message>)> {
        self.newest.lock(py).in_order(|message| message.bind(py).clone())
    }
}

/// Stores a message of a definition in a dictionary.
fn keep_in(messages: &Bound<'_, PyDict>, message: &Bound<'_, Message>) -> PyResult<()> {
    match message.get().info {
        Some(info) => add_message(messages, info.name.bind(messages.py()), message),
        None => Ok(()),
    }
}

new! {
    SystemState: |_cls| -> Self {
        Self { messages: Slot::new(), newest: Lock::new(Newest::default()) }
    }
}

#[pymethods]
impl SystemState {
    fn __setattr__(
        slf: &Bound<'_, Self>,
        name: &Bound<'_, PyString>,
        value: &Bound<'_, PyAny>,
    ) -> PyResult<()> {
        let before = instance_dict(slf)?.get_item(name)?;
        // A value that cannot be compared, like an array, may have changed.
        let changed = before.is_none_or(|before| !before.eq(value).unwrap_or(false));
        generic_setattr(slf, name, Some(value))?;
        if changed {
            forget_states();
        }
        Ok(())
    }

    fn __delattr__(slf: &Bound<'_, Self>, name: &Bound<'_, PyString>) -> PyResult<()> {
        generic_setattr(slf, name, None)?;
        forget_states();
        Ok(())
    }

    /// Message type -> newest message.
    #[getter(messages)]
    fn get_messages<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyDict>>> {
        if self.messages.get(py).is_none() {
            return Ok(None);
        }
        self.messages(py).map(Some)
    }
    #[setter(messages)]
    fn set_messages(&self, value: Bound<'_, PyDict>) {
        self.newest.lock(value.py()).take_unseen(|_| ());
        self.messages.set(Some(value.unbind()));
    }

    /// Component id -> message type -> newest message of that component alone, as they are now.
    #[getter]
    fn components<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let tables = PyDict::new(py);
        for (compid, message) in self.in_order(py) {
            let table = match tables.get_item(compid)? {
                Some(table) => table.cast_into::<PyDict>()?,
                None => PyDict::new(py),
            };
            keep_in(&table, &message)?;
            tables.set_item(compid, table)?;
        }
        Ok(tables)
    }

    /// Message type -> newest message of a component, as they are now. With `kind` of that type alone.
    #[pyo3(signature = (compid, kind = None))]
    fn of_component<'py>(
        &self,
        py: Python<'py>,
        compid: i64,
        kind: Option<&str>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let table = PyDict::new(py);
        for (_, message) in
            self.in_order(py).into_iter().filter(|found| i64::from(found.0) == compid)
        {
            let info = message.get().info;
            if kind.is_none() || info.map(|info| info.definition.name.as_str()) == kind {
                keep_in(&table, &message)?;
            }
        }
        Ok(table)
    }

    fn __traverse__(&self, visit: PyVisit<'_>) -> Result<(), PyTraverseError> {
        // SAFETY: the garbage collector runs attached.
        for message in unsafe { self.newest.try_lock() }.iter().flat_map(|newest| newest.iter()) {
            visit.call(message)?;
        }
        self.messages.traverse(visit)
    }

    fn __clear__(&self, py: Python<'_>) {
        let newest = std::mem::take(&mut *self.newest.lock(py));
        drop(newest);
        self.messages.set(None);
    }
}

/// A system that was heard.
pub(crate) struct Heard {
    sysid: u8,
    pub(crate) state: Py<SystemState>,
    /// Forgotten when a program changes the state.
    pub(crate) repeats: Repeats,
}

/// Systems by id, so that not every message costs a dictionary look-up.
#[derive(Default)]
pub(crate) struct Systems {
    heard: Vec<Heard>,
    epoch: u64,
}

impl Systems {
    #[inline]
    pub(crate) fn find(&mut self, sysid: u8) -> Option<&mut Heard> {
        if self.epoch != EPOCH.load(Relaxed) {
            return None;
        }
        self.heard.iter_mut().find(|heard| heard.sysid == sysid)
    }

    /// Keeps a system. Returns what it forgets, to be dropped without a lock held.
    #[must_use]
    pub(crate) fn remember(&mut self, sysid: u8, state: Py<SystemState>) -> impl Sized + use<> {
        let mut forgotten = Vec::new();
        let now = EPOCH.load(Relaxed);
        if self.epoch != now {
            self.epoch = now;
            forgotten = std::mem::take(&mut self.heard);
        }
        self.heard.push(Heard { sysid, state, repeats: Repeats::default() });
        forgotten
    }

    pub(crate) fn traverse(&self, visit: PyVisit<'_>) -> Result<(), PyTraverseError> {
        self.heard.iter().try_for_each(|heard| visit.call(&heard.state))
    }
}
