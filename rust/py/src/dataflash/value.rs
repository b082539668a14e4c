//! Field values as Python objects: from a record's bytes, from a line of a text log, or from an object somebody set.

use mavwire_core::log::dataflash::text::decode_line;
use mavwire_core::log::dataflash::{Field, FieldKind, Value};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyFloat, PyInt, PyString};

use crate::python::calling::Calling;

/// Digits that Python's `int` takes of a text. Longer numbers are damage, and read as floats, mostly infinite.
const MAX_DIGITS: usize = 4300;

/// The text of a field: up to its NUL, UTF-8, or Latin-1 where it is none.
pub(super) fn text_of(bytes: &[u8]) -> String {
    decode_line(&bytes[..memchr::memchr(0, bytes).unwrap_or(bytes.len())])
}

/// The stored value: texts are bytes with all their NULs, arrays are `array.array`.
pub(super) fn stored<'py>(py: Python<'py>, value: Value<'_>) -> PyResult<Bound<'py, PyAny>> {
    Ok(match value {
        Value::Integer(number) => number.into_pyobject(py)?.into_any(),
        Value::Unsigned(number) => number.into_pyobject(py)?.into_any(),
        Value::Float(number) => PyFloat::new(py, number).into_any(),
        Value::Text(bytes) => PyBytes::new(py, bytes).into_any(),
        Value::Array(bytes) => array(py, bytes)?,
    })
}

/// The value of a field in a record's body.
#[inline]
pub(super) fn from_body<'py>(
    py: Python<'py>,
    field: &Field,
    body: &[u8],
    raw_bytes: bool,
) -> PyResult<Bound<'py, PyAny>> {
    match field.value(body) {
        Value::Integer(number) if field.kind.scale().is_some() => {
            Ok(PyFloat::new(py, field.kind.scaled(number as f64)).into_any())
        }
        Value::Text(bytes) if !(raw_bytes && bytes.len() == 64) => {
            let bytes = &bytes[..memchr::memchr(0, bytes).unwrap_or(bytes.len())];
            match std::str::from_utf8(bytes) {
                Ok(text) => Ok(PyString::new(py, text).into_any()),
                Err(_) => Ok(PyString::new(py, &decode_line(bytes)).into_any()),
            }
        }
        other => stored(py, other),
    }
}

/// `array.array('h')` of little-endian numbers.
fn array<'py>(py: Python<'py>, bytes: &[u8]) -> PyResult<Bound<'py, PyAny>> {
    let numbers: Vec<i16> =
        bytes.as_chunks::<2>().0.iter().map(|pair| i16::from_le_bytes(*pair)).collect();
    py.import(intern!(py, "array"))?.getattr(intern!(py, "array"))?.invoke1(("h", numbers))
}

/// The value of a field of a text log.
pub(super) fn from_text<'py>(
    py: Python<'py>,
    kind: FieldKind,
    bytes: &[u8],
) -> PyResult<Bound<'py, PyAny>> {
    let is_number = !matches!(kind, FieldKind::Text(_) | FieldKind::Array | FieldKind::Mode);
    if is_number && let Ok(text) = std::str::from_utf8(bytes) {
        if !kind.is_float()
            && let Ok(number) = text.parse::<i64>()
        {
            return Ok(number.into_pyobject(py)?.into_any());
        }
        if (kind.is_float() || text.len() > MAX_DIGITS)
            && let Ok(number) = text.parse::<f64>()
        {
            return Ok(PyFloat::new(py, number).into_any());
        }
    }
    from_object(PyString::new(py, &decode_line(bytes)).as_any(), kind, false, false)
}

/// The value of a field whose element is any object: as Python converts it to the field's type.
///
/// Fails with Python's exception where it does not convert.
pub(super) fn from_object<'py>(
    element: &Bound<'py, PyAny>,
    kind: FieldKind,
    scale: bool,
    raw_bytes: bool,
) -> PyResult<Bound<'py, PyAny>> {
    let py = element.py();
    match kind {
        FieldKind::Text(len) => Ok(match element.cast::<PyBytes>() {
            Ok(_) if raw_bytes && len == 64 => element.clone(),
            Ok(bytes) => PyString::new(py, &text_of(bytes.as_bytes())).into_any(),
            Err(_) => element.str()?.into_any(),
        }),
        FieldKind::Array => match element.cast::<PyBytes>() {
            Ok(bytes) => array(py, bytes.as_bytes()),
            Err(_) => Ok(element.clone()),
        },
        // Text logs have the mode's name.
        FieldKind::Mode if element.is_instance_of::<PyString>() => Ok(element.clone()),
        _ if kind.is_float() => {
            let number = py.get_type::<PyFloat>().invoke1((element,))?;
            if !scale || kind.scale().is_none() {
                return Ok(number);
            }
            Ok(PyFloat::new(py, kind.scaled(number.extract()?)).into_any())
        }
        _ => int(element),
    }
}

fn int<'py>(element: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
    element.py().get_type::<PyInt>().invoke1((element,))
}
