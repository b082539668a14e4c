//! Re-scanning and message ids that the dialect does not define.
//!
//! Their checksum cannot be verified for want of `crc_extra`, yet a bridge must forward them, and a false STX in front of
//! good frames claims an unknown id more often than not. What can be known:
//!
//! * A checksum that no `crc_extra` explains is wrong: 255 of 256 false candidates end here.
//! * A candidate directly behind a good frame (or at the start of the stream) whose header is sane is then believed, and
//!   like any good frame not looked into.
//! * Any other candidate (inside or behind junk, flags that nobody defined, system 0) is believed once its id was met
//!   before with the same implied `crc_extra` and another checksum (the same bytes again are no new evidence), which
//!   makes the check as sharp as that of a known message.
//!
//! All of it depends on the bytes alone and not on how they arrive. What was met before only ever lets a frame pass,
//! so that forged frames cannot shut out genuine ones.

use crate::frame::Header;

const SLOTS: usize = 64;

/// An unknown id as it was last met.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Sighting {
    msgid: u32,
    extra: u8,
    checksum: u16,
    believed: bool,
}

/// The unknown ids met lately.
#[derive(Debug, Clone)]
pub(super) struct UnknownIds {
    /// At a slot that follows from the id; a newer id displaces an older one.
    met: [Option<Sighting>; SLOTS],
}

impl Default for UnknownIds {
    fn default() -> Self {
        Self { met: [None; SLOTS] }
    }
}

impl UnknownIds {
    /// Whether to take a candidate for a frame. `extra` is the `crc_extra` that its `checksum` implies.
    pub(super) fn believe(
        &mut self,
        header: &Header,
        extra: u8,
        checksum: u16,
        in_sync: bool,
    ) -> bool {
        let Header { msgid, compat_flags, sysid, .. } = *header;
        let slot = &mut self.met[msgid as usize % SLOTS];
        let met_before = slot.is_some_and(|met| {
            (met.msgid, met.extra) == (msgid, extra) && (met.checksum != checksum || met.believed)
        });
        let believed = met_before || (in_sync && compat_flags == 0 && sysid != 0);
        *slot = Some(Sighting { msgid, extra, checksum, believed });
        believed
    }
}
