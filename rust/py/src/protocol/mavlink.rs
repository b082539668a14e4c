//! `MAVLink`: one link's protocol state, sending and receiving. The Python class of each dialect derives from it.

use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, AtomicI64, AtomicU8, AtomicU64, Ordering::Relaxed};

use mavwire_core::scan::Resync;
use pyo3::exceptions::{PyRuntimeWarning, PyValueError};
use pyo3::gc::{PyTraverseError, PyVisit};
use pyo3::prelude::*;
use pyo3::types::{PyByteArray, PyBytes, PyDict, PyList, PyString, PyTuple, PyType};

use crate::dialect::registry::Dialect;
use crate::message::object::Message;
use crate::protocol::pack::{Sender, header_byte};
use crate::protocol::parse::{self, Parser};
use crate::protocol::peer_check;
use crate::protocol::send;
use crate::protocol::sending::Sending;
use crate::protocol::signing::Signing;
use crate::python::calling::{Calling, truth};
use crate::python::lists::{bytes, collected};
use crate::sync::lock::{Guard, Lock};
use crate::sync::slot::Slot;

/// A callback with the arguments it was registered with.
pub(crate) struct Callback {
    /// Whether there is one, so that its absence costs nothing.
    is_set: AtomicBool,
    function: Slot,
    args: Slot,
    kwargs: Slot,
}

impl Callback {
    const fn new() -> Self {
        Self {
            is_set: AtomicBool::new(false),
            function: Slot::new(),
            args: Slot::new(),
            kwargs: Slot::new(),
        }
    }

    fn set(
        &self,
        function: Py<PyAny>,
        args: &Bound<'_, PyTuple>,
        kwargs: Option<&Bound<'_, PyDict>>,
    ) {
        let py = args.py();
        self.args.set(Some(args.clone().into_any().unbind()));
        self.kwargs.set(Some(match kwargs {
            Some(kwargs) => kwargs.clone().into_any().unbind(),
            None => PyDict::new(py).into_any().unbind(),
        }));
        self.set_function((!function.is_none(py)).then_some(function));
    }

    fn set_function(&self, function: Option<Py<PyAny>>) {
        self.is_set.store(function.is_some(), Relaxed);
        self.function.set(function);
    }

    pub(crate) fn is_set(&self) -> bool {
        self.is_set.load(Relaxed)
    }

    /// Calls `function(message, *args, **kwargs)` if one is registered.
    pub(crate) fn call(&self, message: &Bound<'_, PyAny>) -> PyResult<()> {
        if !self.is_set() {
            return Ok(());
        }
        let py = message.py();
        let Some(function) = self.function.get(py) else { return Ok(()) };
        let mut arguments = vec![message.clone()];
        if let Some(extra) = self.args.get(py) {
            arguments.extend(collected(extra.items()?)?);
        }
        let kwargs = self.kwargs.get(py).and_then(|kwargs| kwargs.cast_into::<PyDict>().ok());
        function.invoke(PyTuple::new(py, arguments)?, kwargs.as_ref())?;
        Ok(())
    }

    fn traverse(&self, visit: PyVisit<'_>) -> Result<(), PyTraverseError> {
        self.function.traverse(visit)?;
        self.args.traverse(visit)?;
        self.kwargs.traverse(visit)
    }
}

/// Counters of what was received, that users read and reset.
#[derive(Default)]
pub(crate) struct Counters {
    pub(crate) packets_received: AtomicU64,
    pub(crate) bytes_received: AtomicU64,
    pub(crate) receive_errors: AtomicU64,
}

/// Protocol state of one link.
#[pyclass(frozen, subclass, module = "mavwire._native")]
pub(crate) struct MAVLink {
    pub(crate) dialect: Py<Dialect>,
    own_sending: Sending,
    /// The one whose sequence numbers and counters go on here.
    predecessor: OnceLock<Py<Self>>,
    src_system: AtomicI64,
    src_component: AtomicI64,
    pub(crate) robust_parsing: AtomicBool,
    pub(crate) counters: Counters,
    parser: Lock<Parser>,
    pub(crate) file: Slot,
    pub(crate) callback: Callback,
    pub(crate) send_callback: Callback,
    /// Bits of [`overridden`]: what a subclass or an instance attribute replaces.
    overridden: AtomicU8,
}

