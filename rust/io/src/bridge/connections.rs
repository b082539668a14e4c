//! Links that are added and removed, connections that come and go.

use std::collections::HashMap;
use std::io;
use std::net::{SocketAddr, TcpListener, UdpSocket};
use std::sync::Arc;
use std::time::Duration;

use mavwire_core::peer_slots::{Origin, Slot, SlotHolder, slot_for};
use mavwire_core::router::LinkId;
use mavwire_core::scan::{Resync, Scanner};

use super::BridgeError;
use super::endpoint::{LinkSpec, Opened, Stream, Wire};
use super::event_loop::{Command, EventLoop, PROGRAM_NAME, TICK, TURNS};
use super::stats::Departed;
use crate::address::Address;
use crate::error_text::in_words;

/// Peers of a UDP server, and connections to a TCP server.
const MAX_PEERS: usize = 64;
/// Ports that only links of the program may use, not peers of servers.
const RESERVED_PORTS: usize = 32;
/// The first pause before a connection is tried again, doubled up to the limit of the link; microseconds.
const FIRST_RETRY: u64 = 250_000;

/// The state of a link besides its ports.
pub(super) enum Kind {
    DatagramServer(Arc<UdpSocket>, HashMap<Address, LinkId>),
    Listener(TcpListener),
    Dialled(LinkId, Dialling),
}

/// The state of a connection that is made again. Times are in microseconds.
#[derive(Debug)]
pub(super) struct Dialling {
    /// When to try again; `None` while connected, being connected, or given up.
    pub(super) at: Option<u64>,
    pub(super) under_way: bool,
    pub(super) connections: u64,
    /// When the last connection came about.
    since: u64,
    /// The next pause, and the longest; `None` to give up after the first connection.
    pause: u64,
    longest: Option<u64>,
}

impl Dialling {
    fn new(longest: Option<Duration>) -> Self {
        let longest = longest.map(|longest| longest.as_micros() as u64);
        Self {
            at: Some(0),
            under_way: false,
            connections: 0,
            since: 0,
            pause: FIRST_RETRY,
            longest,
        }
    }

    fn connected(&mut self, now: u64) {
        (self.at, self.since) = (None, now);
        self.connections += 1;
    }

    fn failed(&mut self, now: u64) {
        let longest = self.longest.unwrap_or(FIRST_RETRY);
        self.at = Some(now + self.pause.min(longest));
        self.pause = (self.pause * 2).min(longest);
    }

    /// A connection has ended over which a good frame came last when it was `heard`. One that was good for something is
    /// made again soon; one that always ends at once is a failure like any other.
    fn ended(&mut self, now: u64, heard: u64) {
        if heard > self.since || now - self.since > self.pause {
            self.pause = FIRST_RETRY;
        }
        if self.longest.is_some() {
            self.failed(now);
        }
    }
}

pub(super) struct Link {
    pub(super) spec: LinkSpec,
    pub(super) kind: Kind,
    pub(super) refused: u64,
    /// Peers that a server got so far.
    pub(super) welcomed: u64,
    pub(super) error: Option<String>,
    /// The numbers of the peers that left, and the junk of senders that are no peers.
    pub(super) departed: Departed,
    /// Looks for frames of senders that are no peers yet, and remembers the definitions that they use.
    pub(super) strangers: Scanner,
    /// A listener that cannot accept, for want of descriptors, is left alone until the next tick.
    pub(super) resting: bool,
}

impl EventLoop {
    /// Adds a link that is open.
    pub(super) fn add(&mut self, spec: LinkSpec, opened: Opened) -> Result<(), BridgeError> {
        let taken = self.links.values().any(|link| link.spec.name == spec.name);
        if taken || spec.name == PROGRAM_NAME {
            return Err(BridgeError::NameTaken(spec.name));
        }
        let number = self.last_number + 1;
        let kind = self.kind(number, &spec, opened)?;
        self.last_number = number;
        self.hub.name_link(number, &spec.name);
        let mut strangers = Scanner::new(Resync::Rescan);
        strangers.accept_unverified = spec.port.forward_unverified;
        let link = Link {
            spec,
            kind,
            refused: 0,
            welcomed: 0,
            error: None,
            departed: Departed::default(),
            strangers,
            resting: false,
        };
        self.links.insert(number, link);
        Ok(())
    }

