//! Python numbers to Rust ones, without building an exception where one does not fit.

use pyo3::prelude::*;
use pyo3::types::{PyFloat, PyInt};
use pyo3::{Borrowed, ffi};

/// An `int` (or a subclass of it) that fits.
#[inline]
pub(crate) fn integer(value: Borrowed<'_, '_, PyAny>) -> Option<i64> {
    (value.is_exact_instance_of::<PyInt>() || value.is_instance_of::<PyInt>()).then_some(())?;
    let mut overflow = 0;
    // SAFETY: the object is an int, for which this call cannot fail other than by overflow, which raises nothing.
    let number = unsafe { ffi::PyLong_AsLongLongAndOverflow(value.as_ptr(), &raw mut overflow) };
    (overflow == 0).then_some(number)
}

/// An `int` of 0 to 2^64 - 1.
pub(crate) fn unsigned(value: Borrowed<'_, '_, PyAny>) -> Option<u64> {
    match integer(value) {
        Some(number) => u64::try_from(number).ok(),
        None => value.cast::<PyInt>().ok()?.extract().ok(),
    }
}

/// A `float`, or an `int` that is no subclass and fits into one without loss. Runs no Python code, like all functions here.
#[inline]
pub(crate) fn float(value: Borrowed<'_, '_, PyAny>) -> Option<f64> {
    if value.is_exact_instance_of::<PyFloat>() {
        // SAFETY: the object is a float.
        return Some(unsafe { ffi::PyFloat_AsDouble(value.as_ptr()) });
    }
    if !value.is_exact_instance_of::<PyInt>() {
        return value.cast::<PyFloat>().ok().map(|float| float.value());
    }
    let number = integer(value)?;
    (number.unsigned_abs() <= 1 << f64::MANTISSA_DIGITS).then_some(number as f64)
}
