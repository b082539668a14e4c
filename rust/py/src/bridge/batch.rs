//! `FrameBatch`: frames of a bridge in one object. Bytes and messages are made when they are asked for.

use std::io::Cursor;
use std::sync::Arc;

use mavwire_columns::input::Steps;
use mavwire_columns::reader::reader;
use mavwire_columns::scan::Framing;
use mavwire_io::bridge::{FrameInfo, Frames, Hub};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyIterator, PyList};

use crate::dialect::registry::Dialect;
use crate::message::object::Message;
use crate::python::calling::Calling;
use crate::python::error::Result;
use crate::tables::columns::{LogColumns, Query};
use mavwire_core::frame::FrameBytes;

/// Frames in the order they came. Iterating gives messages.
#[pyclass(frozen, module = "mavwire._native")]
pub(crate) struct FrameBatch {
    dialect: Py<Dialect>,
    frames: Frames,
    /// Link numbers in `frames`, and what they are called.
    names: Vec<(u32, String)>,
}

impl FrameBatch {
    pub(crate) fn new(dialect: Py<Dialect>, frames: Frames, hub: &Hub) -> Self {
        let mut numbers: Vec<u32> = frames.infos.iter().map(|info| info.link).collect();
        numbers.sort_unstable();
        numbers.dedup();
        let named = |number| (number, hub.link_name(number).unwrap_or_default());
        Self { dialect, frames, names: numbers.into_iter().map(named).collect() }
    }

    fn name(&self, link: u32) -> &str {
        let found = self.names.binary_search_by_key(&link, |(number, _)| *number);
        found.map_or("", |n| &self.names[n].1)
    }

    fn list<'py, T: IntoPyObject<'py>>(
        &self,
        py: Python<'py>,
        of: impl Fn(&FrameInfo) -> T,
    ) -> PyResult<Bound<'py, PyList>> {
        PyList::new(py, self.frames.infos.iter().map(of))
    }

    /// The frames that the dialect knows, as a telemetry log has them: each behind the time when it arrived.
    fn records(&self) -> Vec<u8> {
        let known = self.frames.iter().filter(|(info, _)| info.index.is_some());
        known.flat_map(|(info, frame)| [&info.time.to_be_bytes()[..], frame].concat()).collect()
    }
}

#[pymethods]
impl FrameBatch {
    fn __len__(&self) -> usize {
        self.frames.infos.len()
    }

    #[allow(clippy::disallowed_methods)] // a list runs no code of Python's
    fn __iter__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyIterator>> {
        self.messages(py)?.try_iter()
    }

    /// All frames, one behind the other.
    #[getter]
    fn raw<'py>(&self, py: Python<'py>) -> Bound<'py, PyBytes> {
        PyBytes::new(py, &self.frames.bytes)
    }

    /// The bytes of each frame.
    fn frames<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyList>> {
        let frames: Vec<_> = self.frames.iter().map(|(_, bytes)| PyBytes::new(py, bytes)).collect();
        PyList::new(py, frames)
    }

    /// A message object for each frame.
    fn messages<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyList>> {
        let messages = PyList::empty(py);
        for (info, bytes) in self.frames.iter() {
            let frame = FrameBytes::from(bytes);
            let time = info.time as f64 / 1e6;
            let stamped = |message: Message| message.stamped(time, Some(0));
            messages.append(self.dialect.get().message(py, info.index, frame, stamped)?)?;
        }
        Ok(messages)
    }

    /// A table for each message type, by name.
    #[pyo3(signature = (*, units=None, enums=None, invalid=None))]
    fn tables<'py>(
        slf: &Bound<'py, Self>,
        units: Option<Bound<'py, PyAny>>,
        enums: Option<Bound<'py, PyAny>>,
        invalid: Option<Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let py = slf.py();
        let module = py.import(intern!(py, "mavwire.logs.reading"))?;
        module.invoke_method1(intern!(py, "tables_of_batch"), (slf, units, enums, invalid))
    }

    /// The frames as a run over a log, for `tables`.
    fn columns(&self, py: Python<'_>, query: Query) -> Result<LogColumns> {
        let dialect = self.dialect.get();
        let open = || {
            let (records, registry) = (self.records(), Arc::clone(&dialect.registry));
            let mut plan = query.plan(Some(dialect), records.len() as u64);
            plan.options.text_parts = true;
            let (framing, source) = (Some(Framing::Stamped), Box::new(Cursor::new(records)));
            reader(Steps::default(), source, framing, registry, plan)
        };
        LogColumns::begin(py, &query, open)
    }

    /// When each arrived; seconds since 1970.
    #[getter]
    fn times<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyList>> {
        self.list(py, |info| info.time as f64 / 1e6)
    }

    /// Name of the link that each came over.
    #[getter]
    fn links<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyList>> {
        self.list(py, |info| self.name(info.link))
    }

    /// `(system, component, message id)` of each.
    #[getter]
    fn ids<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyList>> {
        self.list(py, |info| (info.sysid, info.compid, info.msgid))
    }

    fn __repr__(&self) -> String {
        format!("<FrameBatch of {} frames>", self.frames.infos.len())
    }
}
