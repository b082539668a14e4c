//! The instance dictionary of a message: what Python wrote to it, `vars()`, copying and pickling.

use std::sync::atomic::Ordering;

use pyo3::ffi;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict, PyTuple};

use crate::calling::{Calling, import};
use crate::create::{self, create};
use crate::frame_bytes::FrameBytes;
use crate::message::{Message, Origin, flags};
use crate::meta::Meta;

/// The instance's own dictionary, as it stands.
pub(crate) fn instance_dict<'py>(message: &Bound<'py, Message>) -> PyResult<Bound<'py, PyDict>> {
    generic_dict(message.as_any())
}

/// The dictionary of any object that has one, whatever its class says about `__dict__`.
pub(crate) fn generic_dict<'py>(message: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyDict>> {
    // SAFETY: the argument is a live object; the call returns a new reference to its dictionary or sets an exception.
    let dict = unsafe {
        let dict = ffi::PyObject_GenericGetDict(message.as_ptr(), std::ptr::null_mut());
        Bound::from_owned_ptr_or_err(message.py(), dict)?
    };
    Ok(dict.cast_into::<PyDict>()?)
}

/// What writing to an attribute of this name may change.
pub(crate) fn flags_for(name: &str) -> u32 {
    match name {
        "_timestamp" => 0,
        "_posted" | "_link" | "_instances" => flags::DICT,
        _ if name.starts_with('_') && !name.ends_with("_raw") => flags::DICT | flags::META,
        _ => flags::DICT | flags::FIELDS,
    }
}

/// `vars(message)`: the dictionary with every attribute in it.
#[pyfunction]
pub(crate) fn message_dict<'py>(message: &Bound<'py, Message>) -> PyResult<Bound<'py, PyDict>> {
    let dict = instance_dict(message)?;
    let this = message.get();
    if this.has(flags::MATERIALISED) {
        return Ok(dict);
    }
    let py = message.py();
    let written = dict.copy()?;
    dict.clear();
    fill_meta(message, &dict)?;
    if let Some(info) = &this.info {
        for names in &info.names {
            for name in names.raw.iter().chain([&names.name]) {
                let name = name.bind(py);
                if written.contains(name)? {
                    dict.set_item(name, written.get_item(name)?)?;
                } else if this.origin == Origin::Decoded {
                    dict.set_item(name, message.attribute(name)?)?;
                }
            }
        }
    }
    for name in odd_fields(this.origin) {
        if !written.contains(name)? {
            dict.set_item(name, message.attribute(name)?)?;
        }
    }
    if let Some(seconds) = this.timestamp() {
        dict.set_item(intern!(py, "_timestamp"), seconds)?;
    }
    dict.update(written.as_mapping())?;
    Message::written(
        message,
        flags::DICT | flags::META | flags::FIELDS | flags::MATERIALISED | flags::TIMESTAMP_IN_DICT,
    );
    Ok(dict)
}

/// Fields of messages that no definition describes.
fn odd_fields(origin: Origin) -> &'static [&'static str] {
    match origin {
        Origin::Bad => &["data", "reason"],
        Origin::Unknown => &["data"],
        Origin::Built | Origin::Decoded => &[],
    }
}

/// Puts every underscore attribute into the dictionary that is not there yet.
pub(crate) fn fill_meta(message: &Bound<'_, Message>, dict: &Bound<'_, PyDict>) -> PyResult<()> {
    for meta in Meta::ALL {
        if !dict.contains(meta.name())?
            && let Some(value) = meta.read(message)?
        {
            dict.set_item(meta.name(), value)?;
        }
    }
    Ok(())
}

/// A new message of the same class with the same frame; `each` copies what Python wrote to it.
pub(crate) fn copy<'py>(
    message: &Bound<'py, Message>,
    each: impl Fn(&Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, Message>> {
    let this = message.get();
    let copied = create(&message.get_type(), this.duplicate(message.py()))?;
    if this.has(flags::DICT) {
        let target = instance_dict(&copied)?;
        for (key, value) in instance_dict(message)? {
            target.set_item(key, each(&value)?)?;
        }
        Message::written(&copied, this.flags.load(Ordering::Relaxed));
    }
    Ok(copied)
}

/// `(restore, (class, frame, ...), attributes)` for pickle.
pub(crate) fn reduce<'py>(message: &Bound<'py, Message>) -> PyResult<Bound<'py, PyTuple>> {
    let py = message.py();
    let this = message.get();
    let restore = import(py, intern!(py, "mavwire._native"))?.attribute(intern!(py, "restore"))?;
    let decoded = this.origin == Origin::Decoded && !this.has(flags::PACKED);
    let frame = decoded.then(|| PyBytes::new(py, &this.frame));
    let timestamp = this.timestamp().filter(|_| decoded);
    let link = this.link.load(Ordering::Relaxed);
    let state = if decoded && !this.has(flags::DICT) {
        None
    } else if decoded {
        Some(instance_dict(message)?)
    } else {
        Some(message_dict(message)?)
    };
    let flags = this.flags.load(Ordering::Relaxed) & (flags::WIRE | flags::WRITTEN);
    (restore, (message.get_type(), frame, flags, timestamp, link), state).into_pyobject(py)
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
    let info = class.attribute(intern!(py, "_info"))?;
    let info = info.cast::<crate::info::MessageInfo>().ok().map(|info| info.get().info);
    let origin = match frame {
        Some(frame) if info.is_some() && mavwire_core::frame::FrameRef::parse(frame).is_ok() => {
            Origin::Decoded
        }
        Some(_) => {
            return Err(pyo3::exceptions::PyValueError::new_err(
                "pickled message has no valid frame",
            ));
        }
        None => Origin::Built,
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
