//! Finding frames in a stream of bytes: slice in, outcome out.
//!
//! The scanner looks at the front of the unread bytes and names the item there. A policy decides where to go on after a
//! frame that turned out wrong ([`Resync`]), because the protocol does not say:
//!
//! * `Skip` drops the whole length that the bad frame claimed. One stray STX can swallow good frames, but the outcome is
//!   byte for byte pymavlink's.
//! * `Rescan` looks again from the second byte of the bad frame and so finds every good frame. It never looks inside a
//!   frame whose checksum is right. A frame that travelled inside a damaged frame's payload can surface; signing rejects
//!   such a frame.
//!
//! Both take linear time on any input in any chunking. See the `window` module for how re-scanning does it, and the `evidence`
//! module for what re-scanning makes of messages that the dialect does not define, or defines in another way.

mod evidence;
mod window;

use crate::frame::{
    FrameError, HEADER_LEN_V1, HEADER_LEN_V2, Header, IFLAG_SIGNED, STX_V1, STX_V2, claimed_len,
};
use crate::registry::{Entry, Registry};
use crate::x25;
use evidence::{Claim, Evidence, fits};
use window::Window;

/// The place where scanning goes on after a rejected frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Resync {
    /// Go on behind the length it claimed, as pymavlink does.
    Skip,
    /// Go on at its second byte.
    Rescan,
}

/// The first item in the unread bytes. Remove its `len` bytes before the next look.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Found {
    /// A frame whose checksum is right, or unknown for want of a definition.
    Frame {
        /// Bytes of the frame, signature included.
        len: usize,
        /// Its header.
        header: Header,
        /// The message definition. `None` for an unknown id, or a definition that nobody knows: its checksum cannot be
        /// verified.
        entry: Option<Entry>,
    },
    /// Bytes that start no frame.
    Noise {
        /// At least 1.
        len: usize,
    },
    /// Bytes that looked like a frame and are none. Under `Rescan` this may run on over any further junk.
    Rejected {
        /// At least 1.
        len: usize,
        /// The error of the (first) candidate.
        error: FrameError,
    },
    /// The start of a frame.
    Incomplete {
        /// Bytes, counted from the front, that must be there before the next look can say more.
        needed: usize,
    },
}

/// The scanner's decision about one candidate.
enum Verdict {
    Accept { len: usize, header: Header, entry: Option<Entry> },
    Reject { error: FrameError },
    Need { total: usize },
}

/// Finds frames. Holds a few kilobytes of state for re-scanning and no bytes of the stream.
///
/// Each call's `unread` must start where the previous outcome ended (or, after `Incomplete`, where the previous slice
/// started); call [`Scanner::reset`] when the stream breaks off.
#[derive(Debug, Clone)]
pub struct Scanner {
    policy: Resync,
    /// Deliver frames of known messages with any checksum.
    pub ignore_checksum: bool,
    /// Under `Rescan`, deliver frames of known ids too whose checksum some other `crc_extra` explains, by the rules for
    /// unknown ids.
    pub accept_unverified: bool,
    window: Window,
    evidence: Evidence,
    /// The front directly follows a good frame or the start of the stream.
    in_sync: bool,
}

impl Scanner {
    /// A scanner at the start of a stream.
    pub fn new(policy: Resync) -> Self {
        Self {
            policy,
            ignore_checksum: false,
            accept_unverified: false,
            window: Window::default(),
            evidence: Evidence::default(),
            in_sync: true,
        }
    }

    /// The policy it was made with.
    pub fn policy(&self) -> Resync {
        self.policy
    }

    /// Forgets the stream so far.
    pub fn reset(&mut self) {
        self.evidence = Evidence::default();
        self.restart();
    }

    /// Goes on elsewhere in the stream. The definitions that its senders use are still known.
    pub fn restart(&mut self) {
        self.window = Window::default();
        self.in_sync = true;
    }

    /// Steps over bytes in front of the next look that are no part of the frame stream, such as a log's time stamps.
    pub fn skip(&mut self, len: usize) {
        self.window.consume(len);
    }

    /// Bytes that went through a checksum.
    #[cfg(test)]
    pub(crate) fn work(&self) -> u64 {
        self.window.work.get()
    }

    /// Whether a good frame of a known message at the front is taken in any case: no byte before it is still in
    /// doubt.
    pub fn is_settled(&self) -> bool {
        !self.window.is_open()
    }

    /// Steps over good frames of known messages, and what lies between them, that someone else has looked at. Only where
    /// [`Scanner::is_settled`] says so.
    pub fn pass_good(&mut self, len: usize) {
        self.window.consume(len);
        self.in_sync = true;
    }

