//! Calls of Python functions that the end of the interpreter may cut short.
//!
//! Before Python 3.14 a daemon thread that wants the interpreter's lock while the interpreter ends is ended by
//! `pthread_exit`, which unwinds its stack. PyO3 declares the C API as functions that never unwind, so that Rust aborts the
//! process when it reaches a frame of Rust. Here the thread hangs instead, as a thread of PyO3 does that takes the lock
//! itself: the process is about to end.
//!
//! All calls of functions that a program may have written, and that may wait, go through here. `clippy.toml` forbids
//! PyO3's own methods for them. Attributes, comparisons and texts use PyO3's.

use std::mem::{forget, transmute};
use std::ptr::{null_mut, read_volatile};
use std::sync::OnceLock;

use pyo3::BoundObject;
use pyo3::ffi;
use pyo3::ffi::PyObject;
use pyo3::prelude::*;
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

type Object = *mut PyObject;
type Call = unsafe extern "C" fn(Object, Object, Object) -> Object;
type UnwindingCall = unsafe extern "C-unwind" fn(Object, Object, Object) -> Object;
type CallMethod = unsafe extern "C" fn(Object, Object, ...) -> Object;
type UnwindingCallMethod = unsafe extern "C-unwind" fn(Object, Object, ...) -> Object;

/// Does a call that may unwind.
fn guarded(py: Python<'_>, call: impl FnOnce() -> Object) -> PyResult<Bound<'_, PyAny>> {
    let guard = HangThread;
    let result = call();
    forget(guard);
    // SAFETY: the result of a call is a new reference, or null with an exception.
    unsafe { Bound::from_owned_ptr_or_err(py, result) }
}

/// Calls of functions that may be a program's.
pub(crate) trait Calling<'py>: PyAnyMethods<'py> {
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
        self.getattr(name)?.invoke1(args)
    }

    /// `self.name(*args, **kwargs)`
    fn invoke_method(
        &self,
        name: impl IntoPyObject<'py, Target = PyString>,
        args: impl IntoPyObject<'py, Target = PyTuple>,
        kwargs: Option<&Bound<'py, PyDict>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        self.getattr(name)?.invoke(args, kwargs)
    }
}

impl<'py> Calling<'py> for Bound<'py, PyAny> {
    fn invoke(
        &self,
        args: impl IntoPyObject<'py, Target = PyTuple>,
        kwargs: Option<&Bound<'py, PyDict>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let args = args.into_pyobject(self.py()).map_err(Into::into)?;
        let (args, kwargs) = (args.as_borrowed(), kwargs.map_or(null_mut(), Bound::as_ptr));
        // SAFETY: live objects; null means no keywords. See `call`.
        guarded(self.py(), || unsafe { call()(self.as_ptr(), args.as_ptr(), kwargs) })
    }

    fn invoke_method0(
        &self,
        name: impl IntoPyObject<'py, Target = PyString>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let name = name.into_pyobject(self.py()).map_err(Into::into)?;
        let (name, end) = (name.as_borrowed(), null_mut::<PyObject>());
        // SAFETY: live objects; null ends the arguments. See `call_method`.
        guarded(self.py(), || unsafe { call_method()(self.as_ptr(), name.as_ptr(), end) })
    }

    fn invoke_method_with(
        &self,
        name: &Bound<'py, PyString>,
        argument: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let (argument, end) = (argument.as_ptr(), null_mut::<PyObject>());
        // SAFETY: as above.
        guarded(self.py(), || unsafe { call_method()(self.as_ptr(), name.as_ptr(), argument, end) })
    }
}

// The compiler remembers how a function that it sees was declared, and would leave out the guard. So the functions are read
// as volatile.

/// `PyObject_Call`, which may unwind.
#[inline]
fn call() -> UnwindingCall {
    let declared: Call = ffi::PyObject_Call;
    // SAFETY: the same function, of which less is assumed.
    unsafe { transmute::<Call, UnwindingCall>(read_volatile(&raw const declared)) }
}

/// `PyObject_CallMethodObjArgs`, which may unwind.
#[inline]
fn call_method() -> UnwindingCallMethod {
    let declared: CallMethod = ffi::PyObject_CallMethodObjArgs;
    // SAFETY: as above.
    unsafe { transmute::<CallMethod, UnwindingCallMethod>(read_volatile(&raw const declared)) }
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
        let found = py.import(self.module.get(py))?.getattr(self.name.get(py))?.unbind();
        Ok(self.found.get_or_init(|| found).bind(py))
    }
}

/// `cls.__name__`. PyO3's strings are not for `format!`: `PyObject_Str` looks for signals first, and what a handler raises
/// there is told of and forgotten.
pub(crate) fn class_name(class: &Bound<'_, PyType>) -> PyResult<String> {
    #[expect(clippy::disallowed_methods, reason = "this is what stands in for it")]
    Ok(class.name()?.to_cow()?.into_owned())
}

/// `bool(value)`, for arguments that may be anything.
pub(crate) fn truth(value: &Bound<'_, PyAny>) -> PyResult<bool> {
    value.is_truthy()
}
