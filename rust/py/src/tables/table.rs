//! `RecordBatches`: a table, handed out by the Arrow C data interface and, column by column, as buffers.

use std::collections::{BTreeSet, VecDeque};
use std::path::PathBuf;
use std::sync::{Arc, OnceLock};

use mavwire_columns::arrow::array::{
    Array, ArrayRef, BinaryArray, RecordBatch, RecordBatchIterator, StringArray, UInt8Array,
};
use mavwire_columns::arrow::compute::concat_batches;
use mavwire_columns::arrow::datatypes::{DataType, Schema, SchemaRef};
use mavwire_columns::arrow::error::ArrowError;
use mavwire_columns::arrow::ffi::FFI_ArrowSchema;
use mavwire_columns::arrow::ffi_stream::{FFI_ArrowArrayStream, RecordBatchStreamReader};
use mavwire_columns::arrow::ipc::reader::StreamReader;
use mavwire_columns::arrow::ipc::writer::StreamWriter;
use mavwire_columns::common_schema::CommonSchema;
use mavwire_columns::fit::fit;
use mavwire_columns::instances::split;
use pyo3::exceptions::{PyKeyError, PyKeyboardInterrupt, PyTypeError, PyValueError};
use pyo3::ffi;
use pyo3::prelude::*;
use pyo3::types::{IntoPyDict, PyCapsule, PyDict, PyIterator, PyString, PyTuple};

use crate::python::calling::Calling;
use crate::python::error::Result;
use crate::python::lists::list;
use crate::tables::column_view::ColumnView;

/// A table: a schema and batches of rows.
#[pyclass(frozen, module = "mavwire._native")]
pub(crate) struct RecordBatches {
    schema: SchemaRef,
    batches: Vec<RecordBatch>,
    /// All rows in one batch, once somebody wanted that.
    whole: OnceLock<RecordBatch>,
}

impl RecordBatches {
    pub(crate) fn new(schema: SchemaRef, batches: Vec<RecordBatch>) -> Self {
        Self { schema, batches, whole: OnceLock::new() }
    }

    pub(crate) fn batches(&self) -> &[RecordBatch] {
        &self.batches
    }

    pub(crate) fn schema(&self) -> &SchemaRef {
        &self.schema
    }

    /// All rows in one batch.
    pub(crate) fn whole(&self, py: Python<'_>) -> Result<&RecordBatch> {
        if let Some(whole) = self.whole.get() {
            return Ok(whole);
        }
        let whole = match &self.batches[..] {
            [one] => one.clone(),
            all => {
                check_joinable(&self.schema, all, i32::MAX as usize)?;
                py.detach(|| concat_batches(&self.schema, all))?
            }
        };
        Ok(self.whole.get_or_init(|| whole))
    }

    fn index_of(&self, py: Python<'_>, name: &str) -> PyResult<usize> {
        if let Ok(index) = self.schema.index_of(name) {
            return Ok(index);
        }
        let text = py.import(intern!(py, "mavwire._text"))?;
        let hint = text.invoke_method1(intern!(py, "did_you_mean"), (name, self.names()))?;
        let name = PyString::new(py, name).repr()?;
        Err(PyKeyError::new_err(format!("the table has no column {name}{hint}")))
    }
}

#[pymethods]
impl RecordBatches {
    /// A table of anything that has `__arrow_c_stream__`; the data is shared.
    #[staticmethod]
    fn from_stream(table: &Bound<'_, PyAny>) -> Result<Self> {
        let capsule = table.invoke_method0("__arrow_c_stream__")?.cast_into::<PyCapsule>()?;
        let pointer = capsule.pointer_checked(Some(c"arrow_array_stream"))?;
        // SAFETY: a capsule of this name holds such a stream, which is moved out and marked as released.
        let stream = unsafe { FFI_ArrowArrayStream::from_raw(pointer.as_ptr().cast()) };
        let reader = RecordBatchStreamReader::try_new(stream)?;
        let schema = mavwire_columns::arrow::array::RecordBatchReader::schema(&reader);
        Ok(Self::new(schema, reader.collect::<Result<_, _>>()?))
    }

