//! Calls into Python that the end of the interpreter may cut short.
//!
//! Before Python 3.14 a daemon thread that wants the interpreter's lock while the interpreter ends is ended by
//! `pthread_exit`, which unwinds its stack. `PyO3` declares the C API as functions that never unwind, so that Rust aborts the
//! process when a frame of its own is reached. Here the thread hangs instead, as `PyO3` has a thread hang that takes the lock
//! itself, and Python 3.14 any: the process is about to end.
//!
//! All that may run Python code goes through here; `clippy.toml` forbids `PyO3`'s own methods. What is left is what hardly
//! any object has written in Python: `__del__`, `__hash__`, `__len__` and conversions to numbers.

use std::ffi::c_int;
use std::mem::{forget, transmute};
use std::ptr::{null_mut, read_volatile};
use std::sync::OnceLock;

use pyo3::BoundObject;
use pyo3::exceptions::PyAttributeError;
use pyo3::ffi;
use pyo3::ffi::PyObject;
use pyo3::prelude::*;
use pyo3::pyclass::CompareOp;
use pyo3::types::{PyDict, PyString, PyTuple, PyType};

use crate::python::intern::Interned;

/// Hangs the thread whose stack is unwound through it.
struct HangThread;

impl Drop for HangThread {
    fn drop(&mut self) {
        loop {
            std::thread::park();
        }
    }
}

/// `unwinding!(f(a: A, b: B) -> R)` calls the C API's `f` as a function that may unwind.
macro_rules! unwinding {
    ($name:ident($($argument:expr => $kind:ty),* $(; $($more:expr),+; $dots:tt)?) -> $result:ty) => {{
        type Declared = unsafe extern "C" fn($($kind),* $(, $dots)?) -> $result;
        type Unwinding = unsafe extern "C-unwind" fn($($kind),* $(, $dots)?) -> $result;
        let declared: Declared = ffi::$name;
        // The same function, of which less is assumed. It is read as volatile since the compiler remembers how a function
        // that it sees was declared, and would leave out the way to the guard.
        let function: Unwinding = transmute::<Declared, Unwinding>(read_volatile(&raw const declared));
        let guard = HangThread;
        let result = function($($argument),* $(, $($more),+)?);
        forget(guard);
        result
    }};
}

type Object = *mut PyObject;

