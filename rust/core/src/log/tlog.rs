//! Telemetry logs: per frame eight bytes of big-endian microseconds since 1970, then the frame as it was on the wire.
//!
//! Four readers for four needs. [`parse_record`] looks at one place. [`index_chunk`] hops from record to record by
//! their lengths, the fastest way and pymavlink's. [`RecordScanner`] checks checksums and finds every good frame of a
//! damaged log in linear time, with the time stamp that stands in front of it. [`find_runs`] looks at any stretch of a log
//! by itself, so that many can do so side by side, for a [`RecordScanner`] to put together. [`recordable`] is for writers.

mod index;
mod recordable;
mod records;
mod runs;

pub use index::{ChunkIndex, RecordEntry, index_chunk};
pub use recordable::recordable;
pub use records::{FoundRecord, RecordScanner};
pub use runs::{Located, Run, Runs, find_runs};

use crate::frame::{FrameRef, claimed_len};

/// Bytes of the time stamp in front of each frame.
pub const STAMP_LEN: usize = 8;

/// The time stamp of a record.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Stamp(pub u64);

impl Stamp {
    /// Reads a stamp; `None` where there are fewer than eight bytes.
    #[inline]
    pub fn parse(bytes: &[u8]) -> Option<Self> {
        bytes.first_chunk().map(|bytes| Self(u64::from_be_bytes(*bytes)))
    }

    /// Microseconds since 1970, with the link number in the low two bits, as pymavlink counts them.
    #[inline]
    pub fn micros(self) -> u64 {
        self.0
    }

    /// Number of the link that the frame came from: the low two bits.
    #[inline]
    pub fn link(self) -> u8 {
        (self.0 & 3) as u8
    }

    /// The bytes to write, for a time and a link number.
    pub fn encode(micros: u64, link: u8) -> [u8; STAMP_LEN] {
        (micros & !3 | u64::from(link & 3)).to_be_bytes()
    }
}

/// What stands at the front of some bytes of a log.
#[derive(Debug, Clone, Copy)]
pub enum Parsed<'a> {
    /// A record. Its checksum is not checked.
    Record {
        /// Bytes of the record.
        len: usize,
        /// Its time.
        stamp: Stamp,
        /// Its frame.
        frame: FrameRef<'a>,
    },
    /// No frame starts behind the first eight bytes.
    NoRecord,
    /// The start of a record.
    Incomplete {
        /// Bytes that must be there to say more.
        needed: usize,
    },
}

/// Takes the front of `bytes` for a record.
pub fn parse_record(bytes: &[u8]) -> Parsed<'_> {
    let Some((stamp, rest)) = bytes.split_first_chunk::<STAMP_LEN>() else {
        return Parsed::Incomplete { needed: STAMP_LEN + 1 };
    };
    let Some(len) = claimed_len(rest) else {
        let undecided = rest.first().is_none_or(|&byte| crate::scan::is_stx(byte));
        let needed = STAMP_LEN + if rest.is_empty() { 1 } else { crate::scan::MIN_LOOK };
        return if undecided { Parsed::Incomplete { needed } } else { Parsed::NoRecord };
    };
    let Some(frame) = rest.get(..len) else {
        return Parsed::Incomplete { needed: STAMP_LEN + len };
    };
    match FrameRef::parse(frame) {
        Ok(frame) => {
            Parsed::Record { len: STAMP_LEN + len, stamp: Stamp(u64::from_be_bytes(*stamp)), frame }
        }
        Err(_) => Parsed::NoRecord,
    }
}

#[cfg(test)]
mod tests;
