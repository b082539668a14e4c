//! Checksums of many overlapping candidates in constant time each.
//!
//! Re-scanning a rejected frame tries every STX inside it, and each candidate may again claim 280 bytes: computing every
//! checksum from scratch costs up to 280 times the input (`FE FE FE ...`). A CRC is linear: with the register after every
//! prefix of the bytes (from zero), the register over any part is that at its end xor that at its start moved on by the
//! part's length. So the first rejected frame opens a window of prefix registers, each byte enters it once, and it lasts
//! until scanning has left the bytes it covers.

use crate::x25;

/// Entries kept behind the scanning position before they are dropped in one go.
const SLACK: usize = 1024;

/// Prefix registers over the bytes from `start` on. Positions are counted from the start of the stream.
#[derive(Debug, Clone, Default)]
pub(super) struct Window {
    /// Position of the front of the unread bytes.
    front: u64,
    /// Position of the first byte that `prefixes` covers.
    start: u64,
    /// `prefixes[n]`: register after the first `n` covered bytes; empty while no window is open.
    prefixes: Vec<u16>,
    /// Bytes that went through a register, for tests of the linear bound.
    #[cfg(test)]
    pub(super) work: std::cell::Cell<u64>,
}

impl Window {
    /// The front moves on.
    #[inline]
    pub(super) fn consume(&mut self, len: usize) {
        self.front += len as u64;
    }

    /// The window covers bytes behind the front.
    #[inline]
    pub(super) fn is_open(&self) -> bool {
        self.start + self.prefixes.len() as u64 > self.front + 1
    }

    /// Checksum of `unread[from..to]` (from the initial register), where `from` never decreases over the stream.
    #[inline]
    pub(super) fn checksum(&mut self, unread: &[u8], from: usize, to: usize) -> u16 {
        let Some(first) = self.index_of(from) else {
            self.count(to - from);
            return x25::checksum(&unread[from..to]);
        };
        self.extend(unread, to);
        let last = first + (to - from);
        let register =
            self.prefixes[last] ^ x25::advance(self.prefixes[first] ^ x25::INIT, to - from);
        self.forget_before(first);
        register
    }

    /// The candidate with the checked bytes `unread[from..to]` was rejected: cover them, unless they are already.
    pub(super) fn open(&mut self, unread: &[u8], from: usize, to: usize) {
        if self.index_of(from).is_none() {
            self.start = self.front + from as u64;
            self.prefixes.clear();
            self.prefixes.push(0);
            self.extend(unread, to);
        }
    }

    /// Index into `prefixes` of the position `at` bytes behind the front.
    #[inline]
    fn index_of(&self, at: usize) -> Option<usize> {
        let offset = (self.front + at as u64).checked_sub(self.start)?;
        usize::try_from(offset).ok().filter(|&index| index < self.prefixes.len())
    }

    /// Covers the bytes before `unread[to]`.
    fn extend(&mut self, unread: &[u8], to: usize) {
        let Some(&last) = self.prefixes.last() else { return };
        let end = self.start + self.prefixes.len() as u64 - 1;
        let from = (end - self.front) as usize;
        let Some(new) = unread.get(from..to) else { return };
        let mut register = last;
        self.prefixes.extend(new.iter().map(|&byte| {
            register = x25::push(register, byte);
            register
        }));
        self.count(to - from);
    }

    /// Bounds the memory: positions only grow.
    fn forget_before(&mut self, index: usize) {
        if index > SLACK {
            self.prefixes.drain(..index);
            self.start += index as u64;
        }
    }

    /// Takes note of bytes that go through a register; in tests only.
    #[cfg(test)]
    pub(super) fn count(&self, bytes: usize) {
        self.work.set(self.work.get() + bytes as u64);
    }

    #[cfg(not(test))]
    #[inline]
    #[allow(clippy::unused_self)] // the counter exists in tests only
    pub(super) fn count(&self, _bytes: usize) {}

    #[cfg(test)]
    pub(super) fn covered(&self) -> usize {
        self.prefixes.len()
    }
}