/// What of Python's objects may be written in Python.
pub(crate) trait Calling<'py> {
    /// `self(*args)`
    fn invoke1(
        &self,
        args: impl IntoPyObject<'py, Target = PyTuple>,
    ) -> PyResult<Bound<'py, PyAny>> {
        self.invoke(args, None)
    }

    /// `self(*args, **kwargs)`
    fn invoke(
        &self,
        args: impl IntoPyObject<'py, Target = PyTuple>,
        kwargs: Option<&Bound<'py, PyDict>>,
    ) -> PyResult<Bound<'py, PyAny>>;

    /// `self.name()`
    fn invoke_method0(
        &self,
        name: impl IntoPyObject<'py, Target = PyString>,
    ) -> PyResult<Bound<'py, PyAny>>;

    /// `self.name(argument)` without a tuple of arguments.
    fn invoke_method_with(
        &self,
        name: &Bound<'py, PyString>,
        argument: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyAny>>;

    /// `self.name(*args)`
    fn invoke_method1(
        &self,
        name: impl IntoPyObject<'py, Target = PyString>,
        args: impl IntoPyObject<'py, Target = PyTuple>,
    ) -> PyResult<Bound<'py, PyAny>> {
        self.attribute(name)?.invoke1(args)
    }

    /// `self.name(*args, **kwargs)`
    fn invoke_method(
        &self,
        name: impl IntoPyObject<'py, Target = PyString>,
        args: impl IntoPyObject<'py, Target = PyTuple>,
        kwargs: Option<&Bound<'py, PyDict>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        self.attribute(name)?.invoke(args, kwargs)
    }

    /// `self.name`
    fn attribute(
        &self,
        name: impl IntoPyObject<'py, Target = PyString>,
    ) -> PyResult<Bound<'py, PyAny>>;

    /// `self.name`, if there is such an attribute.
    fn attribute_opt(
        &self,
        name: impl IntoPyObject<'py, Target = PyString>,
    ) -> PyResult<Option<Bound<'py, PyAny>>>;

    /// `self.name = value`
    fn set_attribute(
        &self,
        name: impl IntoPyObject<'py, Target = PyString>,
        value: impl IntoPyObject<'py>,
    ) -> PyResult<()>;

    /// `object.__getattribute__(self, name)`
    fn generic_attribute(&self, name: &Bound<'py, PyString>) -> PyResult<Bound<'py, PyAny>>;

    /// `object.__setattr__(self, name, value)`, or `object.__delattr__(self, name)` if there is no value.
    fn set_generic_attribute(
        &self,
        name: &Bound<'py, PyString>,
        value: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<()>;

    /// `bool(self)`
    fn truth(&self) -> PyResult<bool>;

    /// `str(self)`
    fn text(&self) -> PyResult<Bound<'py, PyString>>;

    /// `bool(self == other)`
    fn equals(&self, other: &Bound<'py, PyAny>) -> PyResult<bool>;

    /// `item in self`
    fn includes(&self, item: &Bound<'py, PyAny>) -> PyResult<bool>;

    /// `iter(self)`
    fn items(&self) -> PyResult<Items<'py>>;
}

impl<'py> Calling<'py> for Bound<'py, PyAny> {
    fn invoke(
        &self,
        args: impl IntoPyObject<'py, Target = PyTuple>,
        kwargs: Option<&Bound<'py, PyDict>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let args = args.into_pyobject(self.py()).map_err(Into::into)?;
        let kwargs = kwargs.map_or(null_mut(), Bound::as_ptr);
        // SAFETY: live objects, null stands for no keywords; what comes back is a new reference, or null with an exception.
        unsafe {
            let result = unwinding!(PyObject_Call(
                self.as_ptr() => Object, args.as_borrowed().as_ptr() => Object, kwargs => Object
            ) -> Object);
            Bound::from_owned_ptr_or_err(self.py(), result)
        }
    }

    fn invoke_method0(
        &self,
        name: impl IntoPyObject<'py, Target = PyString>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let name = name.into_pyobject(self.py()).map_err(Into::into)?;
        // SAFETY: as above; null ends the arguments.
        unsafe {
            let result = unwinding!(PyObject_CallMethodObjArgs(
                self.as_ptr() => Object, name.as_borrowed().as_ptr() => Object;
                null_mut::<PyObject>(); ...
            ) -> Object);
            Bound::from_owned_ptr_or_err(self.py(), result)
        }
    }

    fn invoke_method_with(
        &self,
        name: &Bound<'py, PyString>,
        argument: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyAny>> {
        // SAFETY: as above; null ends the arguments.
        unsafe {
            let result = unwinding!(PyObject_CallMethodObjArgs(
                self.as_ptr() => Object, name.as_ptr() => Object;
                argument.as_ptr(), null_mut::<PyObject>(); ...
            ) -> Object);
            Bound::from_owned_ptr_or_err(self.py(), result)
        }
    }

    fn attribute(
        &self,
        name: impl IntoPyObject<'py, Target = PyString>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let name = name.into_pyobject(self.py()).map_err(Into::into)?;
        // SAFETY: as above.
        unsafe {
            let result = unwinding!(PyObject_GetAttr(
                self.as_ptr() => Object, name.as_borrowed().as_ptr() => Object
            ) -> Object);
            Bound::from_owned_ptr_or_err(self.py(), result)
        }
    }

    fn attribute_opt(
        &self,
        name: impl IntoPyObject<'py, Target = PyString>,
    ) -> PyResult<Option<Bound<'py, PyAny>>> {
        match self.attribute(name) {
            Ok(value) => Ok(Some(value)),
            Err(error) if error.is_instance_of::<PyAttributeError>(self.py()) => Ok(None),
            Err(error) => Err(error),
        }
    }

    fn set_attribute(
        &self,
        name: impl IntoPyObject<'py, Target = PyString>,
        value: impl IntoPyObject<'py>,
    ) -> PyResult<()> {
        let name = name.into_pyobject(self.py()).map_err(Into::into)?;
        let value = value.into_pyobject(self.py()).map_err(Into::into)?;
        // SAFETY: live objects, borrowed for the call only; anything but 0 comes with an exception.
        let result = unsafe {
            unwinding!(PyObject_SetAttr(
                self.as_ptr() => Object, name.as_borrowed().as_ptr() => Object,
                value.as_borrowed().as_ptr() => Object
            ) -> c_int)
        };
        if result == 0 { Ok(()) } else { Err(PyErr::fetch(self.py())) }
    }

    fn generic_attribute(&self, name: &Bound<'py, PyString>) -> PyResult<Bound<'py, PyAny>> {
        // SAFETY: as for `invoke`.
        unsafe {
            let result = unwinding!(PyObject_GenericGetAttr(
                self.as_ptr() => Object, name.as_ptr() => Object
            ) -> Object);
            Bound::from_owned_ptr_or_err(self.py(), result)
        }
    }

    fn set_generic_attribute(
        &self,
        name: &Bound<'py, PyString>,
        value: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<()> {
        let value = value.map_or(null_mut(), Bound::as_ptr);
        // SAFETY: as for `set_attribute`; null deletes.
        let result = unsafe {
            unwinding!(PyObject_GenericSetAttr(
                self.as_ptr() => Object, name.as_ptr() => Object, value => Object
            ) -> c_int)
        };
        if result == 0 { Ok(()) } else { Err(PyErr::fetch(self.py())) }
    }

    #[inline]
    fn truth(&self) -> PyResult<bool> {
        // SAFETY: a live object; a negative answer comes with an exception.
        let answer = unsafe { unwinding!(PyObject_IsTrue(self.as_ptr() => Object) -> c_int) };
        yes_or_no(self.py(), answer)
    }

    fn text(&self) -> PyResult<Bound<'py, PyString>> {
        // SAFETY: as for `invoke`; what is not an exception is a string.
        unsafe {
            let result = unwinding!(PyObject_Str(self.as_ptr() => Object) -> Object);
            Ok(Bound::from_owned_ptr_or_err(self.py(), result)?.cast_into_unchecked())
        }
    }

    fn equals(&self, other: &Bound<'py, PyAny>) -> PyResult<bool> {
        // SAFETY: as for `invoke`.
        let result = unsafe {
            let result = unwinding!(PyObject_RichCompare(
                self.as_ptr() => Object, other.as_ptr() => Object, CompareOp::Eq as c_int => c_int
            ) -> Object);
            Bound::from_owned_ptr_or_err(self.py(), result)?
        };
        result.truth()
    }

    fn includes(&self, item: &Bound<'py, PyAny>) -> PyResult<bool> {
        // SAFETY: two live objects; a negative answer comes with an exception.
        let answer = unsafe {
            unwinding!(PySequence_Contains(
                self.as_ptr() => Object, item.as_ptr() => Object
            ) -> c_int)
        };
        yes_or_no(self.py(), answer)
    }

    fn items(&self) -> PyResult<Items<'py>> {
        // SAFETY: as for `invoke`.
        unsafe {
            let result = unwinding!(PyObject_GetIter(self.as_ptr() => Object) -> Object);
            Bound::from_owned_ptr_or_err(self.py(), result).map(Items)
        }
    }
}

fn yes_or_no(py: Python<'_>, answer: c_int) -> PyResult<bool> {
    if answer >= 0 { Ok(answer != 0) } else { Err(PyErr::fetch(py)) }
}

/// What an object gives that is iterated over.
pub(crate) struct Items<'py>(Bound<'py, PyAny>);

impl<'py> Iterator for Items<'py> {
    type Item = PyResult<Bound<'py, PyAny>>;

    fn next(&mut self) -> Option<Self::Item> {
        let py = self.0.py();
        // SAFETY: a live iterator; the item is a new reference, null with or without an exception ends them.
        let item = unsafe {
            let item = unwinding!(PyIter_Next(self.0.as_ptr() => Object) -> Object);
            Bound::from_owned_ptr_or_opt(py, item)
        };
        item.map(Ok).or_else(|| PyErr::take(py).map(Err))
    }
}

/// `import name`; with dots, the last of them.
pub(crate) fn import<'py>(
    py: Python<'py>,
    name: &Bound<'py, PyString>,
) -> PyResult<Bound<'py, PyAny>> {
    // SAFETY: as for `invoke`.
    unsafe {
        let result = unwinding!(PyImport_Import(name.as_ptr() => Object) -> Object);
        Bound::from_owned_ptr_or_err(py, result)
    }
}

