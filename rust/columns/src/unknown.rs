//! Counts of messages that the dialect does not know, so that nothing is left out without a word.

use std::collections::BTreeMap;

use mavwire_core::frame::Header;
use mavwire_core::x25;

/// Kinds that are counted apart.
const MOST_LISTED: usize = 1000;

/// A message id with the `crc_extra` that the checksums of its frames imply.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct UnknownKind {
    /// The message id. The dialect may know it with another `crc_extra`.
    pub msgid: u32,
    /// The `crc_extra` of its definition.
    pub crc_extra: u8,
}

impl UnknownKind {
    /// The kind of a whole frame; `None` where no `crc_extra` explains its checksum.
    pub fn of(frame: &[u8]) -> Option<Self> {
        let header = Header::parse(frame)?;
        let body_end = header.len() + usize::from(header.payload_len);
        let received = u16::from_le_bytes([*frame.get(body_end)?, *frame.get(body_end + 1)?]);
        let crc_extra = x25::implied_extra(x25::checksum(&frame[1..body_end]), received)?;
        Some(Self { msgid: header.msgid, crc_extra })
    }
}

/// How many messages of each kind.
#[derive(Debug, Clone, Default)]
pub struct UnknownCounts {
    /// By kind.
    pub listed: BTreeMap<UnknownKind, u64>,
    /// Messages of kinds beyond those listed.
    pub unlisted: u64,
}

impl UnknownCounts {
    pub(crate) fn add(&mut self, kind: UnknownKind) {
        if self.listed.len() < MOST_LISTED || self.listed.contains_key(&kind) {
            *self.listed.entry(kind).or_default() += 1;
        } else {
            self.unlisted += 1;
        }
    }
}
