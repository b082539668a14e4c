//! The peers of a datagram link, and the half frames that each of them left behind.
//!
//! Frames may be cut anywhere, so every peer's bytes are joined with its own only. A peer costs a few bytes, but anyone can
//! send from any number of addresses: the table is capped, and peers that never sent a good frame make room first.

use mavwire_core::parser::Parser;

use crate::address::Address;

/// Peers remembered.
const MAX_PEERS: usize = 256;
/// How often Python is told that a peer is alive.
const TELL_INTERVAL: f64 = 0.01;

struct Peer {
    address: Address,
    /// The start of a frame whose rest is still to come.
    partial: Vec<u8>,
    /// When it sent last, counted in datagrams.
    heard: u64,
    /// When Python was told that it sent a good message; `None` before the first.
    told: Option<f64>,
}

/// The peers of a link.
#[derive(Default)]
pub struct Peers {
    known: Vec<Peer>,
    /// Whose bytes the parser holds.
    current: usize,
    datagrams: u64,
    /// The current peer is another than the one announced last.
    changed: bool,
    /// Peers that had to make room.
    pub forgotten: u64,
}

impl Peers {
    /// Makes `from` the peer whose bytes the parser gets next.
    #[inline]
    pub fn switch(&mut self, parser: &mut Parser, from: Address) {
        self.datagrams += 1;
        if self.known.get(self.current).is_none_or(|peer| peer.address != from) {
            self.change(parser, from);
        }
        self.known[self.current].heard = self.datagrams;
    }

    #[cold]
    fn change(&mut self, parser: &mut Parser, from: Address) {
        if let Some(peer) = self.known.get_mut(self.current) {
            peer.partial.clear();
            peer.partial.extend_from_slice(parser.unread());
            if !peer.partial.is_empty() {
                parser.clear();
            }
        }
        self.current = self.place(from).unwrap_or_else(|| self.add(from));
        self.changed = true;
        let peer = &mut self.known[self.current];
        if !peer.partial.is_empty() {
            parser.replace(&peer.partial);
            peer.partial.clear();
        }
    }

    fn add(&mut self, address: Address) -> usize {
        if self.known.len() >= MAX_PEERS {
            let silent = (0..self.known.len())
                .min_by_key(|&n| (self.known[n].told.is_some(), self.known[n].heard));
            self.known.swap_remove(silent.unwrap_or(0));
            self.forgotten += 1;
        }
        self.known.push(Peer { address, partial: Vec::new(), heard: 0, told: None });
        self.known.len() - 1
    }

    /// The current peer.
    pub fn current(&self) -> Option<Address> {
        self.known.get(self.current).map(|peer| peer.address)
    }

    /// The index of a peer in the table, which is nearly always the current one.
    #[inline]
    fn place(&self, address: Address) -> Option<usize> {
        if self.known.get(self.current).is_some_and(|peer| peer.address == address) {
            return Some(self.current);
        }
        self.known.iter().position(|peer| peer.address == address)
    }

    /// True if the peer `from`, who just sent something that was good or not, is to be announced.
    #[inline]
    pub fn is_news(&mut self, from: Address, good: bool, now: f64) -> bool {
        let Some(place) = self.place(from) else { return false };
        let peer = &mut self.known[place];
        let is_due = good && peer.told.is_none_or(|told| (now - told).abs() >= TELL_INTERVAL);
        if is_due {
            peer.told = Some(now);
        }
        (place == self.current && std::mem::take(&mut self.changed)) || is_due
    }
}
