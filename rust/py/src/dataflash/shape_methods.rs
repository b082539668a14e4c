//! The Python methods of `DataflashShape`.

use std::sync::Arc;

use mavwire_core::log::dataflash::Layout;
use pyo3::prelude::*;

use super::message::DFMessage;
use super::shape::{DataflashShape, Names};
use crate::python::error::Result;
use crate::python::lists::list;

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
