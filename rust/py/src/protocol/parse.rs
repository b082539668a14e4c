//! Receiving: bytes to message objects, with pymavlink's counters, exceptions and BAD_DATA messages.

use std::sync::atomic::Ordering::Relaxed;

use mavwire_core::frame::{FrameError, FrameRef, IFLAG_SIGNED, STX_V2};
use mavwire_core::parser::Step;
use mavwire_core::registry::Entry;
use pyo3::exceptions::{PyIndexError, PyRuntimeError};
use pyo3::prelude::*;
use pyo3::types::{PyByteArray, PyBytes, PyList, PyString};

use crate::message::create::reused_frame;
use crate::message::descriptors::no_attribute;
use crate::message::meta::BAD_PREFIX;
use crate::message::object::{Message, flags};
use crate::protocol::acceptance::Acceptance;
use crate::protocol::mavlink::{MAVLink, overridden};
use crate::protocol::signing::Signing;
use crate::python::calling::Calling;
use crate::python::error::Error;
use crate::python::instance_dict::instance_dict;
use crate::python::lists::bytes_like;
use crate::sync::shared;
use mavwire_core::frame::FrameBytes;

/// Takes the input; true if a message may be complete now.
fn feed(mav: &Bound<'_, MAVLink>, data: &Bound<'_, PyAny>) -> PyResult<bool> {
    let converted;
    let bytes = if let Ok(bytes) = data.cast_exact::<PyBytes>() {
        bytes.as_bytes()
    } else {
        converted = bytes_like(data)?;
        converted.cast::<PyBytes>()?.as_bytes()
    };
    let this = mav.get();
    let mut parser = this.parser();
    // A program may hand over more than there is memory for twice.
    let is_enough = parser.try_push(bytes).map_err(Error::from)?;
    shared::add(&this.counters.bytes_received, bytes.len() as u64);
    drop(parser);
    if is_enough {
        obey_ignore_checksum(mav)?;
    }
    Ok(is_enough)
}

/// Takes over what the module says about checksums, which user code may change at any time.
pub(crate) fn obey_ignore_checksum(mav: &Bound<'_, MAVLink>) -> PyResult<()> {
    let py = mav.py();
    let namespace = mav.get().dialect.get().namespace(py)?;
    let ignore = match namespace.get_item(intern!(py, "MAVLINK_IGNORE_CRC"))? {
        Some(ignore) => ignore.is_truthy()?,
        None => {
            return Err(PyRuntimeError::new_err("the dialect module lost its MAVLINK_IGNORE_CRC"));
        }
    };
    mav.get().parser().scanner.ignore_checksum = ignore;
    Ok(())
}

/// One call of `parse_char` or `parse_buffer`: what is read once for all messages of the call.
pub(crate) struct Session<'a, 'py> {
    mav: &'a Bound<'py, MAVLink>,
    signing: Option<Bound<'py, Signing>>,
    robust: bool,
}

#[pymethods]
impl MAVLink {
    /// Takes bytes and returns one message, or None. Bytes behind the message wait for the next call.
    fn parse_char<'py>(
        slf: &Bound<'py, Self>,
        c: &Bound<'py, PyAny>,
    ) -> PyResult<Option<Bound<'py, Message>>> {
        if !feed(slf, c)? {
            return Ok(None);
        }
        let message = Session::new(slf).next();
        slf.get().parser().tidy();
        message
    }

    /// Parses bytes. Returns all messages that end in them as a list, None without a message.
    fn parse_buffer<'py>(
        slf: &Bound<'py, Self>,
        s: &Bound<'py, PyAny>,
    ) -> PyResult<Option<Bound<'py, PyList>>> {
        let py = slf.py();
        if slf.get().is_overridden(overridden::RECEIVE) {
            let messages = PyList::empty(py);
            let empty = PyBytes::new(py, b"");
            let mut message = slf.invoke_method1(intern!(py, "parse_char"), (s,))?;
            while !message.is_none() {
                messages.append(&message)?;
                message = slf.invoke_method1(intern!(py, "parse_char"), (&empty,))?;
            }
            return Ok((!messages.is_empty()).then_some(messages));
        }
        if !feed(slf, s)? {
            return Ok(None);
        }
        let mut messages = Vec::new();
        let outcome = Session::new(slf).take_all(&mut messages);
        slf.get().parser().tidy();
        outcome?;
        if messages.is_empty() { Ok(None) } else { PyList::new(py, messages).map(Some) }
    }

    /// Decodes one complete frame, which must be a bytearray; `MAVError` says what is wrong with it.
    fn decode<'py>(
        slf: &Bound<'py, Self>,
        msgbuf: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, Message>> {
        let py = slf.py();
        let Ok(buffer) = msgbuf.cast::<PyByteArray>() else {
            return Err(no_attribute(msgbuf, "append"));
        };
        let bytes = buffer.to_vec();
        let entry = check_frame(slf, &bytes)?;
        let session = Session { robust: false, ..Session::new(slf) };
        let message = session.accepted(FrameBytes::from(bytes.as_slice()), entry)?;
        // The message shows the very object it was decoded from.
        instance_dict(&message)?.set_item(intern!(py, "_msgbuf"), msgbuf)?;
        Message::written(&message, flags::DICT | flags::META);
        Ok(message)
    }
}

