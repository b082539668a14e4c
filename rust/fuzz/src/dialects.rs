//! The messages that targets know, and frames of them.

use std::sync::{Arc, LazyLock};

use mavwire_core::builtin;
use mavwire_core::frame::{self, Header, IFLAG_SIGNED};
use mavwire_core::registry::Registry;
use mavwire_core::signing::{SecretKey, sign};
use mavwire_schema::{Message, WireVersion};

use crate::input::Input;

/// Every message that mavwire ships.
pub(crate) static ALL: LazyLock<Arc<Registry>> = LazyLock::new(|| {
    Arc::new(Registry::new(builtin::dialect("all", WireVersion::V2).expect("it is built in")))
});

/// Some message.
pub(crate) fn any_message(input: &mut Input<'_>) -> &'static Message {
    let messages = &ALL.dialect().messages;
    &messages[usize::from(input.number()) % messages.len()]
}

/// A good, unsigned frame of some message with any payload.
pub(crate) fn any_frame(input: &mut Input<'_>) -> Vec<u8> {
    let message = any_message(input);
    let version = match input.byte() {
        n if n % 2 == 1 && message.id < 256 => WireVersion::V1,
        _ => WireVersion::V2,
    };
    let header = Header::new(version, input.byte(), input.byte(), input.byte(), message.id);
    let payload = input.bytes(message.max_len.into());
    let full = if version == WireVersion::V1 { message.min_len } else { message.max_len };
    frame_of(header, payload, full, message.crc_extra)
}

/// A frame whose payload is cut or filled up to `len` bytes.
pub(crate) fn frame_of(header: Header, payload: &[u8], len: u8, crc_extra: u8) -> Vec<u8> {
    let mut payload = payload[..payload.len().min(len.into())].to_vec();
    payload.resize(len.into(), 0);
    let mut out = Vec::new();
    frame::encode(&mut out, header, &payload, crc_extra).expect("it fits a frame");
    out
}

/// A key that consists of one byte.
pub(crate) fn key(byte: u8) -> SecretKey {
    SecretKey::new(&[byte; 32]).expect("32 bytes")
}

/// The same frame, signed; of version 1 the frame itself, which cannot be.
pub(crate) fn signed(frame: &[u8], key_byte: u8, link_id: u8, timestamp: u64) -> Vec<u8> {
    let whole = frame::FrameRef::parse(frame).expect("a frame");
    let header = *whole.header();
    let Some(entry) = ALL.lookup(header.msgid).filter(|_| header.version == WireVersion::V2) else {
        return frame.to_vec();
    };
    let header = Header { incompat_flags: IFLAG_SIGNED, ..header };
    let mut out = Vec::new();
    frame::encode(&mut out, header, whole.payload(), entry.crc_extra).expect("it fits a frame");
    sign(&mut out, &key(key_byte), link_id, timestamp);
    out
}
