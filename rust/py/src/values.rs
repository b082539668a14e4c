//! Payload bytes to Python values.

use mavwire_core::codec::read;
use mavwire_schema::{Field, FieldType};
use pyo3::IntoPyObjectExt;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyFloat, PyList, PyString};

/// The value of a field as its attribute shows it: int, float, list or text. A payload that was truncated on the wire
/// reads as zeros past its end.
pub(crate) fn field_value(py: Python<'_>, field: &Field, payload: &[u8]) -> PyResult<Py<PyAny>> {
    let offset = usize::from(field.offset);
    if field.is_char() {
        return Ok(text(py, raw_text(payload, offset, field.elements())).into_any().unbind());
    }
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
    PyBytes::new(py, raw_text(payload, usize::from(field.offset), field.elements()))
}

fn raw_text(payload: &[u8], offset: usize, len: usize) -> &[u8] {
    let start = offset.min(payload.len());
    let end = (offset + len).min(payload.len());
    let bytes = &payload[start..end];
    let kept = bytes.iter().rposition(|&b| b != 0).map_or(0, |last| last + 1);
    &bytes[..kept]
}

/// Text before the first NUL; each byte that is not ASCII becomes U+FFFD.
pub(crate) fn text<'py>(py: Python<'py>, raw: &[u8]) -> Bound<'py, PyString> {
    let end = memchr::memchr(0, raw).unwrap_or(raw.len());
    let raw = &raw[..end];
    match std::str::from_utf8(raw) {
        Ok(ascii) if raw.is_ascii() => PyString::new(py, ascii),
        _ => {
            let replaced: String =
                raw.iter().map(|&b| if b.is_ascii() { b as char } else { '\u{FFFD}' }).collect();
            PyString::new(py, &replaced)
        }
    }
}

/// One number. Bytes beyond the end of the payload are zero.
#[inline]
pub(crate) fn scalar(
    py: Python<'_>,
    field_type: FieldType,
    payload: &[u8],
    offset: usize,
) -> PyResult<Py<PyAny>> {
    match field_type {
        FieldType::Char | FieldType::U8 => read::<1>(payload, offset)[0].into_py_any(py),
        FieldType::I8 => i8::from_le_bytes(read(payload, offset)).into_py_any(py),
        FieldType::U16 => u16::from_le_bytes(read(payload, offset)).into_py_any(py),
        FieldType::I16 => i16::from_le_bytes(read(payload, offset)).into_py_any(py),
        FieldType::U32 => u32::from_le_bytes(read(payload, offset)).into_py_any(py),
        FieldType::I32 => i32::from_le_bytes(read(payload, offset)).into_py_any(py),
        FieldType::U64 => u64::from_le_bytes(read(payload, offset)).into_py_any(py),
        FieldType::I64 => i64::from_le_bytes(read(payload, offset)).into_py_any(py),
        FieldType::F32 => {
            let value = f64::from(f32::from_le_bytes(read(payload, offset)));
            Ok(PyFloat::new(py, value).into_any().unbind())
        }
        FieldType::F64 => {
            let value = f64::from_le_bytes(read(payload, offset));
            Ok(PyFloat::new(py, value).into_any().unbind())
        }
    }
}