/// Methods that the fast paths must not go around.
pub(crate) mod overridden {
    pub(crate) const SEND: u8 = 1;
    pub(crate) const RECEIVE: u8 = 2;
    pub(crate) const ENCODE: u8 = 4;
    /// What links call for received bytes is not the native one, so that the bytes have to be shown to it.
    pub(crate) const PARSER: u8 = 8;
    /// The program has its own method to check signatures.
    pub(crate) const SIGNATURE: u8 = 16;

    /// Methods of the native class whose replacement matters.
    pub(super) const METHODS: [&str; 5] =
        ["send", "decode", "parse_char", "bytes_needed", "check_signature"];

    /// A method of pymavlink's parser that this parser never calls.
    pub(super) const NOT_CALLED: &str = "buf_len";

    pub(super) fn by_name(name: &str) -> u8 {
        match name {
            "send" => SEND,
            "parse_char" => RECEIVE | PARSER,
            "bytes_needed" => PARSER,
            "decode" => RECEIVE,
            "check_signature" => RECEIVE | SIGNATURE,
            _ if name.ends_with("_encode") => ENCODE,
            _ => 0,
        }
    }
}

impl MAVLink {
    #[inline]
    pub(crate) fn parser(&self) -> Guard<'_, Parser> {
        // SAFETY: links are Python objects, whose methods run attached.
        self.parser.lock(unsafe { Python::assume_attached() })
    }

    /// What frames are sent with, be it by this object or by one that it took the place of, which threads may still use.
    #[inline]
    pub(crate) fn sending(&self) -> &Sending {
        match self.predecessor.get() {
            Some(predecessor) => &predecessor.get().own_sending,
            None => &self.own_sending,
        }
    }

    /// Forgets the bytes of a frame whose rest will not come: as if they had never been received.
    pub(crate) fn drop_unread(&self, parser: &mut Parser) {
        if !parser.unread().is_empty() {
            let dropped = parser.clear() as u64;
            // The user may have set it back in the meantime.
            let received = &self.counters.bytes_received;
            received.store(received.load(Relaxed).saturating_sub(dropped), Relaxed);
        }
    }

    pub(crate) fn is_overridden(&self, bits: u8) -> bool {
        self.overridden.load(Relaxed) & bits != 0
    }

    pub(crate) fn signing<'py>(&self, py: Python<'py>) -> Option<Bound<'py, Signing>> {
        self.parser().signing.as_ref().map(|signing| signing.bind(py).clone())
    }

    /// Somebody wants to see each message: a callback, or a subclass's own `decode`.
    pub(crate) fn shows_messages(&self) -> bool {
        self.callback.is_set() || self.is_overridden(overridden::RECEIVE)
    }

    pub(crate) fn sender<'py>(&self, py: Python<'py>) -> PyResult<Sender<'py>> {
        Ok(Sender {
            seq: header_byte(py, self.sending().seq.load(Relaxed))?,
            sysid: header_byte(py, self.src_system.load(Relaxed))?,
            compid: header_byte(py, self.src_component.load(Relaxed))?,
            signing: self.signing(py).filter(|signing| signing.get().signs_outgoing()),
        })
    }
}

fn warn_not_called(py: Python<'_>) -> PyResult<()> {
    let text = c"MAVLink.buf_len was replaced, and mavwire does not call it: the parser counts its bytes itself. \
        Replace parse_char to see what is received";
    PyErr::warn(py, &py.get_type::<PyRuntimeWarning>(), text, 1)
}

macro_rules! counter {
    ($self:ident, $name:ident, $value:ident) => {
        $self.counters.$name.store($value, Relaxed)
    };
}

