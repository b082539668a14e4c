//! Message signing (MAVLink guide, "Message Signing"): who may be believed.
//!
//! A signature block is `link_id`, a 48-bit timestamp and the first 48 bits of SHA-256 over key, frame and timestamp. The
//! timestamp of each stream (`link_id`, `sysid`, `compid`) must grow, which stops replays. The order matters: first the
//! timestamp is looked at, then the digest, and only a good digest changes anything, so that someone without the key can
//! neither block a genuine stream nor open the replay window of a new one.
//!
//! The clock is an argument (`now`, in signing units; `None` without a clock). The caller decides about frames that
//! are not genuine, and the [`Verdict`] says enough to apply and to log its policy.

mod key;
mod rules;
mod stream_table;

pub use key::{Digest, SecretKey, sig48};
pub use rules::{KEPT_FREE, MAX_LOCAL_LEAD, NEW_STREAM_WINDOW, Stream, Verdict};
pub use stream_table::{StreamId, StreamTable};

use crate::frame::{CHECKSUM_LEN, FrameRef, IFLAG_SIGNED, INCOMPAT_FLAGS_AT, SIGNATURE_LEN};
use crate::x25;

/// Unix time of signing timestamp 0: 2015-01-01 00:00 UTC, in seconds.
pub const EPOCH_UNIX_SECONDS: u64 = 1_420_070_400;
/// Timestamp units in a second (10 microseconds each).
pub const UNITS_PER_SECOND: u64 = 100_000;
/// Largest timestamp that 48 bits hold, reached in 2104.
pub const MAX_TIMESTAMP: u64 = (1 << 48) - 1;
/// Message id of `SETUP_SIGNING`, which carries the secret key: never to be broadcast or forwarded.
pub const SETUP_SIGNING: u32 = 256;

/// Why something cannot be signed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum SigningError {
    /// A key of another length than 32 bytes.
    #[error("a signing key has 32 bytes, not {0}")]
    KeyLength(usize),
    /// No key is set.
    #[error("no signing key is set")]
    NoKey,
    /// The 48-bit timestamp is used up; it never wraps.
    #[error("the signing timestamp is beyond 48 bits")]
    TimestampExhausted,
}

/// The streams and the timestamp of frames that [`SigningState::look`] has verified.
#[derive(Debug, Clone, Default)]
pub struct Sightings {
    streams: StreamTable,
    /// As far as verified timestamps would have moved the local one.
    timestamp: u64,
}

impl Sightings {
    /// The same streams for a party with another local timestamp.
    #[must_use]
    pub fn begun_anew(&self) -> Self {
        Self { streams: self.streams.clone(), timestamp: 0 }
    }
}

/// Key, timestamps and streams of one party. Links that use the same key share one, so that what was heard on one link
/// cannot be replayed on another.
#[derive(Debug, Default)]
pub struct SigningState {
    key: Option<SecretKey>,
    /// The timestamp of the next frame to sign. Not above 2^48.
    pub timestamp: u64,
    /// Last timestamp of each verified stream.
    pub streams: StreamTable,
    /// Refuse timestamps further ahead of the clock than this; `None` sets no limit, as the protocol does.
    pub max_ahead: Option<u64>,
}

impl SigningState {
    /// Sets or removes the key. Streams and timestamp stay.
    pub fn set_key(&mut self, key: Option<SecretKey>) {
        self.key = key;
    }

    /// The key that is set.
    pub fn key(&self) -> Option<&SecretKey> {
        self.key.as_ref()
    }

    /// A key is set.
    pub fn has_key(&self) -> bool {
        self.key.is_some()
    }

    /// Judges a received frame whose checksum is right, and takes note of it if it is genuine.
    pub fn check(&mut self, frame: &FrameRef<'_>, now: Option<u64>) -> Verdict {
        let mut streams = std::mem::take(&mut self.streams);
        let verdict = self.judge(&mut streams, None, frame, now);
        self.streams = streams;
        verdict
    }

    /// The same with a table of streams that several parties share, in place of this one's own.
    pub fn check_in(
        &mut self,
        streams: &mut StreamTable,
        frame: &FrameRef<'_>,
        now: Option<u64>,
    ) -> Verdict {
        self.judge(streams, None, frame, now)
    }

