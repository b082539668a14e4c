//! Which messages `recv_match` returns.

use pyo3::prelude::*;
use pyo3::types::{PyList, PySet, PyString};

use crate::link::message_source::message_type;
use crate::message::object::Message;
use crate::python::calling::Calling;

pub(crate) enum Filter<'py> {
    All,
    One(Bound<'py, PyString>),
    In(Bound<'py, PyAny>),
}

impl<'py> Filter<'py> {
    /// The filter for the argument `type`: a name, or a list or set of names. Anything else is one (odd) name, which no
    /// message has, or with `any_collection` a collection too.
    pub(crate) fn new(types: Option<&Bound<'py, PyAny>>, any_collection: bool) -> PyResult<Self> {
        let Some(types) = types else { return Ok(Self::All) };
        if let Ok(name) = types.cast::<PyString>() {
            return Ok(Self::One(name.clone()));
        }
        let is_collection =
            any_collection || types.is_instance_of::<PyList>() || types.is_instance_of::<PySet>();
        if is_collection {
            return Ok(Self::In(types.clone()));
        }
        Ok(Self::In(PyList::new(types.py(), [types])?.into_any()))
    }

    /// Whether `message`, which a program's own `recv_msg` may have made, is of a wanted type.
    pub(crate) fn wants(&self, message: &Bound<'_, PyAny>) -> PyResult<bool> {
        if matches!(self, Self::All) {
            return Ok(true);
        }
        let kind = match message.cast::<Message>() {
            Ok(message) => message_type(message)?.into_any(),
            Err(_) => message.invoke_method0(intern!(message.py(), "get_type"))?,
        };
        match self {
            Self::All => Ok(true),
            Self::One(name) => Ok(kind.is(name) || kind.eq(name)?),
            Self::In(names) => names.contains(&kind),
        }
    }
}