    /// Looks at the front of `unread`.
    #[inline]
    pub fn next(&mut self, unread: &[u8], registry: &Registry) -> Found {
        match self.policy {
            Resync::Skip => self.next_skip(unread, registry),
            Resync::Rescan => self.next_rescan(unread, registry, false),
        }
    }

    /// The good frame of a known message at the front, if there is one: its length and definition.
    ///
    /// That is nearly always so, and asking for this alone is cheaper than [`Scanner::next`], which has to be asked next
    /// where the answer is no.
    #[inline(always)] // measured: as a call it returns through memory, which stalls
    pub fn next_good(&mut self, unread: &[u8], registry: &Registry) -> Option<(usize, Entry)> {
        if self.policy == Resync::Rescan && self.window.is_open() {
            return None;
        }
        let header_len = match unread {
            [STX_V2, _, flags, ..] if flags & !IFLAG_SIGNED == 0 => HEADER_LEN_V2,
            [STX_V1, ..] => HEADER_LEN_V1,
            _ => return None,
        };
        let len = claimed_len(unread)?;
        let frame = unread.get(..len)?;
        let msgid = match *frame {
            [STX_V2, _, _, _, _, _, _, a, b, c, ..] => u32::from_le_bytes([a, b, c, 0]),
            [_, _, _, _, _, msgid, ..] => msgid.into(),
            _ => return None,
        };
        let entry = registry.lookup(msgid)?;
        let body_end = header_len + usize::from(frame[1]);
        let received = u16::from_le_bytes([frame[body_end], frame[body_end + 1]]);
        let calculated = x25::push(x25::checksum(&frame[1..body_end]), entry.crc_extra);
        self.window.count(body_end - 1);
        if calculated != received && !self.ignore_checksum {
            return None;
        }
        if self.policy == Resync::Rescan {
            self.in_sync = true;
            self.window.consume(len);
        }
        Some((len, entry))
    }

    /// Looks at the front of the last bytes of a stream. Under `Rescan` a frame that the end cuts off is rejected, so
    /// that good frames behind a false STX are still found; under `Skip` it stays incomplete.
    pub fn next_at_end(&mut self, unread: &[u8], registry: &Registry) -> Found {
        match self.policy {
            Resync::Skip => self.next_skip(unread, registry),
            Resync::Rescan => self.next_rescan(unread, registry, true),
        }
    }

    #[inline(always)] // measured: 17 instead of 21 ns per frame in a caller's loop
    fn next_skip(&self, unread: &[u8], registry: &Registry) -> Found {
        let Some(len) = claimed_len(unread) else { return short_or_noise(unread) };
        let (Some(frame), Some(header)) = (unread.get(..len), Header::parse(unread)) else {
            return Found::Incomplete { needed: len };
        };
        if header.incompat_flags & !IFLAG_SIGNED != 0 {
            return Found::Rejected {
                len,
                error: FrameError::IncompatFlags(header.incompat_flags),
            };
        }
        let entry = registry.lookup(header.msgid);
        let Some(Entry { crc_extra, .. }) = entry else {
            return Found::Frame { len, header, entry };
        };
        let body_end = header.len() + usize::from(header.payload_len);
        let received = u16::from_le_bytes([frame[body_end], frame[body_end + 1]]);
        let calculated = x25::push(x25::checksum(&frame[1..body_end]), crc_extra);
        self.window.count(body_end - 1);
        if calculated == received || self.ignore_checksum {
            return Found::Frame { len, header, entry };
        }
        let error = FrameError::BadChecksum { msgid: header.msgid, received, calculated };
        Found::Rejected { len, error }
    }

    #[inline(always)] // as above
    fn next_rescan(&mut self, unread: &[u8], registry: &Registry, at_end: bool) -> Found {
        // Nearly always a good frame follows a good frame.
        if !self.window.is_open()
            && let found @ Found::Frame { len, entry: Some(_), .. } =
                self.next_skip(unread, registry)
        {
            self.in_sync = true;
            self.window.consume(len);
            return found;
        }
        self.next_in_doubt(unread, registry, at_end)
    }

    #[inline(never)]
    fn next_in_doubt(&mut self, unread: &[u8], registry: &Registry, at_end: bool) -> Found {
        let found = match self.judge(unread, 0, registry, at_end) {
            None => short_or_noise(unread),
            Some(Verdict::Need { total }) => Found::Incomplete { needed: total },
            Some(Verdict::Accept { len, header, entry }) => Found::Frame { len, header, entry },
            Some(Verdict::Reject { error }) => {
                self.in_sync = false;
                Found::Rejected { len: self.junk_len(unread, registry, at_end), error }
            }
        };
        match found {
            Found::Frame { len, .. } => {
                self.in_sync = true;
                self.window.consume(len);
            }
            Found::Noise { len } | Found::Rejected { len, .. } => {
                self.in_sync = false;
                self.window.consume(len);
            }
            Found::Incomplete { .. } => {}
        }
        found
    }

