//! Making and unmaking message objects fast.
//!
//! PyO3 makes an instance of a Python subclass through `tp_new`, which costs as much as everything else about a message
//! together. [`create`] allocates as `object.__new__` does and writes the Rust value where PyO3 keeps it. The import of
//! the extension checks that place on an instance that PyO3 made.
//!
//! A message that came off the wire refers to no Python object but its class, so the garbage collector need not know
//! it: it is untracked here and tracked again by [`track`] when something is first written to it. That keeps lists of
//! millions of messages out of every collection.
//!
//! A program that reads a stream drops messages as fast as it gets them. So the classes that [`message_class`] makes
//! have a `tp_dealloc` of their own, which keeps a limited number of dead objects for [`pooled`]: those that never had
//! a dictionary or a weak reference. It saves two thirds of what CPython and PyO3 do for an object's birth and death.

use std::ffi::{CStr, c_void};
use std::mem::offset_of;
use std::ptr::null_mut;
use std::sync::atomic::{AtomicPtr, AtomicUsize, Ordering::Relaxed};

use pyo3::exceptions::{PyRuntimeError, PyTypeError};
use pyo3::ffi;
use pyo3::prelude::*;
use pyo3::types::{PyTuple, PyType};

use crate::message::info::Info;
use crate::message::object::{Message, Origin, flags};
use crate::python::calling::class_name;
use crate::python::collector::untrack;
use mavwire_core::frame::FrameBytes;

/// An instance as PyO3 lays it out.
#[repr(C)]
struct Instance {
    head: ffi::PyObject,
    message: Message,
    dict: *mut ffi::PyObject,
    weak_references: *mut ffi::PyObject,
}

/// Refuses a PyO3 that lays out instances differently from [`Instance`].
pub(crate) fn check_layout(py: Python<'_>) -> PyResult<()> {
    let object = Bound::new(py, Message::built(None))?;
    let number = |name: &str| object.get_type().getattr(name)?.extract::<usize>();
    // There must be nothing else that would have to be initialised.
    let is_expected = std::ptr::from_ref(object.get()) as usize - object.as_ptr() as usize
        == offset_of!(Instance, message)
        && number("__basicsize__")? == size_of::<Instance>()
        && number("__dictoffset__")? == offset_of!(Instance, dict)
        && number("__weakrefoffset__")? == offset_of!(Instance, weak_references);
    if is_expected {
        return Ok(());
    }
    Err(PyRuntimeError::new_err("mavwire does not know how this Python lays out objects"))
}

/// An instance of `class` (a Python subclass of `Message`) around `message`, without going through its `__init__`.
pub(crate) fn create<'py>(
    class: &Bound<'py, PyType>,
    message: Message,
) -> PyResult<Bound<'py, Message>> {
    // SAFETY: `class` derives from `Message`, so that the allocation gives a zeroed object of at least `Message`'s basic
    // size, laid out like `Instance` (see `check_layout`). The value is written before anybody can see the object.
    unsafe {
        let object = ffi::PyType_GenericAlloc(class.as_type_ptr(), 0);
        let object = Bound::from_owned_ptr_or_err(class.py(), object)?;
        (&raw mut (*object.as_ptr().cast::<Instance>()).message).write(message);
        untrack(&object);
        Ok(object.cast_into_unchecked())
    }
}

/// The same for a class that [`message_class`] made, with an object from the pool if there is one.
#[inline]
pub(crate) fn pooled<'py>(
    class: &Bound<'py, PyType>,
    mut message: Message,
) -> PyResult<Bound<'py, Message>> {
    *message.flags.get_mut() |= flags::POOLED;
    match pool::take() {
        Some(instance) => Ok(revive(class, instance, message)),
        None => create(class, message),
    }
}

/// A message around the first `len` bytes of `stream`, a frame of the definition `info`, finished by `finish`; `None` where no
/// object is waiting or the frame does not fit into it. Nothing of Python's is called, so that locks may be held.
#[inline]
pub(crate) fn reused_frame<'py>(
    class: &Bound<'py, PyType>,
    info: &'static Info,
    stream: &[u8],
    len: usize,
    finish: impl FnOnce(Message) -> Message,
) -> Option<Bound<'py, Message>> {
    // All in one go: a frame that is put together elsewhere and then moved has to be waited for.
    let frame = FrameBytes::inline(stream, len)?;
    let instance = pool::take()?;
    let mut message = finish(Message::received(Some(info), frame, Origin::Decoded));
    *message.flags.get_mut() |= flags::POOLED;
    Some(revive(class, instance, message))
}

/// A message around a frame.
pub(crate) fn around(info: &'static Info, frame: &[u8]) -> Message {
    Message::received(Some(info), FrameBytes::from(frame), Origin::Decoded)
}

/// Makes an object of the pool a message.
#[inline(always)] // as above
fn revive<'py>(
    class: &Bound<'py, PyType>,
    instance: *mut Instance,
    message: Message,
) -> Bound<'py, Message> {
    // SAFETY: an object from the pool is memory for an instance of such a class. No other code knows it, and its
    // dictionary and weak references are null; `PyObject_Init` gives it its class and one reference.
    unsafe {
        (&raw mut (*instance).message).write(message);
        let object = ffi::PyObject_Init(instance.cast(), class.as_type_ptr());
        Bound::from_owned_ptr(class.py(), object).cast_into_unchecked()
    }
}

