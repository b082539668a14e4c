//! A record type for its messages: the layout, and the names as interned Python strings.

use std::sync::Arc;

use mavwire_core::log::dataflash::Layout;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyString, PyType};

/// A layout and its names.
pub(crate) struct Names {
    pub(crate) layout: Arc<Layout>,
    pub(crate) name: Py<PyString>,
    /// Of the fields that attribute access finds; `None` where the class has an attribute of that name.
    fields: Vec<Option<Py<PyString>>>,
    /// Field name -> index, of the same fields.
    index: Py<PyDict>,
    /// `Z` fields hold any bytes: those of the type FILE.
    pub(crate) raw_bytes: bool,
}

impl Names {
    /// `class` is that of the messages, whose attributes hide fields.
    pub(crate) fn new(class: &Bound<'_, PyType>, layout: Arc<Layout>) -> PyResult<Self> {
        let py = class.py();
        let index = PyDict::new(py);
        let mut fields = Vec::new();
        for (number, field) in layout.fields.iter().enumerate() {
            let name = PyString::intern(py, &field.name);
            if class.getattr_opt(&name)?.is_some() {
                fields.push(None);
                continue;
            }
            index.set_item(&name, number)?;
            fields.push(Some(name.unbind()));
        }
        let name = PyString::intern(py, &layout.name).unbind();
        let raw_bytes = layout.name == "FILE";
        Ok(Self { layout, name, fields, index: index.unbind(), raw_bytes })
    }

    /// Index of the field of this name, the last if there are several.
    #[inline]
    pub(crate) fn field(&self, name: &Bound<'_, PyString>) -> PyResult<Option<usize>> {
        let is_it = |field: &Option<Py<PyString>>| field.as_ref().is_some_and(|own| own.is(name));
        if let Some(index) = self.fields.iter().rposition(is_it) {
            return Ok(Some(index));
        }
        // Interned strings differ only if their objects do, but not every name is interned.
        match self.index.bind(name.py()).get_item(name)? {
            Some(index) => Ok(Some(index.extract()?)),
            None => Ok(None),
        }
    }
}