    /// Tables of one type, one behind the other. `ValueError` where their columns differ.
    #[staticmethod]
    fn joined(#[pyo3(from_py_with = list)] tables: Vec<PyRef<'_, Self>>) -> PyResult<Self> {
        let first = tables.first().ok_or_else(|| PyValueError::new_err("no tables"))?;
        let schema = Arc::clone(&first.schema);
        if tables.iter().any(|table| table.schema != schema) {
            return Err(PyValueError::new_err("the tables have different columns"));
        }
        let batches = tables.iter().flat_map(|table| table.batches.iter().cloned()).collect();
        Ok(Self::new(schema, batches))
    }

    /// Bytes of the values.
    #[getter]
    fn nbytes(&self) -> usize {
        let columns = self.batches.iter().flat_map(RecordBatch::columns);
        columns.map(|column| column.to_data().get_slice_memory_size().unwrap_or(0)).sum()
    }

    /// `{column: {key: value}}`.
    fn metadata<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let all = PyDict::new(py);
        for field in self.schema.fields() {
            all.set_item(field.name(), field.metadata().iter().into_py_dict(py)?)?;
        }
        Ok(all)
    }

    /// `{column: Arrow's name of its type}`.
    fn types<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let fields = self.schema.fields().iter();
        fields.map(|field| (field.name(), field.data_type().to_string())).into_py_dict(py)
    }

    /// A column in one piece.
    fn column(&self, py: Python<'_>, name: &str) -> PyResult<ColumnView> {
        let index = self.index_of(py, name)?;
        let array = self.whole(py)?.column(index);
        ColumnView::new(array).ok_or_else(|| {
            PyTypeError::new_err(format!("no view of {name}: {}", array.data_type()))
        })
    }

    /// The same table without columns of raw bytes that hold nothing but nulls.
    fn without_empty_raw(slf: Bound<'_, Self>) -> PyResult<Bound<'_, Self>> {
        let table = slf.get();
        let fields = table.schema.fields();
        let is_empty = |index: usize| {
            *fields[index].data_type() == DataType::Binary
                && table.batches.iter().all(|b| b.column(index).null_count() == b.num_rows())
        };
        let kept: Vec<usize> = (0..fields.len()).filter(|&index| !is_empty(index)).collect();
        if kept.len() == fields.len() {
            return Ok(slf);
        }
        Bound::new(slf.py(), table.project(&kept)?)
    }

    /// Some of the columns, in the order given.
    fn select(
        &self,
        py: Python<'_>,
        #[pyo3(from_py_with = list)] names: Vec<String>,
    ) -> Result<Self> {
        let kept: Vec<_> =
            names.iter().map(|name| self.index_of(py, name)).collect::<Result<_, _>>()?;
        self.project(&kept)
    }

    /// The rows of each value of a column, by the text of the value: `[(text, table), ...]`.
    fn split(&self, py: Python<'_>, name: &str) -> Result<Vec<(String, Self)>> {
        let index = self.index_of(py, name)?;
        let whole = self.whole(py)?;
        let parts = py.detach(|| split(whole, index))?;
        let part = |(text, rows)| (text, Self::new(Arc::clone(&self.schema), vec![rows]));
        Ok(parts.into_iter().map(part).collect())
    }

    /// System and component ids of the rows, each pair once; none where the table lacks them.
    fn senders(&self, py: Python<'_>) -> BTreeSet<(u8, u8)> {
        py.detach(|| {
            let mut senders = BTreeSet::new();
            for batch in &self.batches {
                let ids = |name| batch.column_by_name(name).and_then(|c| c.as_any().downcast_ref());
                let (Some(systems), Some(components)): (Option<&UInt8Array>, Option<&UInt8Array>) =
                    (ids("sysid"), ids("compid"))
                else {
                    continue;
                };
                let mut pairs: Vec<_> = systems
                    .values()
                    .iter()
                    .copied()
                    .zip(components.values().iter().copied())
                    .collect();
                pairs.dedup();
                senders.extend(pairs);
            }
            senders
        })
    }

    /// Some of the rows.
    fn slice(&self, py: Python<'_>, start: usize, rows: usize) -> PyResult<Self> {
        let whole = self.whole(py)?;
        let start = start.min(whole.num_rows());
        let rows = rows.min(whole.num_rows() - start);
        Ok(Self::new(Arc::clone(&self.schema), vec![whole.slice(start, rows)]))
    }

    /// An empty table with the columns of all `tables`, pairs of `(path of the log, table)` of one message type. `ValueError`
    /// if columns of one name in two logs have no common type.
    #[staticmethod]
    fn common(tables: &Bound<'_, PyIterator>) -> Result<Self> {
        let mut common = CommonSchema::default();
        for pair in tables.try_iter()? {
            let (path, table): (PathBuf, PyRef<'_, Self>) = pair?.extract()?;
            common.add(&table.schema, path);
        }
        let schema = common.schema()?;
        Ok(Self::new(schema, Vec::new()))
    }

    /// The same rows with the columns of a table that `common` made. Values that do not fit are null.
    fn fitted(&self, py: Python<'_>, like: &Self) -> Result<Self> {
        let fit_all = || self.batches.iter().map(|batch| fit(batch, &like.schema)).collect();
        let fitted: Result<_, ArrowError> = py.detach(fit_all);
        Ok(Self::new(Arc::clone(&like.schema), fitted?))
    }

    /// An Arrow stream of the tables of an iterator, with the columns of this table, which `common` made.
    fn stream<'py>(
        &self,
        py: Python<'py>,
        tables: Py<PyIterator>,
    ) -> PyResult<Bound<'py, PyCapsule>> {
        let schema = Arc::clone(&self.schema);
        let batches = TableBatches {
            schema: Arc::clone(&schema),
            tables,
            left: VecDeque::new(),
            failed: None,
        };
        let stream = FFI_ArrowArrayStream::new(Box::new(RecordBatchIterator::new(batches, schema)));
        PyCapsule::new_with_value(py, stream, c"arrow_array_stream")
    }

    #[pyo3(signature = (requested_schema=None))]
    fn __arrow_c_stream__<'py>(
        &self,
        py: Python<'py>,
        requested_schema: Option<Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyCapsule>> {
        // The protocol lets a producer that does not convert leave the request aside.
        drop(requested_schema);
        let batches = self.batches.clone().into_iter().map(Ok);
        let reader = RecordBatchIterator::new(batches, Arc::clone(&self.schema));
        let stream = FFI_ArrowArrayStream::new(Box::new(reader));
        PyCapsule::new_with_value(py, stream, c"arrow_array_stream")
    }

    fn __arrow_c_schema__<'py>(&self, py: Python<'py>) -> Result<Bound<'py, PyCapsule>> {
        let schema = FFI_ArrowSchema::try_from(self.schema.as_ref())?;
        Ok(PyCapsule::new_with_value(py, schema, c"arrow_schema")?)
    }

    fn __len__(&self) -> usize {
        self.num_rows()
    }

    /// Lets pickle store the table: a stream of its rows.
    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> Result<Bound<'py, PyTuple>> {
        let (py, this) = (slf.py(), slf.get());
        let bytes = py.detach(|| ipc_bytes(&this.schema, &this.batches))?;
        let restore = slf.get_type().getattr("from_ipc")?;
        Ok((restore, (pyo3::types::PyBytes::new(py, &bytes),)).into_pyobject(py)?)
    }

    /// The table in the bytes of an Arrow stream.
    #[staticmethod]
    fn from_ipc(bytes: &[u8]) -> Result<Self> {
        let reader = StreamReader::try_new(bytes, None)?;
        let schema = reader.schema();
        Ok(Self::new(schema, reader.collect::<Result<_, _>>()?))
    }
}

