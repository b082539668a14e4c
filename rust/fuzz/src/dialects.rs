//! The messages that targets know, and frames of them.

use std::sync::{Arc, LazyLock};

use mavwire_core::builtin;
use mavwire_core::frame::{self, Header};
use mavwire_core::registry::Registry;
use mavwire_schema::WireVersion;

use crate::input::Input;

/// Every message that mavwire ships.
pub(crate) static ALL: LazyLock<Arc<Registry>> = LazyLock::new(|| {
    Arc::new(Registry::new(builtin::dialect("all", WireVersion::V2).expect("it is built in")))
});

/// A good, unsigned frame of some message with any payload.
pub(crate) fn any_frame(input: &mut Input<'_>) -> Vec<u8> {
    let messages = &ALL.dialect().messages;
    let message = &messages[usize::from(input.number()) % messages.len()];
    let version = match input.byte() {
        n if n % 2 == 1 && message.id < 256 => WireVersion::V1,
        _ => WireVersion::V2,
    };
    let header = Header {
        version,
        payload_len: 0,
        incompat_flags: 0,
        compat_flags: 0,
        seq: input.byte(),
        sysid: input.byte(),
        compid: input.byte(),
        msgid: message.id,
    };
    let mut payload = input.bytes(message.max_len.into()).to_vec();
    let full = if version == WireVersion::V1 { message.min_len } else { message.max_len };
    payload.resize(full.into(), 0);
    let mut out = Vec::new();
    frame::encode(&mut out, header, &payload, message.crc_extra).expect("it fits a frame");
    out
}
