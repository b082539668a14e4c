//! The message object: a frame's bytes and its definition; fields are decoded when they are read.
//!
//! Every message class of every dialect is a Python subclass of [`Message`]. An object that came off the wire has no
//! instance dictionary until something is written to it. [`Flags`] remembers what may stand in that dictionary, so
//! that the fast paths know when they must ask Python instead of the frame.

use std::sync::atomic::{AtomicU8, AtomicU32, AtomicU64, Ordering};

use mavwire_core::frame::{HEADER_LEN_V1, HEADER_LEN_V2, Header, STX_V2};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyString};

use crate::message::extra::Extra;
use crate::message::info::Info;
use crate::python::collector;
use crate::sync::shared;
use mavwire_core::frame::FrameBytes;

/// How a message came to be.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Origin {
    /// Made by calling its class; its values stand in the instance dictionary.
    Built,
    /// Off the wire, checksum good.
    Decoded,
    /// Off the wire, id not in the dialect.
    Unknown,
    /// Off the wire, rejected; [`Message::reason`] says why.
    Bad,
}

/// Bits of [`Message::flags`].
pub(crate) mod flags {
    /// Something was written to the instance dictionary.
    pub(crate) const DICT: u32 = 1;
    /// ... perhaps a field.
    pub(crate) const FIELDS: u32 = 2;
    /// ... perhaps an underscore attribute.
    pub(crate) const META: u32 = 4;
    /// ... perhaps `_timestamp`.
    pub(crate) const TIMESTAMP_IN_DICT: u32 = 8;
    /// The signature was checked with a key and was good.
    pub(crate) const SIGNED: u32 = 16;
    /// `_posted` is set.
    pub(crate) const POSTED: u32 = 32;
    /// `_link` is set.
    pub(crate) const LINK: u32 = 64;
    /// `_timestamp` is set.
    pub(crate) const TIMESTAMP: u32 = 128;
    /// `__dict__` was handed out with everything in it; what is missing there was deleted.
    pub(crate) const MATERIALISED: u32 = 256;
    /// `pack` made a frame of its own.
    pub(crate) const PACKED: u32 = 512;
    /// The object may be used again for another message once it is free.
    pub(crate) const POOLED: u32 = 1024;

    /// Facts of a received message that its bytes do not tell.
    pub(crate) const WIRE: u32 = SIGNED | POSTED | LINK;
    /// Facts about the instance dictionary.
    pub(crate) const WRITTEN: u32 = DICT | FIELDS | META | TIMESTAMP_IN_DICT | MATERIALISED;
}

/// One MAVLink message. Its 96 bytes and what Python adds make an object of 144.
#[pyclass(frozen, subclass, dict, weakref, module = "mavwire._native")]
pub(crate) struct Message {
    /// `None` for BAD_DATA, UNKNOWN and the bare base class.
    pub(crate) info: Option<&'static Info>,
    /// The whole frame as received, signature included; empty when built.
    pub(crate) frame: FrameBytes,
    timestamp: AtomicU64,
    /// The frame that `pack` made last, or why this is BAD_DATA.
    pub(in crate::message) extra: Extra,
    pub(crate) flags: AtomicU32,
    pub(crate) origin: Origin,
    /// `_link`: which link of a multi-link log.
    pub(crate) link: AtomicU8,
}

const _: () = assert!(size_of::<Message>() <= 96, "a message object is to fit 144 bytes");

impl Message {
    #[inline]
    pub(crate) fn received(info: Option<&'static Info>, frame: FrameBytes, origin: Origin) -> Self {
        Self {
            info,
            frame,
            origin,
            flags: AtomicU32::new(0),
            timestamp: AtomicU64::new(0),
            link: AtomicU8::new(0),
            extra: Extra::none(),
        }
    }

    /// Bytes that are no frame of the dialect. Without a reason they look like no frame at all.
    pub(crate) fn bad(frame: FrameBytes, reason: Option<&Bound<'_, PyString>>) -> Self {
        let extra = reason.map_or(Extra::none(), |reason| Extra::holding(reason.as_any()));
        Self { extra, ..Self::received(None, frame, Origin::Bad) }
    }

    /// Why this is BAD_DATA, if there is more to say than that no frame starts there.
    pub(crate) fn reason<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyAny>> {
        if self.origin != Origin::Bad || self.has(flags::PACKED) {
            return None;
        }
        self.extra.get(py)
    }

