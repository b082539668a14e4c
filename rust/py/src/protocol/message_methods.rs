//! The Python methods of `Message`.

use pyo3::exceptions::PyIndexError;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyString};

use mavwire_core::frame::Header;

use crate::message::descriptors::no_attribute;
use crate::message::dict;
use crate::message::info::MessageInfo;
use crate::message::object::{Message, flags, flags_for};
use crate::python::instance_dict::{generic_setattr, instance_dict};

new! {
    Message: |cls| -> PyResult<Self> {
        let info = cls.getattr(intern!(cls.py(), "_info"))?;
        Ok(Self::built(info.cast::<MessageInfo>().ok().map(|info| info.get().info)))
    }
}

#[pymethods]
impl Message {
    fn __setattr__(
        slf: &Bound<'_, Self>,
        name: &Bound<'_, PyString>,
        value: &Bound<'_, PyAny>,
    ) -> PyResult<()> {
        Self::written(slf, flags_for(name.to_str()?));
        generic_setattr(slf, name, Some(value))
    }

    fn __delattr__(slf: &Bound<'_, Self>, name: &Bound<'_, PyString>) -> PyResult<()> {
        // This fills the dictionary with all attributes. One that is missing there has been deleted.
        let attributes = dict::message_dict(slf)?;
        if attributes.contains(name)? {
            return attributes.del_item(name);
        }
        generic_setattr(slf, name, None)
    }

    /// Takes the attributes of a pickled message.
    fn __setstate__(slf: &Bound<'_, Self>, state: &Bound<'_, PyDict>) -> PyResult<()> {
        instance_dict(slf)?.update(state.as_mapping())?;
        Self::written(slf, flags::DICT | flags::FIELDS | flags::META);
        Ok(())
    }

    /// Seconds since 1970, or of the log's own clock, set by the link that received the message.
    #[getter(_timestamp)]
    fn get_timestamp(slf: &Bound<'_, Self>) -> PyResult<Py<PyAny>> {
        let py = slf.py();
        let this = slf.get();
        if this.has(flags::TIMESTAMP_IN_DICT) {
            if let Some(value) = instance_dict(slf)?.get_item(intern!(py, "_timestamp"))? {
                return Ok(value.unbind());
            }
        } else if let Some(seconds) = this.timestamp() {
            return Ok(seconds.into_pyobject(py)?.into_any().unbind());
        }
        Err(no_attribute(slf, "_timestamp"))
    }

    #[setter(_timestamp)]
    fn put_timestamp(slf: &Bound<'_, Self>, value: &Bound<'_, PyAny>) -> PyResult<()> {
        let this = slf.get();
        if let (false, Ok(seconds)) =
            (this.has(flags::TIMESTAMP_IN_DICT), value.cast_exact::<pyo3::types::PyFloat>())
        {
            this.set_timestamp(seconds.extract()?);
            return Ok(());
        }
        instance_dict(slf)?.set_item(intern!(slf.py(), "_timestamp"), value)?;
        Self::written(slf, flags::TIMESTAMP_IN_DICT | flags::DICT);
        Ok(())
    }

    /// The whole frame, signature included; empty before packing or decoding.
    fn get_msgbuf<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        slf.getattr(intern!(slf.py(), "_msgbuf"))
    }

    /// The header object.
    fn get_header<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        slf.getattr(intern!(slf.py(), "_header"))
    }

    /// After packing the payload as sent; after decoding the frame from byte 6 up to the checksum.
    fn get_payload<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        slf.getattr(intern!(slf.py(), "_payload"))
    }

    /// Checksum of the frame, or None.
    fn get_crc<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        slf.getattr(intern!(slf.py(), "_crc"))
    }

    /// Field names in XML order.
    fn get_fieldnames<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        if slf.get().has(flags::META) {
            return slf.getattr(intern!(slf.py(), "_fieldnames"));
        }
        slf.get_type().getattr(intern!(slf.py(), "fieldnames"))
    }

    /// Message name, "BAD_DATA" or "UNKNOWN_<id>".
    fn get_type<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        let py = slf.py();
        match &slf.get().info {
            Some(info) if !slf.get().has(flags::META) => Ok(info.name.bind(py).clone().into_any()),
            _ => slf.getattr(intern!(py, "_type")),
        }
    }

    /// Message id; -1 for BAD_DATA, -2 for UNKNOWN.
    #[pyo3(name = "get_msgId")]
    fn get_msg_id<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        let py = slf.py();
        match &slf.get().info {
            Some(info) if !slf.get().has(flags::META) => {
                Ok(info.definition.id.into_pyobject(py)?.into_any())
            }
            _ => slf.getattr(intern!(py, "_header"))?.getattr(intern!(py, "msgId")),
        }
    }

    /// Id of the sending system.
    #[pyo3(name = "get_srcSystem")]
    fn get_src_system<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        header_item(slf, "srcSystem", |header| i64::from(header.sysid))
    }

    /// Id of the sending component.
    #[pyo3(name = "get_srcComponent")]
    fn get_src_component<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        header_item(slf, "srcComponent", |header| i64::from(header.compid))
    }

    /// Sequence number of the frame.
    fn get_seq<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        header_item(slf, "seq", |header| i64::from(header.seq))
    }

    /// True only if a signature was checked with a key and was good.
    fn get_signed<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        slf.getattr(intern!(slf.py(), "_signed"))
    }

    /// Link id of a verified signature, else None.
    fn get_link_id<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        slf.getattr(intern!(slf.py(), "_link_id"))
    }

    /// The message of one instance (battery, named value, ...), where mavutil keeps several.
    fn __getitem__<'py>(
        slf: &Bound<'py, Self>,
        key: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let instances = slf.getattr(intern!(slf.py(), "_instances"))?;
        if instances.is_none() || !instances.contains(key.as_any())? {
            return Err(PyIndexError::new_err(()));
        }
        instances.get_item(key)
    }
}

/// `_header.<name>` where a program may have replaced it, else straight from the frame.
fn header_item<'py>(
    slf: &Bound<'py, Message>,
    name: &str,
    read: impl FnOnce(Header) -> i64,
) -> PyResult<Bound<'py, PyAny>> {
    let py = slf.py();
    if slf.get().has(flags::META) {
        return slf.getattr(intern!(py, "_header"))?.getattr(name);
    }
    let value = slf.get().header().map_or(0, read);
    Ok(value.into_pyobject(py)?.into_any())
}
