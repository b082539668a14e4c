//! Text, dict and JSON forms of a message, and equality.
//!
//! An unedited message is formatted from its frame in Rust. An edited or built one goes attribute by attribute, so that a
//! stored Python object shows up as itself.

use mavwire_core::text as format;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict, PyList, PyString};

use crate::message::info::Info;
use crate::message::object::{Message, flags};
use crate::message::values;
use crate::python::calling::Calling;

/// The definition, if everything can be read from the frame and the message's class has none of its own `methods`.
fn pristine(
    message: &Bound<'_, Message>,
    methods: &[&Bound<'_, PyString>],
) -> PyResult<Option<&'static Info>> {
    let this = message.get();
    if !this.is_pristine() || this.has(flags::META) {
        return Ok(None);
    }
    let (class, native) = (message.get_type(), message.py().get_type::<Message>());
    for &method in methods {
        if !class.getattr(method)?.is(&native.getattr(method)?) {
            return Ok(None);
        }
    }
    Ok(this.info)
}

/// `message.format_attr(field)`, which a class may have of its own.
fn formatted<'py>(
    message: &Bound<'py, Message>,
    field: &Bound<'py, PyString>,
) -> PyResult<Bound<'py, PyAny>> {
    message.invoke_method1(intern!(message.py(), "format_attr"), (field,))
}

pub(crate) fn format_attr<'py>(
    message: &Bound<'py, Message>,
    field: &Bound<'py, PyString>,
) -> PyResult<Bound<'py, PyAny>> {
    let py = message.py();
    let value = message.getattr(field)?;
    if !value.is_instance_of::<PyBytes>() {
        return Ok(value);
    }
    let text = value.invoke_method1(intern!(py, "decode"), ("utf-8", "backslashreplace"))?;
    text.invoke_method1(intern!(py, "rstrip"), ("\0",))
}

/// A field's value as texts show it: no secret key.
fn shown<'py>(
    name: &Bound<'py, PyString>,
    value: Bound<'py, PyAny>,
) -> PyResult<Bound<'py, PyAny>> {
    if name.to_str()? != format::SECRET_FIELD {
        return Ok(value);
    }
    Ok(PyList::new(value.py(), [0xFF; 32])?.into_any())
}

/// The names that `_fieldnames` holds, which may have been replaced.
fn fieldnames<'py>(
    message: &Bound<'py, Message>,
) -> PyResult<impl Iterator<Item = PyResult<Bound<'py, PyString>>>> {
    let names = message.getattr(intern!(message.py(), "_fieldnames"))?.try_iter()?;
    Ok(names.map(|name| Ok(name?.cast_into::<PyString>()?)))
}

fn type_name<'py>(message: &Bound<'py, Message>) -> PyResult<Bound<'py, PyAny>> {
    message.getattr(intern!(message.py(), "_type"))
}

pub(crate) fn to_text(message: &Bound<'_, Message>) -> PyResult<Py<PyString>> {
    let py = message.py();
    let mut out = String::with_capacity(256);
    if let Some(info) = pristine(message, &[intern!(py, "format_attr")])? {
        format::write_text(&mut out, &info.definition, message.get().decoded_payload());
        return Ok(PyString::new(py, &out).unbind());
    }
    out.push_str(&type_name(message)?.str()?.to_string_lossy());
    out.push_str(" {");
    for (i, name) in fieldnames(message)?.enumerate() {
        let name = name?;
        if i > 0 {
            out.push_str(", ");
        }
        out.push_str(&name.to_string_lossy());
        out.push_str(" : ");
        let value = shown(&name, formatted(message, &name)?)?;
        out.push_str(&value.str()?.to_string_lossy());
    }
    out.push('}');
    Ok(PyString::new(py, &out).unbind())
}

pub(crate) fn to_dict<'py>(message: &Bound<'py, Message>) -> PyResult<Bound<'py, PyDict>> {
    let py = message.py();
    let dict = PyDict::new(py);
    let type_key = intern!(py, "mavpackettype");
    if let Some(info) = pristine(message, &[intern!(py, "format_attr")])? {
        let payload = message.get().decoded_payload();
        dict.set_item(type_key, info.name.bind(py))?;
        for (field, names) in info.definition.fields.iter().zip(&info.names) {
            dict.set_item(names.name.bind(py), values::field_value(py, field, payload)?)?;
        }
        return Ok(dict);
    }
    dict.set_item(type_key, type_name(message)?)?;
    for name in fieldnames(message)? {
        let name = name?;
        dict.set_item(&name, formatted(message, &name)?)?;
    }
    Ok(dict)
}

pub(crate) fn to_json<'py>(message: &Bound<'py, Message>) -> PyResult<Bound<'py, PyAny>> {
    let py = message.py();
    if let Some(info) = pristine(message, &[intern!(py, "to_dict"), intern!(py, "format_attr")])? {
        let mut out = String::with_capacity(256);
        format::write_json(&mut out, &info.definition, message.get().decoded_payload());
        return Ok(PyString::new(py, &out).into_any());
    }
    let dict = message.invoke_method0(intern!(py, "to_dict"))?;
    if let Ok(secret) = dict.get_item(format::SECRET_FIELD) {
        let name = PyString::new(py, format::SECRET_FIELD);
        dict.set_item(&name, shown(&name, secret)?)?;
    }
    py.import(intern!(py, "json"))?.invoke_method1(intern!(py, "dumps"), (dict,))
}

/// Same type, checksum, sequence number, source and field values. Messages of different dialect modules differ.
pub(crate) fn equal(message: &Bound<'_, Message>, other: &Bound<'_, PyAny>) -> PyResult<bool> {
    let py = message.py();
    let Ok(other) = other.cast::<Message>() else { return Ok(false) };
    let base = intern!(py, "_message_base");
    if !message.getattr(base)?.is(&other.getattr(base)?) {
        return Ok(false);
    }
    for method in ["get_type", "get_crc", "get_seq", "get_srcSystem", "get_srcComponent"] {
        if !message.invoke_method0(method)?.eq(&other.invoke_method0(method)?)? {
            return Ok(false);
        }
    }
    for name in fieldnames(message)? {
        let name = name?;
        if !format_attr(message, &name)?.eq(&format_attr(other, &name)?)? {
            return Ok(false);
        }
    }
    Ok(true)
}