#[pymethods]
impl MAVLink {
    #[new]
    #[classmethod]
    #[pyo3(signature = (*_args, **_kwargs))]
    fn new(
        cls: &Bound<'_, PyType>,
        _args: &Bound<'_, PyTuple>,
        _kwargs: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Self> {
        let py = cls.py();
        let dialect = cls.attribute(intern!(py, "_dialect"))?.cast_into::<Dialect>()?.unbind();
        let native = py.get_type::<Self>();
        let mut replaced = 0;
        for name in overridden::METHODS {
            if !cls.attribute(name)?.is(&native.attribute(name)?) {
                replaced |= overridden::by_name(name);
            }
        }
        let buf_len = intern!(py, "buf_len");
        if !cls.attribute(buf_len)?.is(&native.attribute(buf_len)?) {
            warn_not_called(py)?;
        }
        if !cls.attribute(intern!(py, "_mavlink_base"))?.is(cls) {
            replaced |= overridden::ENCODE;
        }
        Ok(Self {
            dialect,
            own_sending: Sending::new(),
            predecessor: OnceLock::new(),
            src_system: AtomicI64::new(0),
            src_component: AtomicI64::new(0),
            robust_parsing: AtomicBool::new(false),
            counters: Counters::default(),
            parser: Lock::new(Parser::new()),
            file: Slot::new(),
            callback: Callback::new(),
            send_callback: Callback::new(),
            overridden: AtomicU8::new(replaced),
        })
    }

    fn __setattr__(
        slf: &Bound<'_, Self>,
        name: &Bound<'_, PyString>,
        value: &Bound<'_, PyAny>,
    ) -> PyResult<()> {
        let name_text = name.to_str()?;
        slf.get().overridden.fetch_or(overridden::by_name(name_text), Relaxed);
        if name_text == overridden::NOT_CALLED {
            warn_not_called(slf.py())?;
        }
        slf.set_generic_attribute(name, Some(value))
    }

    fn __delattr__(slf: &Bound<'_, Self>, name: &Bound<'_, PyString>) -> PyResult<()> {
        slf.set_generic_attribute(name, None)
    }

    /// Sequence number of the next frame, 0 to 255.
    #[getter]
    fn seq(&self) -> i64 {
        self.sending().seq.load(Relaxed)
    }
    #[setter(seq)]
    fn set_seq(&self, value: i64) {
        self.sending().seq.store(value, Relaxed);
    }

    /// System id that frames are sent with.
    #[getter(srcSystem)]
    fn src_system(&self) -> i64 {
        self.src_system.load(Relaxed)
    }
    #[setter(srcSystem)]
    fn set_src_system(&self, value: i64) {
        self.src_system.store(value, Relaxed);
    }

    /// Component id that frames are sent with.
    #[getter(srcComponent)]
    fn src_component(&self) -> i64 {
        self.src_component.load(Relaxed)
    }
    #[setter(srcComponent)]
    fn set_src_component(&self, value: i64) {
        self.src_component.store(value, Relaxed);
    }

    /// Bad input gives BAD_DATA messages instead of exceptions.
    #[getter]
    fn robust_parsing(&self) -> bool {
        self.robust_parsing.load(Relaxed)
    }
    #[setter]
    fn set_robust_parsing(&self, #[pyo3(from_py_with = truth)] value: bool) {
        self.robust_parsing.store(value, Relaxed);
    }

    /// What to do after a damaged frame: "skip" drops its whole claimed length, "rescan" looks for frames inside it.
    #[getter]
    fn resync(&self) -> &'static str {
        match self.parser().resync() {
            Resync::Skip => "skip",
            Resync::Rescan => "rescan",
        }
    }
    #[setter(resync)]
    fn set_resync(&self, value: &str) -> PyResult<()> {
        let resync = match value {
            "skip" => Resync::Skip,
            "rescan" => Resync::Rescan,
            _ => {
                return Err(PyValueError::new_err(format!(
                    "resync must be \"skip\" or \"rescan\", not {value:?}"
                )));
            }
        };
        self.parser().set_resync(resync);
        Ok(())
    }

    /// What frames are written to: any object with `write(bytes)`.
    #[getter]
    fn file<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyAny>> {
        self.file.get(py)
    }
    #[setter(file)]
    fn set_file(&self, value: Option<Py<PyAny>>) {
        self.file.set(value);
    }

