//! Descriptors that decode when they are read.
//!
//! Both kinds are *non-data* descriptors: an entry in the instance `__dict__` (a built or edited message) wins by
//! CPython's own lookup rule, so a decoded message needs no dictionary until a program writes to it.
//!
//! Reading a field is what programs do most, so [`field_getter_type`] puts a function of its own into `tp_descr_get`,
//! which spares the conversion of arguments and the checks that PyO3 makes for every call (230 of 450 instructions).

use std::ffi::c_void;
use std::ptr::null_mut;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicPtr, Ordering::Relaxed};

use mavwire_schema::{Field, FieldType};
use pyo3::exceptions::{PyAttributeError, PyValueError};
use pyo3::gc::{PyTraverseError, PyVisit};
use pyo3::prelude::*;
use pyo3::types::{PyString, PyType};
use pyo3::{Borrowed, PyTypeInfo, ffi};

use crate::message::create;
use crate::message::info::MessageInfo;
use crate::message::meta;
use crate::message::object::{Message, Origin, flags};
use crate::message::values;
use crate::python::calling::{Calling, class_name};

/// A field of a decoded message, or the raw bytes behind a text field.
#[pyclass(frozen, subclass, module = "mavwire._native")]
pub(crate) struct FieldGetter {
    field: Field,
    name: Py<PyString>,
    raw: bool,
    /// The attribute of the class that the field shadows: fields may be called `id` or `name`.
    class_value: Option<Py<PyAny>>,
    /// The message class it is an attribute of, whose instances need no closer look.
    owner: OnceLock<Py<PyType>>,
}

#[pymethods]
impl FieldGetter {
    /// `FieldGetter(info, field name, raw=False, class_value=None)`
    #[new]
    #[pyo3(signature = (info, field, raw = false, class_value = None))]
    fn new(
        py: Python<'_>,
        info: &MessageInfo,
        field: &str,
        raw: bool,
        class_value: Option<Py<PyAny>>,
    ) -> PyResult<Self> {
        let (index, definition) = info
            .info
            .field(field)
            .ok_or_else(|| PyValueError::new_err(format!("no field {field:?}")))?;
        let names = &info.info.names[index];
        let name = if raw { names.raw.as_ref() } else { Some(&names.name) };
        let name = name.ok_or_else(|| PyValueError::new_err(format!("{field:?} is not text")))?;
        Ok(Self {
            field: definition.clone(),
            name: name.clone_ref(py),
            raw,
            class_value,
            owner: OnceLock::new(),
        })
    }

    fn __get__(
        slf: &Bound<'_, Self>,
        obj: Option<&Bound<'_, PyAny>>,
        owner: Option<&Bound<'_, PyType>>,
    ) -> PyResult<Py<PyAny>> {
        let py = slf.py();
        let this = slf.get();
        let Some(obj) = obj else { return this.class_attribute(py, None, owner) };
        if let Ok(message) = obj.cast::<Message>() {
            let message = message.get();
            if message.origin == Origin::Decoded && !message.has(flags::MATERIALISED) {
                let payload = message.decoded_payload();
                return if this.raw {
                    Ok(values::field_raw(py, &this.field, payload).into_any().unbind())
                } else {
                    values::field_value(py, &this.field, payload)
                };
            }
        }
        match this.class_value {
            Some(_) => this.class_attribute(py, Some(obj), owner),
            None => Err(no_attribute(obj, &this.name.bind(py).to_cow()?)),
        }
    }

    fn __traverse__(&self, visit: PyVisit<'_>) -> Result<(), PyTraverseError> {
        visit.call(&self.class_value)?;
        visit.call(self.owner.get())
    }
}

