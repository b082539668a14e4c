//! The rules by which a signed frame is believed, and how far verified timestamps move the local one.

use subtle::{Choice, ConstantTimeEq};

use super::{Digest, MAX_TIMESTAMP, SigningState, StreamId, StreamTable, UNITS_PER_SECOND, sig48};
use crate::frame::FrameRef;

/// How far a new stream's first timestamp may lie behind this side's time: one minute.
pub const NEW_STREAM_WINDOW: u64 = 60 * UNITS_PER_SECOND;
/// How far received timestamps may move the local one ahead of the clock: one day.
pub const MAX_LOCAL_LEAD: u64 = 24 * 3600 * UNITS_PER_SECOND;
/// The rest of the 48-bit timestamps that received ones may not use up where there is no clock: one year.
pub const KEPT_FREE: u64 = 365 * MAX_LOCAL_LEAD;

/// Whether the stream table has the stream of a signed frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stream {
    /// First frame of its stream.
    New,
    /// The stream is known and its timestamp grew.
    Known,
}

/// The result of checking a frame's signature.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Verdict {
    /// No key is set, so that nothing can be said. Accepted as not verified.
    NoKey,
    /// A key is set and the frame carries no signature (version 1 frames never do).
    Unsigned,
    /// Genuine.
    Good {
        /// Whether its stream is new or known.
        stream: Stream,
    },
    /// Not newer than what its stream had already: a replay.
    OldTimestamp {
        /// Timestamp of the frame.
        timestamp: u64,
        /// Last timestamp of the stream.
        last: u64,
    },
    /// First of its stream, and more than a minute behind this side's time or below the floor of its link id.
    NewStreamTooOld {
        /// Timestamp of the frame.
        timestamp: u64,
        /// This side's time, or the floor of the link id if that is later.
        local: u64,
    },
    /// Further ahead of the clock than the application allows.
    TooFarAhead {
        /// Timestamp of the frame.
        timestamp: u64,
        /// The clock.
        now: u64,
    },
    /// The digest is not that of the key.
    Mismatch {
        /// Whether the stream that it claims is new or known.
        stream: Stream,
    },
}

impl Verdict {
    /// The signature was checked and is good.
    pub fn is_verified(self) -> bool {
        matches!(self, Self::Good { .. })
    }
}

impl SigningState {
    /// A frame that is old to `others` is old, too.
    pub(super) fn judge(
        &mut self,
        streams: &mut StreamTable,
        others: Option<&StreamTable>,
        frame: &FrameRef<'_>,
        now: Option<u64>,
    ) -> Verdict {
        let Some(key) = &self.key else { return Verdict::NoKey };
        let Some((id, timestamp)) = stream_of(frame) else { return Verdict::Unsigned };
        let place = streams.find(id);
        let (mut is_known, mut least) = (place.is_ok(), streams.least(place, id));
        if let Some(others) = others {
            let place = others.find(id);
            is_known |= place.is_ok();
            least = least.max(others.least(place, id));
        }
        let stream = if is_known { Stream::Known } else { Stream::New };
        if is_known && timestamp < least {
            return Verdict::OldTimestamp { timestamp, last: least - 1 };
        }
        let local = self.local_time(now);
        if !is_known && (timestamp < least || timestamp + NEW_STREAM_WINDOW < local) {
            return Verdict::NewStreamTooOld { timestamp, local: local.max(least) };
        }
        if let (Some(now), Some(limit)) = (now, self.max_ahead)
            && timestamp > now.saturating_add(limit)
        {
            return Verdict::TooFarAhead { timestamp, now };
        }
        let Some((signed, digest)) = frame.bytes().split_last_chunk() else {
            return Verdict::Unsigned;
        };
        if !bool::from(same_digest(sig48(key, &[signed]), *digest)) {
            return Verdict::Mismatch { stream };
        }
        let horizon = now.map_or(u64::MAX, |now| now.saturating_add(NEW_STREAM_WINDOW));
        streams.put(place, id, timestamp, horizon);
        self.follow(timestamp, now);
        Verdict::Good { stream }
    }

    /// The time that new streams are compared with: the clock, if there is one. The local timestamp follows those of peers by
    /// up to [`MAX_LOCAL_LEAD`], and one peer with a fast clock must not shut out the others. A local timestamp beyond that
    /// lead shows that the clock went back.
    fn local_time(&self, now: Option<u64>) -> u64 {
        now.map_or(self.timestamp, |now| now.max(self.timestamp.saturating_sub(MAX_LOCAL_LEAD)))
    }

    /// Moves the local timestamp up to a verified one, but not far beyond the clock: one peer with a wrong clock must not
    /// use up the 48 bits.
    fn follow(&mut self, timestamp: u64, now: Option<u64>) {
        let limit = match now {
            Some(now) => now.saturating_add(MAX_LOCAL_LEAD),
            None => MAX_TIMESTAMP - KEPT_FREE,
        };
        self.timestamp = self.timestamp.max(timestamp.min(limit));
    }
}

/// The stream of a signed frame, and its timestamp.
#[inline]
fn stream_of(frame: &FrameRef<'_>) -> Option<(StreamId, u64)> {
    let (header, signature) = (frame.header(), frame.signature()?);
    let id = StreamId { link_id: signature.link_id, sysid: header.sysid, compid: header.compid };
    Some((id, signature.timestamp))
}

/// Whether two digests are equal, in constant time.
#[inline]
pub(super) fn same_digest(one: Digest, other: Digest) -> Choice {
    // As numbers, which takes one step; byte by byte is as constant and takes six.
    let number = |[a, b, c, d, e, f]: Digest| u64::from_le_bytes([a, b, c, d, e, f, 0, 0]);
    number(one).ct_eq(&number(other))
}
