//! Counts of the messages that the dialect does not define.

use std::collections::BTreeMap;

use crate::frame::Header;
use crate::x25;

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
    pub fn of(frame: &[u8]) -> Option<Self> {
        let header = Header::parse(frame)?;
        let body_end = header.len() + usize::from(header.payload_len);
        let received = u16::from_le_bytes([*frame.get(body_end)?, *frame.get(body_end + 1)?]);
        let crc_extra = x25::implied_extra(x25::checksum(&frame[1..body_end]), received)?;
        Some(Self { msgid: header.msgid, crc_extra })
    }
}

/// Kinds of a log that are counted apart. The author of a log chooses their number.
pub const MOST_LISTED: usize = 1000;

/// The messages of each kind.
#[derive(Debug, Clone)]
pub struct UnknownCounts<C = u64> {
    /// By kind.
    pub listed: BTreeMap<UnknownKind, C>,
    /// Messages of further kinds.
    pub unlisted: u64,
}

impl<C> Default for UnknownCounts<C> {
    fn default() -> Self {
        Self { listed: BTreeMap::new(), unlisted: 0 }
    }
}

impl<C: Default> UnknownCounts<C> {
    /// The count of a kind; `None` for an unexplained checksum, and beyond `most` kinds.
    pub fn of(&mut self, kind: Option<UnknownKind>, most: usize) -> Option<&mut C> {
        let kind = kind?;
        let is_listed = self.listed.len() < most || self.listed.contains_key(&kind);
        is_listed.then(|| self.listed.entry(kind).or_default())
    }
}

impl UnknownCounts {
    /// Counts messages of a kind. At most `most` kinds are listed.
    pub fn add(&mut self, kind: UnknownKind, messages: u64, most: usize) {
        *match self.of(Some(kind), most) {
            Some(count) => count,
            None => &mut self.unlisted,
        } += messages;
    }
}
