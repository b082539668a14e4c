//! Records of a log that are checked ahead of being asked for.
//!
//! Entering and leaving reader, scanner and checksum for each record costs as much as their work; a loop over a few
//! hundred records does not pay it. What the loop finds is good as long as reading goes on where it expects.

use std::sync::Arc;

use mavwire_core::frame::Header;
use mavwire_core::registry::Registry;
use mavwire_core::scan::{Resync, Scanner};

/// Records looked at in one go, at most: they stay in the processor's cache until they are asked for.
const MOST: usize = 256;

/// A good frame of a known message.
#[derive(Clone, Copy)]
pub(crate) struct Checked {
    /// Where the record begins.
    offset: u64,
    /// Index of the message type.
    pub(crate) index: u16,
    /// Bytes of the frame.
    pub(crate) len: u16,
}

/// What decides whether a record is good.
#[derive(Clone, Copy)]
pub(crate) struct Rules<'a> {
    pub(crate) registry: &'a Arc<Registry>,
    pub(crate) ignore_checksum: bool,
    /// Bytes in front of each frame.
    pub(crate) lead: usize,
    /// A signed record counts only if another follows: its signature may have lost bytes.
    pub(crate) looks_behind_signed: bool,
}

/// See the module.
pub(crate) struct Ahead {
    records: Vec<Checked>,
    next: usize,
    /// What the records were checked with. The definitions are held, so that no others can take their address.
    scanner: Scanner,
    looks_behind_signed: bool,
    registry: Option<Arc<Registry>>,
    /// Records to look at next time: few after a jump, since the next jump may be near.
    wanted: usize,
}

impl Ahead {
    pub(crate) fn new() -> Self {
        // A good frame is one under either policy, and this one needs no memory of what was before.
        let scanner = Scanner::new(Resync::Skip);
        Self {
            records: Vec::new(),
            next: 0,
            scanner,
            looks_behind_signed: false,
            registry: None,
            wanted: 1,
        }
    }

    /// The record at `offset`, if it is known to be good.
    #[inline]
    pub(crate) fn get(&self, offset: u64, rules: Rules<'_>) -> Option<Checked> {
        let next = self.records.get(self.next).copied()?;
        (next.offset == offset && self.obeys(rules)).then_some(next)
    }

    /// The record at `offset` comes next.
    pub(crate) fn expects(&self, offset: u64) -> bool {
        self.records.get(self.next).is_some_and(|next| next.offset == offset)
    }

    fn obeys(&self, rules: Rules<'_>) -> bool {
        self.scanner.ignore_checksum == rules.ignore_checksum
            && self.looks_behind_signed == rules.looks_behind_signed
            && self.registry.as_ref().is_some_and(|known| Arc::ptr_eq(known, rules.registry))
    }

    /// Reading goes on behind the record that comes next.
    #[inline]
    pub(crate) fn advance(&mut self) {
        self.next += 1;
    }

    /// Forgets everything, since the file is read elsewhere.
    pub(crate) fn clear(&mut self) {
        self.records.clear();
        self.next = 0;
        self.wanted = 1;
    }

    fn begin(&mut self, rules: Rules<'_>) {
        self.records.clear();
        self.next = 0;
        if !self.obeys(rules) {
            self.scanner.ignore_checksum = rules.ignore_checksum;
            self.looks_behind_signed = rules.looks_behind_signed;
            self.registry = Some(Arc::clone(rules.registry));
        }
    }

    /// Checks the record at the front of `bytes`, which stand at `offset`; gives its length.
    #[inline]
    fn check(&mut self, offset: u64, bytes: &[u8], rules: Rules<'_>) -> Option<usize> {
        let (len, entry) = self.scanner.next_good(bytes.get(rules.lead..)?, rules.registry)?;
        self.records.push(Checked { offset, index: entry.index, len: len as u16 });
        Some(rules.lead + len)
    }

    /// Checks the records at the front of `bytes`, which stand at `offset`.
    pub(crate) fn fill(&mut self, mut offset: u64, mut bytes: &[u8], rules: Rules<'_>) {
        self.begin(rules);
        let mut last = bytes;
        // One more where the last one may be left out: else a signed record would never be known ahead.
        let wanted = self.wanted + usize::from(rules.looks_behind_signed);
        while self.records.len() < wanted
            && let Some(len) = self.check(offset, bytes, rules)
        {
            last = bytes;
            offset += len as u64;
            bytes = &bytes[len..];
        }
        if rules.looks_behind_signed
            && let Some(frame) = last.get(rules.lead..)
            && Header::parse(frame).is_some_and(|header| header.is_signed())
        {
            self.records.pop();
        }
        self.wanted = (2 * self.wanted).min(MOST);
    }

    /// Checks the records at `offsets`, as far as their bytes are at hand.
    pub(crate) fn fill_at<'a>(
        &mut self,
        offsets: &[u64],
        bytes_at: impl Fn(u64) -> &'a [u8],
        rules: Rules<'_>,
    ) {
        self.begin(rules);
        for &offset in offsets.iter().take(MOST) {
            if self.check(offset, bytes_at(offset), rules).is_none() {
                break;
            }
        }
    }
}
