//! The Python methods of `MAVLink`.

use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, AtomicI64, AtomicU8, Ordering::Relaxed};

use mavwire_core::parser::Parser;
use mavwire_core::scan::Resync;
use pyo3::exceptions::{PyRuntimeWarning, PyValueError};
use pyo3::gc::{PyTraverseError, PyVisit};
use pyo3::prelude::*;
use pyo3::types::{PyByteArray, PyBytes, PyDict, PyString, PyTuple};

use crate::dialect::registry::Dialect;
use crate::protocol::mavlink::{Callback, Counters, MAVLink, overridden};
use crate::protocol::sending::Sending;
use crate::protocol::signing::Signing;
use crate::python::calling::truth;
use crate::python::instance_dict::generic_setattr;
use crate::python::lists::{bytes, bytes_like};
use crate::sync::lock::Lock;
use crate::sync::slot::Slot;

fn warn_not_called(py: Python<'_>) -> PyResult<()> {
    let text = c"MAVLink.buf_len was replaced, and mavwire does not call it: the parser counts its bytes itself. \
        Replace parse_char to see what is received";
    PyErr::warn(py, &py.get_type::<PyRuntimeWarning>(), text, 1)
}

new! {
    MAVLink: |cls| -> PyResult<Self> {
        let py = cls.py();
        let dialect = cls.getattr(intern!(py, "_dialect"))?.cast_into::<Dialect>()?.unbind();
        let native = py.get_type::<Self>();
        let mut replaced = 0;
        for (name, bits) in overridden::METHODS {
            if !cls.getattr(name)?.is(&native.getattr(name)?) {
                replaced |= bits;
            }
        }
        let buf_len = intern!(py, "buf_len");
        if !cls.getattr(buf_len)?.is(&native.getattr(buf_len)?) {
            warn_not_called(py)?;
        }
        if !cls.getattr(intern!(py, "_mavlink_base"))?.is(cls) {
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
            parser: Lock::new(Parser::default()),
            signing: Slot::new(),
            file: Slot::new(),
            callback: Callback::new("callback_args", "callback_kwargs"),
            send_callback: Callback::new("send_callback_args", "send_callback_kwargs"),
            overridden: AtomicU8::new(replaced),
        })
    }
}

