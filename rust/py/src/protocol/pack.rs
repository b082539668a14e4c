//! Message objects to frames.

use mavwire_core::frame::FrameBuffer;
use mavwire_schema::WireVersion;
use pyo3::exceptions::PyNotImplementedError;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};
use pyo3::{Borrowed, ffi};

use crate::dialect::registry::Dialect;
use crate::message::encode;
use crate::message::info::Info;
use crate::message::meta;
use crate::message::object::{Message, flags};
use crate::protocol::mavlink::MAVLink;
use crate::protocol::sender::{Sender, byte};
use crate::protocol::signing::Signing;
use crate::python::calling::{Calling, truth};
use crate::python::instance_dict::instance_dict;
use crate::python::lists;
use crate::python::raw_function;
use crate::python::raw_function::Arguments;

/// The sender that `mav` describes, which may be any object with these attributes.
fn sender_of<'py>(mav: &Bound<'py, PyAny>) -> PyResult<Sender<'py>> {
    if let Ok(native) = mav.cast::<MAVLink>() {
        return native.get().sender(mav.py());
    }
    let py = mav.py();
    let signing = mav.getattr(intern!(py, "signing"))?;
    let sign = signing.getattr(intern!(py, "sign_outgoing"))?.is_truthy()?;
    Ok(Sender {
        seq: byte(&mav.getattr(intern!(py, "seq"))?)?,
        sysid: byte(&mav.getattr(intern!(py, "srcSystem"))?)?,
        compid: byte(&mav.getattr(intern!(py, "srcComponent"))?)?,
        signing: if sign { Some(signing.cast_into::<Signing>()?) } else { None },
    })
}

/// Whether `message.pack` is mavwire's own method.
pub(crate) fn is_own(message: &Bound<'_, Message>) -> PyResult<bool> {
    let (py, name) = (message.py(), intern!(message.py(), "pack"));
    let own = py.get_type::<Message>().getattr(name)?;
    let is_replaced = message.get().has(flags::DICT) && instance_dict(message)?.contains(name)?;
    Ok(!is_replaced && message.get_type().getattr(name)?.is(&own))
}

#[pymethods]
impl Message {
    /// The frame as bytes, with source and sequence number taken from `mav`, which is not advanced.
    #[pyo3(signature = (mav, force_mavlink1 = false))]
    pub(crate) fn pack<'py>(
        slf: &Bound<'py, Self>,
        mav: &Bound<'py, PyAny>,
        #[pyo3(from_py_with = truth)] force_mavlink1: bool,
    ) -> PyResult<Bound<'py, PyBytes>> {
        let Some(info) = slf.get().info else {
            let text = "MAVLink_message cannot be serialized directly";
            return Err(PyNotImplementedError::new_err(text));
        };
        let mut frame = FrameBuffer::default();
        put_payload(slf, info, frame.payload_mut())?;
        let definition = &info.definition;
        let len = |version| encode::payload_len(definition, version);
        finish(slf, mav, frame, (len, definition.crc_extra), force_mavlink1)
    }

    /// Frames a ready payload: `_pack(mav, crc_extra, payload, force_mavlink1=False) -> bytes`.
    #[pyo3(signature = (mav, crc_extra, payload, force_mavlink1 = false))]
    fn _pack<'py>(
        slf: &Bound<'py, Self>,
        mav: &Bound<'py, PyAny>,
        crc_extra: u8,
        payload: &[u8],
        #[pyo3(from_py_with = truth)] force_mavlink1: bool,
    ) -> PyResult<Bound<'py, PyBytes>> {
        let mut frame = FrameBuffer::default();
        put_bytes(frame.payload_mut(), payload);
        finish(slf, mav, frame, (|_| payload.len(), crc_extra), force_mavlink1)
    }

    /// Appends a signature to the packed frame and advances the signing timestamp.
    fn sign_packet(slf: &Bound<'_, Self>, mav: &Bound<'_, PyAny>) -> PyResult<()> {
        let py = slf.py();
        let signing = mav.getattr(intern!(py, "signing"))?.cast_into::<Signing>()?;
        let buffer = slf.getattr(intern!(py, "_msgbuf"))?;
        let block = signing.get().sign(&lists::bytes(&buffer)?)?;
        buffer.invoke_method1(intern!(py, "extend"), (PyBytes::new(py, &block),))?;
        Ok(())
    }
}

/// Makes the frame of the payload that is in it, whose length may depend on the version.
fn finish<'py>(
    message: &Bound<'py, Message>,
    mav: &Bound<'py, PyAny>,
    mut frame: FrameBuffer,
    (len, crc_extra): (impl FnOnce(WireVersion) -> usize, u8),
    force_mavlink1: bool,
) -> PyResult<Bound<'py, PyBytes>> {
    let py = message.py();
    let msgid = match &message.get().info {
        Some(info) if !message.get().has(flags::META) => info.definition.id,
        _ => message.getattr(intern!(py, "_header"))?.getattr(intern!(py, "msgId"))?.extract()?,
    };
    let version = dialect_of(message, msgid, mav)?.get().version(py, force_mavlink1)?;
    sender_of(mav)?.frame(&mut frame, msgid, len(version), crc_extra, version)?;
    let packed = PyBytes::new(py, &frame);
    meta::set_packed(message, &packed)?;
    Ok(packed)
}