impl<'a, 'py> Session<'a, 'py> {
    pub(crate) fn new(mav: &'a Bound<'py, MAVLink>) -> Self {
        let this = mav.get();
        Self { mav, signing: this.signing(mav.py()), robust: this.robust_parsing.load(Relaxed) }
    }

    /// Appends all messages in what was fed.
    fn take_all(&self, messages: &mut Vec<Bound<'py, Message>>) -> PyResult<()> {
        loop {
            self.take_plain(messages)?;
            let Some(message) = self.next()? else { return Ok(()) };
            messages.push(message);
        }
    }

    /// The next message in what was fed.
    #[inline]
    fn next(&self) -> PyResult<Option<Bound<'py, Message>>> {
        let this = self.mav.get();
        let step = this.parser().step(&this.dialect.get().registry, self.robust);
        self.take_step(step)
    }

    /// Appends the good frames of known messages at the front, where neither a signature nor code of the program decides
    /// about them.
    fn take_plain(&self, messages: &mut Vec<Bound<'py, Message>>) -> PyResult<()> {
        let (py, this) = (self.mav.py(), self.mav.get());
        if this.shows_messages() || this.checks_signatures(py) {
            return Ok(());
        }
        let dialect = this.dialect.get();
        let mut parser = this.parser();
        while let Some((index, len, stream)) = parser.take_good(&dialect.registry) {
            if matches!(stream, [STX_V2, _, flags, ..] if flags & IFLAG_SIGNED != 0) {
                this.note_signed(py);
            }
            let reused = dialect.known_class(index).and_then(|known| {
                reused_frame(known.class.bind(py), known.info, stream, len, |message| message)
            });
            if let Some(message) = reused {
                messages.push(message);
                shared::add(&this.counters.packets_received, 1);
                continue;
            }
            let frame = FrameBytes::from(&stream[..len]);
            drop(parser); // a new object may run code of the program
            messages.push(dialect.message(py, Some(index), frame, |message| message)?);
            shared::add(&this.counters.packets_received, 1);
            if this.shows_messages() {
                return Ok(());
            }
            parser = this.parser();
        }
        Ok(())
    }

    /// The message of a step of the parser, with counter and callback.
    pub(crate) fn take_step(&self, step: Step) -> PyResult<Option<Bound<'py, Message>>> {
        let this = self.mav.get();
        let message = match step {
            Step::Frame { bytes, entry, .. } => self.received(bytes, entry)?,
            Step::Nothing | Step::BadPrefix(None) => return Ok(None),
            Step::BadPrefix(Some(byte)) => {
                this.counters.receive_errors.fetch_add(1, Relaxed);
                return Err(mav_error(self.mav, FrameError::BadPrefix(byte)));
            }
            Step::Bad { error: Some(error), .. } if !self.robust => {
                return Err(mav_error(self.mav, error));
            }
            Step::Bad { bytes, error } => bad_data(self.mav, bytes, error)?,
        };
        shared::add(&this.counters.packets_received, 1);
        this.callback.call(self.mav, message.as_any())?;
        Ok(Some(message))
    }

    /// A frame with a good checksum (or an unknown id) to a message object, if signing lets it pass.
    pub(crate) fn received(
        &self,
        bytes: FrameBytes,
        entry: Option<Entry>,
    ) -> PyResult<Bound<'py, Message>> {
        if self.mav.get().is_overridden(overridden::RECEIVE) {
            return decode_by_method(self.mav, &bytes, self.robust);
        }
        self.accepted(bytes, entry)
    }

    fn accepted(&self, bytes: FrameBytes, entry: Option<Entry>) -> PyResult<Bound<'py, Message>> {
        let acceptance = match &self.signing {
            Some(signing) => signing.get().accept(self.mav, &bytes, entry.is_some())?,
            None => Acceptance::Unchecked,
        };
        if acceptance == Acceptance::Rejected {
            return self.rejected(&bytes);
        }
        let (py, dialect) = (self.mav.py(), self.mav.get().dialect.get());
        let message =
            dialect.message(py, entry.map(|entry| entry.index), bytes, |message| message)?;
        if acceptance == Acceptance::Verified {
            message.get().set(flags::SIGNED);
        }
        Ok(message)
    }

    /// The outcome for a frame that signing does not let pass.
    fn rejected(&self, bytes: &[u8]) -> PyResult<Bound<'py, Message>> {
        let error = FrameError::InvalidSignature;
        if self.robust {
            bad_data(self.mav, FrameBytes::from(bytes), Some(error))
        } else {
            Err(mav_error(self.mav, error))
        }
    }
}

