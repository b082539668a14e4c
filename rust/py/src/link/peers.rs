//! Who sends to a datagram link, and the half frames that each sender left behind.
//!
//! Frames may be cut anywhere, so every peer's bytes are joined with its own only. A peer costs a few bytes, but anyone can
//! send from any number of addresses: the table is capped, and peers that never sent a good frame make room first.

use core::net::IpAddr;

use mavwire_core::peer_slots::{Origin, Slot, SlotHolder, Usefulness, slot_for};
use mavwire_io::address::Address;
use pyo3::prelude::*;
use pyo3::types::{PyString, PyTuple};

use crate::protocol::parser::Parser;

/// Peers remembered.
const MAX_PEERS: usize = 256;
/// How often Python is told that a peer is alive.
const TELL_INTERVAL: f64 = 0.01;

struct Peer {
    address: Address,
    /// The address as Python shows it.
    shown: Option<Py<PyTuple>>,
    /// The start of a frame whose rest is still to come.
    partial: Vec<u8>,
    /// When it sent last, counted in datagrams.
    heard: u64,
    /// When Python was told that it sent a good message; `None` before the first.
    told: Option<f64>,
}

/// The peers of a link.
#[derive(Default)]
pub(crate) struct Peers {
    known: Vec<Peer>,
    /// Whose bytes the parser holds.
    current: usize,
    datagrams: u64,
    /// The current peer is another than the one announced last.
    changed: bool,
    /// Peers that had to make room.
    pub(crate) forgotten: u64,
}

impl Peers {
    /// Makes `from` the peer whose bytes the parser gets next.
    #[inline]
    pub(crate) fn switch(&mut self, parser: &mut Parser, from: Address) {
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
        self.known.push(Peer { address, shown: None, partial: Vec::new(), heard: 0, told: None });
        self.known.len() - 1
    }

    /// The current peer.
    pub(crate) fn current(&self) -> Option<Address> {
        self.known.get(self.current).map(|peer| peer.address)
    }

    /// A peer as Python shows it, if that was needed before.
    pub(crate) fn shown<'py>(
        &self,
        py: Python<'py>,
        address: Address,
    ) -> Option<Bound<'py, PyTuple>> {
        let peer = self.known.get(self.place(address)?)?;
        peer.shown.as_ref().map(|shown| shown.bind(py).clone())
    }

    /// Where a peer stands in the table, which is nearly always the current one.
    #[inline]
    fn place(&self, address: Address) -> Option<usize> {
        if self.known.get(self.current).is_some_and(|peer| peer.address == address) {
            return Some(self.current);
        }
        self.known.iter().position(|peer| peer.address == address)
    }

    /// Keeps what Python shows for a peer.
    pub(crate) fn show(&mut self, address: Address, shown: &Bound<'_, PyTuple>) {
        if let Some(place) = self.place(address) {
            self.known[place].shown = Some(shown.clone().unbind());
        }
    }

    /// True if the peer `from`, who just sent something that was good or not, is to be announced.
    #[inline]
    pub(crate) fn is_news(&mut self, from: Address, good: bool, now: f64) -> bool {
        let Some(place) = self.place(from) else { return false };
        let peer = &mut self.known[place];
        let is_due = good && peer.told.is_none_or(|told| (now - told).abs() >= TELL_INTERVAL);
        if is_due {
            peer.told = Some(now);
        }
        (place == self.current && std::mem::take(&mut self.changed)) || is_due
    }
}

/// The position of the peer that a full link replaces by a new one from `host`; None if all peers stay. Each peer is given
/// by its host, whether it has sent a message to a system, and the seconds since its last message.
#[pyfunction]
pub(crate) fn peer_to_replace(host: &str, peers: Vec<(String, bool, f64)>) -> Option<usize> {
    let holders: Vec<SlotHolder> = peers
        .into_iter()
        .map(|(host, is_useful, silence)| SlotHolder {
            origin: origin(&host),
            usefulness: if is_useful { Usefulness::Useful } else { Usefulness::Heard },
            silence: (silence * 1e6) as u64,
        })
        .collect();
    match slot_for(origin(host), &holders, holders.len()) {
        Slot::Replace(position) => Some(position),
        Slot::Free | Slot::Refused => None,
    }
}

/// The origin of a host as Python shows it. Host names share one origin.
fn origin(host: &str) -> Origin {
    let address = host.split('%').next().unwrap_or(host).parse();
    Origin::from(address.unwrap_or(IpAddr::from([0; 4])))
}

/// An address as Python's sockets show it.
pub(crate) fn to_python(py: Python<'_>, address: Address) -> PyResult<Bound<'_, PyTuple>> {
    let host = PyString::new(py, &address.host());
    match address.flow_and_scope() {
        None => (host, address.port()).into_pyobject(py),
        Some((flow, scope)) => (host, address.port(), flow, scope).into_pyobject(py),
    }
}

/// The same backwards; `None` for what is no numeric address.
pub(crate) fn from_python(address: &Bound<'_, PyAny>) -> Option<Address> {
    let parts = address.cast::<PyTuple>().ok()?;
    let number = |n: usize| parts.get_item(n).ok()?.extract::<u32>().ok();
    let host = parts.get_item(0).ok()?.extract::<String>().ok()?;
    let port = parts.get_item(1).ok()?.extract().ok()?;
    Address::new(&host, port, number(2).unwrap_or(0), number(3).unwrap_or(0))
}
