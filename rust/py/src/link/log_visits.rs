//! The messages of some types of an indexed log, one after the other, for tools that ask nothing else of it: nothing is
//! read along, and no call has arguments.

use pyo3::gc::{PyTraverseError, PyVisit};
use pyo3::prelude::*;
use pyo3::types::PyString;

use crate::link::log_link::{LogLink, TURN_INTERVAL};
use crate::link::log_receive;
use crate::link::log_wanted::Wanted;
use crate::link::message_source::message_type;
use crate::message::object::Message;
use crate::sync::gil_yield::GilYield;
use crate::sync::lock::Lock;

/// An iterator of messages.
#[pyclass(frozen, module = "mavwire._native")]
pub(crate) struct LogVisits {
    log: Py<LogLink>,
    names: Vec<Py<PyString>>,
    wanted: Lock<Wanted>,
}

impl LogVisits {
    pub(crate) fn new(log: Py<LogLink>, names: Vec<Py<PyString>>, wanted: Wanted) -> Self {
        Self { log, names, wanted: Lock::new(wanted) }
    }

    fn wants(&self, message: &Bound<'_, Message>) -> PyResult<bool> {
        let kind = message_type(message)?;
        // Names of types are interned, by Python too.
        if self.names.iter().any(|name| name.is(&kind)) {
            return Ok(true);
        }
        for name in &self.names {
            if kind.as_any().eq(name.bind(message.py()))? {
                return Ok(true);
            }
        }
        Ok(false)
    }
}

#[pymethods]
impl LogVisits {
    fn __iter__(slf: PyRef<'_, Self>) -> PyRef<'_, Self> {
        slf
    }

    fn __next__<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, Message>>> {
        let log = self.log.bind(py);
        let (mut passed, mut gil_yield): (u64, _) = (0, GilYield::new());
        loop {
            if let Some(rest) = self.wanted.lock(py).advance() {
                LogLink::visit(log, rest)?;
            }
            let Some(message) = log_receive::next_without_params(log.as_super())? else {
                return Ok(None);
            };
            if self.wants(&message)? {
                return Ok(Some(message));
            }
            passed += 1;
            if passed.is_multiple_of(TURN_INTERVAL) {
                gil_yield.give_way(py)?;
            }
        }
    }

    fn __traverse__(&self, visit: PyVisit<'_>) -> Result<(), PyTraverseError> {
        visit.call(&self.log)
    }
}
