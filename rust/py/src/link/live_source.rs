//! What a live link has received and not handed out, and where it comes from.

use std::io;
use std::time::{Duration, Instant};

use mavwire_io::address::Address;
use mavwire_io::bytes::{READ_SIZE, read_available};
use mavwire_io::datagrams::{BATCH, Inbox};

use crate::dialect::registry::Dialect;
use crate::link::peers::Peers;
use crate::protocol::parser::{Parser, Step};

/// How a link's descriptor is read.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Transport {
    /// By Python alone.
    Foreign,
    /// Datagrams; those of the address given are the link's own.
    Datagrams(Option<Address>),
    Stream,
}

/// What came of reading.
pub(crate) enum Arrived {
    /// Also says how many bytes went into the parser.
    Data(usize),
    Nothing,
    /// The end of a stream, or something else: Python's `recv` knows what to do about it.
    Trouble,
    /// An error of a stream, which the system does not say twice.
    Failed(i32),
}

pub(crate) struct LiveSource {
    pub(crate) transport: Transport,
    pub(crate) inbox: Inbox,
    pub(crate) peers: Peers,
    /// The last read took everything, so that it is better to wait than to read again.
    pub(crate) drained: bool,
    /// Python has bytes to send which the peer did not take yet, and sends them when it receives.
    pub(crate) has_unsent: bool,
    /// This is a server for one client at a time.
    pub(crate) serves_one: bool,
    next_tending: Option<Instant>,
}

impl LiveSource {
    pub(crate) fn new() -> Self {
        Self {
            transport: Transport::Foreign,
            inbox: Inbox::default(),
            peers: Peers::default(),
            drained: false,
            has_unsent: false,
            serves_one: false,
            next_tending: None,
        }
    }

    /// It is time to look after the client and the log, if there is one, and the next time is after `interval`.
    pub(crate) fn is_time_to_tend(&mut self, logs: bool, now: Instant, interval: Duration) -> bool {
        let is_due = (logs || self.serves_one) && self.next_tending.is_none_or(|due| now >= due);
        if is_due {
            self.next_tending = now.checked_add(interval);
        }
        is_due
    }

    /// Reads what is there: datagrams into the empty inbox, a stream into the parser.
    pub(crate) fn fill(&mut self, fd: i32, parser: &mut Parser) -> Arrived {
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
            Err(error) => match error.raw_os_error() {
                Some(number) if self.transport == Transport::Stream => Arrived::Failed(number),
                _ => Arrived::Trouble,
            },
        }
    }

    /// The peer that sent what was parsed last, if peers are answered, which multicast links do not do.
    #[inline]
    pub(crate) fn sender(&self) -> Option<Address> {
        if self.transport == Transport::Datagrams(None) { self.peers.current() } else { None }
    }

    /// The peer `from`, if what it sent, which was good or not, is a reason to announce it.
    #[inline]
    pub(crate) fn news(&mut self, from: Option<Address>, good: bool, now: f64) -> Option<Address> {
        from.filter(|&from| self.peers.is_news(from, good, now))
    }

    /// The next thing received; `Step::Nothing` if something has to arrive first. Also says how many bytes of the inbox
    /// went into it.
    #[inline]
    pub(crate) fn next(
        &mut self,
        parser: &mut Parser,
        dialect: &Dialect,
        robust: bool,
    ) -> (Step, usize) {
        let mut used = 0;
        if !parser.unread().is_empty() {
            let step = parser.step(dialect, robust);
            if !matches!(step, Step::Nothing) {
                return (step, used);
            }
        }
        while let Some((_, from)) = self.inbox.front() {
            self.peers.switch(parser, from);
            let Some((bytes, _)) = self.inbox.front() else { break };
            if parser.unread().is_empty()
                && let Some((step, len)) = parser.look(bytes, dialect)
            {
                self.inbox.advance(len);
                return (step, used + len);
            }
            let len = bytes.len();
            parser.push(bytes);
            self.inbox.advance(len);
            used += len;
            let step = parser.step(dialect, robust);
            if !matches!(step, Step::Nothing) {
                return (step, used);
            }
        }
        parser.tidy();
        (Step::Nothing, used)
    }
}
