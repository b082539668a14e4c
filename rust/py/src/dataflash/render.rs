//! A message as text: `IMU {TimeUS : 4000, AccX : 1.5}`.

use std::fmt::Write;

use mavwire_core::log::dataflash::{Value, value};
use mavwire_core::pyfloat;
use pyo3::prelude::*;
use pyo3::types::PyFloat;

use super::message::DFMessage;
use super::value::text_of;

/// The one NaN that is plainly `nan`; others were made by an autopilot's reckoning and are `qnan`.
const PLAIN_NAN: u64 = 0x7FF8_0000_0000_0000;

/// `str(message)`.
pub(super) fn text(message: &DFMessage, py: Python<'_>) -> PyResult<String> {
    let layout = &message.names.layout;
    let mut out = String::with_capacity(32 * (layout.fields.len() + 1));
    out.push_str(&layout.name);
    out.push_str(" {");
    for (index, field) in layout.fields.iter().enumerate() {
        if index > 0 {
            out.push_str(", ");
        }
        out.push_str(&field.name);
        out.push_str(" : ");
        if !write_stored(&mut out, message, py, index) {
            write_object(&mut out, &message.value(py, index)?)?;
        }
    }
    out.push('}');
    Ok(out)
}

/// Writes a value straight from the record; false where that takes Python.
fn write_stored(out: &mut String, message: &DFMessage, py: Python<'_>, index: usize) -> bool {
    let field = &message.names.layout.fields[index];
    let Some(body) = message.body(py) else { return false };
    match value(field.kind, body, usize::from(field.offset)) {
        Value::Integer(number) if field.kind.scale().is_some() => {
            pyfloat::write_repr(out, field.kind.scaled(number as f64));
        }
        Value::Integer(number) => drop(write!(out, "{number}")),
        Value::Unsigned(number) => drop(write!(out, "{number}")),
        Value::Float(number) => write_float(out, number),
        Value::Text(bytes) if !message.names.raw_bytes => out.push_str(&text_of(bytes)),
        Value::Text(_) | Value::Array(_) => return false,
    }
    true
}

fn write_object(out: &mut String, value: &Bound<'_, PyAny>) -> PyResult<()> {
    match value.cast_exact::<PyFloat>() {
        Ok(number) => write_float(out, number.value()),
        Err(_) => out.push_str(&value.str()?.to_string_lossy()),
    }
    Ok(())
}

fn write_float(out: &mut String, number: f64) {
    if number.is_nan() && number.to_bits() != PLAIN_NAN {
        out.push_str("qnan");
    } else {
        pyfloat::write_repr(out, number);
    }
}
