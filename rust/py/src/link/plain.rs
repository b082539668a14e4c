//! Plain messages: good frames of known messages from known systems, which is nearly all there are.
//!
//! Logs and live links account for them here without calling Python. [`crate::link::tracking`] does it for all others.

use mavwire_core::frame::Header;
use mavwire_core::telemetry::{RADIO, Reception, Sender};
use pyo3::prelude::*;

use crate::link::state::Link;
use crate::link::system::{SystemState, Systems};
use crate::link::tracking;
use crate::message::info::Info;
use crate::message::object::Message;
use crate::protocol::mavlink::MAVLink;
use crate::sync::shared;

/// A frame with a good checksum, of a message that has a class.
pub(crate) struct PlainFrame<'a> {
    pub(crate) header: Header,
    pub(crate) info: &'static Info,
    pub(crate) payload: &'a [u8],
}

impl<'a> PlainFrame<'a> {
    /// The frame at the start of `stream`; `None` if it is cut off.
    #[inline(always)] // once for each message of a log
    pub(crate) fn parse(stream: &'a [u8], info: &'static Info) -> Option<Self> {
        let header = Header::parse(stream)?;
        let payload = header.len()..header.len() + usize::from(header.payload_len);
        Some(Self { header, info, payload: stream.get(payload)? })
    }
}

/// A plain message that was accounted for and is still to be made and delivered.
pub(crate) struct Plain<'py> {
    /// Time of the message.
    pub(crate) time: f64,
    info: &'static Info,
    compid: u8,
    system: Bound<'py, SystemState>,
    /// Python has to update the system's state or to call hooks.
    needs_python: bool,
}

/// Whether the messages that `mav` makes can be plain. Signatures, callbacks and replaced methods need the other way.
pub(crate) fn makes_plain_messages(py: Python<'_>, mav: &MAVLink) -> bool {
    !mav.checks_signatures(py) && !mav.shows_messages()
}

impl<'py> Plain<'py> {
    /// Accounts for a frame. Returns `None`, with nothing changed, for one from an unknown system or from the radio.
    #[inline(always)] // as above
    pub(crate) fn account(
        py: Python<'py>,
        (systems, reception): (&mut Systems, &mut Reception),
        mav: &MAVLink,
        frame: &PlainFrame<'_>,
        has_hooks: bool,
        now: f64,
    ) -> Option<Self> {
        let &PlainFrame { header, info, payload } = frame;
        let Header { sysid, compid, seq, .. } = header;
        let heard = systems.find(sysid).filter(|_| (sysid, compid) != RADIO)?;
        let changes_state = info.changes_state && !heard.repeats.hear(&header, payload);
        let plain = Self {
            time: reception.account(Some(Sender { sysid, compid, seq }), info.uptime(payload), now),
            info,
            compid,
            system: heard.state.bind(py).clone(),
            needs_python: changes_state || has_hooks,
        };
        shared::add(&mav.counters.packets_received, 1);
        if header.is_signed() {
            mav.note_signed(py);
        }
        Some(plain)
    }

    /// Makes `message`, which nobody has seen, the newest of its type, and calls Python where necessary.
    #[inline(always)] // as above
    pub(crate) fn deliver(
        self,
        link: &Bound<'py, Link>,
        message: &Bound<'py, Message>,
    ) -> PyResult<()> {
        let kind = self.info.name.bind(link.py());
        tracking::keep_newest(link, &self.system, self.compid, kind, message)?;
        if self.needs_python {
            tracking::call_python(link, message, kind, &self.system)?;
        }
        Ok(())
    }
}
