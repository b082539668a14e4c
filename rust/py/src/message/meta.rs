//! The attributes of a message that its definition does not describe, made when they are first read.
//!
//! Objects with an identity (`_msgbuf`, `_header`, `_payload`, `data`) are kept in the instance dictionary once made, so that
//! a caller that changes them sees the change again.

use pyo3::IntoPyObjectExt;
use pyo3::prelude::*;
use pyo3::types::{PyByteArray, PyBytes};

use mavwire_core::frame::{CHECKSUM_LEN, FrameRef, Header, SIGNATURE_LEN};
use std::sync::atomic::Ordering;

use crate::message::object::{Message, Origin, flags, flags_for, payload_of};
use crate::python::calling::Calling;
use crate::python::instance_dict::instance_dict;

/// The underscore attributes in the order of `vars(message)`. The last two are only there once they are set, and
/// `_instance_offset` only in messages of a definition.
pub(crate) const NAMES: [&str; 13] = [
    "_header",
    "_payload",
    "_msgbuf",
    "_crc",
    "_fieldnames",
    "_type",
    "_signed",
    "_link_id",
    "_instances",
    "_instance_field",
    "_instance_offset",
    "_posted",
    "_link",
];

/// The fields of BAD_DATA and UNKNOWN, which no definition describes.
pub(crate) const SPECIAL_FIELDS: [&str; 2] = ["data", "reason"];

/// The attributes that depend on the frame.
const OF_FRAME: [&str; 4] = ["_header", "_payload", "_msgbuf", "_crc"];

/// Reason of bytes that start no frame.
pub(crate) const BAD_PREFIX: &str = "Bad prefix";

/// The value, or `None` if the attribute is not set. An object with an identity is stored, so that the next call gives the
/// same one.
pub(crate) fn read(message: &Bound<'_, Message>, name: &str) -> PyResult<Option<Py<PyAny>>> {
    let value = value(message, name)?;
    if value.is_none() || !matches!(name, "_header" | "_payload" | "_msgbuf" | "data") {
        return Ok(value);
    }
    // The header is made by Python code. Another thread may have stored its own meanwhile.
    let attributes = instance_dict(message)?;
    if let Some(kept) = attributes.get_item(name)? {
        return Ok(Some(kept.unbind()));
    }
    attributes.set_item(name, &value)?;
    Message::written(message, flags_for(name));
    Ok(value)
}

fn value(message: &Bound<'_, Message>, name: &str) -> PyResult<Option<Py<PyAny>>> {
    let py = message.py();
    let this = message.get();
    let class = message.get_type();
    Ok(Some(match name {
        "_header" => header_object(message)?,
        "_payload" => payload_object(py, this)?,
        "_msgbuf" => msgbuf_object(py, this),
        "_crc" => crc(py, this).into_py_any(py)?,
        "_fieldnames" => class.getattr(intern!(py, "fieldnames"))?.unbind(),
        "_type" => match (this.info, this.origin) {
            (Some(info), _) => info.name.clone_ref(py).into_any(),
            (None, Origin::Bad) => "BAD_DATA".into_py_any(py)?,
            (None, Origin::Unknown) => unknown_name(this).into_py_any(py)?,
            (None, _) => class.getattr(intern!(py, "msgname"))?.unbind(),
        },
        "_signed" => this.has(flags::SIGNED).into_py_any(py)?,
        "_link_id" => link_id(this).into_py_any(py)?,
        "_instances" => py.None(),
        "_instance_field" => class.getattr(intern!(py, "instance_field"))?.unbind(),
        "_instance_offset" if this.info.is_some() => {
            class.getattr(intern!(py, "instance_offset"))?.unbind()
        }
        "_posted" if this.has(flags::POSTED) => true.into_py_any(py)?,
        "_link" if this.has(flags::LINK) => this.link.load(Ordering::Relaxed).into_py_any(py)?,
        "data" if matches!(this.origin, Origin::Bad | Origin::Unknown) => {
            PyByteArray::new(py, &this.frame).into_py_any(py)?
        }
        "reason" if this.origin == Origin::Bad => match this.reason(py) {
            Some(reason) => reason.unbind(),
            None => intern!(py, BAD_PREFIX).into_py_any(py)?,
        },
        _ => return Ok(None),
    }))
}

