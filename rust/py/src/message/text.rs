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

#[pymethods]
impl Message {
    /// A field as text and JSON show it: bytes become text, everything else stays.
    fn format_attr<'py>(
        slf: &Bound<'py, Self>,
        field: &Bound<'py, PyString>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let py = slf.py();
        let value = slf.getattr(field)?;
        if !value.is_instance_of::<PyBytes>() {
            return Ok(value);
        }
        let text = value.invoke_method1(intern!(py, "decode"), ("utf-8", "backslashreplace"))?;
        text.invoke_method1(intern!(py, "rstrip"), ("\0",))
    }

    fn __str__(slf: &Bound<'_, Self>) -> PyResult<Py<PyString>> {
        let py = slf.py();
        let mut out = String::with_capacity(256);
        if let Some(info) = pristine(slf, &[intern!(py, "format_attr")])? {
            format::write_text(&mut out, &info.definition, slf.get().decoded_payload());
            return Ok(PyString::new(py, &out).unbind());
        }
        out.push_str(&type_name(slf)?.str()?.to_string_lossy());
        out.push_str(" {");
        for (i, name) in fieldnames(slf)?.enumerate() {
            let name = name?;
            if i > 0 {
                out.push_str(", ");
            }
            out.push_str(&name.to_string_lossy());
            out.push_str(" : ");
            let value = shown(&name, formatted(slf, &name)?)?;
            out.push_str(&value.str()?.to_string_lossy());
        }
        out.push('}');
        Ok(PyString::new(py, &out).unbind())
    }

    /// `{"mavpackettype": type, field: value, ...}` in XML order.
    fn to_dict<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyDict>> {
        let py = slf.py();
        let dict = PyDict::new(py);
        let type_key = intern!(py, "mavpackettype");
        if let Some(info) = pristine(slf, &[intern!(py, "format_attr")])? {
            let payload = slf.get().decoded_payload();
            dict.set_item(type_key, info.name.bind(py))?;
            for (field, names) in info.definition.fields.iter().zip(&info.names) {
                dict.set_item(names.name.bind(py), values::field_value(py, field, payload)?)?;
            }
            return Ok(dict);
        }
        dict.set_item(type_key, type_name(slf)?)?;
        for name in fieldnames(slf)? {
            let name = name?;
            dict.set_item(&name, formatted(slf, &name)?)?;
        }
        Ok(dict)
    }

    /// `json.dumps(to_dict())`.
    fn to_json<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        let py = slf.py();
        if let Some(info) = pristine(slf, &[intern!(py, "to_dict"), intern!(py, "format_attr")])? {
            let mut out = String::with_capacity(256);
            format::write_json(&mut out, &info.definition, slf.get().decoded_payload());
            return Ok(PyString::new(py, &out).into_any());
        }
        let dict = slf.invoke_method0(intern!(py, "to_dict"))?;
        if let Ok(secret) = dict.get_item(format::SECRET_FIELD) {
            let name = PyString::new(py, format::SECRET_FIELD);
            dict.set_item(&name, shown(&name, secret)?)?;
        }
        py.import(intern!(py, "json"))?.invoke_method1(intern!(py, "dumps"), (dict,))
    }

    /// Same type, checksum, sequence number, source and field values. Messages of different dialect modules differ.
    fn __eq__(slf: &Bound<'_, Self>, other: &Bound<'_, PyAny>) -> PyResult<bool> {
        let py = slf.py();
        let Ok(other) = other.cast::<Message>() else { return Ok(false) };
        let base = intern!(py, "_message_base");
        if !slf.getattr(base)?.is(&other.getattr(base)?) {
            return Ok(false);
        }
        for method in ["get_type", "get_crc", "get_seq", "get_srcSystem", "get_srcComponent"] {
            if !slf.invoke_method0(method)?.eq(&other.invoke_method0(method)?)? {
                return Ok(false);
            }
        }
        for name in fieldnames(slf)? {
            let name = name?;
            if !Self::format_attr(slf, &name)?.eq(&Self::format_attr(other, &name)?)? {
                return Ok(false);
            }
        }
        Ok(true)
    }
}
