//! Where the records of a binary log are, damaged or not.
//!
//! Records have no checksum. One is taken for good if the next begins right behind it. If it does not, and another
//! record that is followed by one begins within its bytes, then it was cut off there: the other one counts, and nothing
//! that is intact gets lost behind a gap. Otherwise it is taken as it is, and what follows it is junk. Each byte is
//! looked at a bounded number of times.

use memchr::memmem;

use super::definitions::Definitions;
use super::{HEAD, HEAD_LEN, MAX_RECORD_LEN};

/// Bytes that decide about any record: its own, those of a record that begins within, and the head behind that.
pub const LOOK_LEN: usize = 2 * MAX_RECORD_LEN + HEAD.len();

/// The next item in the bytes of a log.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Found {
    /// A record of `len` bytes.
    Record {
        /// Its length.
        len: usize,
        /// Index of its layout.
        layout: u16,
    },
    /// Bytes that belong to no record, at least one.
    Junk {
        /// How many.
        len: usize,
    },
    /// More bytes are needed to say: [`LOOK_LEN`] are enough. Never at the end of the log.
    Incomplete,
}

/// A record in a log.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct RecordEntry {
    /// Where it starts in the log.
    pub offset: u64,
    /// Index of its layout.
    pub layout: u16,
    /// Its length, head included.
    pub len: u8,
}

/// Looks at the front of `bytes`, which stand at `offset` in the log; `last` if the log ends with them.
#[inline]
pub fn look(bytes: &[u8], offset: u64, definitions: &Definitions, last: bool) -> Found {
    if let &[first, second, type_id, ..] = bytes
        && [first, second] == HEAD
        && let Some((layout, len)) = definitions.record(type_id, offset)
    {
        // The usual case: the next record follows.
        if bytes.get(len..len + HEAD.len()) == Some(&HEAD) {
            return Found::Record { len, layout };
        }
        return odd_record(bytes, offset, definitions, last, (len, layout));
    }
    junk(bytes, offset, definitions, last)
}

/// A record that no other follows, or that is not all there.
#[cold]
fn odd_record(
    bytes: &[u8],
    offset: u64,
    definitions: &Definitions,
    last: bool,
    (len, layout): (usize, u16),
) -> Found {
    if !last && bytes.len() < LOOK_LEN {
        return Found::Incomplete;
    }
    if is_followed(bytes, len, last) {
        return Found::Record { len, layout };
    }
    // A head may begin with the last byte.
    let inside = &bytes[..(len + 1).min(bytes.len())];
    for at in memmem::find_iter(&inside[1..], &HEAD).map(|at| at + 1) {
        if begins_followed_record(&bytes[at..], offset + at as u64, definitions, last) {
            return Found::Junk { len: at };
        }
    }
    if bytes.len() >= len {
        Found::Record { len, layout }
    } else {
        Found::Junk { len: bytes.len() }
    }
}

/// Whether a record of `len` bytes is there and another, or the end of the log, follows.
fn is_followed(bytes: &[u8], len: usize, last: bool) -> bool {
    match bytes.get(len..) {
        None => false,
        Some([]) => last,
        Some(&[first]) => first == HEAD[0],
        Some(&[first, second, ..]) => [first, second] == HEAD,
    }
}

fn begins_followed_record(
    bytes: &[u8],
    offset: u64,
    definitions: &Definitions,
    last: bool,
) -> bool {
    let record = bytes.get(HEAD.len()).and_then(|&type_id| definitions.record(type_id, offset));
    record.is_some_and(|(_, len)| is_followed(bytes, len, last))
}

/// Bytes up to the next head of a known type.
#[cold]
fn junk(bytes: &[u8], offset: u64, definitions: &Definitions, last: bool) -> Found {
    for at in memmem::find_iter(bytes, &HEAD) {
        let Some(&type_id) = bytes.get(at + HEAD.len()) else { break };
        if at > 0 && definitions.record(type_id, offset + at as u64).is_some() {
            return Found::Junk { len: at };
        }
    }
    // The last bytes may be the start of a head.
    let kept = if last { 0 } else { HEAD_LEN - 1 };
    match bytes.len().checked_sub(kept) {
        None | Some(0) => Found::Incomplete,
        Some(len) => Found::Junk { len },
    }
}

/// Passes over records of layouts that are not `wanted`, `most` of them at most; returns how many bytes that makes, and how
/// many records.
///
/// It stops in front of a wanted record, of bytes that are not a record, and of the last [`LOOK_LEN`] bytes: [`look`]
/// judges those.
#[inline]
pub fn pass(
    bytes: &[u8],
    offset: u64,
    definitions: &Definitions,
    wanted: &[bool],
    most: u32,
) -> (usize, u32) {
    let (mut at, mut passed) = (0, 0);
    let safe = bytes.len().saturating_sub(LOOK_LEN);
    while at < safe
        && passed < most
        && let Found::Record { len, layout } =
            look(&bytes[at..], offset + at as u64, definitions, false)
        && !wanted[usize::from(layout)]
    {
        at += len;
        passed += 1;
    }
    (at, passed)
}

/// Calls `record` for each record of `bytes` that starts before `limit`, with the record's bytes; returns where the next
/// one has to be looked for, and how many bytes belong to no record.
///
/// `bytes` stand at `offset` in the log, which ends with them if `last`; otherwise they have to go on beyond `limit` by
/// [`LOOK_LEN`] bytes, or indexing stops short of it. A pure function: what is found from a place on depends on nothing
/// before it, so a stretch that begins where the one before ended is indexed as the whole log would be, and stretches that
/// begin anywhere else soon agree with it.
pub fn index(
    bytes: &[u8],
    offset: u64,
    limit: usize,
    definitions: &Definitions,
    last: bool,
    mut record: impl FnMut(RecordEntry, &[u8]),
) -> (usize, u64) {
    let (mut at, mut junk) = (0, 0);
    while at < limit.min(bytes.len()) {
        let place = offset + at as u64;
        match look(&bytes[at..], place, definitions, last) {
            Found::Record { len, layout } => {
                let entry = RecordEntry { offset: place, layout, len: len as u8 };
                record(entry, &bytes[at..at + len]);
                at += len;
            }
            Found::Junk { len } => {
                junk += len as u64;
                at += len;
            }
            Found::Incomplete => break,
        }
    }
    (at, junk)
}
