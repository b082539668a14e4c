//! Message classes, which Python's class statement could make as well, but not with a `tp_dealloc` of their own.

use std::ffi::CString;

use pyo3::prelude::*;
use pyo3::types::{PyDict, PyString, PyType};

use crate::message::create;
use crate::message::descriptors::FieldGetter;

/// A class called `name` in `module`, derived from `base`, with the attributes in `body`.
///
/// `ValueError` where the names hold a NUL, `TypeError` where `base` is no message class.
#[pyfunction]
pub(crate) fn message_class<'py>(
    module: &str,
    name: &Bound<'py, PyString>,
    base: &Bound<'py, PyType>,
    body: &Bound<'py, PyDict>,
) -> PyResult<Bound<'py, PyType>> {
    let full_name = CString::new(format!("{module}.{name}"))?;
    let class = create::message_class(&full_name, base)?;
    // The module is part of neither name, for texts that quote the class.
    class.setattr(intern!(name.py(), "__name__"), name)?;
    class.setattr(intern!(name.py(), "__qualname__"), name)?;
    for (attribute, value) in body {
        class.setattr(attribute.cast::<PyString>()?, &value)?;
        if let Ok(getter) = value.cast::<FieldGetter>() {
            getter.get().set_owner(&class);
        }
    }
    Ok(class)
}