    pub(crate) fn built(info: Option<&'static Info>) -> Self {
        Self::received(info, FrameBytes::empty(), Origin::Built)
    }

    #[inline]
    pub(crate) fn has(&self, bits: u32) -> bool {
        self.flags.load(Ordering::Relaxed) & bits != 0
    }

    #[inline]
    pub(crate) fn set(&self, bits: u32) {
        shared::set_bits(&self.flags, bits);
    }

    /// Notes that something is written to the instance dictionary.
    pub(crate) fn written(slf: &Bound<'_, Self>, bits: u32) {
        let before = shared::set_bits(&slf.get().flags, bits);
        if before & flags::DICT == 0 && bits & flags::DICT != 0 {
            collector::track(slf);
        }
    }

    /// Payload of a received frame, as truncated on the wire.
    #[inline]
    pub(crate) fn decoded_payload(&self) -> &[u8] {
        payload_of(&self.frame)
    }

    /// Header of the frame packed last, else of the frame received.
    #[inline]
    pub(crate) fn header(&self) -> Option<Header> {
        if self.has(flags::PACKED) {
            return Python::attach(|py| Header::parse(self.packed(py)?.as_bytes()));
        }
        if self.origin == Origin::Decoded { Header::parse(&self.frame) } else { None }
    }

    /// The frame that `pack` made last.
    pub(crate) fn packed<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyBytes>> {
        if !self.has(flags::PACKED) {
            return None;
        }
        self.extra.get(py)?.cast_into().ok()
    }

    /// A message with the time when it came, and the number of its link if it is out of a log, before anybody sees it.
    #[inline]
    pub(crate) fn stamped(mut self, seconds: f64, link: Option<u8>) -> Self {
        *self.timestamp.get_mut() = seconds.to_bits();
        *self.link.get_mut() = link.unwrap_or_default();
        *self.flags.get_mut() |= flags::TIMESTAMP | if link.is_some() { flags::LINK } else { 0 };
        self
    }

    /// A message that is taken into the state of its link before anybody sees it.
    #[inline]
    pub(crate) fn posted(mut self) -> Self {
        *self.flags.get_mut() |= flags::POSTED;
        self
    }

    pub(crate) fn set_timestamp(&self, seconds: f64) {
        self.timestamp.store(seconds.to_bits(), Ordering::Relaxed);
        self.set(flags::TIMESTAMP);
    }

    pub(crate) fn timestamp(&self) -> Option<f64> {
        self.has(flags::TIMESTAMP).then(|| f64::from_bits(self.timestamp.load(Ordering::Relaxed)))
    }

    /// A copy without what Python wrote to the instance dictionary.
    pub(crate) fn duplicate(&self, py: Python<'_>) -> Self {
        let copied = flags::WIRE | flags::TIMESTAMP | flags::PACKED;
        let extra = self.extra.get(py);
        Self {
            flags: AtomicU32::new(self.flags.load(Ordering::Relaxed) & copied),
            timestamp: AtomicU64::new(self.timestamp.load(Ordering::Relaxed)),
            link: AtomicU8::new(self.link.load(Ordering::Relaxed)),
            extra: extra.map_or(Extra::none(), |extra| Extra::holding(&extra)),
            ..Self::received(self.info, self.frame.clone(), self.origin)
        }
    }

    /// Everything needed is in the frame: no field was written by Python.
    pub(crate) fn is_pristine(&self) -> bool {
        self.origin == Origin::Decoded && !self.has(flags::FIELDS)
    }
}

/// Payload bytes of a complete frame; empty for any other.
#[inline]
pub(crate) fn payload_of(frame: &[u8]) -> &[u8] {
    let &[stx, len, ..] = frame else { return &[] };
    let start = if stx == STX_V2 { HEADER_LEN_V2 } else { HEADER_LEN_V1 };
    frame.get(start..).and_then(|rest| rest.get(..usize::from(len))).unwrap_or_default()
}

/// The flags that writing to an attribute of this name sets.
pub(crate) fn flags_for(name: &str) -> u32 {
    match name {
        "_timestamp" => 0,
        "_posted" | "_link" | "_instances" => flags::DICT,
        _ if name.starts_with('_') && !name.ends_with("_raw") => flags::DICT | flags::META,
        _ => flags::DICT | flags::FIELDS,
    }
}
