//! The one Python object that a message may hold besides its dictionary: the frame that `pack` made, or the reason why
//! bytes are BAD_DATA. Eight bytes, since most messages have none.

use std::sync::atomic::{AtomicPtr, Ordering::Relaxed};

use pyo3::ffi;
use pyo3::prelude::*;

/// A `bytes` or a `str`, or nothing. Neither can be part of a reference cycle, so the garbage collector need not know.
pub(crate) struct Extra(AtomicPtr<ffi::PyObject>);

impl Extra {
    pub(crate) const fn none() -> Self {
        Self(AtomicPtr::new(std::ptr::null_mut()))
    }

    /// Holds `value`, which must be a `bytes` or a `str`.
    pub(crate) fn holding(value: &Bound<'_, PyAny>) -> Self {
        Self(AtomicPtr::new(value.clone().into_ptr()))
    }

    pub(crate) fn get<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyAny>> {
        // SAFETY: null or an object of which this holds a reference. Only an attached thread can replace it.
        unsafe { Bound::from_borrowed_ptr_or_opt(py, self.0.load(Relaxed)) }
    }

    pub(crate) fn set(&self, value: &Bound<'_, PyAny>) {
        let new = value.clone().into_ptr();
        let old = self.0.load(Relaxed);
        self.0.store(new, Relaxed);
        // SAFETY: null or an object of which this held a reference, which it has given up.
        unsafe { ffi::Py_XDECREF(old) };
    }
}

impl Drop for Extra {
    fn drop(&mut self) {
        // SAFETY: null or an object of which this holds a reference. Messages are dropped with their Python object or
        // before there is one, in both cases by a thread that is attached.
        unsafe { ffi::Py_XDECREF(*self.0.get_mut()) };
    }
}
