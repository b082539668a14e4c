//! `FrameBatch`: frames of a bridge in one object. Bytes and messages are made when they are asked for.

use mavwire_link::bridge::{FrameInfo, Frames, Hub};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyIterator, PyList};

use crate::dialect::Dialect;
use crate::frame_bytes::FrameBytes;

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
            messages.append(self.dialect.get().stamped(py, info.index, frame, time, 0)?)?;
        }
        Ok(messages)
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
