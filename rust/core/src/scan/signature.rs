//! Signed frames of a log whose signature lost bytes.
//!
//! No checksum covers a signature. Where bytes of one are lost, the frame's length reaches into the next record, which
//! would be lost with it. So the signed frames of a log are asked what follows them: usually a good frame of a known message
//! begins where the next record's should, and that is all. If none does, and one begins a little earlier, within what
//! the signed frame claims, then the signed frame ends in front of that one and is not whole. Where records have time stamps
//! it is the stamp that may have lost those bytes: then what stands in front of the frame is no time. It is one if it is
//! near that of the signed record or, since that one's stamp may be damaged too, near that of the record behind the frame.
//! Where the signed record's time is no date at all, any date is one.
//!
//! In a stream nobody is asked: a frame that came is not to wait for the next one.

use super::{MIN_LOOK, Scanner, is_stx};
use crate::frame::{Header, IFLAG_SIGNED, SIGNATURE_LEN, STX_V2, claimed_len};
use crate::log::tlog::{STAMP_LEN, are_near, is_date};
use crate::registry::Registry;
use crate::x25;

/// What a scanner knows of the log around its frames.
#[derive(Debug, Clone, Copy)]
pub(crate) struct InLog {
    /// Bytes in front of each frame.
    pub(crate) lead: usize,
    /// The time of the record whose frame is at the front, in microseconds; `None` where records have none.
    pub(crate) time: Option<u64>,
}

/// What follows a signed frame says about its signature.
pub(super) enum Signature {
    /// Nothing against it.
    Whole,
    /// It lost bytes: the next frame begins so many bytes behind the start of the signed one.
    Short { next: usize },
    /// More bytes are needed, counted from the front.
    Need { total: usize },
}

/// A place where a good frame of a known message may begin.
enum Place {
    /// One with this `crc_extra` may be there, if the checksum over `from..to` says so.
    Perhaps { from: usize, to: usize, crc_extra: u8 },
    /// None.
    Nothing,
    /// More bytes are needed, counted from the front.
    Need { total: usize },
}

/// Whether a record's time stands in front of a good frame.
enum Record {
    /// It does.
    Here,
    /// It does not.
    Nothing,
    /// More bytes are needed, counted from the front.
    Need { total: usize },
}

impl Scanner {
    /// Whether a frame at the front of `unread` has to be looked behind before it is taken.
    #[inline]
    pub(super) fn looks_behind(&self, unread: &[u8]) -> bool {
        self.log.is_some()
            && !self.ignore_checksum
            && matches!(unread, [STX_V2, _, flags, ..] if flags & IFLAG_SIGNED != 0)
    }

    /// Looks behind the signed frame of `len` bytes at the front.
    pub(super) fn signature(
        &mut self,
        unread: &[u8],
        len: usize,
        registry: &Registry,
        at_end: bool,
    ) -> Signature {
        let end = len + self.log.map_or(0, |log| log.lead);
        match place(unread, end, registry) {
            Place::Perhaps { from, to, crc_extra } => {
                let register = self.window.checksum(unread, from, to);
                if is_good(register, crc_extra, unread, to) {
                    return Signature::Whole;
                }
                self.window.open(unread, end - SIGNATURE_LEN + 1, to);
            }
            Place::Need { total } if !at_end => return Signature::Need { total },
            Place::Nothing | Place::Need { .. } => {}
        }
        self.frame_within(unread, end - SIGNATURE_LEN, end, registry, at_end)
    }

    /// Looks for a good frame that begins in `first..end`. The window keeps the work linear where many seem to.
    fn frame_within(
        &mut self,
        unread: &[u8],
        first: usize,
        end: usize,
        registry: &Registry,
        at_end: bool,
    ) -> Signature {
        for at in first..end {
            match place(unread, at, registry) {
                Place::Perhaps { from, to, crc_extra } => {
                    self.window.open(unread, from, from);
                    let register = self.window.checksum(unread, from, to);
                    if is_good(register, crc_extra, unread, to) {
                        match self.record_at(unread, at) {
                            Record::Here => return Signature::Short { next: at },
                            Record::Need { total } if !at_end => return Signature::Need { total },
                            Record::Nothing | Record::Need { .. } => {}
                        }
                    }
                }
                Place::Need { total } if !at_end => return Signature::Need { total },
                Place::Nothing | Place::Need { .. } => {}
            }
        }
        Signature::Whole
    }

    /// Whether the good frame at a place has the time of a record in front.
    fn record_at(&self, unread: &[u8], at: usize) -> Record {
        let Some(signed) = self.log.and_then(|log| log.time) else { return Record::Here };
        let Some(time) = time_before(unread, at) else { return Record::Nothing };
        if are_near(time, signed) || !is_date(signed) && is_date(time) {
            return Record::Here;
        }
        let next = at + claimed_len(&unread[at..]).unwrap_or(MIN_LOOK) + STAMP_LEN;
        match time_before(unread, next) {
            Some(next) if are_near(time, next) => Record::Here,
            Some(_) => Record::Nothing,
            None => Record::Need { total: next },
        }
    }
}

/// The time that ends in front of a place.
fn time_before(unread: &[u8], at: usize) -> Option<u64> {
    unread.get(..at)?.last_chunk().map(|stamp: &[u8; STAMP_LEN]| u64::from_be_bytes(*stamp))
}

/// What stands at a place as far as its header tells.
fn place(unread: &[u8], at: usize, registry: &Registry) -> Place {
    let bytes = unread.get(at..).unwrap_or_default();
    match *bytes {
        [] => return Place::Need { total: at + 1 },
        [first, ..] if !is_stx(first) => return Place::Nothing,
        [STX_V2, _, flags, ..] if flags & !IFLAG_SIGNED != 0 => return Place::Nothing,
        _ => {}
    }
    let total = claimed_len(bytes).unwrap_or(MIN_LOOK);
    let Some(header) = Header::parse(bytes).filter(|_| bytes.len() >= total) else {
        return Place::Need { total: at + total };
    };
    let to = at + header.len() + usize::from(header.payload_len);
    match registry.lookup(header.msgid) {
        Some(entry) => Place::Perhaps { from: at + 1, to, crc_extra: entry.crc_extra },
        None => Place::Nothing,
    }
}

/// Whether the checksum at `to` is right for the register over the bytes in front of it.
fn is_good(register: u16, crc_extra: u8, unread: &[u8], to: usize) -> bool {
    x25::push(register, crc_extra) == u16::from_le_bytes([unread[to], unread[to + 1]])
}
