//! Python objects that user code reads and replaces while other threads use them.

use pyo3::ffi;
use pyo3::gc::{PyTraverseError, PyVisit};
use pyo3::prelude::*;

use crate::sync::lock::Lock;

/// A place for a Python object of a known type, or for any.
pub(crate) struct Slot<T = PyAny>(Lock<Option<Py<T>>>);

impl<T> Slot<T> {
    pub(crate) const fn new() -> Self {
        Self(Lock::new(None))
    }

    #[inline]
    pub(crate) fn get<'py>(&self, py: Python<'py>) -> Option<Bound<'py, T>> {
        self.0.lock(py).as_ref().map(|value| value.bind(py).clone())
    }

    /// Whether anybody else may refer to the object.
    #[inline]
    pub(crate) fn is_shared(&self, py: Python<'_>) -> bool {
        // SAFETY: the object is alive while the lock is held.
        let references = |value: &Py<T>| unsafe { ffi::Py_REFCNT(value.as_ptr()) };
        cfg!(Py_GIL_DISABLED) || self.0.lock(py).as_ref().is_some_and(|value| references(value) > 1)
    }

    /// Whether there is an object of which `is` holds. `is` must not run Python code.
    #[inline]
    pub(crate) fn is_some_and(&self, py: Python<'_>, is: impl FnOnce(&Py<T>) -> bool) -> bool {
        self.0.lock(py).as_ref().is_some_and(is)
    }

    pub(crate) fn set(&self, value: Option<Py<T>>) {
        // The old value is dropped after the lock is released: its destructor may run Python code.
        let old = Python::attach(|py| std::mem::replace(&mut *self.0.lock(py), value));
        drop(old);
    }

    pub(crate) fn traverse(&self, visit: PyVisit<'_>) -> Result<(), PyTraverseError> {
        // SAFETY: the garbage collector runs attached.
        match unsafe { self.0.try_lock() } {
            Some(value) => visit.call(value.as_ref()),
            None => Ok(()),
        }
    }
}
