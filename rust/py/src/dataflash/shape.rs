//! `DataflashShape`: the record type of a `DFFormat`.

use std::sync::Arc;

use mavwire_core::log::dataflash::Layout;
use pyo3::prelude::*;

use super::message::DFMessage;
use super::names::Names;
use crate::python::error::Result;
use crate::python::lists::list;

/// The record type of a `DFFormat`.
#[pyclass(frozen, module = "mavwire._native")]
pub(crate) struct DataflashShape {
    names: Arc<Names>,
}

/// The shape of a `DFFormat`, which its attribute `_shape` holds.
pub(crate) fn of_format(format: &Bound<'_, PyAny>) -> PyResult<Arc<Names>> {
    let shape = format.getattr(intern!(format.py(), "_shape"))?;
    Ok(Arc::clone(&shape.cast::<DataflashShape>()?.get().names))
}

#[pymethods]
impl DataflashShape {
    /// A record type by the parts of its FMT record.
    ///
    /// `Exception` for an unknown format character, `ValueError` for fields that do not fit into a record.
    #[new]
    fn new(
        py: Python<'_>,
        type_id: u8,
        name: String,
        format: String,
        #[pyo3(from_py_with = list)] columns: Vec<String>,
    ) -> Result<Self> {
        let layout = Layout::new(type_id, 0, name, format, columns)?;
        Ok(Self { names: Arc::new(Names::new(&py.get_type::<DFMessage>(), Arc::new(layout))?) })
    }
}