/// Updates a complete dictionary to the frame packed last. Values are replaced and never removed: other threads may read
/// them meanwhile.
fn refresh(message: &Bound<'_, Message>) -> PyResult<()> {
    for name in OF_FRAME {
        let value = value(message, name)?;
        instance_dict(message)?.set_item(name, value)?;
    }
    Ok(())
}

/// Remembers the frame that `pack` made, and forgets what was derived from an earlier one.
pub(crate) fn set_packed(slf: &Bound<'_, Message>, frame: &Bound<'_, PyBytes>) -> PyResult<()> {
    let this = slf.get();
    if let Some(reason) = this.reason(slf.py()) {
        instance_dict(slf)?.set_item(intern!(slf.py(), "reason"), reason)?;
        Message::written(slf, flags::DICT | flags::FIELDS);
    }
    this.extra.set(frame.as_any());
    this.set(flags::PACKED);
    if this.has(flags::MATERIALISED) {
        return refresh(slf);
    }
    if this.has(flags::META) {
        let attributes = instance_dict(slf)?;
        for name in OF_FRAME {
            if attributes.contains(name)? {
                attributes.del_item(name)?;
            }
        }
    }
    Ok(())
}

fn header_object(message: &Bound<'_, Message>) -> PyResult<Py<PyAny>> {
    let py = message.py();
    let this = message.get();
    let class = message.getattr(intern!(py, "_header_class"))?;
    let Some(header) = this.header() else {
        let msgid = match (this.info, this.origin) {
            (Some(info), _) => i64::from(info.definition.id),
            (None, Origin::Unknown) => -2,
            (None, Origin::Bad) => -1,
            (None, _) => 0,
        };
        return Ok(class.invoke1((msgid,))?.unbind());
    };
    let Header { incompat_flags, compat_flags, payload_len, seq, sysid, compid, msgid, .. } =
        header;
    let arguments = (msgid, incompat_flags, compat_flags, payload_len, seq, sysid, compid);
    Ok(class.invoke1(arguments)?.unbind())
}

/// After `pack` the payload as sent. After decoding a slice from byte 6 for headers of any length, as in pymavlink.
fn payload_object(py: Python<'_>, message: &Message) -> PyResult<Py<PyAny>> {
    if message.has(flags::PACKED) {
        return match message.packed(py) {
            Some(frame) => PyBytes::new(py, payload_of(frame.as_bytes())).into_py_any(py),
            None => Ok(py.None()),
        };
    }
    if message.origin != Origin::Decoded {
        return Ok(py.None());
    }
    let frame = &message.frame;
    let signed = message.header().is_some_and(|header| header.is_signed());
    let tail = CHECKSUM_LEN + if signed { SIGNATURE_LEN } else { 0 };
    PyByteArray::new(py, frame.get(6..frame.len() - tail).unwrap_or_default()).into_py_any(py)
}

fn msgbuf_object(py: Python<'_>, message: &Message) -> Py<PyAny> {
    let frame = match message.packed(py) {
        Some(frame) => PyByteArray::new(py, frame.as_bytes()),
        None => PyByteArray::new(py, &message.frame),
    };
    frame.into_any().unbind()
}

fn crc(py: Python<'_>, message: &Message) -> Option<u16> {
    let read = |frame: &[u8]| FrameRef::parse(frame).ok().map(|frame| frame.checksum());
    match message.packed(py) {
        Some(frame) => read(frame.as_bytes()),
        None if message.origin == Origin::Decoded => read(&message.frame),
        None => None,
    }
}

/// The name of a message that the dialect lacks.
fn unknown_name(message: &Message) -> String {
    format!("UNKNOWN_{}", Header::parse(&message.frame).map_or(0, |header| header.msgid))
}

fn link_id(message: &Message) -> Option<u8> {
    if !message.has(flags::SIGNED) {
        return None;
    }
    FrameRef::parse(&message.frame).ok()?.signature().map(|signature| signature.link_id)
}
