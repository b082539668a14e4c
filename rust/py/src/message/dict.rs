//! The instance dictionary of a message: what Python wrote to it, `vars()`, copying and pickling.

use std::sync::atomic::Ordering;

use pyo3::exceptions::PyValueError;
use pyo3::ffi;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict, PyTuple};

use crate::message::create::{self, create};
use crate::message::meta;
use crate::message::object::{Message, Origin, flags};
use crate::python::instance_dict::instance_dict;
use mavwire_core::frame::{FrameBytes, FrameRef};

/// `vars(message)`: the dictionary with every attribute in it.
#[pyfunction]
pub(crate) fn message_dict<'py>(message: &Bound<'py, Message>) -> PyResult<Bound<'py, PyDict>> {
    let this = message.get();
    if !this.has(flags::MATERIALISED) {
        // Python code, and so other threads, may run here. They see the old dictionary until the new one is complete.
        let complete = complete_dict(message)?;
        if !this.has(flags::MATERIALISED) {
            complete.update(instance_dict(message)?.as_mapping())?;
            replace_dict(message, &complete)?;
        }
    }
    instance_dict(message)
}

/// Every attribute, in the order of `vars(message)`.
fn complete_dict<'py>(message: &Bound<'py, Message>) -> PyResult<Bound<'py, PyDict>> {
    let py = message.py();
    let this = message.get();
    let written = instance_dict(message)?.copy()?;
    let complete = PyDict::new(py);
    let special: &[&str] = if this.info.is_none() { &meta::SPECIAL_FIELDS } else { &[] };
    for name in meta::NAMES.iter().chain(special) {
        let value = match written.get_item(name)? {
            Some(value) => Some(value.unbind()),
            None => meta::read(message, name)?,
        };
        if let Some(value) = value {
            complete.set_item(name, value)?;
        }
    }
    if let Some(info) = &this.info {
        for names in &info.names {
            for name in names.raw.iter().chain([&names.name]) {
                let name = name.bind(py);
                if let Some(value) = written.get_item(name)? {
                    complete.set_item(name, value)?;
                } else if this.origin == Origin::Decoded {
                    complete.set_item(name, message.getattr(name)?)?;
                }
            }
        }
    }
    if let Some(seconds) = this.timestamp() {
        complete.set_item(intern!(py, "_timestamp"), seconds)?;
    }
    Ok(complete)
}

/// Replaces the dictionary of a message by a complete one.
fn replace_dict(message: &Bound<'_, Message>, complete: &Bound<'_, PyDict>) -> PyResult<()> {
    // SAFETY: two live objects; the call takes a reference of its own or sets an exception.
    let status = unsafe {
        let context = std::ptr::null_mut();
        ffi::PyObject_GenericSetDict(message.as_ptr(), complete.as_ptr(), context)
    };
    if status != 0 {
        return Err(PyErr::fetch(message.py()));
    }
    Message::written(
        message,
        flags::DICT | flags::META | flags::FIELDS | flags::MATERIALISED | flags::TIMESTAMP_IN_DICT,
    );
    Ok(())
}

#[pymethods]
impl Message {
    /// A new message of the same class with the same frame and attributes.
    #[pyo3(name = "__copy__")]
    pub(crate) fn copy<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, Self>> {
        let this = slf.get();
        // One snapshot: making an object may run Python code, and other threads may write to the message meanwhile.
        let (bits, duplicate) = (this.flags.load(Ordering::Relaxed), this.duplicate(slf.py()));
        let has_dict = bits & flags::DICT != 0;
        let attributes = has_dict.then(|| instance_dict(slf)?.copy()).transpose()?;
        let copied = create(&slf.get_type(), duplicate)?;
        if let Some(attributes) = attributes {
            instance_dict(&copied)?.update(attributes.as_mapping())?;
            Self::written(&copied, bits);
        }
        Ok(copied)
    }

    /// `(restore, (class, frame, ...), attributes)` for pickle.
    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyTuple>> {
        let py = slf.py();
        let this = slf.get();
        let restore = py.import(intern!(py, "mavwire._native"))?.getattr(intern!(py, "restore"))?;
        let decoded = this.origin == Origin::Decoded && !this.has(flags::PACKED);
        let frame = decoded.then(|| PyBytes::new(py, &this.frame));
        let timestamp = this.timestamp().filter(|_| decoded);
        let link = this.link.load(Ordering::Relaxed);
        let attributes = match decoded {
            false => Some(message_dict(slf)?),
            true if this.has(flags::DICT) => Some(instance_dict(slf)?),
            true => None,
        };
        // A copy: other threads may write to the message while pickle reads it.
        let state = attributes.map(|attributes| attributes.copy()).transpose()?;
        let flags = this.flags.load(Ordering::Relaxed) & (flags::WIRE | flags::WRITTEN);
        (restore, (slf.get_type(), frame, flags, timestamp, link), state).into_pyobject(py)
    }
}

/// Rebuilds a pickled message; the attributes follow through `__setstate__`.
///
/// `TypeError` for a class that is none of a message, `ValueError` for bytes that are no frame.
#[pyfunction]
pub(crate) fn restore<'py>(
    class: &Bound<'py, pyo3::types::PyType>,
    frame: Option<&[u8]>,
    flags: u32,
    timestamp: Option<f64>,
    link: u8,
) -> PyResult<Bound<'py, Message>> {
    let py = class.py();
    create::require_message_class(class)?;
    let info = class.getattr(intern!(py, "_info"))?;
    let info = info.cast::<crate::message::info::MessageInfo>().ok().map(|info| info.get().info);
    let origin = match frame {
        None => Origin::Built,
        Some(frame) if info.is_some() && FrameRef::parse(frame).is_ok() => Origin::Decoded,
        Some(_) => return Err(PyValueError::new_err("pickled message has no valid frame")),
    };
    let message = Message::received(info, FrameBytes::from(frame.unwrap_or_default()), origin);
    message.set(flags & flags::WIRE);
    message.link.store(link, Ordering::Relaxed);
    if let Some(seconds) = timestamp {
        message.set_timestamp(seconds);
    }
    let restored = create(class, message)?;
    Message::written(&restored, flags & flags::WRITTEN);
    Ok(restored)
}
