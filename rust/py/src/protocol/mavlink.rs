//! `MAVLink`: one link's protocol state, sending and receiving. The Python class of each dialect derives from it.

use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, AtomicI64, AtomicU8, AtomicU64, Ordering::Relaxed};

use mavwire_core::parser::Parser;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};

use crate::dialect::registry::Dialect;
use crate::protocol::sender::{Sender, header_byte};
use crate::protocol::sending::Sending;
use crate::protocol::signing::Signing;
use crate::python::calling::Calling;
use crate::python::intern::Interned;
use crate::python::lists::collected;
use crate::sync::lock::{Guard, Lock};
use crate::sync::shared;
use crate::sync::slot::Slot;

/// A callback. Attributes of the `MAVLink` object hold what else it is called with.
pub(crate) struct Callback {
    /// Whether there is one, so that its absence costs nothing.
    is_set: AtomicBool,
    pub(super) function: Slot,
    args: Interned,
    kwargs: Interned,
}

impl Callback {
    pub(super) const fn new(args: &'static str, kwargs: &'static str) -> Self {
        Self {
            is_set: AtomicBool::new(false),
            function: Slot::new(),
            args: Interned::new(args),
            kwargs: Interned::new(kwargs),
        }
    }

    pub(super) fn get<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyAny>> {
        self.function.get(py)
    }

    pub(super) fn set(&self, function: Option<Py<PyAny>>) {
        self.is_set.store(function.is_some(), Relaxed);
        self.function.set(function);
    }

    pub(super) fn set_with(
        &self,
        mav: &Bound<'_, MAVLink>,
        function: Option<Py<PyAny>>,
        args: &Bound<'_, PyTuple>,
        kwargs: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<()> {
        let py = mav.py();
        mav.setattr(self.args.get(py), args)?;
        let none = || PyDict::new(py);
        mav.setattr(self.kwargs.get(py), kwargs.cloned().unwrap_or_else(none))?;
        self.set(function);
        Ok(())
    }

    pub(crate) fn is_set(&self) -> bool {
        self.is_set.load(Relaxed)
    }

    /// Calls `function(message, *args, **kwargs)` if one is registered.
    pub(crate) fn call(
        &self,
        mav: &Bound<'_, MAVLink>,
        message: &Bound<'_, PyAny>,
    ) -> PyResult<()> {
        if !self.is_set() {
            return Ok(());
        }
        let py = message.py();
        let Some(function) = self.get(py) else { return Ok(()) };
        let mut arguments = vec![message.clone()];
        let extra = mav.getattr(self.args.get(py))?;
        if !extra.is_none() {
            arguments.extend(collected(extra.try_iter()?)?);
        }
        let kwargs = mav.getattr(self.kwargs.get(py))?.cast_into::<PyDict>().ok();
        function.invoke(PyTuple::new(py, arguments)?, kwargs.as_ref())?;
        Ok(())
    }
}

/// Gives the class the attributes of its callbacks, unset.
pub(crate) fn add_callback_attributes(py: Python<'_>) -> PyResult<()> {
    let names = ["callback_args", "callback_kwargs", "send_callback_args", "send_callback_kwargs"];
    names.iter().try_for_each(|name| py.get_type::<MAVLink>().setattr(name, py.None()))
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
    pub(super) own_sending: Sending,
    /// The one whose sequence numbers and counters go on here.
    pub(super) predecessor: OnceLock<Py<Self>>,
    pub(super) src_system: AtomicI64,
    pub(super) src_component: AtomicI64,
    pub(crate) robust_parsing: AtomicBool,
    pub(crate) counters: Counters,
    pub(super) parser: Lock<Parser>,
    pub(super) signing: Slot<Signing>,
    pub(crate) file: Slot,
    pub(crate) callback: Callback,
    pub(crate) send_callback: Callback,
    /// Bits of [`overridden`]: what a subclass or an instance attribute replaces.
    pub(super) overridden: AtomicU8,
}

/// Methods that the fast paths must not go around.
pub(crate) mod overridden {
    pub(crate) const SEND: u8 = 1;
    pub(crate) const RECEIVE: u8 = 2;
    pub(crate) const ENCODE: u8 = 4;
    /// Links call a method of the program's for received bytes, so that these have to be shown to it.
    pub(crate) const PARSER: u8 = 8;
    /// The program has its own method to check signatures.
    pub(crate) const SIGNATURE: u8 = 16;

    /// Methods of the native class whose replacement matters.
    pub(crate) const METHODS: [(&str, u8); 5] = [
        ("send", SEND),
        ("decode", RECEIVE),
        ("parse_char", RECEIVE | PARSER),
        ("bytes_needed", PARSER),
        ("check_signature", RECEIVE | SIGNATURE),
    ];

    /// A method of pymavlink's parser that this parser never calls.
    pub(crate) const NOT_CALLED: &str = "buf_len";

    pub(crate) fn by_name(name: &str) -> u8 {
        let encode = if name.ends_with("_encode") { ENCODE } else { 0 };
        METHODS.iter().find(|(method, _)| *method == name).map_or(encode, |&(_, bits)| bits)
    }
}

impl MAVLink {
    #[inline]
    pub(crate) fn parser(&self) -> Guard<'_, Parser> {
        // SAFETY: links are Python objects, whose methods run attached.
        self.parser.lock(unsafe { Python::assume_attached() })
    }

    /// The state of sending. An object that took the place of another one shares that one's, since threads may still use it.
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

    /// Whether frames have to be shown to signing.
    pub(crate) fn checks_signatures(&self, py: Python<'_>) -> bool {
        self.signing.is_some_and(py, |signing| signing.get().has_key())
    }

    /// Counts a frame with a signature that is not checked.
    #[cold]
    pub(crate) fn note_signed(&self, py: Python<'_>) {
        if let Some(signing) = self.signing(py) {
            shared::add(&signing.get().seen, 1);
        }
    }

    /// Whether each message is shown: to a callback, or to a subclass's own `decode`.
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
