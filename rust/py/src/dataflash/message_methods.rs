//! The Python methods of `DFMessage`.

use std::sync::Arc;

use pyo3::exceptions::{PyAttributeError, PyIndexError};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict, PyList, PyString};
use pyo3::{PyTraverseError, PyVisit};

use super::clock::Seconds;
use super::message::{DFMessage, Written};
use super::shape;
use crate::python::calling::{Calling, truth};
use crate::python::instance_dict::generic_getattr;
use crate::python::lists::collected;
use crate::sync::lock::Lock;
use mavwire_core::frame::FrameBytes;

/// A function of the package's for messages.
fn helper<'py>(py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyAny>> {
    py.import(intern!(py, "mavwire._dataflash.messages"))?.getattr(name)
}

#[pymethods]
impl DFMessage {
    /// A message of the type that `fmt` describes, from the stored values of its columns.
    #[new]
    fn new(
        fmt: &Bound<'_, PyAny>,
        elements: Bound<'_, PyAny>,
        #[pyo3(from_py_with = truth)] apply_multiplier: bool,
        parent: Option<Py<PyAny>>,
    ) -> PyResult<Self> {
        let elements = match elements.cast::<PyList>() {
            Ok(list) => list.clone(),
            Err(_) => PyList::new(fmt.py(), collected(elements.try_iter()?)?)?,
        };
        let written = Written { elements: Some(elements.unbind()), attributes: None };
        Ok(Self {
            names: shape::of_format(fmt)?,
            bytes: FrameBytes::empty(),
            delimiter: None,
            timestamp: Seconds::nothing(),
            written: Lock::new(written),
            fmt: fmt.clone().unbind(),
            parent,
            apply_multiplier,
        })
    }

    fn __getattribute__<'py>(
        slf: &Bound<'py, Self>,
        name: &Bound<'py, PyString>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let (py, this) = (slf.py(), slf.get());
        if let Some(attributes) = this.attributes_set(py)
            && let Some(value) = attributes.get_item(name)?
        {
            return Ok(value);
        }
        if let Some(index) = this.names.field(name)? {
            return this.value(py, index);
        }
        generic_getattr(slf, name).map_err(|error| {
            if error.is_instance_of::<PyAttributeError>(py) {
                return PyAttributeError::new_err(name.clone().unbind());
            }
            error
        })
    }

    fn __setattr__(
        slf: &Bound<'_, Self>,
        name: &Bound<'_, PyString>,
        value: &Bound<'_, PyAny>,
    ) -> PyResult<()> {
        let (py, this) = (slf.py(), slf.get());
        if let Some(index) = this.settable(name)? {
            let scale = this.names.layout.fields[index].kind.scale();
            let elements = this.elements(py)?;
            return match scale.filter(|_| this.apply_multiplier) {
                Some(scale) => elements.set_item(index, value.div(scale)?),
                None => elements.set_item(index, value),
            };
        }
        if name.to_str()? == "_timestamp" && this.timestamp.set_object(value).is_ok() {
            return Ok(());
        }
        this.attributes(py).set_item(name, value)
    }

    fn __delattr__(&self, name: &Bound<'_, PyString>) -> PyResult<()> {
        let error = || PyAttributeError::new_err(name.clone().unbind());
        let attributes = self.attributes_set(name.py()).ok_or_else(error)?;
        attributes.del_item(name).map_err(|_| error())
    }

    /// Seconds: Unix time, or since start where the log does not tell.
    #[getter]
    fn _timestamp<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.timestamp.object(py).ok_or_else(|| PyAttributeError::new_err("_timestamp"))
    }

    #[getter]
    fn _fieldnames(&self) -> Vec<&str> {
        self.get_fieldnames()
    }

    /// The type's name.
    fn get_type(&self, py: Python<'_>) -> Py<PyString> {
        self.names.name.clone_ref(py)
    }

    /// Names of the columns.
    fn get_fieldnames(&self) -> Vec<&str> {
        self.names.layout.fields.iter().map(|field| field.name.as_str()).collect()
    }

    /// `mavpackettype` and the values of all columns.
    fn to_dict<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let dict = PyDict::new(py);
        dict.set_item(intern!(py, "mavpackettype"), &self.names.name)?;
        for (index, field) in self.names.layout.fields.iter().enumerate() {
            dict.set_item(&field.name, self.value(py, index)?)?;
        }
        Ok(dict)
    }

    /// The bytes of the record, encoded anew if a value was set; None where a value does not fit.
    fn get_msgbuf<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        let (py, this) = (slf.py(), slf.get());
        if let Some(body) = this.body(py) {
            let head = [0xA3, 0x95, this.names.layout.type_id];
            return Ok(PyBytes::new(py, &[&head[..], body].concat()).into_any());
        }
        helper(py, "get_msgbuf")?.invoke1((slf,))
    }

    /// Writes a line for each column, with units and what the log's documentation says, to the file `f`.
    fn dump_verbose(slf: &Bound<'_, Self>, f: &Bound<'_, PyAny>) -> PyResult<()> {
        helper(slf.py(), "dump_verbose")?.invoke1((slf, f)).map(drop)
    }

    /// Writes the bits of the value `val` of column `c` as `field_metadata` describes them.
    fn dump_verbose_bitmask(
        slf: &Bound<'_, Self>,
        f: &Bound<'_, PyAny>,
        c: &Bound<'_, PyAny>,
        val: &Bound<'_, PyAny>,
        field_metadata: &Bound<'_, PyAny>,
    ) -> PyResult<()> {
        let arguments = (slf, f, c, val, field_metadata);
        helper(slf.py(), "dump_verbose_bitmask")?.invoke1(arguments).map(drop)
    }

    /// The newest message of another instance of this type. `IndexError` if the log has no such instance.
    fn __getitem__<'py>(
        slf: &Bound<'py, Self>,
        key: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let (py, this) = (slf.py(), slf.get());
        let Some(parent) = &this.parent else {
            return Err(PyAttributeError::new_err("'NoneType' object has no attribute 'messages'"));
        };
        let messages = parent.bind(py).getattr(intern!(py, "messages"))?;
        let name = format!("{}[{}]", this.names.layout.name, key.str()?);
        messages.get_item(name).map_err(|_| PyIndexError::new_err(()))
    }

    fn __copy__<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, Self>> {
        let (py, this) = (slf.py(), slf.get());
        let elements =
            this.elements_set(py).map(|list| PyList::new(py, list.iter())).transpose()?;
        let attributes = this.attributes_set(py).map(|dict| dict.copy()).transpose()?;
        let written = Written {
            elements: elements.map(Bound::unbind),
            attributes: attributes.map(Bound::unbind),
        };
        Bound::new(
            py,
            Self {
                names: Arc::clone(&this.names),
                bytes: this.bytes.clone(),
                delimiter: this.delimiter,
                timestamp: this.timestamp.clone(),
                written: Lock::new(written),
                fmt: this.fmt.clone_ref(py),
                parent: this.parent.as_ref().map(|parent| parent.clone_ref(py)),
                apply_multiplier: this.apply_multiplier,
            },
        )
    }

    fn __traverse__(&self, visit: PyVisit<'_>) -> Result<(), PyTraverseError> {
        visit.call(&self.fmt)?;
        visit.call(&self.parent)?;
        // SAFETY: the garbage collector runs attached.
        if let Some(written) = unsafe { self.written.try_lock() } {
            visit.call(&written.elements)?;
            visit.call(&written.attributes)?;
        }
        Ok(())
    }
}