/// `FieldGetter` with a quicker `__get__` for messages off the wire; in all other cases it is the one above.
pub(crate) fn field_getter_type(py: Python<'_>) -> PyResult<Bound<'_, PyType>> {
    let base = py.get_type::<FieldGetter>();
    // SAFETY: a type with that slot.
    let slow = unsafe { ffi::PyType_GetSlot(base.as_type_ptr(), ffi::Py_tp_descr_get) };
    SLOW_GET.store(slow, Relaxed);
    let slots = [(ffi::Py_tp_descr_get, quick_get as *mut c_void)];
    create::derived_type(c"mavwire._native.FieldGetter", &base, &slots)
}

/// `FieldGetter`'s own `tp_descr_get`.
static SLOW_GET: AtomicPtr<c_void> = AtomicPtr::new(null_mut());

unsafe extern "C" fn quick_get(
    slf: *mut ffi::PyObject,
    obj: *mut ffi::PyObject,
    owner: *mut ffi::PyObject,
) -> *mut ffi::PyObject {
    // SAFETY: CPython calls this attached, with a `FieldGetter` and a live object or null. The object is looked at only if
    // it is a message.
    unsafe {
        let py = Python::assume_attached();
        let getter = Borrowed::from_ptr(py, slf).cast_unchecked::<FieldGetter>();
        if !obj.is_null() && getter.get().takes(py, ffi::Py_TYPE(obj)) {
            let message = Borrowed::from_ptr(py, obj).cast_unchecked::<Message>();
            if let Some(value) = getter.get().quick_value(py, message.get()) {
                return value.into_ptr();
            }
        }
        let get: ffi::descrgetfunc = std::mem::transmute(SLOW_GET.load(Relaxed));
        get(slf, obj, owner)
    }
}

impl FieldGetter {
    /// Makes it an attribute of a message class.
    pub(crate) fn set_owner(&self, class: &Bound<'_, PyType>) {
        let _ = self.owner.set(class.clone().unbind());
    }

    /// Whether instances of a type are messages.
    #[inline]
    fn takes(&self, py: Python<'_>, class: *mut ffi::PyTypeObject) -> bool {
        let owner = self.owner.get().map_or(null_mut(), |owner| owner.as_ptr().cast());
        // SAFETY: two types that are alive.
        class == owner || unsafe { ffi::PyType_IsSubtype(class, Message::type_object_raw(py)) != 0 }
    }

    /// The value of a plain number of a message off the wire. Does not panic.
    #[inline]
    fn quick_value(&self, py: Python<'_>, message: &Message) -> Option<Py<PyAny>> {
        let Field { field_type, offset, array_length, .. } = self.field;
        let plain = array_length == 0 && field_type != FieldType::Char;
        if !plain || message.origin != Origin::Decoded || message.has(flags::MATERIALISED) {
            return None;
        }
        values::scalar(py, field_type, message.decoded_payload(), usize::from(offset)).ok()
    }

    /// The attribute of the class, for itself or for an instance from which the field was deleted.
    fn class_attribute(
        &self,
        py: Python<'_>,
        obj: Option<&Bound<'_, PyAny>>,
        owner: Option<&Bound<'_, PyType>>,
    ) -> PyResult<Py<PyAny>> {
        match (&self.class_value, owner) {
            (Some(value), owner) => {
                let value = value.bind(py);
                if value.getattr_opt(intern!(py, "__get__"))?.is_some() {
                    Ok(value.invoke_method1(intern!(py, "__get__"), (obj, owner))?.unbind())
                } else {
                    Ok(value.clone().unbind())
                }
            }
            (None, Some(owner)) => Err(PyAttributeError::new_err(format!(
                "type object '{}' has no attribute '{}'",
                class_name(owner)?,
                self.name.bind(py).to_cow()?
            ))),
            (None, None) => Err(PyAttributeError::new_err(self.name.clone_ref(py))),
        }
    }
}

/// An attribute of a message that its definition does not describe: `_header`, `_msgbuf`, `_crc`, `data` and so on.
#[pyclass(frozen, module = "mavwire._native")]
pub(crate) struct MetaAttr {
    name: String,
}

#[pymethods]
impl MetaAttr {
    /// `MetaAttr(name)`, name as in `vars(message)`.
    #[new]
    fn new(name: String) -> Self {
        Self { name }
    }

    fn __get__(
        slf: &Bound<'_, Self>,
        obj: Option<&Bound<'_, PyAny>>,
        _owner: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Py<PyAny>> {
        let Some(obj) = obj else { return Ok(slf.clone().into_any().unbind()) };
        let message = obj.cast::<Message>()?;
        let name = &slf.get().name;
        let deleted = message.get().has(flags::MATERIALISED);
        let value = if deleted { None } else { meta::read(message, name)? };
        value.ok_or_else(|| no_attribute(obj, name))
    }
}

/// Gives messages the attributes that all of them have.
pub(crate) fn add_meta_attributes(py: Python<'_>) -> PyResult<()> {
    let messages = py.get_type::<Message>();
    meta::NAMES.iter().try_for_each(|&name| messages.setattr(name, MetaAttr::new(name.to_owned())))
}

/// The error of reading an attribute that does not exist.
pub(crate) fn no_attribute(obj: &Bound<'_, PyAny>, name: &str) -> PyErr {
    match class_name(&obj.get_type()) {
        Ok(class) => {
            PyAttributeError::new_err(format!("'{class}' object has no attribute '{name}'"))
        }
        Err(error) => error,
    }
}
