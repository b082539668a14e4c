//! The message object: a frame's bytes and its definition; fields are decoded when they are read.
//!
//! Every message class of every dialect is a Python subclass of [`Message`]. An object that came off the wire has no
//! instance dictionary until something is written to it. [`Flags`] remembers what may stand in that dictionary, so
//! that the fast paths know when they must ask Python instead of the frame.

use std::sync::atomic::{AtomicU8, AtomicU32, AtomicU64, Ordering};

use mavwire_core::frame::{HEADER_LEN_V1, HEADER_LEN_V2, Header, STX_V2};
use pyo3::exceptions::{PyAttributeError, PyIndexError, PyNotImplementedError};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict, PyString, PyTuple, PyType};

use crate::message::create;
use crate::message::dict;
use crate::message::extra::Extra;
use crate::message::frame_bytes::FrameBytes;
use crate::message::info::{Info, MessageInfo};
use crate::message::meta::{self, Meta};
use crate::message::text;
use crate::protocol::pack;
use crate::python::calling::{Calling, class_name, import, truth};
use crate::sync::shared;

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

    /// What a received message was given beside its bytes.
    pub(crate) const WIRE: u32 = SIGNED | POSTED | LINK;
    /// What may stand in the instance dictionary.
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
    extra: Extra,
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
            create::track(slf);
        }
    }

    /// Payload of a received frame, as truncated on the wire.
    #[inline]
    pub(crate) fn decoded_payload(&self) -> &[u8] {
        payload_of(&self.frame)
    }

    /// The same; `None` where that would panic, which no frame does that was checked.
    #[inline]
    pub(crate) fn quick_payload(&self) -> Option<&[u8]> {
        let frame: &[u8] = &self.frame;
        let &[stx, len, ..] = frame else { return None };
        let start = if stx == STX_V2 { HEADER_LEN_V2 } else { HEADER_LEN_V1 };
        frame.get(start..)?.get(..usize::from(len))
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

    /// Remembers the frame that `pack` made, and forgets what was derived from an earlier one.
    pub(crate) fn set_packed(slf: &Bound<'_, Self>, frame: &Bound<'_, PyBytes>) -> PyResult<()> {
        let this = slf.get();
        if let Some(reason) = this.reason(slf.py()) {
            dict::instance_dict(slf)?.set_item(intern!(slf.py(), "reason"), reason)?;
            Self::written(slf, flags::DICT | flags::FIELDS);
        }
        this.extra.set(frame.as_any());
        this.set(flags::PACKED);
        if this.has(flags::MATERIALISED) {
            return meta::refresh(slf);
        }
        if this.has(flags::META) {
            let attributes = dict::instance_dict(slf)?;
            for meta in Meta::OF_FRAME {
                if attributes.contains(meta.name())? {
                    attributes.del_item(meta.name())?;
                }
            }
        }
        Ok(())
    }

    /// Whether `frame` is still the frame that `pack` made last, if it made one.
    pub(crate) fn is_packed_as(&self, py: Python<'_>, frame: Option<&Bound<'_, PyBytes>>) -> bool {
        let packed = self.packed(py);
        packed.as_ref().map(Bound::as_ptr) == frame.map(Bound::as_ptr)
    }

    /// A message out of a log, stamped before anybody sees it.
    #[inline]
    pub(crate) fn stamped(mut self, seconds: f64, link: u8) -> Self {
        *self.timestamp.get_mut() = seconds.to_bits();
        *self.link.get_mut() = link;
        *self.flags.get_mut() |= flags::TIMESTAMP | flags::LINK;
        self
    }

    /// The same, and taken into the state of its link.
    #[inline]
    pub(crate) fn posted(mut self, seconds: f64, link: u8) -> Self {
        *self.flags.get_mut() |= flags::POSTED;
        self.stamped(seconds, link)
    }

    /// A message of a live link, stamped and taken into its state before anybody sees it.
    #[inline]
    pub(crate) fn seen_at(mut self, seconds: f64) -> Self {
        *self.timestamp.get_mut() = seconds.to_bits();
        *self.flags.get_mut() |= flags::TIMESTAMP | flags::POSTED;
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
            info: self.info,
            frame: self.frame.clone(),
            origin: self.origin,
            flags: AtomicU32::new(self.flags.load(Ordering::Relaxed) & copied),
            timestamp: AtomicU64::new(self.timestamp.load(Ordering::Relaxed)),
            link: AtomicU8::new(self.link.load(Ordering::Relaxed)),
            extra: extra.map_or(Extra::none(), |extra| Extra::holding(&extra)),
        }
    }

    /// Everything needed is in the frame: no field was written by Python.
    pub(crate) fn is_pristine(&self) -> bool {
        self.origin == Origin::Decoded && !self.has(flags::FIELDS)
    }

    /// `_header.<name>` where somebody may have replaced it, else straight from the frame.
    fn header_item<'py>(
        slf: &Bound<'py, Self>,
        name: &str,
        read: impl FnOnce(Header) -> i64,
    ) -> PyResult<Bound<'py, PyAny>> {
        let py = slf.py();
        if slf.get().has(flags::META) {
            return slf.attribute(intern!(py, "_header"))?.attribute(name);
        }
        let value = slf.get().header().map_or(0, read);
        Ok(value.into_pyobject(py)?.into_any())
    }
}

