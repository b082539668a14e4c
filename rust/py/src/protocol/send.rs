//! Sending: one frame after the other, from any number of threads.

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

/// Writes the frame that `pack` makes, of the length it says, before other threads write theirs.
///
/// A thread that holds the lock for a second may be waiting for this one, as the program's own code may run in it. This one
/// goes past, then.
#[inline]
pub(super) fn in_turn<'py>(
    mav: &Bound<'py, MAVLink>,
    pack: impl FnOnce() -> PyResult<(Bound<'py, PyAny>, usize)>,
) -> PyResult<()> {
    let (py, sending) = (mav.py(), mav.get().sending());
    let guard = sending.lock.lock(py)?;
    if guard.is_beside() {
        sending.advance(sending.seq()); // the other frame has this number
    }
    let (frame, len) = pack()?;
    let seq = sending.seq();
    let file = mav.get().file.get(py).unwrap_or_else(|| py.None().into_bound(py));
    file.invoke_method_with(intern!(py, "write"), &frame)?;
    sending.advance(seq);
    sending.count(len);
    Ok(())
}

/// `send_values(mav, info, force_mavlink1, *values)` for `mav.<message>_send(...)`: straight from the arguments to the
/// frame, without a message object, unless code of the program sees one.
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
