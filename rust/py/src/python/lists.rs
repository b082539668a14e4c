//! Lists that come from a program.
//!
//! `Vec` as PyO3 makes it takes memory at once for as many items as an object says it has, and the process ends if there
//! is not so much: `range(10**12)` and objects that lie are enough. These take items one after the other, up to a number
//! that no list here comes near.

use pyo3::conversion::FromPyObjectOwned;
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyByteArray, PyBytes, PyList, PyString};

use crate::python::calling::Calling;

/// Items that a list may have.
const MAX_ITEMS: usize = 1 << 20;

fn too_long() -> PyErr {
    PyValueError::new_err(format!("a list of more than {MAX_ITEMS} items"))
}

/// The items of any iterable but a string, for `#[pyo3(from_py_with = list)]`. `TypeError` for other types, `ValueError` for
/// more than 1,048,576 items.
pub(crate) fn list<'py, T: FromPyObjectOwned<'py>>(object: &Bound<'py, PyAny>) -> PyResult<Vec<T>> {
    if object.is_instance_of::<PyString>() {
        return Err(PyTypeError::new_err("a list is needed, not a string"));
    }
    // A length that is too large is believed before a million items are taken, a smaller one is not.
    if object.len().is_ok_and(|len| len > MAX_ITEMS) {
        return Err(too_long());
    }
    collected(object.try_iter()?.map(|item| item?.extract().map_err(Into::into)))
}

/// The items of an iterator over objects of a program, if they are not too many.
pub(crate) fn collected<T>(from: impl Iterator<Item = PyResult<T>>) -> PyResult<Vec<T>> {
    let mut items = Vec::new();
    for item in from {
        if items.len() == MAX_ITEMS {
            return Err(too_long());
        }
        items.push(item?);
    }
    Ok(items)
}

/// The items of a [`list`], or `None` for `None`.
pub(crate) fn optional_list<'py, T: FromPyObjectOwned<'py>>(
    object: &Bound<'py, PyAny>,
) -> PyResult<Option<Vec<T>>> {
    if object.is_none() { Ok(None) } else { list(object).map(Some) }
}

/// Bytes: of any length if they are `bytes` or a `bytearray`, else the numbers of a [`list`].
pub(crate) fn bytes(object: &Bound<'_, PyAny>) -> PyResult<Vec<u8>> {
    if let Ok(bytes) = object.cast::<PyBytes>() {
        return Ok(bytes.as_bytes().to_vec());
    }
    match object.cast::<PyByteArray>() {
        Ok(array) => Ok(array.to_vec()),
        Err(_) => list(object),
    }
}

/// Bytes of anything that `bytearray.extend` takes.
pub(crate) fn bytes_like<'py>(data: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
    if data.is_exact_instance_of::<PyBytes>() {
        return Ok(data.clone());
    }
    let buffer = PyByteArray::new(data.py(), b"");
    buffer.invoke_method1(intern!(data.py(), "extend"), (data,))?;
    Ok(PyBytes::new(data.py(), &buffer.to_vec()).into_any())
}

/// A Python list of the values.
pub(crate) fn list_of<'py, T: IntoPyObject<'py>>(
    py: Python<'py>,
    values: impl Iterator<Item = T>,
) -> PyResult<Bound<'py, PyList>> {
    let list = PyList::empty(py);
    for value in values {
        list.append(value)?;
    }
    Ok(list)
}
