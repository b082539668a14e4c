//! One column as a buffer, which NumPy takes without a copy, or as a list where its values are texts.

use std::borrow::Cow;
use std::ffi::{CStr, c_int, c_void};

use mavwire_columns::arrow::array::{
    Array, ArrayRef, BinaryArray, DictionaryArray, FixedSizeListArray, StringArray,
};
use mavwire_columns::arrow::buffer::Buffer;
use mavwire_columns::arrow::datatypes::{DataType, Int32Type};
use pyo3::exceptions::PyBufferError;
use pyo3::ffi;
use pyo3::prelude::*;
use pyo3::types::PyList;

use crate::python::lists::list_of;

/// Numbers in memory: `shape` is (rows,) or (rows, elements).
#[pyclass(frozen, module = "mavwire._native")]
pub(crate) struct ColumnView {
    values: ArrayRef,
    numbers: Option<Numbers>,
}

struct Numbers {
    buffer: Buffer,
    /// First byte of the column in the buffer.
    start: usize,
    format: &'static CStr,
    item: isize,
    shape: Vec<isize>,
    strides: Vec<isize>,
}

/// Letter of Python's struct module and bytes of a number.
fn format_of(data_type: &DataType) -> Option<(&'static CStr, usize)> {
    Some(match data_type {
        DataType::UInt8 => (c"B", 1),
        DataType::Int8 => (c"b", 1),
        DataType::UInt16 => (c"H", 2),
        DataType::Int16 => (c"h", 2),
        DataType::UInt32 => (c"I", 4),
        DataType::Int32 => (c"i", 4),
        DataType::UInt64 => (c"Q", 8),
        DataType::Int64 | DataType::Timestamp(..) => (c"q", 8),
        DataType::Float32 => (c"f", 4),
        DataType::Float64 => (c"d", 8),
        _ => return None,
    })
}

impl Numbers {
    fn new(array: &ArrayRef, rows: usize, elements: Option<usize>) -> Option<Self> {
        let (format, item) = format_of(array.data_type())?;
        let data = array.to_data();
        let mut shape = vec![rows as isize];
        let mut strides = vec![(item * elements.unwrap_or(1)) as isize];
        if let Some(elements) = elements {
            shape.push(elements as isize);
            strides.push(item as isize);
        }
        let start = data.offset() * item;
        let buffer = data.buffers().first()?.clone();
        Some(Self { buffer, start, format, item: item as isize, shape, strides })
    }
}

impl ColumnView {
    /// A view of a column; `None` where there is no way to show it.
    pub(crate) fn new(array: &ArrayRef) -> Option<Self> {
        let numbers = match array.as_any().downcast_ref::<FixedSizeListArray>() {
            Some(lists) => {
                let elements = lists.value_length() as usize;
                let first = lists.value_offset_at(0);
                let values = lists.values().slice(first, lists.len() * elements);
                Numbers::new(&values, lists.len(), Some(elements))
            }
            None => Numbers::new(array, array.len(), None),
        };
        let shown = numbers.is_some()
            || match array.data_type() {
                DataType::FixedSizeList(item, _) => is_text(item.data_type()),
                other => is_text(other),
            };
        shown.then(|| Self { values: array.clone(), numbers })
    }
}

#[pymethods]
impl ColumnView {
    /// Whether the buffer protocol shows it.
    #[getter]
    fn is_numeric(&self) -> bool {
        self.numbers.is_some()
    }

    /// Whether it is a column of times, microseconds since 1970.
    #[getter]
    fn is_time(&self) -> bool {
        matches!(self.values.data_type(), DataType::Timestamp(..))
    }

