//! Instance dictionaries of objects.

use pyo3::ffi;
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// The dictionary of any object that has one, whatever its class says about `__dict__`.
pub(crate) fn generic_dict<'py>(object: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyDict>> {
    // SAFETY: the argument is a live object; the call returns a new reference to its dictionary or sets an exception.
    let dict = unsafe {
        let dict = ffi::PyObject_GenericGetDict(object.as_ptr(), std::ptr::null_mut());
        Bound::from_owned_ptr_or_err(object.py(), dict)?
    };
    Ok(dict.cast_into::<PyDict>()?)
}
