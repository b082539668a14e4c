//! Records of a log that are checked ahead of being asked for.
//!
//! Entering and leaving reader, scanner and checksum for each record costs as much as their work; a loop over a few
//! hundred records does not pay it. Its records are valid as long as reading goes on where it expects.

use std::sync::Arc;

use crate::registry::Registry;
use crate::scan::{Resync, Scanner};

/// Records looked at in one go, at most: they stay in the processor's cache until they are asked for.
const MOST: usize = 256;

/// A good frame of a known message.
#[derive(Clone, Copy)]
pub struct Checked {
    /// Where the record begins.
    offset: u64,
    /// Index of the message type.
    pub index: u16,
    /// Bytes of the frame.
    pub len: u16,
}

/// The conditions under which a record is good.
#[derive(Clone, Copy)]
pub struct Rules<'a> {
    /// The definitions of messages.
    pub registry: &'a Arc<Registry>,
    /// Frames with a wrong checksum are good.
    pub ignore_checksum: bool,
    /// Bytes in front of each frame.
    pub lead: usize,
}

/// The records that were checked ahead.
pub struct Ahead {
    records: Vec<Checked>,
    next: usize,
    /// The scanner that checked the records. `registry` keeps its definitions alive: no others get their address.
    scanner: Scanner,
    registry: Option<Arc<Registry>>,
    /// Records to look at next time: few after a jump, since the next jump may be near.
    wanted: usize,
}

impl Default for Ahead {
    fn default() -> Self {
        // A good frame is one under either policy, and this one needs no memory of what was before.
        let scanner = Scanner::new(Resync::Skip);
        Self { records: Vec::new(), next: 0, scanner, registry: None, wanted: 1 }
    }
}

impl Ahead {
    /// The record at `offset`, if it is known to be good.
    #[inline]
    pub fn get(&self, offset: u64, rules: Rules<'_>) -> Option<Checked> {
        let next = self.records.get(self.next).copied()?;
        (next.offset == offset && self.obeys(rules)).then_some(next)
    }

    /// The record at `offset` comes next.
    pub fn expects(&self, offset: u64) -> bool {
        self.records.get(self.next).is_some_and(|next| next.offset == offset)
    }

    fn obeys(&self, rules: Rules<'_>) -> bool {
        self.scanner.ignore_checksum == rules.ignore_checksum
            && self.registry.as_ref().is_some_and(|known| Arc::ptr_eq(known, rules.registry))
    }

    /// Reading goes on behind the record that comes next.
    #[inline]
    pub fn advance(&mut self) {
        self.next += 1;
    }

    /// Forgets everything, since the file is read elsewhere.
    pub fn clear(&mut self) {
        self.records.clear();
        self.next = 0;
        self.wanted = 1;
    }

    fn begin(&mut self, rules: Rules<'_>) {
        self.records.clear();
        self.next = 0;
        if !self.obeys(rules) {
            self.scanner.ignore_checksum = rules.ignore_checksum;
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
    pub fn fill(&mut self, mut offset: u64, mut bytes: &[u8], rules: Rules<'_>) {
        self.begin(rules);
        while self.records.len() < self.wanted
            && let Some(len) = self.check(offset, bytes, rules)
        {
            offset += len as u64;
            bytes = &bytes[len..];
        }
        self.wanted = (2 * self.wanted).min(MOST);
    }

    /// Checks the records at `offsets`, as far as their bytes are at hand.
    pub fn fill_at<'a>(
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::builtin;
    use crate::frame::{FrameBuffer, Header};
    use mavwire_schema::WireVersion::V2;

    #[test]
    fn records_are_known_up_to_a_damaged_one() {
        let registry = Arc::new(Registry::new(builtin::dialect("minimal", V2).expect("built in")));
        let entry = registry.lookup(0).expect("HEARTBEAT");
        let mut frame = FrameBuffer::default();
        frame.encode(Header::new(V2, 0, 1, 1, 0), &[1; 9], entry.crc_extra).expect("it fits");
        let mut log = frame.repeat(4);
        let len = log.len() / 4;
        log[2 * len + 12] ^= 1;
        let rules = Rules { registry: &registry, ignore_checksum: false, lead: 0 };
        let mut ahead = Ahead::default();
        let mut known = Vec::new();
        for offset in (0..4).map(|number| number * len) {
            if !ahead.expects(offset as u64) {
                ahead.fill(offset as u64, &log[offset..], rules);
            }
            let record = ahead.get(offset as u64, rules);
            known.push(record.map(|record| usize::from(record.len)));
            if record.is_some() {
                ahead.advance();
            }
        }
        assert_eq!(known, [Some(len), Some(len), None, Some(len)]);
    }
}
