//! Fields of the two message classes that no definition describes: BAD_DATA and UNKNOWN.

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyByteArray;

use crate::message::descriptors::no_attribute;
use crate::message::object::{Message, Origin, flags, instance_dict};

/// Reason of bytes that start no frame.
pub(crate) const BAD_PREFIX: &str = "Bad prefix";

#[derive(Clone, Copy, PartialEq, Eq)]
enum Kind {
    Data,
    Reason,
}

impl Kind {
    const fn name(self) -> &'static str {
        match self {
            Self::Data => "data",
            Self::Reason => "reason",
        }
    }
}

/// `data` or `reason`, made when first read.
#[pyclass(frozen, module = "mavwire._native")]
pub(crate) struct SpecialField {
    kind: Kind,
}

#[pymethods]
impl SpecialField {
    /// `SpecialField("data")` or `SpecialField("reason")`
    #[new]
    fn new(name: &str) -> PyResult<Self> {
        match name {
            "data" => Ok(Self { kind: Kind::Data }),
            "reason" => Ok(Self { kind: Kind::Reason }),
            _ => Err(PyValueError::new_err(format!("no such field: {name:?}"))),
        }
    }

    fn __get__(
        slf: &Bound<'_, Self>,
        obj: Option<&Bound<'_, PyAny>>,
        _owner: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Py<PyAny>> {
        let py = slf.py();
        let Some(obj) = obj else { return Ok(slf.clone().into_any().unbind()) };
        let message = obj.cast::<Message>()?;
        let this = message.get();
        let kind = slf.get().kind;
        if this.has(flags::MATERIALISED) {
            return Err(no_attribute(obj, kind.name()));
        }
        match (kind, this.origin) {
            (Kind::Data, Origin::Bad | Origin::Unknown) => {
                let data = PyByteArray::new(py, &this.frame);
                instance_dict(message)?.set_item(intern!(py, "data"), &data)?;
                Message::written(message, flags::DICT | flags::FIELDS);
                Ok(data.into_any().unbind())
            }
            (Kind::Reason, Origin::Bad) => Ok(match this.reason(py) {
                Some(reason) => reason.unbind(),
                None => intern!(py, BAD_PREFIX).clone().into_any().unbind(),
            }),
            _ => Err(no_attribute(obj, kind.name())),
        }
    }
}
