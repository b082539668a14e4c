//! The good records of a log that may be damaged.
//!
//! The frames are found by the re-scanning scanner over the bytes behind each stamp, so a false STX in a stamp or a
//! record with a wrong length costs no good record. A frame's stamp is the eight bytes in front of it. A raw stream is a
//! log whose records have no stamp.

use super::{STAMP_LEN, Stamp};
use crate::frame::Header;
use crate::registry::{Entry, Registry};
use crate::scan::{Found, Resync, Scanner};

/// The next item in the unread bytes of a log.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FoundRecord {
    /// A record; `len` bytes, of which the first eight are the stamp, unless it has none.
    Record {
        /// Bytes of the record.
        len: usize,
        /// Its time; 0 where it has none.
        stamp: Stamp,
        /// The header of its frame.
        header: Header,
        /// The message definition; `None` for an unknown id.
        entry: Option<Entry>,
    },
    /// Bytes that belong to no record.
    Junk {
        /// At least 1.
        len: usize,
    },
    /// The start of a record.
    Incomplete {
        /// Bytes, counted from the front, that must be there before the next look can say more.
        needed: usize,
    },
}

/// The position of the frame scanner.
#[derive(Debug, Clone, Copy)]
enum Ahead {
    /// At the front, where a stamp should start.
    AtFront,
    /// Behind the front's stamp.
    BehindStamp,
    /// Behind the frame of the record at the front, which is this.
    BehindFrame { len: usize, header: Header, entry: Option<Entry> },
}

/// Finds records, from the start of a log or from anywhere in it. `unread` must start where the previous outcome ended, as for
/// [`Scanner`].
#[derive(Debug, Clone)]
pub struct RecordScanner {
    /// Bytes in front of each frame.
    lead: usize,
    scanner: Scanner,
    ahead: Ahead,
}

impl Default for RecordScanner {
    fn default() -> Self {
        Self::with_lead(STAMP_LEN)
    }
}

impl RecordScanner {
    pub(super) fn with_lead(lead: usize) -> Self {
        Self { lead, scanner: Scanner::new(Resync::Rescan), ahead: Ahead::AtFront }
    }

    /// Goes on elsewhere in the log. The definitions that its senders use are still known.
    pub fn restart(&mut self) {
        self.scanner.restart();
        self.ahead = Ahead::AtFront;
    }

    /// Bytes in front of each frame: 8, or 0 in a raw stream.
    pub fn lead(&self) -> usize {
        self.lead
    }

    /// Whether the records of a [`super::Run`] that starts at the front are what [`RecordScanner::next`] would find.
    pub fn is_settled(&self) -> bool {
        matches!(self.ahead, Ahead::AtFront) && self.scanner.is_settled()
    }

    /// Steps over `len` bytes of a run, where [`RecordScanner::is_settled`] allows it.
    pub fn pass_run(&mut self, len: usize) {
        self.scanner.pass_good(len);
    }

    /// Bytes that went through a checksum.
    #[cfg(test)]
    pub(super) fn work(&self) -> u64 {
        self.scanner.work()
    }

    /// Looks at the front of `unread`. `at_end` says that no more bytes follow: then only an empty rest is incomplete.
    pub fn next(&mut self, unread: &[u8], registry: &Registry, at_end: bool) -> FoundRecord {
        if let Ahead::BehindFrame { len, header, entry } = self.ahead {
            return self.record(unread, len, header, entry);
        }
        let Some(frames) = unread.get(self.lead..) else {
            return self.without_frame(unread, self.lead + 1, at_end);
        };
        if let Ahead::AtFront = self.ahead {
            self.scanner.skip(self.lead);
            self.ahead = Ahead::BehindStamp;
        }
        let mut junk = 0;
        loop {
            match self.next_frame(&frames[junk..], registry, at_end) {
                Found::Frame { len, header, entry } if junk == 0 => {
                    return self.record(unread, len, header, entry);
                }
                Found::Frame { len, header, entry } => {
                    self.ahead = Ahead::BehindFrame { len, header, entry };
                    return FoundRecord::Junk { len: junk };
                }
                Found::Noise { len } | Found::Rejected { len, .. } => junk += len,
                Found::Incomplete { .. } if junk > 0 => return FoundRecord::Junk { len: junk },
                Found::Incomplete { needed } => {
                    return self.without_frame(unread, self.lead + needed, at_end);
                }
            }
        }
    }

    fn next_frame(&mut self, bytes: &[u8], registry: &Registry, at_end: bool) -> Found {
        if at_end {
            self.scanner.next_at_end(bytes, registry)
        } else {
            self.scanner.next(bytes, registry)
        }
    }

    /// The record at the front, whose frame the scanner has found.
    fn record(
        &mut self,
        unread: &[u8],
        len: usize,
        header: Header,
        entry: Option<Entry>,
    ) -> FoundRecord {
        self.ahead = Ahead::AtFront;
        let stamp = Stamp::parse(unread).filter(|_| self.lead > 0).unwrap_or(Stamp(0));
        FoundRecord::Record { len: self.lead + len, stamp, header, entry }
    }

    /// Handles a stamp without a frame behind it, yet or for ever.
    fn without_frame(&mut self, unread: &[u8], needed: usize, at_end: bool) -> FoundRecord {
        if at_end && !unread.is_empty() {
            self.ahead = Ahead::AtFront;
            return FoundRecord::Junk { len: unread.len() };
        }
        FoundRecord::Incomplete { needed }
    }
}
