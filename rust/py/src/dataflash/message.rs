//! `DFMessage`: a record of a dataflash log. A field is decoded when it is read.

use std::sync::Arc;

use mavwire_core::log::dataflash::text::{Delimiter, decode_line, text_values, value_at};
use pyo3::exceptions::PyIndexError;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList, PyString};

use super::clock::Seconds;
use super::names::Names;
use super::value;
use crate::sync::lock::Lock;
use mavwire_core::frame::FrameBytes;

/// The list of values, if a program has seen it and may have changed it, and the attributes that a program set.
#[derive(Default)]
pub(super) struct Written {
    /// `_elements`, once a program has read it. From then on it holds the values.
    pub(super) elements: Option<Py<PyList>>,
    /// Attributes that are not columns.
    pub(super) attributes: Option<Py<PyDict>>,
}

/// One record of a dataflash log: its columns are attributes.
#[pyclass(frozen, weakref, module = "mavwire.DFReader")]
pub(crate) struct DFMessage {
    pub(crate) names: Arc<Names>,
    /// The body of a binary record, or the line of a text log.
    pub(super) bytes: FrameBytes,
    /// Of a text log.
    pub(super) delimiter: Option<Delimiter>,
    pub(super) timestamp: Seconds,
    pub(super) written: Lock<Written>,
    /// The type's `DFFormat`.
    #[pyo3(get)]
    pub(super) fmt: Py<PyAny>,
    #[pyo3(get, name = "_parent")]
    pub(super) parent: Option<Py<PyAny>>,
    /// Stored integers are scaled when they are read.
    #[pyo3(get, name = "_apply_multiplier")]
    pub(super) apply_multiplier: bool,
}

impl DFMessage {
    /// A message around the bytes of a record.
    #[inline]
    pub(crate) fn read(
        names: Arc<Names>,
        bytes: FrameBytes,
        delimiter: Option<Delimiter>,
        fmt: Py<PyAny>,
        parent: Py<PyAny>,
    ) -> Self {
        Self {
            names,
            bytes,
            delimiter,
            timestamp: Seconds::nothing(),
            written: Lock::new(Written::default()),
            fmt,
            parent: Some(parent),
            apply_multiplier: delimiter.is_none(),
        }
    }

    /// Body of the record, if the values are still those in there.
    pub(super) fn body(&self, py: Python<'_>) -> Option<&[u8]> {
        let as_read = self.elements_set(py).is_none();
        (as_read && self.delimiter.is_none()).then_some(&*self.bytes)
    }

    pub(super) fn elements_set<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyList>> {
        Some(self.written.lock(py).elements.as_ref()?.bind(py).clone())
    }

    /// The value of a column.
    #[inline]
    pub(crate) fn value<'py>(&self, py: Python<'py>, index: usize) -> PyResult<Bound<'py, PyAny>> {
        let Some(field) = self.names.layout.fields.get(index) else {
            return Err(PyIndexError::new_err("list index out of range"));
        };
        let raw_bytes = self.names.raw_bytes;
        if let Some(elements) = self.elements_set(py) {
            let element = elements.get_item(index)?;
            return value::from_object(&element, field.kind, self.apply_multiplier, raw_bytes);
        }
        let Some(delimiter) = self.delimiter else {
            return value::from_body(py, field, &self.bytes, raw_bytes);
        };
        let name = &self.names.layout.name;
        let bytes = value_at(&self.bytes, delimiter, name, index).unwrap_or_default();
        value::from_text(py, field.kind, bytes)
    }

    /// Attributes that are no columns, if there are any.
    pub(super) fn attributes_set<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyDict>> {
        Some(self.written.lock(py).attributes.as_ref()?.bind(py).clone())
    }

    /// Index of the column that setting an attribute changes: one whose name begins with a capital letter.
    pub(super) fn settable(&self, name: &Bound<'_, PyString>) -> PyResult<Option<usize>> {
        let capital = name.to_str()?.chars().next().is_some_and(char::is_uppercase);
        if capital { self.names.field(name) } else { Ok(None) }
    }
}

#[pymethods]
impl DFMessage {
    /// The stored values, which are the message's from now on.
    #[getter(_elements)]
    pub(super) fn elements<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyList>> {
        if let Some(elements) = self.elements_set(py) {
            return Ok(elements);
        }
        let list = PyList::empty(py);
        let layout = &self.names.layout;
        if let Some(delimiter) = self.delimiter {
            for value in text_values(&decode_line(&self.bytes), delimiter, &layout.name) {
                list.append(value)?;
            }
        } else {
            for field in &layout.fields {
                list.append(value::stored(py, field.value(&self.bytes))?)?;
            }
        }
        self.written.lock(py).elements = Some(list.clone().unbind());
        Ok(list)
    }

    /// Attributes that were set and are no columns.
    #[getter(__dict__)]
    pub(super) fn attributes<'py>(&self, py: Python<'py>) -> Bound<'py, PyDict> {
        if let Some(attributes) = self.attributes_set(py) {
            return attributes;
        }
        let attributes = PyDict::new(py);
        self.written.lock(py).attributes = Some(attributes.clone().unbind());
        attributes
    }
}
