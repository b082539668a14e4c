//! Telemetry logs: per frame eight bytes of big-endian microseconds since 1970, then the frame as it was on the wire.
//!
//! [`RecordScanner`] checks checksums and finds every good frame of a damaged log in linear time, with the time stamp
//! in front of it. [`find_runs`] looks at any stretch of a log by itself, so that many can do so side by side, for a
//! [`RecordScanner`] to put together. [`recordable`] is for writers.

mod ahead;
mod framing;
mod recordable;
mod records;
mod runs;
mod times;

pub use ahead::{Ahead, Checked, Rules};
pub use framing::Framing;
pub use recordable::recordable;
pub use records::{FoundRecord, RecordScanner};
pub use runs::{Located, Run, Runs, find_runs};
pub use times::{Before, MAX_JUMP, are_near, is_date};

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

#[cfg(test)]
mod tests;