#[pymethods]
impl MAVLink {
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
        generic_setattr(slf, name, Some(value))
    }

    fn __delattr__(slf: &Bound<'_, Self>, name: &Bound<'_, PyString>) -> PyResult<()> {
        generic_setattr(slf, name, None)
    }

    /// The policy after a damaged frame: "skip" drops its whole claimed length, "rescan" looks for frames inside it.
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

    /// Signing state.
    #[getter]
    pub(crate) fn signing<'py>(&self, py: Python<'py>) -> Option<Bound<'py, Signing>> {
        self.signing.get(py)
    }
    #[setter]
    fn set_signing(&self, value: Py<Signing>) {
        self.signing.set(Some(value));
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

    /// `callback(message, *args, **kwargs)` is called for every message received.
    #[pyo3(signature = (callback, *args, **kwargs))]
    fn set_callback(
        slf: &Bound<'_, Self>,
        callback: Option<Py<PyAny>>,
        args: &Bound<'_, PyTuple>,
        kwargs: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<()> {
        slf.get().callback.set_with(slf, callback, args, kwargs)
    }

    /// `callback(message, *args, **kwargs)` is called for every message sent.
    #[pyo3(signature = (callback, *args, **kwargs))]
    fn set_send_callback(
        slf: &Bound<'_, Self>,
        callback: Option<Py<PyAny>>,
        args: &Bound<'_, PyTuple>,
        kwargs: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<()> {
        slf.get().send_callback.set_with(slf, callback, args, kwargs)
    }

    /// From now on the sequence numbers and counters of what is sent are those of `other`, whose place this one takes:
    /// threads may be sending with it.
    fn _share_sending(&self, other: &Bound<'_, Self>) {
        let first = other.get().predecessor.get().unwrap_or(other.as_unbound());
        let _ = self.predecessor.set(first.clone_ref(other.py()));
    }

    /// Bytes received and not parsed yet.
    fn buf_len(&self) -> usize {
        self.parser().unread().len()
    }

    /// Bytes still missing of the frame being received; at least 1.
    fn bytes_needed(&self) -> usize {
        self.parser().bytes_needed()
    }

    /// True if the frame's signature is good and fresh; only then the stream's state moves. The source is the one in the
    /// frame, which is what is signed.
    fn check_signature(
        slf: &Bound<'_, Self>,
        msgbuf: &Bound<'_, PyAny>,
        #[allow(non_snake_case)] srcSystem: u8,
        #[allow(non_snake_case)] srcComponent: u8,
    ) -> PyResult<bool> {
        let _ = (srcSystem, srcComponent);
        let bytes = bytes_like(msgbuf)?;
        let Some(signing) = slf.get().signing(slf.py()) else { return Ok(false) };
        signing.get().check(slf, bytes.cast::<PyBytes>()?.as_bytes())
    }

    fn __traverse__(&self, visit: PyVisit<'_>) -> Result<(), PyTraverseError> {
        visit.call(&self.dialect)?;
        visit.call(self.predecessor.get())?;
        self.file.traverse(visit)?;
        self.signing.traverse(visit)?;
        self.callback.function.traverse(visit)?;
        self.send_callback.function.traverse(visit)
    }

    fn __clear__(&self) {
        self.file.set(None);
        self.signing.set(None);
        self.callback.set(None);
        self.send_callback.set(None);
    }
}

properties! {
    MAVLink:

    /// Bad input gives BAD_DATA messages instead of exceptions.
    robust_parsing, set_robust_parsing as truth: bool = |mav| (atomic mav.robust_parsing);
    /// The last byte read started no frame (only without `robust_parsing`).
    have_prefix_error, set_have_prefix_error as truth: bool = |mav| (field mav.parser().have_prefix_error);
    /// The object that frames are written to: it has `write(bytes)`.
    file, set_file: Option<Py<PyAny>> = |mav| (slot mav.file);
    /// `callback(message, *callback_args, **callback_kwargs)` is called for every message received.
    callback, put_callback: Option<Py<PyAny>> = |mav| (slot mav.callback);
    /// The same for every message sent, with `send_callback_args` and `send_callback_kwargs`.
    send_callback, put_send_callback: Option<Py<PyAny>> = |mav| (slot mav.send_callback);
    /// Bytes of the frame being received, as far as known.
    expected_length, set_expected_length: usize = |mav| (field mav.parser().expected_length);
    /// Sequence number of the next frame, 0 to 255.
    seq, set_seq: i64 = |mav| (atomic mav.sending().seq);
    /// System id that frames are sent with.
    srcSystem, set_src_system: i64 = |mav| (atomic mav.src_system);
    /// Component id that frames are sent with.
    srcComponent, set_src_component: i64 = |mav| (atomic mav.src_component);
    /// Frames sent.
    total_packets_sent, set_total_packets_sent: u64 = |mav| (atomic mav.sending().packets);
    /// Bytes sent.
    total_bytes_sent, set_total_bytes_sent: u64 = |mav| (atomic mav.sending().bytes);
    /// Messages received, BAD_DATA and UNKNOWN included.
    total_packets_received, set_total_packets_received: u64 = |mav| (atomic mav.counters.packets_received);
    /// Bytes given to `parse_char` and `parse_buffer`.
    total_bytes_received, set_total_bytes_received: u64 = |mav| (atomic mav.counters.bytes_received);
    /// Runs of junk and rejected frames.
    total_receive_errors, set_total_receive_errors: u64 = |mav| (atomic mav.counters.receive_errors);
}