    /// How far the junk reaches that starts with a rejected candidate at the front: to the next candidate that is a
    /// frame or may become one.
    fn junk_len(&mut self, unread: &[u8], registry: &Registry, at_end: bool) -> usize {
        let mut at = 1;
        loop {
            at += distance_to_stx(&unread[at..]);
            match self.judge(unread, at, registry, at_end) {
                Some(Verdict::Reject { .. }) => at += 1,
                Some(Verdict::Accept { .. } | Verdict::Need { .. }) | None => return at,
            }
        }
    }

    /// Judges the candidate at `unread[at..]`; `None` if the byte there is not an STX.
    #[inline]
    fn judge(
        &mut self,
        unread: &[u8],
        at: usize,
        registry: &Registry,
        at_end: bool,
    ) -> Option<Verdict> {
        let bytes = &unread[at..];
        if !bytes.first().is_some_and(|&byte| is_stx(byte)) {
            return None;
        }
        // The flags alone may decide, without the rest of the frame.
        if let &[STX_V2, _, flags, ..] = bytes
            && flags & !IFLAG_SIGNED != 0
        {
            return Some(Verdict::Reject { error: FrameError::IncompatFlags(flags) });
        }
        let total = claimed_len(bytes).unwrap_or(MIN_LOOK);
        let header = Header::parse(bytes).filter(|_| bytes.len() >= total);
        Some(match header {
            Some(header) => self.judge_complete(unread, at, header, registry),
            None if at_end => Verdict::Reject {
                error: FrameError::Truncated {
                    needed: total as u16,
                    available: bytes.len() as u16,
                },
            },
            None => Verdict::Need { total },
        })
    }

    #[inline]
    fn judge_complete(
        &mut self,
        unread: &[u8],
        at: usize,
        header: Header,
        registry: &Registry,
    ) -> Verdict {
        let msgid = header.msgid;
        let entry = registry.lookup(msgid);
        let accept = |entry| Verdict::Accept { len: header.frame_len(), header, entry };
        if self.ignore_checksum {
            return accept(entry);
        }
        let body_end = at + header.len() + usize::from(header.payload_len);
        let received = u16::from_le_bytes([unread[body_end], unread[body_end + 1]]);
        let register = self.window.checksum(unread, at + 1, body_end);
        let error = match entry {
            Some(Entry { crc_extra, .. }) => {
                let calculated = x25::push(register, crc_extra);
                if calculated == received {
                    return accept(entry);
                }
                FrameError::BadChecksum { msgid, received, calculated }
            }
            None => FrameError::ImplausibleUnknown { msgid },
        };
        let extra = x25::implied_extra(register, received);
        let other = extra.and_then(|extra| registry.other(msgid, extra));
        let other = other.filter(|&other| fits(&header, other));
        if other.is_some_and(|other| registry.is_merged_in(msgid, other.crc_extra)) {
            return accept(other);
        }
        let claim = match (entry, other) {
            _ if self.accept_unverified => Claim::UnknownId,
            (_, Some(_)) => Claim::KnownLayout,
            (None, None) => Claim::UnknownId,
            (Some(_), None) => Claim::OtherDefinition,
        };
        if self.evidence.believe(&header, claim, extra, received, self.in_sync) {
            return accept(other);
        }
        self.window.open(unread, at + 1, body_end);
        Verdict::Reject { error }
    }
}

/// Bytes that say how long a frame is.
const MIN_LOOK: usize = 3;

#[inline]
pub(crate) fn is_stx(byte: u8) -> bool {
    byte == STX_V1 || byte == STX_V2
}

/// Bytes before the next STX, or all of them.
#[inline]
pub fn distance_to_stx(bytes: &[u8]) -> usize {
    if bytes.first().is_some_and(|&byte| is_stx(byte)) {
        return 0;
    }
    memchr::memchr2(STX_V1, STX_V2, bytes).unwrap_or(bytes.len())
}

/// The outcome where the front is too short to tell a length, or no STX.
fn short_or_noise(unread: &[u8]) -> Found {
    match distance_to_stx(unread) {
        0 if unread.is_empty() => Found::Incomplete { needed: 1 },
        0 => Found::Incomplete { needed: MIN_LOOK },
        len => Found::Noise { len },
    }
}

#[cfg(test)]
mod tests;