    fn kind(&mut self, number: u32, spec: &LinkSpec, opened: Opened) -> Result<Kind, BridgeError> {
        let now = self.switch.moment.now;
        let mut add =
            |wire| self.switch.add(number, wire, &spec.port).ok_or(BridgeError::TooManyLinks);
        Ok(match opened {
            Opened::DatagramServer(socket) => Kind::DatagramServer(socket, HashMap::new()),
            Opened::Listener(listener) => Kind::Listener(listener),
            Opened::Dialled(wire) => {
                let mut dialling = Dialling::new(spec.retry);
                if !matches!(wire, Wire::Down) {
                    dialling.connected(now);
                }
                Kind::Dialled(add(wire)?, dialling)
            }
        })
    }

    /// Removes a link, which closes it.
    pub(super) fn remove(&mut self, name: &str) -> Result<(), BridgeError> {
        let found = self.links.iter().find(|(_, link)| link.spec.name == name);
        let number = *found.ok_or_else(|| BridgeError::NoSuchLink(name.to_owned()))?.0;
        self.links.remove(&number);
        self.hub.retire_link(number);
        let ports: Vec<LinkId> =
            self.switch.ports().filter(|port| port.link == number).map(|port| port.id).collect();
        for id in ports {
            self.switch.remove(id);
        }
        Ok(())
    }

    /// Takes the connections that wait at a server.
    pub(super) fn accept(&mut self, number: u32) {
        for _ in 0..TURNS {
            let Some(link) = self.links.get_mut(&number) else { return };
            let Kind::Listener(listener) = &link.kind else { return };
            let (stream, from) = match listener.accept() {
                Ok(accepted) => accepted,
                Err(error) => {
                    use io::ErrorKind::{ConnectionAborted, Interrupted, WouldBlock};
                    let passing = [ConnectionAborted, Interrupted, WouldBlock];
                    link.resting = !passing.contains(&error.kind());
                    return;
                }
            };
            let patience = link.spec.peer_timeout;
            if let Ok(stream) = Stream::tcp(stream, patience) {
                self.welcome(number, Wire::Stream(stream), from); // else dropped, which closes it
            }
        }
    }

    /// A port for a new peer of a server; `None` if there is no room for it.
    pub(super) fn welcome(&mut self, number: u32, wire: Wire, from: SocketAddr) -> Option<LinkId> {
        let origin = Origin::from(from.ip());
        let room = self.free_slot(number, origin);
        let link = self.links.get_mut(&number)?;
        let added = room.then(|| self.switch.add_peer(number, wire, &link.spec.port)).flatten();
        let Some(port) = added else {
            link.refused += 1;
            return None;
        };
        port.peer = Some(from.to_string());
        port.origin = Some(origin);
        link.welcomed += 1;
        Some(port.id)
    }

    /// Whether a new peer of a server gets a slot. A less useful peer may be disconnected for it. If the bridge has no more
    /// ports, the peers of all servers compete.
    fn free_slot(&mut self, number: u32, origin: Origin) -> bool {
        let is_own = |&(link, ..): &(u32, LinkId, SlotHolder)| link == number;
        let mut rivals: Vec<_> = self.switch.peers().collect();
        let is_full = rivals.iter().filter(|rival| is_own(rival)).count() >= MAX_PEERS;
        if !is_full && self.switch.free_ports() > RESERVED_PORTS {
            return true;
        }
        if is_full {
            rivals.retain(is_own);
        }
        let peers: Vec<SlotHolder> = rivals.iter().map(|&(.., peer)| peer).collect();
        let Slot::Replace(n) = slot_for(origin, &peers, peers.len()) else { return false };
        let (number, id, _) = rivals[n];
        let Some(link) = self.links.get_mut(&number) else { return false };
        if let Kind::DatagramServer(_, peers) = &mut link.kind {
            peers.retain(|_, port| *port != id);
        }
        link.departed.add(self.switch.remove(id));
        true
    }