impl RecordBatches {
    fn project(&self, kept: &[usize]) -> Result<Self> {
        let schema = Arc::new(self.schema.project(kept)?);
        let batches = self.batches.iter().map(|batch| batch.project(kept));
        Ok(Self::new(schema, batches.collect::<Result<_, _>>()?))
    }
}

properties! {
    RecordBatches:

    num_rows: usize = |table| (field table.batches.iter().map(RecordBatch::num_rows).sum());
    /// Names of the columns.
    names: Vec<&str> =
        |table| (field table.schema.fields().iter().map(|field| field.name().as_str()).collect());
}

/// The batches of tables that a Python iterator gives, one behind the other.
struct TableBatches {
    schema: SchemaRef,
    tables: Py<PyIterator>,
    /// Those of the last table.
    left: VecDeque<RecordBatch>,
    /// Why there are no more; who asks again is told again.
    failed: Option<String>,
}

impl TableBatches {
    /// The batches of the next table; None behind the last one.
    fn step(&self) -> PyResult<Option<Vec<RecordBatch>>> {
        Python::attach(|py| {
            let Some(table) = self.tables.bind(py).try_iter()?.next().transpose()? else {
                return Ok(None);
            };
            Ok(Some(table.cast::<RecordBatches>()?.get().batches.clone()))
        })
    }
}