/// A subclass has its own `decode`, which gets the frame and whose `MAVError` becomes BAD_DATA.
fn decode_by_method<'py>(
    mav: &Bound<'py, MAVLink>,
    bytes: &[u8],
    robust: bool,
) -> PyResult<Bound<'py, Message>> {
    let py = mav.py();
    let frame = PyByteArray::new(py, bytes);
    match mav.invoke_method1(intern!(py, "decode"), (frame,)) {
        Ok(message) => Ok(message.cast_into::<Message>()?),
        Err(error)
            if robust
                && error.is_instance(py, &mav.get().dialect.get().global(py, "MAVError")?) =>
        {
            mav.get().counters.receive_errors.fetch_add(1, Relaxed);
            let reason = error.value(py).getattr(intern!(py, "message"))?;
            let class = mav.get().dialect.get().global(py, "MAVLink_bad_data")?;
            Ok(class.invoke1((PyByteArray::new(py, bytes), reason))?.cast_into::<Message>()?)
        }
        Err(error) => Err(error),
    }
}

fn bad_data<'py>(
    mav: &Bound<'py, MAVLink>,
    bytes: FrameBytes,
    error: Option<FrameError>,
) -> PyResult<Bound<'py, Message>> {
    let this = mav.get();
    this.counters.receive_errors.fetch_add(1, Relaxed);
    let py = mav.py();
    let reason = error.map(|error| PyString::new(py, &error.to_string()));
    let message = Message::bad(bytes, reason.as_ref());
    this.dialect.get().special(py, "MAVLink_bad_data", message, |message| {
        let reason = reason.unwrap_or_else(|| PyString::new(py, BAD_PREFIX));
        (PyByteArray::new(py, &message.frame), reason).into_pyobject(py)
    })
}

fn mav_error(mav: &Bound<'_, MAVLink>, error: FrameError) -> PyErr {
    let class = mav.get().dialect.get().global(mav.py(), "MAVError");
    match class.and_then(|class| class.invoke1((error.to_string(),))) {
        Ok(error) => PyErr::from_value(error),
        Err(error) => error,
    }
}

/// The registry's entry for a complete frame, whose checksum is right then; `None` for an unknown id.
fn check_frame(mav: &Bound<'_, MAVLink>, bytes: &[u8]) -> PyResult<Option<Entry>> {
    if bytes.is_empty() {
        return Err(PyIndexError::new_err("bytearray index out of range"));
    }
    let fail = |error| mav_error(mav, error);
    let frame = FrameRef::parse(bytes).map_err(fail)?;
    let dialect = mav.get().dialect.get();
    let msgid = frame.header().msgid;
    let Some(entry) = dialect.registry.lookup(msgid) else { return Ok(None) };
    let (received, calculated) = (frame.checksum(), frame.calculated_checksum(entry.crc_extra));
    if calculated != received && !dialect.global(mav.py(), "MAVLINK_IGNORE_CRC")?.is_truthy()? {
        return Err(fail(FrameError::BadChecksum { msgid, received, calculated }));
    }
    Ok(Some(entry))
}
