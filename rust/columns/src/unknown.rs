//! Counts of the messages that the dialect does not define.

use std::collections::BTreeMap;

use mavwire_core::frame::Header;
use mavwire_core::x25;

use crate::summary::{Count, RecordTime};

/// Kinds that are counted apart. Whoever makes a log chooses their number.
const MOST_LISTED: usize = 1000;

/// A message id with the `crc_extra` that the checksums of its frames imply.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct UnknownKind {
    /// The message id. The dialect may define it with another `crc_extra`.
    pub msgid: u32,
    /// The `crc_extra` of its definition.
    pub crc_extra: u8,
}

impl UnknownKind {
    /// The kind of the frame at the front of some bytes; `None` where no `crc_extra` explains its checksum.
    fn of(frame: &[u8]) -> Option<Self> {
        let header = Header::parse(frame)?;
        let body_end = header.len() + usize::from(header.payload_len);
        let received = u16::from_le_bytes([*frame.get(body_end)?, *frame.get(body_end + 1)?]);
        let crc_extra = x25::implied_extra(x25::checksum(&frame[1..body_end]), received)?;
        Some(Self { msgid: header.msgid, crc_extra })
    }
}

/// The messages of each kind.
#[derive(Debug, Clone, Default)]
pub struct UnknownCounts {
    /// By kind.
    pub listed: BTreeMap<UnknownKind, Count>,
    /// Messages of further kinds.
    pub unlisted: u64,
}

impl UnknownCounts {
    /// Counts the message whose frame is at the front of some bytes.
    pub(crate) fn add(&mut self, frame: &[u8], moment: Option<RecordTime>) {
        match UnknownKind::of(frame) {
            Some(kind) if self.listed.len() < MOST_LISTED || self.listed.contains_key(&kind) => {
                self.listed.entry(kind).or_default().add(moment);
            }
            _ => self.unlisted += 1,
        }
    }

    /// The messages of each id.
    pub fn by_id(&self) -> BTreeMap<u32, Count> {
        let mut ids = BTreeMap::<u32, Count>::new();
        for (kind, count) in &self.listed {
            ids.entry(kind.msgid).or_default().merge(count);
        }
        ids
    }
}