/// The dialect of a message's class. It is nearly always that of `mav`.
fn dialect_of<'py>(
    message: &Bound<'py, Message>,
    msgid: u32,
    mav: &Bound<'py, PyAny>,
) -> PyResult<Bound<'py, Dialect>> {
    let (py, class) = (message.py(), message.get_type());
    if let Ok(native) = mav.cast::<MAVLink>()
        && let dialect = native.get().dialect.bind(py)
        && dialect.get().made(&class, msgid)
    {
        return Ok(dialect.clone());
    }
    Ok(class.getattr(intern!(py, "_dialect"))?.cast_into()?)
}

/// Copies as many bytes as there is room for.
fn put_bytes(payload: &mut [u8], bytes: &[u8]) {
    let len = bytes.len().min(payload.len());
    payload[..len].copy_from_slice(&bytes[..len]);
}

/// Writes the payload at full length: straight from the frame where no field was changed.
fn put_payload(message: &Bound<'_, Message>, info: &Info, payload: &mut [u8]) -> PyResult<()> {
    let this = message.get();
    if this.is_pristine() && !info.has_char_scalar {
        put_bytes(payload, this.decoded_payload());
        return Ok(());
    }
    let py = message.py();
    let written = instance_dict(message)?;
    if put_in_order(info, &written, payload).is_some() {
        return Ok(());
    }
    let attribute = |i: usize| {
        let name = info.names[i].stored().bind(py);
        match written.get_item(name) {
            Ok(Some(value)) => Ok(value),
            _ => message.getattr(name),
        }
    };
    let packed = encode::encode_by_struct(message, info, attribute)?;
    put_bytes(payload, packed.as_bytes());
    Ok(())
}

/// Encodes the fields as they stand in the instance dictionary, if they are all there in the order in which [`build`]
/// puts them: walking over it is much quicker than looking up each. `None` if not, or if `struct` has to judge a value.
fn put_in_order(info: &Info, written: &Bound<'_, PyDict>, payload: &mut [u8]) -> Option<()> {
    let mut position = 0;
    let mut next = || {
        let (mut key, mut value) = (std::ptr::null_mut(), std::ptr::null_mut());
        // SAFETY: the dictionary is alive; key and value are borrowed from it and used before anything can change it,
        // because encoding a value runs no Python code.
        unsafe {
            (ffi::PyDict_Next(written.as_ptr(), &raw mut position, &raw mut key, &raw mut value)
                != 0)
                .then(|| (key, Borrowed::from_ptr(written.py(), value)))
        }
    };
    for (names, &place) in info.names.iter().zip(&info.places) {
        let (key, value) = next()?;
        if key != names.stored().as_ptr() {
            return None;
        }
        encode::put(payload, place, value)?;
        if names.raw.is_some() {
            next()?;
        }
    }
    Some(())
}

/// `build(message, *values)`: stores what a message is made from, in XML order, as its constructor got it.
pub(crate) unsafe extern "C" fn build(
    _module: *mut ffi::PyObject,
    arguments: *mut *mut ffi::PyObject,
    count: ffi::Py_ssize_t,
) -> *mut ffi::PyObject {
    // SAFETY: the arguments are this function's own.
    unsafe {
        raw_function::call(arguments, count, |_, arguments| {
            store(&*arguments.require(0)?.cast::<Message>()?, &arguments.from(1))
        })
    }
}

fn store(message: &Bound<'_, Message>, values: &Arguments<'_, '_>) -> PyResult<()> {
    let py = message.py();
    let Some(info) = message.get().info else { return Ok(()) };
    let written = instance_dict(message)?;
    for (names, value) in info.names.iter().zip(values.iter()) {
        if let Some(raw) = &names.raw {
            written.set_item(raw.bind(py), value)?;
            written.set_item(names.name.bind(py), text_of(&value)?)?;
        } else {
            written.set_item(names.name.bind(py), value)?;
        }
    }
    Message::written(message, flags::DICT | flags::FIELDS);
    Ok(())
}

/// The text of a `char[n]` argument: up to the first NUL, ASCII, other bytes replaced.
fn text_of<'py>(value: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
    let py = value.py();
    if let Ok(bytes) = value.cast_exact::<PyBytes>() {
        return Ok(crate::message::values::text(py, bytes.as_bytes()).into_any());
    }
    let head =
        value.invoke_method1(intern!(py, "split"), (PyBytes::new(py, b"\0"), 1))?.get_item(0)?;
    let kwargs = PyDict::new(py);
    kwargs.set_item(intern!(py, "errors"), intern!(py, "replace"))?;
    head.invoke_method(intern!(py, "decode"), (intern!(py, "ascii"),), Some(&kwargs))
}
