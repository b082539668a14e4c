//! Sending: one frame after the other, whatever the number of threads.

use mavwire_core::frame::FrameBuffer;
use pyo3::ffi;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyTuple};

use crate::message::encode::Payload;
use crate::message::info::{Info, MessageInfo};
use crate::protocol::mavlink::{MAVLink, overridden};
use crate::python::calling::Calling;
use crate::python::raw_function;
use crate::python::raw_function::Arguments;
use crate::sync::thread_lock::ThreadGuard;

/// Writes the frame that `pack` makes, and its length says, before other threads write theirs.
///
/// Where somebody passed meanwhile, in a `pack` or a timestamp store of the program's own, the frame may have a number that
/// is used, or a timestamp that is too old: it is made again, once, since that may take as long.
#[inline]
pub(super) fn in_turn<'py>(
    mav: &Bound<'py, MAVLink>,
    pack: impl Fn() -> PyResult<(Bound<'py, PyAny>, usize)>,
) -> PyResult<()> {
    let mut is_again = false;
    loop {
        let guard = begin(mav)?;
        let (frame, len) = pack()?;
        if is_again || guard.is_held() {
            return write(mav, &frame, len, guard);
        }
        is_again = true;
    }
}

/// Waits until no other thread sends. One that is at the same frame for a second may be waiting for what this thread has, as
/// what it is written to may be the program's own, and is gone past.
fn begin<'a>(mav: &'a Bound<'_, MAVLink>) -> PyResult<ThreadGuard<'a>> {
    let sending = mav.get().sending();
    let guard = sending.lock.lock(mav.py())?;
    if guard.is_beside() {
        sending.advance(sending.seq()); // the other frame has this number
    }
    Ok(guard)
}

/// Writes a frame of `len` bytes, then advances sequence number and counters.
fn write(
    mav: &Bound<'_, MAVLink>,
    frame: &Bound<'_, PyAny>,
    len: usize,
    _guard: ThreadGuard<'_>,
) -> PyResult<()> {
    let (py, sending) = (mav.py(), mav.get().sending());
    let seq = sending.seq();
    let file = mav.get().file.get(py).unwrap_or_else(|| py.None().into_bound(py));
    let written = file.invoke_method_with(intern!(py, "write"), frame);
    // A number that is not used is one lost frame to receivers, one that is used twice is 255.
    if written.is_ok() || may_have_sent(&file) {
        sending.advance(seq);
    }
    written?;
    sending.count(len);
    Ok(())
}

/// Whether `file` is a link, which raises what a signal handler does, also behind the frame.
#[cold]
fn may_have_sent(file: &Bound<'_, PyAny>) -> bool {
    // Asked of the class: a file of the program's own may have any attribute.
    file.get_type()
        .getattr_opt(intern!(file.py(), "_raises_behind_frames"))
        .is_ok_and(|flag| flag.is_some())
}

/// `send_values(mav, info, force_mavlink1, *values)` for `mav.<message>_send(...)`: straight from the arguments to the
/// frame, without a message object, unless somebody is there to see one.
pub(crate) unsafe extern "C" fn send_values(
    _module: *mut ffi::PyObject,
    arguments: *mut *mut ffi::PyObject,
    count: ffi::Py_ssize_t,
) -> *mut ffi::PyObject {
    // SAFETY: the arguments are this function's own.
    unsafe {
        raw_function::call(arguments, count, |_, arguments| {
            let info = arguments.require(1)?.cast::<MessageInfo>()?.get().info;
            let (mav, force_mavlink1) = (arguments.require(0)?, arguments.require(2)?);
            send_arguments(&mav, info, &force_mavlink1, &arguments.from(3))
        })
    }
}

fn send_arguments(
    mav: &Bound<'_, PyAny>,
    info: &Info,
    force_mavlink1: &Bound<'_, PyAny>,
    values: &Arguments<'_, '_>,
) -> PyResult<()> {
    let py = mav.py();
    if let Ok(native) = mav.cast::<MAVLink>()
        && !native.get().is_overridden(overridden::SEND | overridden::ENCODE)
        && !native.get().send_callback.is_set()
        && send_directly(native, info, force_mavlink1.is_truthy()?, values)?
    {
        return Ok(());
    }
    let encode = format!("{}_encode", info.definition.name.to_lowercase());
    let values = PyTuple::new(py, values.iter().collect::<Vec<_>>())?;
    let message = mav.invoke_method1(encode, values)?;
    let kwargs = pyo3::types::PyDict::new(py);
    kwargs.set_item(intern!(py, "force_mavlink1"), force_mavlink1)?;
    mav.invoke_method(intern!(py, "send"), (message,), Some(&kwargs))?;
    Ok(())
}

/// False, with nothing done, if the values need a closer look.
fn send_directly(
    mav: &Bound<'_, MAVLink>,
    info: &Info,
    force_mavlink1: bool,
    values: &Arguments<'_, '_>,
) -> PyResult<bool> {
    let py = mav.py();
    let this = mav.get();
    let definition = &info.definition;
    let mut payload = Payload::zeroed(definition);
    for (i, &place) in info.places.iter().enumerate() {
        if values.get(i).and_then(|value| payload.put(place, value)).is_none() {
            return Ok(false);
        }
    }
    let version = this.dialect.get().version(py, force_mavlink1)?;
    let payload = payload.sent(definition, version);
    in_turn(mav, || {
        let mut frame = FrameBuffer::default();
        let sender = this.sender(py)?;
        sender.frame(&mut frame, definition.id, payload, definition.crc_extra, version)?;
        Ok((PyBytes::new(py, &frame).into_any(), frame.len()))
    })?;
    Ok(true)
}
