//! Message objects to frames.

use mavwire_core::frame::FrameBuffer;
use mavwire_schema::WireVersion;
use pyo3::exceptions::PyNotImplementedError;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};
use pyo3::{Borrowed, ffi};

use crate::dialect::registry::Dialect;
use crate::message::encode::{self, Payload};
use crate::message::info::Info;
use crate::message::meta;
use crate::message::object::{Message, flags, instance_dict};
use crate::protocol::mavlink::MAVLink;
use crate::protocol::sender::{Sender, byte};
use crate::protocol::signing::Signing;
use crate::python::calling::Calling;
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

/// `message.pack(mav, force_mavlink1)`
pub(crate) fn pack_message<'py>(
    message: &Bound<'py, Message>,
    mav: &Bound<'py, PyAny>,
    force_mavlink1: bool,
) -> PyResult<Bound<'py, PyAny>> {
    let Some(info) = message.get().info else {
        let text = "MAVLink_message cannot be serialized directly";
        return Err(PyNotImplementedError::new_err(text));
    };
    let payload = payload(message, info)?;
    let sent = |version| payload.sent(&info.definition, version);
    pack_payload(message, mav, info.definition.crc_extra, sent, force_mavlink1)
}

/// The same with a ready payload, which may depend on the version.
pub(crate) fn pack_payload<'a, 'py>(
    message: &Bound<'py, Message>,
    mav: &Bound<'py, PyAny>,
    crc_extra: u8,
    payload: impl FnOnce(WireVersion) -> &'a [u8],
    force_mavlink1: bool,
) -> PyResult<Bound<'py, PyAny>> {
    let py = message.py();
    let msgid = match &message.get().info {
        Some(info) if !message.get().has(flags::META) => info.definition.id,
        _ => message.getattr(intern!(py, "_header"))?.getattr(intern!(py, "msgId"))?.extract()?,
    };
    let dialect = message.getattr(intern!(py, "_dialect"))?.cast_into::<Dialect>()?;
    let version = dialect.get().version(py, force_mavlink1)?;
    let mut frame = FrameBuffer::default();
    sender_of(mav)?.frame(&mut frame, msgid, payload(version), crc_extra, version)?;
    let packed = PyBytes::new(py, &frame);
    meta::set_packed(message, &packed)?;
    Ok(packed.into_any())
}

/// The payload at full length: straight from the frame where no field was changed.
fn payload(message: &Bound<'_, Message>, info: &Info) -> PyResult<Payload> {
    let this = message.get();
    if this.is_pristine() && !info.has_char_scalar {
        return Ok(Payload::extended(&info.definition, this.decoded_payload()));
    }
    let py = message.py();
    let written = instance_dict(message)?;
    let mut payload = Payload::zeroed(&info.definition);
    if put_in_order(info, &written, &mut payload).is_some() {
        return Ok(payload);
    }
    let attribute = |i: usize| {
        let name = info.names[i].stored().bind(py);
        match written.get_item(name) {
            Ok(Some(value)) => Ok(value),
            _ => message.getattr(name),
        }
    };
    encode::encode_by_struct(message, info, attribute)
}

/// Encodes the fields as they stand in the instance dictionary, if they are all there in the order in which [`build`]
/// puts them: walking over it is much quicker than looking up each. `None` if not, or if `struct` has to judge a value.
fn put_in_order(info: &Info, written: &Bound<'_, PyDict>, payload: &mut Payload) -> Option<()> {
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
        payload.put(place, value)?;
        if names.raw.is_some() {
            next()?;
        }
    }
    Some(())
}

/// `message.sign_packet(mav)`: appends a signature to the packed frame.
pub(crate) fn sign_packet(message: &Bound<'_, Message>, mav: &Bound<'_, PyAny>) -> PyResult<()> {
    let py = message.py();
    let signing = mav.getattr(intern!(py, "signing"))?.cast_into::<Signing>()?;
    let buffer = message.getattr(intern!(py, "_msgbuf"))?;
    let block = signing.get().sign(&lists::bytes(&buffer)?)?;
    buffer.invoke_method1(intern!(py, "extend"), (PyBytes::new(py, &block),))?;
    Ok(())
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
