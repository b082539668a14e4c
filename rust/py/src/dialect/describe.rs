//! Descriptions out of a user's XML.

use std::collections::HashMap;

use mavwire_schema::{Enum, Message, WireVersion, resolve};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::dialect::registry::lookup;
use crate::python::error::Result;

/// All descriptions of a dialect: `{"messages": {name: (text, {field: text})}, "enums": {enum: {entry: (text,
/// {parameter: text})}}}`. Raises `DefinitionError`.
#[pyfunction]
pub(crate) fn describe<'py>(
    py: Python<'py>,
    main: &str,
    sources: HashMap<String, String>,
) -> Result<Bound<'py, PyDict>> {
    let dialect = resolve(main, &mut |path| lookup(&sources, path), WireVersion::V2)?;
    let result = PyDict::new(py);
    result.set_item("messages", messages(py, &dialect.messages)?)?;
    result.set_item("enums", enums(py, &dialect.enums)?)?;
    Ok(result)
}

fn messages<'py>(py: Python<'py>, messages: &[Message]) -> PyResult<Bound<'py, PyDict>> {
    let result = PyDict::new(py);
    for message in messages {
        let fields: HashMap<&str, &str> =
            message.fields.iter().map(|f| (f.name.as_str(), f.description.as_str())).collect();
        result.set_item(&message.name, (&message.description, fields))?;
    }
    Ok(result)
}

fn enums<'py>(py: Python<'py>, enums: &[Enum]) -> PyResult<Bound<'py, PyDict>> {
    let result = PyDict::new(py);
    for definition in enums {
        let entries = PyDict::new(py);
        for entry in &definition.entries {
            let params: HashMap<u8, &str> =
                entry.params.iter().map(|p| (p.index, p.description.as_str())).collect();
            entries.set_item(&entry.name, (&entry.description, params))?;
        }
        result.set_item(&definition.name, entries)?;
    }
    Ok(result)
}