impl Iterator for TableBatches {
    type Item = Result<RecordBatch, ArrowError>;

    fn next(&mut self) -> Option<Self::Item> {
        while self.left.is_empty() && self.failed.is_none() {
            match self.step() {
                Ok(None) => return None,
                Ok(Some(batches)) => self.left.extend(batches),
                Err(error) => self.failed = Some(failure(&error)),
            }
        }
        if let Some(failed) = &self.failed {
            return Some(Err(ArrowError::ExternalError(failed.as_str().into())));
        }
        self.left.pop_front().map(|batch| fit(&batch, &self.schema))
    }
}

/// The text of an exception, since a stream cannot carry more. Ctrl-C is raised again when the reader is back in
/// Python.
fn failure(error: &PyErr) -> String {
    Python::attach(|py| {
        let text = error.to_string();
        if error.is_instance_of::<PyKeyboardInterrupt>(py) {
            // SAFETY: an attached thread; it only notes that a signal came. Nothing of Python's may run behind it here.
            unsafe { ffi::PyErr_SetInterrupt() };
        }
        text
    })
}

/// Raises `ValueError` where the texts of a column would be more than `most` bytes in one piece.
fn check_joinable(schema: &Schema, batches: &[RecordBatch], most: usize) -> PyResult<()> {
    let bytes = |array: &ArrayRef| {
        let any = array.as_any();
        let texts = any.downcast_ref::<StringArray>().map(|texts| texts.value_data().len());
        texts.or_else(|| any.downcast_ref::<BinaryArray>().map(|bytes| bytes.value_data().len()))
    };
    for (index, field) in schema.fields().iter().enumerate() {
        let total: usize = batches.iter().filter_map(|batch| bytes(batch.column(index))).sum();
        if total > most {
            return Err(PyValueError::new_err(format!(
                "column {:?} has {total} bytes of text, more than one array holds ({most}): choose fewer \
                 rows, or take the pieces by to_arrow, to_polars or mavwire.scan",
                field.name()
            )));
        }
    }
    Ok(())
}

fn ipc_bytes(schema: &SchemaRef, batches: &[RecordBatch]) -> Result<Vec<u8>, ArrowError> {
    let mut stream = StreamWriter::try_new(Vec::new(), schema)?;
    batches.iter().try_for_each(|batch| stream.write(batch))?;
    stream.into_inner()
}
