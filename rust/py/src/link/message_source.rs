//! What a link asks of each message: its type and its source.

use pyo3::prelude::*;
use pyo3::types::PyString;

use crate::message::object::{Message, flags};
use crate::python::calling::Calling;

/// The source of a message.
pub(crate) struct Source {
    pub(crate) sysid: u8,
    pub(crate) compid: u8,
    pub(crate) seq: u8,
    /// Takes part in loss counting: BAD_DATA and UNKNOWN do not.
    pub(crate) counts: bool,
}

pub(crate) fn source_of(message: &Bound<'_, Message>) -> PyResult<Source> {
    let this = message.get();
    if !this.has(flags::META)
        && let Some(header) = this.header()
    {
        let counts = this.info.is_some();
        return Ok(Source { sysid: header.sysid, compid: header.compid, seq: header.seq, counts });
    }
    let number = |method: &str| message.invoke_method0(method)?.extract::<i64>();
    Ok(Source {
        sysid: number("get_srcSystem")? as u8,
        compid: number("get_srcComponent")? as u8,
        seq: number("get_seq")? as u8,
        counts: number("get_msgId")? >= 0,
    })
}

/// The type name, without a copy where nobody changed it.
pub(crate) fn message_type<'py>(message: &Bound<'py, Message>) -> PyResult<Bound<'py, PyString>> {
    match &message.get().info {
        Some(info) if !message.get().has(flags::META) => Ok(info.name.bind(message.py()).clone()),
        _ => {
            let kind = message.invoke_method0(intern!(message.py(), "get_type"))?;
            Ok(kind.cast_into::<PyString>()?)
        }
    }
}