    /// Signing state.
    #[getter(signing)]
    fn get_signing<'py>(&self, py: Python<'py>) -> Option<Bound<'py, Signing>> {
        self.parser().signing.as_ref().map(|signing| signing.bind(py).clone())
    }
    #[setter(signing)]
    fn set_signing(&self, value: Py<Signing>) {
        let old = self.parser().signing.replace(value);
        drop(old);
    }

    #[getter]
    fn callback<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyAny>> {
        self.callback.function.get(py)
    }
    #[setter(callback)]
    fn put_callback(&self, value: Option<Py<PyAny>>) {
        self.callback.set_function(value);
    }
    #[getter]
    fn callback_args<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyAny>> {
        self.callback.args.get(py)
    }
    #[setter]
    fn set_callback_args(&self, value: Option<Py<PyAny>>) {
        self.callback.args.set(value);
    }
    #[getter]
    fn callback_kwargs<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyAny>> {
        self.callback.kwargs.get(py)
    }
    #[setter]
    fn set_callback_kwargs(&self, value: Option<Py<PyAny>>) {
        self.callback.kwargs.set(value);
    }
    #[getter]
    fn send_callback<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyAny>> {
        self.send_callback.function.get(py)
    }
    #[setter(send_callback)]
    fn put_send_callback(&self, value: Option<Py<PyAny>>) {
        self.send_callback.set_function(value);
    }
    #[getter]
    fn send_callback_args<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyAny>> {
        self.send_callback.args.get(py)
    }
    #[setter]
    fn set_send_callback_args(&self, value: Option<Py<PyAny>>) {
        self.send_callback.args.set(value);
    }
    #[getter]
    fn send_callback_kwargs<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyAny>> {
        self.send_callback.kwargs.get(py)
    }
    #[setter]
    fn set_send_callback_kwargs(&self, value: Option<Py<PyAny>>) {
        self.send_callback.kwargs.set(value);
    }

    /// Frames sent.
    #[getter]
    fn total_packets_sent(&self) -> u64 {
        self.sending().packets.load(Relaxed)
    }
    #[setter]
    fn set_total_packets_sent(&self, value: u64) {
        self.sending().packets.store(value, Relaxed);
    }
    /// Bytes sent.
    #[getter]
    fn total_bytes_sent(&self) -> u64 {
        self.sending().bytes.load(Relaxed)
    }
    #[setter]
    fn set_total_bytes_sent(&self, value: u64) {
        self.sending().bytes.store(value, Relaxed);
    }
    /// Messages received, BAD_DATA and UNKNOWN included.
    #[getter]
    fn total_packets_received(&self) -> u64 {
        self.counters.packets_received.load(Relaxed)
    }
    #[setter]
    fn set_total_packets_received(&self, value: u64) {
        counter!(self, packets_received, value);
    }
    /// Bytes given to `parse_char` and `parse_buffer`.
    #[getter]
    fn total_bytes_received(&self) -> u64 {
        self.counters.bytes_received.load(Relaxed)
    }
    #[setter]
    fn set_total_bytes_received(&self, value: u64) {
        counter!(self, bytes_received, value);
    }
    /// Runs of junk and rejected frames.
    #[getter]
    fn total_receive_errors(&self) -> u64 {
        self.counters.receive_errors.load(Relaxed)
    }
    #[setter]
    fn set_total_receive_errors(&self, value: u64) {
        counter!(self, receive_errors, value);
    }

    /// Bytes received and not parsed yet (a copy).
    #[getter]
    fn buf<'py>(&self, py: Python<'py>) -> Bound<'py, PyByteArray> {
        PyByteArray::new(py, self.parser().unread())
    }
    #[setter]
    fn set_buf(&self, #[pyo3(from_py_with = bytes)] value: Vec<u8>) {
        self.parser().replace(&value);
    }
    /// Always 0: `buf` starts with the first unread byte.
    #[getter]
    fn buf_index(&self) -> usize {
        0
    }
    #[setter]
    fn set_buf_index(&self, value: usize) {
        self.parser().skip(value);
    }
    /// Bytes of the frame being received, as far as known.
    #[getter]
    fn expected_length(&self) -> usize {
        self.parser().expected_length
    }
    #[setter]
    fn set_expected_length(&self, value: usize) {
        self.parser().expected_length = value;
    }
    /// The last byte read started no frame (only without `robust_parsing`).
    #[getter]
    fn have_prefix_error(&self) -> bool {
        self.parser().have_prefix_error
    }
    #[setter]
    fn set_have_prefix_error(&self, #[pyo3(from_py_with = truth)] value: bool) {
        self.parser().have_prefix_error = value;
    }

    /// `callback(message, *args, **kwargs)` is called for every message received.
    #[pyo3(signature = (callback, *args, **kwargs))]
    fn set_callback(
        &self,
        callback: Py<PyAny>,
        args: &Bound<'_, PyTuple>,
        kwargs: Option<&Bound<'_, PyDict>>,
    ) {
        self.callback.set(callback, args, kwargs);
    }

    /// `callback(message, *args, **kwargs)` is called for every message sent.
    #[pyo3(signature = (callback, *args, **kwargs))]
    fn set_send_callback(
        &self,
        callback: Py<PyAny>,
        args: &Bound<'_, PyTuple>,
        kwargs: Option<&Bound<'_, PyDict>>,
    ) {
        self.send_callback.set(callback, args, kwargs);
    }

    /// Packs the message and writes it to `file`. Nothing advances if packing or writing fails.
    #[pyo3(signature = (mavmsg, force_mavlink1 = false))]
    fn send(
        slf: &Bound<'_, Self>,
        mavmsg: &Bound<'_, PyAny>,
        #[pyo3(from_py_with = truth)] force_mavlink1: bool,
    ) -> PyResult<()> {
        send::send(slf, mavmsg, force_mavlink1)
    }

    /// From now on the sequence numbers and counters of what is sent are those of `other`, whose place this one takes:
    /// threads may be sending with it.
    fn _share_sending(&self, other: &Bound<'_, Self>) {
        let first = other.get().predecessor.get().unwrap_or(other.as_unbound());
        let _ = self.predecessor.set(first.clone_ref(other.py()));
    }

    /// Whether bytes that are not received here hold a message that may say who sent them: see `trust`.
    fn _holds_trusted(slf: &Bound<'_, Self>, data: &[u8]) -> PyResult<bool> {
        peer_check::holds_trusted(slf, data)
    }

    /// Bytes received and not parsed yet.
    fn buf_len(&self) -> usize {
        self.parser().unread().len()
    }

    /// Bytes still missing of the frame being received; at least 1.
    fn bytes_needed(&self) -> usize {
        self.parser().bytes_needed()
    }

    /// Takes bytes and returns one message, or None. What is left over waits for the next call.
    fn parse_char<'py>(
        slf: &Bound<'py, Self>,
        c: &Bound<'py, PyAny>,
    ) -> PyResult<Option<Bound<'py, Message>>> {
        parse::parse_char(slf, c)
    }

    /// Takes bytes and returns all messages in them as a list, or None if there are none.
    fn parse_buffer<'py>(
        slf: &Bound<'py, Self>,
        s: &Bound<'py, PyAny>,
    ) -> PyResult<Option<Bound<'py, PyList>>> {
        parse::parse_buffer(slf, s)
    }

    /// Decodes one complete frame, which must be a bytearray; `MAVError` says what is wrong with it.
    fn decode<'py>(
        slf: &Bound<'py, Self>,
        msgbuf: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, Message>> {
        parse::decode(slf, msgbuf)
    }

    /// True if the frame's signature is good and fresh; only then the stream's state moves.
    #[pyo3(name = "check_signature")]
    fn check_signature(
        slf: &Bound<'_, Self>,
        msgbuf: &Bound<'_, PyAny>,
        #[allow(non_snake_case)] srcSystem: u8,
        #[allow(non_snake_case)] srcComponent: u8,
    ) -> PyResult<bool> {
        let _ = (srcSystem, srcComponent);
        parse::check_signature(slf, msgbuf)
    }

    fn __traverse__(&self, visit: PyVisit<'_>) -> Result<(), PyTraverseError> {
        visit.call(&self.dialect)?;
        visit.call(self.predecessor.get())?;
        self.file.traverse(visit)?;
        // SAFETY: the garbage collector runs in an attached thread.
        if let Some(parser) = unsafe { self.parser.try_lock() } {
            visit.call(parser.signing.as_ref())?;
        }
        self.callback.traverse(visit)?;
        self.send_callback.traverse(visit)
    }

    fn __clear__(&self) {
        self.file.set(None);
        let signing = self.parser().signing.take();
        drop(signing);
        for callback in [&self.callback, &self.send_callback] {
            callback.set_function(None);
            callback.args.set(None);
            callback.kwargs.set(None);
        }
    }
}

/// Bytes of anything that `bytearray.extend` takes.
pub(crate) fn bytes_like<'py>(data: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
    if data.is_exact_instance_of::<PyBytes>() {
        return Ok(data.clone());
    }
    let buffer = PyByteArray::new(data.py(), b"");
    buffer.invoke_method1(intern!(data.py(), "extend"), (data,))?;
    Ok(PyBytes::new(data.py(), &buffer.to_vec()).into_any())
}
