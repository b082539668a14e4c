//! Where the records of a log are, found by hopping over their lengths.

use super::STAMP_LEN;
use crate::frame::{FrameRef, Header};
use crate::registry::{Entry, Registry};
use crate::scan::distance_to_stx;

/// A record in a log.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct RecordEntry {
    /// Where the record starts in the log, stamp included.
    pub offset: u64,
    /// Bytes of the frame, that is of the record without its stamp.
    pub frame_len: u16,
    /// Message id.
    pub msgid: u32,
    /// The message definition; `None` for an unknown id.
    pub entry: Option<Entry>,
    /// The checksum is right. `true` where it is not checked: unknown ids, and when not asked for.
    pub checksum_ok: bool,
}

/// What a chunk holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ChunkIndex {
    /// Bytes dealt with: the next chunk must start there.
    pub consumed: usize,
    /// The record that the end of the chunk cuts off, where its header is there. Only at the end of the log does it
    /// mean anything.
    pub cut_off: Option<RecordEntry>,
}

/// Appends the records of `chunk`, which stands at `offset` in the log, to `records`.
///
/// Where no STX stands eight bytes ahead it goes on by one byte, and over a record with a wrong checksum it hops like
/// over any other: pymavlink's way. A pure function of its arguments, so that chunks that start at a record can be
/// indexed side by side.
pub fn index_chunk(
    chunk: &[u8],
    offset: u64,
    registry: &Registry,
    check_checksums: bool,
    records: &mut Vec<RecordEntry>,
) -> ChunkIndex {
    let mut at = 0;
    while let Some(rest) = chunk.get(at + STAMP_LEN..) {
        at += distance_to_stx(rest);
        let Some(header) = chunk.get(at + STAMP_LEN..).and_then(Header::parse) else { break };
        let frame_len = header.frame_len();
        let mut record = RecordEntry {
            offset: offset + at as u64,
            frame_len: frame_len as u16,
            msgid: header.msgid,
            entry: registry.lookup(header.msgid),
            checksum_ok: true,
        };
        let start = at + STAMP_LEN;
        let Some(frame) = chunk.get(start..start + frame_len) else {
            return ChunkIndex { consumed: at, cut_off: Some(record) };
        };
        if check_checksums {
            record.checksum_ok = checksum_ok(frame, record.entry);
        }
        records.push(record);
        at = start + frame_len;
    }
    ChunkIndex { consumed: at, cut_off: None }
}

#[inline]
fn checksum_ok(frame: &[u8], entry: Option<Entry>) -> bool {
    match (FrameRef::parse(frame), entry) {
        (Ok(frame), Some(entry)) => frame.calculated_checksum(entry.crc_extra) == frame.checksum(),
        (frame, _) => frame.is_ok(),
    }
}