    /// Judges a frame for a caller that only needs to know its sender, by the same rules. `seen` takes note of it;
    /// [`SigningState::check`] later judges it as if nobody had looked. A frame that is old to `streams`, those of
    /// received frames, is old here.
    pub fn look(
        &mut self,
        seen: &mut Sightings,
        streams: &StreamTable,
        frame: &FrameRef<'_>,
        now: Option<u64>,
    ) -> Verdict {
        let own = self.timestamp;
        self.timestamp = own.max(seen.timestamp);
        let verdict = self.judge(&mut seen.streams, Some(streams), frame, now);
        seen.timestamp = std::mem::replace(&mut self.timestamp, own);
        verdict
    }

    /// The timestamp for the next signed frame: above all earlier ones, and the clock's where that is later.
    ///
    /// # Errors
    /// The 48 bits are used up.
    pub fn next_timestamp(&mut self, now: Option<u64>) -> Result<u64, SigningError> {
        let timestamp = self.timestamp.max(now.unwrap_or(0).min(MAX_TIMESTAMP));
        if timestamp > MAX_TIMESTAMP {
            return Err(SigningError::TimestampExhausted);
        }
        self.timestamp = timestamp + 1;
        Ok(timestamp)
    }

    /// The signature block for a frame that was encoded with [`crate::frame::IFLAG_SIGNED`], and the timestamp in it.
    ///
    /// # Errors
    /// No key, or the timestamp is used up.
    #[inline]
    pub fn sign(
        &mut self,
        frame: &[u8],
        link_id: u8,
        now: Option<u64>,
    ) -> Result<(u64, [u8; SIGNATURE_LEN]), SigningError> {
        if self.key.is_none() {
            return Err(SigningError::NoKey);
        }
        let timestamp = self.next_timestamp(now)?;
        let key = self.key.as_ref().ok_or(SigningError::NoKey)?;
        Ok((timestamp, signature(frame, key, link_id, timestamp)))
    }
}

/// Appends a signature block to the frame in `frame`. The timestamp's upper 16 bits are not sent.
pub fn sign(frame: &mut Vec<u8>, key: &SecretKey, link_id: u8, timestamp: u64) {
    let block = signature(frame, key, link_id, timestamp);
    frame.extend_from_slice(&block);
}

/// The signature block of a frame.
fn signature(frame: &[u8], key: &SecretKey, link_id: u8, timestamp: u64) -> [u8; SIGNATURE_LEN] {
    let mut block = [0; SIGNATURE_LEN];
    block[0] = link_id;
    block[1..7].copy_from_slice(&timestamp.to_le_bytes()[..6]);
    let digest = sig48(key, &[frame, &block[..7]]);
    block[7..].copy_from_slice(&digest);
    block
}

/// A signed frame without its signature.
///
/// The checksum covers the signed flag. It is linear, so what clearing the flag changes depends on the flag's distance
/// from the end alone: `crc_extra` is not needed, and messages that nobody knows keep a good checksum.
pub(crate) fn without_signature(frame: &[u8]) -> Vec<u8> {
    let end = frame.len() - SIGNATURE_LEN;
    let checksum_at = end - CHECKSUM_LEN;
    let mut unsigned = frame[..end].to_vec();
    unsigned[INCOMPAT_FLAGS_AT] &= !IFLAG_SIGNED;
    // `crc_extra` counts as one more byte behind the payload.
    let behind_flag = checksum_at - INCOMPAT_FLAGS_AT - 1 + 1;
    let change = x25::advance(x25::push(0, IFLAG_SIGNED), behind_flag);
    for (byte, changed) in unsigned[checksum_at..].iter_mut().zip(change.to_le_bytes()) {
        *byte ^= changed;
    }
    unsigned
}

/// The clock as a signing timestamp: 0 before 2015, [`MAX_TIMESTAMP`] from 2104 on.
pub fn timestamp_from_unix_micros(micros: u64) -> u64 {
    (micros.saturating_sub(EPOCH_UNIX_SECONDS * 1_000_000) / 10).min(MAX_TIMESTAMP)
}

#[cfg(test)]
mod tests;