/// A function of one of Python's own modules, looked up once, so that no hook of the program's is asked for it again.
pub(crate) struct Known {
    module: Interned,
    name: Interned,
    found: OnceLock<Py<PyAny>>,
}

impl Known {
    pub(crate) const fn new(module: &'static str, name: &'static str) -> Self {
        Self { module: Interned::new(module), name: Interned::new(name), found: OnceLock::new() }
    }

    pub(crate) fn get<'py>(&self, py: Python<'py>) -> PyResult<&Bound<'py, PyAny>> {
        if let Some(found) = self.found.get() {
            return Ok(found.bind(py));
        }
        let found = import(py, self.module.get(py))?.attribute(self.name.get(py))?.unbind();
        Ok(self.found.get_or_init(|| found).bind(py))
    }
}

/// `cls.__name__`. `PyO3`'s strings are not for `format!`: `PyObject_Str` looks for signals first, and what a handler raises
/// there is told of and forgotten.
pub(crate) fn class_name(class: &Bound<'_, PyType>) -> PyResult<String> {
    #[expect(clippy::disallowed_methods, reason = "this is what stands in for it")]
    Ok(class.name()?.to_cow()?.into_owned())
}

/// `bool(value)`, for arguments that may be anything.
pub(crate) fn truth(value: &Bound<'_, PyAny>) -> PyResult<bool> {
    value.truth()
}