/// Payload bytes of a complete frame.
#[inline]
pub(crate) fn payload_of(frame: &[u8]) -> &[u8] {
    let header_len = if frame[0] == STX_V2 { HEADER_LEN_V2 } else { HEADER_LEN_V1 };
    &frame[header_len..header_len + usize::from(frame[1])]
}

#[pymethods]
impl Message {
    #[new]
    #[classmethod]
    #[pyo3(signature = (*_args, **_kwargs))]
    fn new(
        cls: &Bound<'_, PyType>,
        _args: &Bound<'_, PyTuple>,
        _kwargs: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Self> {
        if let Some(prepared) = create::take_prepared() {
            return Ok(prepared);
        }
        let info = cls.attribute(intern!(cls.py(), "_info"))?;
        Ok(Self::built(info.cast::<MessageInfo>().ok().map(|info| info.get().info)))
    }

    fn __setattr__(
        slf: &Bound<'_, Self>,
        name: &Bound<'_, PyString>,
        value: &Bound<'_, PyAny>,
    ) -> PyResult<()> {
        Self::written(slf, dict::flags_for(name.to_str()?));
        slf.set_generic_attribute(name, Some(value))
    }

    fn __delattr__(slf: &Bound<'_, Self>, name: &Bound<'_, PyString>) -> PyResult<()> {
        // Once everything stands in the dictionary, what is missing there is gone.
        let attributes = dict::message_dict(slf)?;
        if attributes.contains(name)? {
            return attributes.del_item(name);
        }
        slf.set_generic_attribute(name, None)
    }

    /// Takes the attributes of a pickled message.
    fn __setstate__(slf: &Bound<'_, Self>, state: &Bound<'_, PyDict>) -> PyResult<()> {
        dict::instance_dict(slf)?.update(state.as_mapping())?;
        Self::written(slf, flags::DICT | flags::FIELDS | flags::META);
        Ok(())
    }

    /// Seconds since 1970 (or of the log's own clock), set by whoever received the message.
    #[getter(_timestamp)]
    fn get_timestamp(slf: &Bound<'_, Self>) -> PyResult<Py<PyAny>> {
        let py = slf.py();
        let this = slf.get();
        if this.has(flags::TIMESTAMP_IN_DICT) {
            if let Some(value) = dict::instance_dict(slf)?.get_item(intern!(py, "_timestamp"))? {
                return Ok(value.unbind());
            }
        } else if let Some(seconds) = this.timestamp() {
            return Ok(seconds.into_pyobject(py)?.into_any().unbind());
        }
        Err(PyAttributeError::new_err(format!(
            "'{}' object has no attribute '_timestamp'",
            class_name(&slf.get_type())?
        )))
    }

    #[setter(_timestamp)]
    fn put_timestamp(slf: &Bound<'_, Self>, value: &Bound<'_, PyAny>) -> PyResult<()> {
        let this = slf.get();
        if let (false, Ok(seconds)) =
            (this.has(flags::TIMESTAMP_IN_DICT), value.cast_exact::<pyo3::types::PyFloat>())
        {
            this.set_timestamp(seconds.extract()?);
            return Ok(());
        }
        dict::instance_dict(slf)?.set_item(intern!(slf.py(), "_timestamp"), value)?;
        Self::written(slf, flags::TIMESTAMP_IN_DICT | flags::DICT);
        Ok(())
    }

    /// The whole frame, signature included; empty before packing or decoding.
    fn get_msgbuf<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        slf.attribute(intern!(slf.py(), "_msgbuf"))
    }

