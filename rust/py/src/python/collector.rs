//! Which objects the garbage collector looks at. It looks at all of them in free-threaded builds.

use pyo3::ffi;
use pyo3::prelude::*;

/// Takes a fresh object out of the garbage collector's sight.
pub(crate) fn untrack(object: &Bound<'_, PyAny>) {
    if cfg!(not(Py_GIL_DISABLED)) {
        // SAFETY: the object is alive and of a type with garbage collection.
        unsafe { ffi::PyObject_GC_UnTrack(object.as_ptr().cast()) };
    }
}

/// Shows an object to the garbage collector, because it may refer to anything from now on.
pub(crate) fn track(object: &Bound<'_, PyAny>) {
    // SAFETY: as above. Tracking is asked for once only.
    unsafe {
        if cfg!(not(Py_GIL_DISABLED)) && ffi::PyObject_GC_IsTracked(object.as_ptr()) == 0 {
            ffi::PyObject_GC_Track(object.as_ptr().cast());
        }
    }
}
