//! The descriptor of a live link, what was read from it and not handed out, and the peers that sent it.

use std::io;
use std::time::{Duration, Instant};

use mavwire_core::parser::{Parser, Step};
use mavwire_core::registry::Registry;

use crate::address::Address;
use crate::bytes::{READ_SIZE, read_available};
use crate::datagrams::{BATCH, Inbox};

use crate::peers::Peers;

/// How a link's descriptor is read.
#[derive(Clone, Copy, PartialEq, Eq, Default)]
pub enum Transport {
    /// By Python alone.
    #[default]
    Foreign,
    /// Datagrams; those of the address given are the link's own.
    Datagrams(Option<Address>),
    /// A stream of bytes.
    Stream,
}

/// The result of one read from a link.
pub enum Arrived {
    /// Data arrived, of which this number of bytes went into the parser.
    Data(usize),
    /// No data is waiting.
    Nothing,
    /// The end of a stream, or something else: Python's `recv` knows what to do about it.
    Trouble,
}

/// The receiving state of a live link: datagrams not parsed yet, their peers, and how reading ended.
#[derive(Default)]
pub struct LiveSource {
    /// How the descriptor is read.
    pub transport: Transport,
    /// Datagrams that were read and not parsed.
    pub inbox: Inbox,
    /// Peers that send datagrams.
    pub peers: Peers,
    /// The last read took everything, so that it is better to wait than to read again.
    pub drained: bool,
    /// This is a server for one client at a time.
    pub serves_one: bool,
    /// The number of the error with which reading a stream ended. The system says it once.
    pub read_error: Option<i32>,
    next_housekeeping: Option<Instant>,
}

impl LiveSource {
    /// It is time to look after the client of a server, and the next time is after `interval`.
    pub fn is_housekeeping_due(&mut self, now: Instant, interval: Duration) -> bool {
        let is_due = self.serves_one && self.next_housekeeping.is_none_or(|due| now >= due);
        if is_due {
            self.next_housekeeping = now.checked_add(interval);
        }
        is_due
    }

    /// Reads what is there: datagrams into the empty inbox, a stream into the parser.
    pub fn fill(&mut self, fd: i32, parser: &mut Parser) -> Arrived {
        if !self.inbox.is_empty() {
            return Arrived::Data(0); // another thread was quicker
        }
        let (received, limit) = match self.transport {
            Transport::Foreign => return Arrived::Trouble,
            Transport::Datagrams(own) => (self.inbox.fill(fd, own), BATCH),
            Transport::Stream => {
                let push = |bytes: &[u8]| {
                    parser.push(bytes);
                };
                (read_available(fd, push), READ_SIZE)
            }
        };
        self.drained = received.as_ref().map_or(true, |&received| received < limit);
        match received {
            Ok(0) => Arrived::Trouble,
            Ok(received) => {
                Arrived::Data(if self.transport == Transport::Stream { received } else { 0 })
            }
            Err(error) if error.kind() == io::ErrorKind::WouldBlock => Arrived::Nothing,
            Err(error) => {
                self.read_error = error.raw_os_error();
                Arrived::Trouble
            }
        }
    }

    /// The peer that sent what was parsed last, if peers are answered, which multicast links do not do.
    #[inline]
    pub fn sender(&self) -> Option<Address> {
        if self.transport == Transport::Datagrams(None) { self.peers.current() } else { None }
    }

    /// The peer `from`, if what it sent, which was good or not, is a reason to announce it.
    #[inline]
    pub fn news(&mut self, from: Option<Address>, good: bool, now: f64) -> Option<Address> {
        from.filter(|&from| self.peers.is_news(from, good, now))
    }

    /// The next thing received; `Step::Nothing` if something has to arrive first. Also says how many bytes of the inbox
    /// went into it.
    #[inline]
    pub fn next(
        &mut self,
        parser: &mut Parser,
        registry: &Registry,
        robust: bool,
    ) -> (Step, usize) {
        let mut used = 0;
        if !parser.unread().is_empty() {
            let step = parser.step(registry, robust);
            if !matches!(step, Step::Nothing) {
                return (step, used);
            }
        }
        while let Some((_, from)) = self.inbox.front() {
            self.peers.switch(parser, from);
            let Some((bytes, _)) = self.inbox.front() else { break };
            if parser.unread().is_empty()
                && let Some((step, len)) = parser.look(bytes, registry)
            {
                self.inbox.advance(len);
                return (step, used + len);
            }
            let len = bytes.len();
            parser.push(bytes);
            self.inbox.advance(len);
            used += len;
            let step = parser.step(registry, robust);
            if !matches!(step, Step::Nothing) {
                return (step, used);
            }
        }
        parser.tidy();
        (Step::Nothing, used)
    }
}
