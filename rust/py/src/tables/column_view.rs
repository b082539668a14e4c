//! One column as a buffer, which NumPy takes without a copy, or as a list if its values are texts.

use std::borrow::Cow;
use std::ffi::c_int;

use mavwire_columns::arrow::array::{
    Array, ArrayRef, AsArray, BinaryArray, FixedSizeListArray, StringArray,
};
use mavwire_columns::arrow::buffer::{Buffer, NullBuffer};
use mavwire_columns::arrow::compute::cast;
use mavwire_columns::arrow::datatypes::{DataType, TimeUnit};
use pyo3::exceptions::PyBufferError;
use pyo3::ffi;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyList};

use crate::python::error::Result;
use crate::python::lists::list_of;

/// The values of a column in memory, those of lists one behind the other.
#[pyclass(frozen, module = "mavwire._native")]
pub(crate) struct ColumnView {
    values: ArrayRef,
    /// Which values there are; `None` for all.
    valid: Option<NullBuffer>,
    /// How many elements the lists of a column have; `None` if its values are no lists.
    #[pyo3(get)]
    elements: Option<i32>,
    /// The type of numbers and times as NumPy spells it; `None` for texts.
    #[pyo3(get)]
    dtype: Option<String>,
    /// The memory of numbers.
    numbers: Buffer,
}

fn dtype(data_type: &DataType) -> Option<String> {
    let kind = match data_type {
        DataType::Timestamp(TimeUnit::Microsecond, _) => return Some("M8[us]".to_owned()),
        integer if integer.is_unsigned_integer() => 'u',
        integer if integer.is_signed_integer() => 'i',
        float if float.is_floating() => 'f',
        _ => return None,
    };
    Some(format!("{kind}{}", data_type.primitive_width()?))
}

impl ColumnView {
    /// A view of a column; `None` if its type cannot be shown.
    pub(crate) fn new(column: &ArrayRef) -> Option<Self> {
        let lists = column.as_any().downcast_ref::<FixedSizeListArray>();
        let elements = lists.map(FixedSizeListArray::value_length);
        let values = lists.map_or_else(
            || column.clone(),
            |lists| lists.values().slice(lists.value_offset_at(0), elements_of(lists)),
        );
        let of_lists =
            lists.and_then(|lists| Some(lists.nulls()?.expand(lists.value_length() as usize)));
        let valid = NullBuffer::union(values.nulls(), of_lists.as_ref());
        let valid = valid.filter(|valid| valid.null_count() > 0);
        let dtype = dtype(values.data_type());
        let is_text = matches!(
            values.data_type(),
            DataType::Utf8 | DataType::Binary | DataType::Dictionary(..)
        );
        if dtype.is_none() && !is_text {
            return None;
        }
        let data = values.to_data();
        let width = values.data_type().primitive_width().unwrap_or(0);
        let numbers =
            data.buffers()[0].slice_with_length(data.offset() * width, data.len() * width);
        Some(Self { values, valid, elements, dtype, numbers })
    }
}

fn elements_of(lists: &FixedSizeListArray) -> usize {
    lists.len() * lists.value_length() as usize
}

#[pymethods]
impl ColumnView {
    /// A byte for each value, 0 for a null. `None` if there are no nulls.
    fn valid(&self) -> Option<Cow<'static, [u8]>> {
        Some(self.valid.as_ref()?.iter().map(u8::from).collect())
    }

    /// The texts or bytes; `None` for nulls.
    fn to_list<'py>(&self, py: Python<'py>) -> Result<Bound<'py, PyList>> {
        if self.dtype.is_some() {
            return Err(PyBufferError::new_err("numbers are read through the buffer").into());
        }
        let is_valid = |row: &usize| self.valid.as_ref().is_none_or(|valid| valid.is_valid(*row));
        let rows = (0..self.values.len()).map(|row| Some(row).filter(is_valid));
        if let Some(bytes) = self.values.as_any().downcast_ref::<BinaryArray>() {
            let bytes = rows.map(|row| row.map(|row| PyBytes::new(py, bytes.value(row))));
            return Ok(list_of(py, bytes)?);
        }
        let texts = cast(&self.values, &DataType::Utf8)?;
        let texts: &StringArray = texts.as_string();
        Ok(list_of(py, rows.map(|row| row.map(|row| texts.value(row))))?)
    }

    fn __len__(&self) -> usize {
        self.values.len()
    }

    /// Fills in a read-only view of the bytes, which this object keeps alive.
    unsafe fn __getbuffer__(
        slf: Bound<'_, Self>,
        view: *mut ffi::Py_buffer,
        flags: c_int,
    ) -> PyResult<()> {
        let bytes = slf.get().numbers.as_slice();
        let (start, len) = (bytes.as_ptr().cast_mut().cast(), bytes.len() as ffi::Py_ssize_t);
        // SAFETY: the interpreter hands in a view to fill. The memory belongs to a frozen object, whose reference goes into
        // the view and is given back when the view is released.
        let done = unsafe { ffi::PyBuffer_FillInfo(view, slf.as_ptr(), start, len, 1, flags) };
        if done == 0 { Ok(()) } else { Err(PyErr::fetch(slf.py())) }
    }
}