    /// A connection has ended. A server's port is removed; a dialled one is dialled again.
    pub(super) fn close_port(&mut self, id: LinkId, error: Option<io::Error>) {
        let Some(port) = self.switch.port(id) else { return };
        let Some(link) = self.links.get_mut(&port.link) else { return };
        if let Some(error) = error {
            link.error = Some(in_words(&error));
        }
        if let Kind::Dialled(_, dialling) = &mut link.kind {
            port.disconnect();
            let heard = port.heard;
            dialling.ended(self.switch.moment.now, heard);
        } else {
            link.departed.add(self.switch.remove(id));
        }
    }

    /// Dials the links that are due, each on a thread of its own.
    pub(super) fn redial(&mut self) {
        let now = self.switch.moment.now;
        for (&number, link) in &mut self.links {
            let Kind::Dialled(_, dialling) = &mut link.kind else { continue };
            if dialling.under_way || dialling.at.is_none_or(|at| at > now) {
                continue;
            }
            let (endpoint, patience) = (link.spec.endpoint.clone(), link.spec.peer_timeout);
            let waker = self.waker.clone();
            let dial = move || {
                // The bridge may have stopped in the meantime, and then nobody wants the answer.
                let _ = waker.send(Command::Dialled(number, endpoint.dial(patience)));
            };
            match std::thread::Builder::new().name("mavwire-dial".into()).spawn(dial) {
                Ok(_) => (dialling.under_way, dialling.at) = (true, None),
                Err(_) => dialling.at = Some(now + TICK),
            }
        }
    }

    /// Takes the result of an attempt to connect.
    pub(super) fn dialled(&mut self, number: u32, result: io::Result<Wire>) {
        let now = self.switch.moment.now;
        let Some(link) = self.links.get_mut(&number) else { return };
        let Kind::Dialled(id, dialling) = &mut link.kind else { return };
        dialling.under_way = false;
        match result {
            Ok(wire) => {
                dialling.connected(now);
                link.error = None;
                if let Some(port) = self.switch.port(*id) {
                    port.connect(wire);
                }
            }
            Err(error) => {
                link.error = Some(in_words(&error));
                dialling.failed(now);
            }
        }
    }

    /// Forgets peers of UDP servers that sent no good frame for too long.
    pub(super) fn forget_silent_peers(&mut self) {
        let now = self.switch.moment.now;
        for link in self.links.values_mut() {
            let Kind::DatagramServer(_, peers) = &mut link.kind else { continue };
            let timeout = link.spec.peer_timeout.as_micros() as u64;
            let silent: Vec<LinkId> = peers
                .values()
                .copied()
                .filter(|&id| {
                    let port = self.switch.port(id);
                    port.is_none_or(|port| now.saturating_sub(port.heard) > timeout)
                })
                .collect();
            peers.retain(|_, id| !silent.contains(id));
            for id in silent {
                link.departed.add(self.switch.remove(id));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pauses_grow_until_a_connection_was_good_for_something() {
        let mut dialling = Dialling::new(Some(Duration::from_secs(1)));
        let mut pause = |now, heard: Option<u64>, lasted: Option<u64>| {
            let end = now + lasted.unwrap_or(0);
            if lasted.is_some() {
                dialling.connected(now);
                dialling.ended(end, heard.unwrap_or(0));
            } else {
                dialling.failed(end);
            }
            dialling.at.map(|at| (at - end) / 1_000)
        };
        let (second, at_once) = (1_000_000, Some(0));
        let refused = [10, 20, 30, 40].map(|now| pause(now * second, None, None));
        assert_eq!(refused, [250, 500, 1_000, 1_000].map(Some));
        let hung_up = [50, 60].map(|now| pause(now * second, None, at_once));
        assert_eq!(hung_up, [1_000, 1_000].map(Some), "accepted, and that was all");
        assert_eq!(pause(70 * second, Some(70 * second + 1), Some(2)), Some(250), "a frame came");
        let hung_up = [80, 90].map(|now| pause(now * second, Some(70 * second + 1), at_once));
        assert_eq!(hung_up, [500, 1_000].map(Some));
        assert_eq!(pause(100 * second, None, Some(5 * second)), Some(250), "it lasted");
    }

    #[test]
    fn without_retry_the_first_connection_is_the_last() {
        let mut dialling = Dialling::new(None);
        dialling.failed(7);
        assert_eq!(dialling.at, Some(7 + FIRST_RETRY), "there was none yet");
        dialling.connected(9);
        dialling.ended(10, 0);
        assert_eq!(dialling.at, None);
    }
}
