//! `DFMessage`: a record of a dataflash log. A field is decoded when it is read.

use std::sync::Arc;

use mavwire_core::log::dataflash::text::{Delimiter, decode_line, text_values};
use pyo3::exceptions::PyIndexError;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList, PyString};

use super::clock::Seconds;
use super::shape::Names;
use super::value;
use crate::sync::lock::Lock;
use mavwire_core::frame::FrameBytes;

/// Where a message's values are.
#[derive(Clone, Copy)]
pub(crate) enum Origin {
    /// In the body of a binary record.
    Body,
    /// In a line of a text log.
    Line(Delimiter),
    /// Nowhere but in the list of elements.
    Made,
}

/// What was put into a message, or asked for.
#[derive(Default)]
pub(super) struct Written {
    /// `_elements`, once somebody saw it: from then on the values are in there.
    pub(super) elements: Option<Py<PyList>>,
    /// Attributes that are no columns.
    pub(super) attributes: Option<Py<PyDict>>,
}

/// One record of a dataflash log: its columns are attributes.
#[pyclass(frozen, weakref, module = "mavwire.DFReader")]
pub(crate) struct DFMessage {
    pub(crate) names: Arc<Names>,
    pub(super) bytes: FrameBytes,
    pub(super) origin: Origin,
    pub(super) timestamp: Seconds,
    pub(super) written: Lock<Option<Box<Written>>>,
    pub(super) fmt: Py<PyAny>,
    pub(super) parent: Option<Py<PyAny>>,
    /// Stored integers are scaled when they are read.
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
        let apply_multiplier = delimiter.is_none();
        Self {
            names,
            bytes,
            origin: delimiter.map_or(Origin::Body, Origin::Line),
            timestamp: Seconds::nothing(),
            written: Lock::new(None),
            fmt,
            parent: Some(parent),
            apply_multiplier,
        }
    }

    /// Body of the record, if the values are still those in there.
    pub(super) fn body(&self, py: Python<'_>) -> Option<&[u8]> {
        let as_read = self.elements_set(py).is_none();
        (as_read && matches!(self.origin, Origin::Body)).then_some(&*self.bytes)
    }

    pub(super) fn elements_set<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyList>> {
        let written = self.written.lock(py);
        Some(written.as_ref()?.elements.as_ref()?.bind(py).clone())
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
        match self.origin {
            Origin::Body => {
                let offset = usize::from(field.offset);
                value::from_body(py, field.kind, &self.bytes, offset, raw_bytes)
            }
            Origin::Line(delimiter) => value::from_line(
                py,
                field.kind,
                &self.bytes,
                delimiter,
                &self.names.layout.name,
                index,
            ),
            Origin::Made => Err(PyIndexError::new_err("list index out of range")),
        }
    }

    /// `_elements`: the stored values, which are the message's from now on.
    pub(super) fn elements<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyList>> {
        if let Some(elements) = self.elements_set(py) {
            return Ok(elements);
        }
        let list = PyList::empty(py);
        match self.origin {
            Origin::Body => {
                let layout = &self.names.layout;
                for index in 0..layout.fields.len() {
                    if let Some(stored) = layout.value(index, &self.bytes) {
                        list.append(value::stored(py, stored)?)?;
                    }
                }
            }
            Origin::Line(delimiter) => {
                let line = decode_line(&self.bytes);
                for value in text_values(&line, delimiter, &self.names.layout.name) {
                    list.append(value)?;
                }
            }
            Origin::Made => {}
        }
        let mut written = self.written.lock(py);
        written.get_or_insert_default().elements = Some(list.clone().unbind());
        Ok(list)
    }

    /// Attributes that are no columns, if there are any.
    pub(super) fn attributes_set<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyDict>> {
        let written = self.written.lock(py);
        Some(written.as_ref()?.attributes.as_ref()?.bind(py).clone())
    }

    pub(super) fn attributes<'py>(&self, py: Python<'py>) -> Bound<'py, PyDict> {
        if let Some(attributes) = self.attributes_set(py) {
            return attributes;
        }
        let attributes = PyDict::new(py);
        let mut written = self.written.lock(py);
        written.get_or_insert_default().attributes = Some(attributes.clone().unbind());
        attributes
    }

    /// Index of the column that setting an attribute changes: one whose name begins with a capital letter.
    pub(super) fn settable(&self, name: &Bound<'_, PyString>) -> PyResult<Option<usize>> {
        let capital = name.to_str()?.chars().next().is_some_and(char::is_uppercase);
        if capital { self.names.field(name) } else { Ok(None) }
    }
}
