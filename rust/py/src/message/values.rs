//! Payload bytes to Python values.

use mavwire_core::codec::{self, Number};
use mavwire_core::text::write_bytes_text;
use mavwire_schema::{Field, FieldType};
use pyo3::IntoPyObjectExt;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyFloat, PyList, PyString};

/// The value of a field as its attribute shows it: int, float, list or text. A payload that was truncated on the wire
/// reads as zeros past its end.
pub(crate) fn field_value(py: Python<'_>, field: &Field, payload: &[u8]) -> PyResult<Py<PyAny>> {
    if field.is_char() {
        return Ok(text(py, codec::text_bytes(field, payload)).into_any().unbind());
    }
    let offset = usize::from(field.offset);
    if field.array_length == 0 {
        return scalar(py, field.field_type, payload, offset);
    }
    let size = field.field_type.size();
    let items =
        (0..field.elements()).map(|i| scalar(py, field.field_type, payload, offset + i * size));
    Ok(PyList::new(py, items.collect::<PyResult<Vec<_>>>()?)?.into_any().unbind())
}

/// The bytes behind a text field, trailing NULs removed.
pub(crate) fn field_raw<'py>(
    py: Python<'py>,
    field: &Field,
    payload: &[u8],
) -> Bound<'py, PyBytes> {
    PyBytes::new(py, codec::text_bytes(field, payload))
}

/// Text before the first NUL; each byte that is not ASCII becomes U+FFFD.
pub(crate) fn text<'py>(py: Python<'py>, raw: &[u8]) -> Bound<'py, PyString> {
    let mut text = String::with_capacity(raw.len());
    write_bytes_text(&mut text, raw);
    PyString::new(py, &text)
}

/// One number. Bytes beyond the end of the payload are zero.
#[inline]
pub(crate) fn scalar(
    py: Python<'_>,
    field_type: FieldType,
    payload: &[u8],
    offset: usize,
) -> PyResult<Py<PyAny>> {
    match codec::number(field_type, payload, offset) {
        // Nearly all are small, which is the quick conversion.
        Number::Unsigned(value) => match i64::try_from(value) {
            Ok(small) => small.into_py_any(py),
            Err(_) => value.into_py_any(py),
        },
        Number::Signed(value) => value.into_py_any(py),
        Number::Float(value) => Ok(PyFloat::new(py, value).into_any().unbind()),
    }
}