/// `Message`'s own `tp_dealloc`, as PyO3 made it.
static DEALLOC: AtomicPtr<c_void> = AtomicPtr::new(null_mut());

/// Refuses a class whose instances are not laid out as messages are, which everything here takes for granted.
pub(crate) fn require_message_class(class: &Bound<'_, PyType>) -> PyResult<()> {
    if class.is_subclass_of::<Message>()? {
        return Ok(());
    }
    Err(PyTypeError::new_err(format!("{} is no message class", class_name(class)?)))
}

/// A message class: one that differs from its base in nothing but how its instances are freed.
///
/// # Errors
/// `TypeError` where the base is no message class.
pub(crate) fn message_class<'py>(
    name: &CStr,
    base: &Bound<'py, PyType>,
) -> PyResult<Bound<'py, PyType>> {
    require_message_class(base)?;
    let message = base.py().get_type::<Message>();
    // SAFETY: a type with that slot.
    let own = unsafe { ffi::PyType_GetSlot(message.as_type_ptr(), ffi::Py_tp_dealloc) };
    DEALLOC.store(own, Relaxed);
    derived_type(name, base, &[(ffi::Py_tp_dealloc, dealloc as *mut c_void)])
}

/// A type that may be derived from, with slots that differ from its base's. The name has a module in front.
pub(crate) fn derived_type<'py>(
    name: &CStr,
    base: &Bound<'py, PyType>,
    slots: &[(std::ffi::c_int, *mut c_void)],
) -> PyResult<Bound<'py, PyType>> {
    let bases = PyTuple::new(base.py(), [base])?;
    let slot = |(slot, pfunc)| ffi::PyType_Slot { slot, pfunc };
    let mut slots: Vec<_> = slots.iter().copied().chain([(0, null_mut())]).map(slot).collect();
    let mut spec = ffi::PyType_Spec {
        name: name.as_ptr(),
        basicsize: 0, // that of the base
        itemsize: 0,
        flags: (ffi::Py_TPFLAGS_DEFAULT | ffi::Py_TPFLAGS_BASETYPE) as std::ffi::c_uint,
        slots: slots.as_mut_ptr(),
    };
    // SAFETY: the specification is complete and copied by the call, which returns a new reference or sets an exception.
    unsafe {
        let class = ffi::PyType_FromSpecWithBases(&raw mut spec, bases.as_ptr());
        Ok(Bound::from_owned_ptr_or_err(base.py(), class)?.cast_into_unchecked())
    }
}

/// `tp_dealloc` of message classes. It calls nothing that can panic.
unsafe extern "C" fn dealloc(object: *mut ffi::PyObject) {
    // SAFETY: called by CPython, attached, with an object of a class that `message_class` made (or a subclass, whose own
    // `tp_dealloc` shows it to the garbage collector first) to which no references are left. Nobody uses it after it was
    // given back here; the class is let go last.
    unsafe {
        let class = ffi::Py_TYPE(object);
        let instance = object.cast::<Instance>();
        if pool::may_keep(instance) {
            (&raw mut (*instance).message).drop_in_place();
            if !pool::keep(instance) {
                ffi::PyObject_GC_Del(object.cast());
            }
            ffi::Py_DECREF(class.cast());
        } else {
            let dealloc: ffi::destructor = std::mem::transmute(DEALLOC.load(Relaxed));
            dealloc(object);
        }
    }
}

/// Dead objects waiting to be messages again. The interpreter's lock guards them.
///
/// A stack of pointers and not a list linked through the objects: those are cold when their turn comes, and a link
/// would have to be waited for.
mod pool {
    use super::{AtomicPtr, AtomicUsize, Instance, Message, Relaxed, ffi, flags, null_mut};

    /// Objects that are kept, at most: half a megabyte.
    const CAPACITY: usize = 4096;

    static WAITING: [AtomicPtr<Instance>; CAPACITY] =
        [const { AtomicPtr::new(null_mut()) }; CAPACITY];
    static COUNT: AtomicUsize = AtomicUsize::new(0);

    /// Takes an object out.
    #[inline]
    pub(super) fn take() -> Option<*mut Instance> {
        let last = COUNT.load(Relaxed).checked_sub(1)?;
        let instance = WAITING.get(last)?.load(Relaxed);
        COUNT.store(last, Relaxed);
        Some(instance)
    }

    /// Whether nothing but the value itself has to be cleaned up.
    ///
    /// # Safety
    /// `instance` must be an object of a class derived from `Message`.
    #[inline]
    pub(super) unsafe fn may_keep(instance: *mut Instance) -> bool {
        // SAFETY: such objects are laid out like this.
        unsafe {
            let message: &Message = &(*instance).message;
            cfg!(not(Py_GIL_DISABLED))
                && message.has(flags::POOLED)
                && (*instance).dict.is_null()
                && (*instance).weak_references.is_null()
                && ffi::PyObject_GC_IsTracked(instance.cast()) == 0
        }
    }

    /// Puts a dead object in, its value dropped; false if there is no room.
    #[inline]
    pub(super) fn keep(instance: *mut Instance) -> bool {
        let count = COUNT.load(Relaxed);
        let Some(place) = WAITING.get(count) else { return false };
        place.store(instance, Relaxed);
        COUNT.store(count + 1, Relaxed);
        true
    }
}
