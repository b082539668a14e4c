//! A message as text: `IMU {TimeUS : 4000, AccX : 1.5}`.

use mavwire_core::log::dataflash::{FieldKind, write_float};
use pyo3::prelude::*;
use pyo3::types::PyFloat;

use super::message::DFMessage;

#[pymethods]
impl DFMessage {
    fn __str__(&self, py: Python<'_>) -> PyResult<String> {
        let layout = &self.names.layout;
        let body = self.body(py);
        let mut out = String::with_capacity(32 * (layout.fields.len() + 1));
        out.push_str(&layout.name);
        out.push_str(" {");
        for (index, field) in layout.fields.iter().enumerate() {
            if index > 0 {
                out.push_str(", ");
            }
            out.push_str(&field.name);
            out.push_str(" : ");
            let is_raw = self.names.raw_bytes && matches!(field.kind, FieldKind::Text(_));
            if is_raw || !body.is_some_and(|body| layout.write_text(&mut out, index, body)) {
                write_object(&mut out, &self.value(py, index)?)?;
            }
        }
        out.push('}');
        Ok(out)
    }
}

fn write_object(out: &mut String, value: &Bound<'_, PyAny>) -> PyResult<()> {
    match value.cast_exact::<PyFloat>() {
        Ok(number) => write_float(out, number.value()),
        Err(_) => out.push_str(&value.str()?.to_string_lossy()),
    }
    Ok(())
}
