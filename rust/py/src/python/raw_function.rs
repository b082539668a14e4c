//! Functions that Python calls without PyO3 in between: the arguments arrive as an array, no tuple is made and nothing is
//! converted. For the two that every message sent goes through; it halves what a call costs.
//!
//! Inside such a function PyO3 does not know that the thread is attached, so it works with `Bound` alone: a `Py` that is
//! dropped there would wait for the next ordinary call to be released.

use std::any::Any;
use std::ffi::CStr;
use std::panic::{AssertUnwindSafe, catch_unwind};

use pyo3::exceptions::PyTypeError;
use pyo3::ffi;
use pyo3::panic::PanicException;
use pyo3::prelude::*;

/// `function(module, arguments, count)`
pub(crate) type Function = unsafe extern "C" fn(
    *mut ffi::PyObject,
    *mut *mut ffi::PyObject,
    ffi::Py_ssize_t,
) -> *mut ffi::PyObject;

/// The positional arguments of a call.
pub(crate) struct Arguments<'a, 'py> {
    py: Python<'py>,
    items: &'a [*mut ffi::PyObject],
}

impl<'a, 'py> Arguments<'a, 'py> {
    /// The argument at `index`, if there is one.
    #[inline]
    pub(crate) fn get(&self, index: usize) -> Option<Borrowed<'a, 'py, PyAny>> {
        // SAFETY: the caller of the function holds a reference to each of its arguments until it returns.
        self.items.get(index).map(|&item| unsafe { Borrowed::from_ptr(self.py, item) })
    }

    /// The argument at `index`, which the function needs.
    #[inline]
    pub(crate) fn require(&self, index: usize) -> PyResult<Borrowed<'a, 'py, PyAny>> {
        self.get(index).ok_or_else(|| PyTypeError::new_err("arguments are missing"))
    }

    /// All arguments from `start` on.
    pub(crate) fn from(&self, start: usize) -> Self {
        Self { py: self.py, items: self.items.get(start..).unwrap_or_default() }
    }

    pub(crate) fn iter(&self) -> impl Iterator<Item = Borrowed<'a, 'py, PyAny>> {
        (0..self.items.len()).filter_map(|index| self.get(index))
    }
}

/// Calls `body` with the arguments; its errors and panics become exceptions. It returns `None`.
///
/// # Safety
/// Must be called by a [`Function`] with its own arguments.
pub(crate) unsafe fn call(
    arguments: *mut *mut ffi::PyObject,
    count: ffi::Py_ssize_t,
    body: impl FnOnce(Python<'_>, Arguments<'_, '_>) -> PyResult<()>,
) -> *mut ffi::PyObject {
    // SAFETY: CPython calls attached, with as many arguments as it says; the array may be null if there are none.
    let (py, items) = unsafe {
        let items = match usize::try_from(count) {
            Ok(count @ 1..) => std::slice::from_raw_parts(arguments, count),
            _ => &[],
        };
        (Python::assume_attached(), items)
    };
    let error = match catch_unwind(AssertUnwindSafe(|| body(py, Arguments { py, items }))) {
        Ok(Ok(())) => return py.None().into_ptr(),
        Ok(Err(error)) => error,
        Err(payload) => PanicException::new_err((panic_text(&*payload),)),
    };
    error.restore(py);
    std::ptr::null_mut()
}

fn panic_text(payload: &(dyn Any + Send)) -> String {
    let text = payload.downcast_ref::<&str>().map(|text| (*text).to_owned());
    text.or_else(|| payload.downcast_ref::<String>().cloned()).unwrap_or_default()
}

/// Adds a function to a module.
pub(crate) fn add(
    module: &Bound<'_, PyModule>,
    name: &'static CStr,
    doc: &'static CStr,
    function: Function,
) -> PyResult<()> {
    // The module may be used until the process ends.
    let definition = Box::leak(Box::new(ffi::PyMethodDef {
        ml_name: name.as_ptr(),
        ml_meth: ffi::PyMethodDefPointer { PyCFunctionFast: function },
        ml_flags: ffi::METH_FASTCALL,
        ml_doc: doc.as_ptr(),
    }));
    // SAFETY: the definition lives for ever; the call returns a new reference or sets an exception.
    let function = unsafe {
        let function =
            ffi::PyCFunction_NewEx(definition, std::ptr::null_mut(), module.name()?.as_ptr());
        Bound::from_owned_ptr_or_err(module.py(), function)?
    };
    module.add(name.to_string_lossy().as_ref(), function)
}