    /// A byte for each value, 0 for a null. List elements have a byte each. `None` if there are no nulls.
    fn valid(&self) -> Option<Cow<'static, [u8]>> {
        if self.values.null_count() == 0 && !has_null_elements(&self.values) {
            return None;
        }
        let Some(lists) = self.values.as_any().downcast_ref::<FixedSizeListArray>() else {
            return Some(
                (0..self.values.len()).map(|row| self.values.is_valid(row).into()).collect(),
            );
        };
        let elements = lists.value_length() as usize;
        let of_row = |row: usize| {
            let first = lists.value_offset_at(row);
            let each = first..first + elements;
            each.map(move |at| u8::from(lists.is_valid(row) && lists.values().is_valid(at)))
        };
        Some((0..lists.len()).flat_map(of_row).collect())
    }

    /// How many elements the lists of a column have; `None` where its values are no lists.
    #[getter]
    fn elements(&self) -> Option<i32> {
        match self.values.data_type() {
            DataType::FixedSizeList(_, elements) => Some(*elements),
            _ => None,
        }
    }

    /// The texts or bytes, those of lists one by one; `None` for rows without.
    fn to_list<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyList>> {
        let any = self.values.as_any();
        if let Some(texts) = any.downcast_ref::<StringArray>() {
            return list_of(py, texts.iter());
        }
        if let Some(bytes) = any.downcast_ref::<BinaryArray>() {
            let bytes = bytes.iter().map(|one| one.map(|b| pyo3::types::PyBytes::new(py, b)));
            return list_of(py, bytes);
        }
        if let Some(keyed) = any.downcast_ref::<DictionaryArray<Int32Type>>()
            && let Some(texts) = keyed.downcast_dict::<StringArray>()
        {
            return list_of(py, texts.into_iter());
        }
        if let Some(lists) = any.downcast_ref::<FixedSizeListArray>()
            && let Some(keyed) =
                lists.values().as_any().downcast_ref::<DictionaryArray<Int32Type>>()
            && let Some(texts) = keyed.downcast_dict::<StringArray>()
        {
            let elements = lists.value_length() as usize;
            let texts: Vec<Option<&str>> = texts.into_iter().collect();
            let of_row = |row: usize| {
                let first = lists.value_offset_at(row);
                let shown = texts[first..first + elements].iter();
                shown.map(move |text| text.filter(|_| lists.is_valid(row)))
            };
            return list_of(py, (0..lists.len()).flat_map(of_row));
        }
        Err(PyBufferError::new_err("a column of numbers is read through its buffer"))
    }

    fn __len__(&self) -> usize {
        self.values.len()
    }

    /// Fills in a read-only view of the memory, which this object keeps alive.
    unsafe fn __getbuffer__(
        slf: Bound<'_, Self>,
        view: *mut ffi::Py_buffer,
        flags: c_int,
    ) -> PyResult<()> {
        let this = slf.get();
        let Some(numbers) = &this.numbers else {
            return Err(PyBufferError::new_err("this column has no numbers"));
        };
        if flags & ffi::PyBUF_WRITABLE == ffi::PyBUF_WRITABLE {
            return Err(PyBufferError::new_err("the memory of a table is read-only"));
        }
        // What was not asked for stays NULL; the memory has no holes, so that it is right without strides too.
        let asked = |flag: c_int| flags & flag == flag;
        let or_null = |flag, sizes: &[isize]| {
            if asked(flag) { sizes.as_ptr().cast_mut() } else { std::ptr::null_mut() }
        };
        let format = numbers.format.as_ptr().cast_mut();
        let bytes = &numbers.buffer.as_slice()[numbers.start..];
        let count: isize = numbers.shape.iter().product();
        // SAFETY: the interpreter hands in a view to fill; shape, strides, format and memory belong to a frozen object,
        // whose reference goes into `obj` and is given back when the view is released.
        unsafe {
            (*view).buf = bytes.as_ptr().cast::<c_void>().cast_mut();
            (*view).len = count * numbers.item;
            (*view).readonly = 1;
            (*view).itemsize = numbers.item;
            (*view).ndim = numbers.shape.len() as c_int;
            (*view).format = if asked(ffi::PyBUF_FORMAT) { format } else { std::ptr::null_mut() };
            (*view).shape = or_null(ffi::PyBUF_ND, &numbers.shape);
            (*view).strides = or_null(ffi::PyBUF_STRIDES, &numbers.strides);
            (*view).suboffsets = std::ptr::null_mut();
            (*view).internal = std::ptr::null_mut();
            (*view).obj = slf.clone().into_any().into_ptr();
        }
        Ok(())
    }

    /// Nothing is held for a view but the reference to this object.
    unsafe fn __releasebuffer__(&self, view: *mut ffi::Py_buffer) {
        let _ = view;
    }
}

fn has_null_elements(array: &ArrayRef) -> bool {
    let lists = array.as_any().downcast_ref::<FixedSizeListArray>();
    lists.is_some_and(|lists| lists.values().null_count() > 0)
}

/// Whether values of a type are shown as a list of texts or bytes.
fn is_text(kind: &DataType) -> bool {
    matches!(kind, DataType::Utf8 | DataType::Binary | DataType::Dictionary(..))
}
