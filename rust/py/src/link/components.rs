//! Newest messages of each component of a system, beside those of the system as a whole.
//!
//! A system with one component, the usual case, needs no second table: its messages are the component's. The tables are
//! made when a second component is heard.

use std::sync::atomic::{AtomicU16, Ordering::Relaxed};

use pyo3::gc::{PyTraverseError, PyVisit};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyString};

use crate::link::instances::add_message;
use crate::link::name_budget::{NameBudget, OWN_COMPONENTS, OWN_NAMES, SharedTables};
use crate::message::object::Message;
use crate::python::calling::Calling;
use crate::sync::slot::Slot;

/// No component was heard yet.
const NOBODY: u16 = 256;
/// More than one component was heard.
const MANY: u16 = 257;

/// The components of one system.
pub(crate) struct Components {
    /// The only component heard, [`NOBODY`] or [`MANY`].
    sole: AtomicU16,
    /// Component id -> its newest messages, once there are several.
    tables: Slot<PyDict>,
}

impl Components {
    pub(crate) const fn new() -> Self {
        Self { sole: AtomicU16::new(NOBODY), tables: Slot::new() }
    }

    /// Only `compid` was ever heard, so that its messages need no table of their own.
    #[inline]
    pub(crate) fn is_sole(&self, compid: u8) -> bool {
        self.sole.load(Relaxed) == u16::from(compid)
    }

    /// Keeps a message that is about to be put into the system's `messages`.
    #[cold]
    pub(crate) fn keep(
        &self,
        link: &dyn SharedTables,
        messages: &Bound<'_, PyDict>,
        compid: u8,
        kind: &Bound<'_, PyString>,
        message: &Bound<'_, Message>,
    ) -> PyResult<()> {
        if self.sole.load(Relaxed) == NOBODY {
            self.sole.store(compid.into(), Relaxed);
            return Ok(());
        }
        let tables = self.open(messages)?;
        self.sole.store(MANY, Relaxed);
        let known = tables.get_item(compid)?;
        let table = match known {
            Some(table) => table.cast_into::<PyDict>()?,
            None if !NameBudget::of(link, OWN_COMPONENTS).takes(tables.len())? => return Ok(()),
            None => {
                let table = PyDict::new(messages.py());
                tables.set_item(compid, &table)?;
                table
            }
        };
        add_message(&table, kind, message, &NameBudget::of(link, own_names(&tables)))
    }

    /// Component id -> newest messages.
    pub(crate) fn tables<'py>(
        &self,
        messages: &Bound<'py, PyDict>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let py = messages.py();
        if let Some(tables) = self.tables.get(py) {
            return Ok(tables);
        }
        let tables = PyDict::new(py);
        let Ok(sole) = u8::try_from(self.sole.load(Relaxed)) else { return Ok(tables) };
        let table = PyDict::new(py);
        for (kind, message) in messages.copy()? {
            if message.is_instance_of::<Message>() && source_of(&message)? == Some(sole) {
                table.set_item(kind, message)?;
            }
        }
        tables.set_item(sole, table)?;
        Ok(tables)
    }

    /// Names in the tables, and tables, for which there is no room of their own.
    pub(crate) fn shared_names(&self, py: Python<'_>) -> PyResult<usize> {
        let Some(tables) = self.tables.get(py) else { return Ok(0) };
        let own = own_names(&tables);
        let mut names = tables.len().saturating_sub(OWN_COMPONENTS);
        for (_, table) in tables {
            names += table.len()?.saturating_sub(own);
        }
        Ok(names)
    }

    /// Keeps the tables from now on.
    fn open<'py>(&self, messages: &Bound<'py, PyDict>) -> PyResult<Bound<'py, PyDict>> {
        let tables = self.tables(messages)?;
        self.tables.set(Some(tables.clone().unbind()));
        Ok(tables)
    }

    pub(crate) fn traverse(&self, visit: PyVisit<'_>) -> Result<(), PyTraverseError> {
        self.tables.traverse(visit)
    }

    pub(crate) fn clear(&self) {
        self.tables.set(None);
    }
}

/// Names that each of a system's tables has room for by itself.
fn own_names(tables: &Bound<'_, PyDict>) -> usize {
    if tables.len() <= OWN_COMPONENTS { OWN_NAMES } else { 0 }
}

/// Component that sent a message; `None` for one that was built and never sent, as the first `HOME`.
fn source_of(message: &Bound<'_, PyAny>) -> PyResult<Option<u8>> {
    message.invoke_method0("get_srcComponent")?.extract()
}
