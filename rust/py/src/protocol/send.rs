//! Sending: one frame after the other, from any number of threads.

use mavwire_core::frame::{FrameBuffer, MAX_FRAME_LEN};
use pyo3::ffi;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict, PyTuple};

use crate::message::encode;
use crate::message::info::{Info, MessageInfo};
use crate::message::object::Message;
use crate::protocol::mavlink::{MAVLink, overridden};
use crate::protocol::pack;
use crate::protocol::sending::Sending;
use crate::python::calling::{Calling, truth};
use crate::python::lists::{bytes, list};
use crate::python::raw_function;
use crate::python::raw_function::Arguments;

/// Writes frames before other threads write theirs. `pack` makes them with the sequence numbers from that of `mav` on, and
/// gives what to write, its length, and how many frames that is.
///
/// A thread that holds the lock for a second may be waiting for this one, as the program's own code may run in it. This one
/// goes past, then.
#[inline]
fn in_turn<'py>(
    mav: &Bound<'py, MAVLink>,
    pack: impl FnOnce(&Sending) -> PyResult<Packed<'py>>,
) -> PyResult<usize> {
    let (py, sending) = (mav.py(), mav.get().sending());
    let guard = sending.lock.lock(py)?;
    if guard.is_beside() {
        sending.advance(sending.seq()); // the other frame has this number
    }
    let Packed { bytes, len, count, last } = pack(sending)?;
    let file = mav.get().file.get(py).unwrap_or_else(|| py.None().into_bound(py));
    file.invoke_method_with(intern!(py, "write"), &bytes)?;
    sending.advance(last);
    sending.count(count, len);
    Ok(count)
}

/// The bytes for one call of `write`.
struct Packed<'py> {
    bytes: Bound<'py, PyAny>,
    len: usize,
    /// Frames in it.
    count: usize,
    /// Sequence number of the last one.
    last: i64,
}

#[pymethods]
impl MAVLink {
    /// Packs the message and writes it to `file`. Nothing advances if packing or writing fails.
    #[pyo3(signature = (mavmsg, force_mavlink1 = false))]
    fn send(
        slf: &Bound<'_, Self>,
        mavmsg: &Bound<'_, PyAny>,
        #[pyo3(from_py_with = truth)] force_mavlink1: bool,
    ) -> PyResult<()> {
        in_turn(slf, |sending| {
            let bytes = frame_of(mavmsg, slf, force_mavlink1)?;
            Ok(Packed { len: bytes.len()?, bytes, count: 1, last: sending.seq() })
        })?;
        slf.get().send_callback.call(slf, mavmsg)
    }

    /// Sends messages in order. As many frames as fit into the `batch_bytes` of `file` leave in one call of its `write`.
    ///
    /// A message that cannot be packed is an error after those before it were sent.
    #[pyo3(signature = (messages, force_mavlink1 = false))]
    fn send_many(
        slf: &Bound<'_, Self>,
        #[pyo3(from_py_with = list)] messages: Vec<Bound<'_, PyAny>>,
        #[pyo3(from_py_with = truth)] force_mavlink1: bool,
    ) -> PyResult<()> {
        let (py, this) = (slf.py(), slf.get());
        if this.is_overridden(overridden::SEND) {
            let send = slf.getattr(intern!(py, "send"))?;
            let mut messages = messages.iter();
            return messages.try_for_each(|one| send.invoke1((one, force_mavlink1)).map(drop));
        }
        let (file, name) = (this.file.get(py), intern!(py, "batch_bytes"));
        let room = file.map(|file| file.getattr_opt(name)).transpose()?.flatten();
        let room = room.map_or(Ok(0), |room| room.extract::<usize>())?;
        let mut rest = &messages[..];
        while !rest.is_empty() {
            let count = in_turn(slf, |sending| join(slf, rest, room, force_mavlink1, sending))?;
            let (sent, left) = rest.split_at(count);
            sent.iter().try_for_each(|message| this.send_callback.call(slf, message))?;
            rest = left;
        }
        Ok(())
    }
}

/// The frames of the first messages: as many as fit into `room` bytes, and at least one.
fn join<'py>(
    mav: &Bound<'py, MAVLink>,
    messages: &[Bound<'py, PyAny>],
    room: usize,
    force_mavlink1: bool,
    sending: &Sending,
) -> PyResult<Packed<'py>> {
    let (mut joined, mut count, mut last) = (Vec::new(), 0, sending.seq());
    for message in messages {
        if count > 0 && joined.len() + MAX_FRAME_LEN > room {
            break;
        }
        if count > 0 {
            sending.advance(last);
        }
        match frame_of(message, mav, force_mavlink1) {
            Ok(frame) => joined.extend(bytes(&frame)?),
            // Raised again when it is the first one.
            Err(_) if count > 0 => break,
            Err(error) => return Err(error),
        }
        (count, last) = (count + 1, sending.seq());
    }
    let bytes = PyBytes::new(mav.py(), &joined).into_any();
    Ok(Packed { bytes, len: joined.len(), count, last })
}

/// `message.pack(mav, force_mavlink1=force_mavlink1)`
fn frame_of<'py>(
    message: &Bound<'py, PyAny>,
    mav: &Bound<'py, MAVLink>,
    force_mavlink1: bool,
) -> PyResult<Bound<'py, PyAny>> {
    let py = mav.py();
    if let Ok(message) = message.cast::<Message>()
        && pack::is_own(message)?
    {
        return Ok(Message::pack(message, mav, force_mavlink1)?.into_any());
    }
    let kwargs = PyDict::new(py);
    kwargs.set_item(intern!(py, "force_mavlink1"), force_mavlink1)?;
    message.invoke_method(intern!(py, "pack"), (mav,), Some(&kwargs))
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
    let kwargs = PyDict::new(py);
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
    let mut frame = FrameBuffer::default();
    let payload = frame.payload_mut();
    for (i, &place) in info.places.iter().enumerate() {
        if values.get(i).and_then(|value| encode::put(payload, place, value)).is_none() {
            return Ok(false);
        }
    }
    let version = this.dialect.get().version(py, force_mavlink1)?;
    let payload_len = encode::payload_len(definition, version);
    in_turn(mav, |sending| {
        let sender = this.sender(py)?;
        sender.frame(&mut frame, definition.id, payload_len, definition.crc_extra, version)?;
        let (bytes, len) = (PyBytes::new(py, &frame).into_any(), frame.len());
        Ok(Packed { bytes, len, count: 1, last: sending.seq() })
    })?;
    Ok(true)
}
