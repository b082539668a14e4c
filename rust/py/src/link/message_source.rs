//! The type and the sender of a message, whether or not a program changed them.

use mavwire_core::frame::Header;
use mavwire_core::telemetry::Sender;
use pyo3::prelude::*;
use pyo3::types::PyString;

use crate::message::object::{Message, Origin, flags};
use crate::python::calling::Calling;

/// The sender of a message, and whether it takes part in loss counting: BAD_DATA and UNKNOWN do not.
pub(crate) fn sender_of(message: &Bound<'_, Message>) -> PyResult<(Sender, bool)> {
    let this = message.get();
    if !this.has(flags::META) {
        if let Some(Header { sysid, compid, seq, .. }) = this.header() {
            return Ok((Sender { sysid, compid, seq }, this.info.is_some()));
        }
        if matches!(this.origin, Origin::Bad | Origin::Unknown) {
            return Ok((Sender { sysid: 0, compid: 0, seq: 0 }, false));
        }
    }
    let number = |method: &str| message.invoke_method0(method)?.extract::<i64>();
    let sender = Sender {
        sysid: number("get_srcSystem")? as u8,
        compid: number("get_srcComponent")? as u8,
        seq: number("get_seq")? as u8,
    };
    Ok((sender, number("get_msgId")? >= 0))
}

/// The type name, without a copy where nobody changed it.
pub(crate) fn message_type<'py>(message: &Bound<'py, Message>) -> PyResult<Bound<'py, PyString>> {
    match &message.get().info {
        Some(info) if !message.get().has(flags::META) => Ok(info.name.bind(message.py()).clone()),
        None if message.get().origin == Origin::Bad && !message.get().has(flags::META) => {
            Ok(intern!(message.py(), "BAD_DATA").clone())
        }
        _ => {
            let kind = message.invoke_method0(intern!(message.py(), "get_type"))?;
            Ok(kind.cast_into::<PyString>()?)
        }
    }
}