    /// The header object.
    fn get_header<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        slf.attribute(intern!(slf.py(), "_header"))
    }

    /// After packing the payload as sent; after decoding the frame from byte 6 up to the checksum.
    fn get_payload<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        slf.attribute(intern!(slf.py(), "_payload"))
    }

    /// Checksum of the frame, or None.
    fn get_crc<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        slf.attribute(intern!(slf.py(), "_crc"))
    }

    /// Field names in XML order.
    fn get_fieldnames<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        if slf.get().has(flags::META) {
            return slf.attribute(intern!(slf.py(), "_fieldnames"));
        }
        slf.get_type().attribute(intern!(slf.py(), "fieldnames"))
    }

    /// Message name, "BAD_DATA" or "UNKNOWN_<id>".
    fn get_type<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        let py = slf.py();
        match &slf.get().info {
            Some(info) if !slf.get().has(flags::META) => Ok(info.name.bind(py).clone().into_any()),
            _ => slf.attribute(intern!(py, "_type")),
        }
    }

    /// Message id; -1 for BAD_DATA, -2 for UNKNOWN.
    #[pyo3(name = "get_msgId")]
    fn get_msg_id<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        let py = slf.py();
        match &slf.get().info {
            Some(info) if !slf.get().has(flags::META) => {
                Ok(info.definition.id.into_pyobject(py)?.into_any())
            }
            _ => slf.attribute(intern!(py, "_header"))?.attribute(intern!(py, "msgId")),
        }
    }

    /// Id of the sending system.
    #[pyo3(name = "get_srcSystem")]
    fn get_src_system<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        Self::header_item(slf, "srcSystem", |header| i64::from(header.sysid))
    }

    /// Id of the sending component.
    #[pyo3(name = "get_srcComponent")]
    fn get_src_component<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        Self::header_item(slf, "srcComponent", |header| i64::from(header.compid))
    }

    /// Sequence number of the frame.
    fn get_seq<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        Self::header_item(slf, "seq", |header| i64::from(header.seq))
    }

    /// True only if a signature was checked with a key and was good.
    fn get_signed<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        slf.attribute(intern!(slf.py(), "_signed"))
    }

    /// Link id of a verified signature, else None.
    fn get_link_id<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        slf.attribute(intern!(slf.py(), "_link_id"))
    }

    /// A field as text and JSON show it: bytes become text, everything else stays.
    fn format_attr<'py>(
        slf: &Bound<'py, Self>,
        field: &Bound<'py, PyString>,
    ) -> PyResult<Bound<'py, PyAny>> {
        text::format_attr(slf, field)
    }

    fn __str__(slf: &Bound<'_, Self>) -> PyResult<Py<PyString>> {
        text::to_text(slf)
    }

    /// `{"mavpackettype": type, field: value, ...}` in XML order.
    fn to_dict<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyDict>> {
        text::to_dict(slf)
    }

    /// `json.dumps(to_dict())`.
    fn to_json<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        text::to_json(slf)
    }

    fn __eq__(slf: &Bound<'_, Self>, other: &Bound<'_, PyAny>) -> PyResult<bool> {
        text::equal(slf, other)
    }

    fn __ne__(slf: &Bound<'_, Self>, other: &Bound<'_, PyAny>) -> PyResult<bool> {
        Ok(!text::equal(slf, other)?)
    }

    /// The message of one instance (battery, named value, ...), where mavutil keeps several.
    fn __getitem__<'py>(
        slf: &Bound<'py, Self>,
        key: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let instances = slf.attribute(intern!(slf.py(), "_instances"))?;
        if instances.is_none() || !instances.includes(key.as_any())? {
            return Err(PyIndexError::new_err(()));
        }
        instances.get_item(key)
    }

    /// The frame as bytes, with source and sequence number taken from `mav`, which is not advanced.
    #[pyo3(signature = (mav, force_mavlink1 = false))]
    fn pack<'py>(
        slf: &Bound<'py, Self>,
        mav: &Bound<'py, PyAny>,
        #[pyo3(from_py_with = truth)] force_mavlink1: bool,
    ) -> PyResult<Bound<'py, PyAny>> {
        if slf.get().info.is_none() {
            return Err(PyNotImplementedError::new_err(
                "MAVLink_message cannot be serialized directly",
            ));
        }
        pack::pack_message(slf, mav, force_mavlink1)
    }

    /// Frames a ready payload: `_pack(mav, crc_extra, payload, force_mavlink1=False) -> bytes`.
    #[pyo3(name = "_pack", signature = (mav, crc_extra, payload, force_mavlink1 = false))]
    fn pack_payload<'py>(
        slf: &Bound<'py, Self>,
        mav: &Bound<'py, PyAny>,
        crc_extra: u8,
        payload: &[u8],
        #[pyo3(from_py_with = truth)] force_mavlink1: bool,
    ) -> PyResult<Bound<'py, PyAny>> {
        pack::pack_payload(slf, mav, crc_extra, payload, force_mavlink1)
    }

    /// Appends a signature to the packed frame and advances the signing timestamp.
    fn sign_packet(slf: &Bound<'_, Self>, mav: &Bound<'_, PyAny>) -> PyResult<()> {
        pack::sign_packet(slf, mav)
    }

    fn __copy__<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, Self>> {
        dict::copy(slf, |value| Ok(value.clone()))
    }

    fn __deepcopy__<'py>(
        slf: &Bound<'py, Self>,
        memo: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, Self>> {
        let deepcopy = import(slf.py(), intern!(slf.py(), "copy"))?.attribute("deepcopy")?;
        dict::copy(slf, |value| deepcopy.invoke1((value, memo)))
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyTuple>> {
        dict::reduce(slf)
    }
}
