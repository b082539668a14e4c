//! One peer behind a link number of the router: its transport, queue and counters.

use std::io;
use std::net::UdpSocket;
use std::os::fd::{AsRawFd as _, RawFd};
use std::sync::Arc;

use mavwire_core::border::Border;
use mavwire_core::frame::Header;
use mavwire_core::peer_slots::{Origin, SlotHolder, Usefulness};
use mavwire_core::registry::Entry;
use mavwire_core::router::LinkId;
use mavwire_core::scan::Resync;
use mavwire_core::signing::timestamp_from_unix_micros;
use mavwire_core::stream::FrameStream;
use mavwire_core::unknown::UnknownCounts;

use super::automation::Automation;
use super::endpoint::{PortSpec, Wire, is_way_gone};
use super::outbox::Outbox;
use super::send::{self, cannot_group, send_batch};
use super::socket_options::overrun;
use super::stats::Traffic;
use super::switch::Moment;
use crate::address::Address;

/// Whether a peer has proved that it speaks MAVLink, with the key where one is needed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Trust {
    /// It has sent no valid frame.
    New,
    /// It has sent no valid frame, and gets none before it sends one with a good signature.
    Muted,
    /// It has sent a valid frame, with a good signature where one is needed.
    Proven,
}

/// A peer, its half-read frame and its queue.
#[derive(Debug)]
pub(super) struct Port {
    pub(super) id: LinkId,
    /// Number of the link that it belongs to.
    pub(super) link: u32,
    pub(super) peer: Option<String>,
    /// The address of a server's peer, which competes for slots.
    pub(super) origin: Option<Origin>,
    pub(super) wire: Wire,
    /// Taken out while it is being fed.
    pub(super) stream: Option<Box<FrameStream>>,
    pub(super) outbox: Outbox,
    /// When the last good frame came; microseconds.
    pub(super) heard: u64,
    /// It takes no more until it is ready again.
    pub(super) blocked: bool,
    /// Datagrams of one length leave together.
    grouped: bool,
    /// Datagrams that the system dropped at the sockets before this one.
    overrun: Option<u64>,
    pub(super) traffic: Traffic,
    /// Arriving messages that the dialect does not define.
    pub(super) unknown: UnknownCounts,
    /// The border that changes or checks its frames; `None` if they stay as they are.
    pub(super) border: Option<Border>,
    pub(super) automation: Option<Automation>,
    /// Messages that leave before others.
    urgent: Box<[u32]>,
    pub(super) trust: Trust,
}

impl Port {
    pub(super) fn new(
        id: LinkId,
        link: u32,
        wire: Wire,
        spec: &PortSpec,
        border: Option<Border>,
        now: u64,
    ) -> Self {
        let stream = FrameStream::new(Resync::Rescan).with_unverified(spec.forward_unverified);
        Self {
            id,
            link,
            peer: None,
            origin: None,
            wire,
            stream: Some(Box::new(stream)),
            outbox: Outbox::new(spec.queue, spec.datagram),
            heard: now,
            blocked: false,
            grouped: true,
            overrun: None,
            traffic: Traffic::default(),
            unknown: UnknownCounts::default(),
            border,
            automation: Automation::new(&spec.automation),
            urgent: spec.options.limits.urgent.as_slice().into(),
            trust: Trust::New,
        }
    }

    /// Queues a frame, if there is anywhere to send it.
    #[inline]
    pub(super) fn push(
        &mut self,
        frame: &[u8],
        header: &Header,
        entry: Option<Entry>,
        moment: Moment,
    ) {
        match self.wire {
            Wire::Program => return,
            _ if self.trust == Trust::Muted => return, // nothing is meant for it yet
            Wire::Down => {
                self.outbox.dropped += 1;
                return;
            }
            Wire::Stream(_) | Wire::Datagrams(..) => {}
        }
        let urgent = self.urgent.contains(&header.msgid);
        let since = moment.now as u32;
        if let Some(border) = &self.border {
            let now = timestamp_from_unix_micros(moment.unix);
            match border.outgoing(frame, entry, now) {
                Some(frame) => self.outbox.push(&frame, urgent, since),
                None => self.traffic.unconverted += 1,
            }
        } else {
            self.outbox.push(frame, urgent, since);
        }
    }

    /// A server's peer as the holder of a slot. `has_targeted`: it has sent a frame to a known system.
    pub(super) fn as_slot_holder(&self, has_targeted: bool, now: u64) -> Option<SlotHolder> {
        let is_verified = self.border.as_ref().is_some_and(Border::verifies);
        let usefulness = match self.trust {
            Trust::New | Trust::Muted => Usefulness::Unproven,
            Trust::Proven if is_verified || has_targeted => Usefulness::Useful,
            Trust::Proven => Usefulness::Heard,
        };
        let silence = now.saturating_sub(self.heard);
        self.origin.map(|origin| SlotHolder { origin, usefulness, silence })
    }

    /// Whether there is anyone to send to.
    pub(super) fn is_up(&self) -> bool {
        matches!(self.wire, Wire::Stream(_) | Wire::Datagrams(..)) && self.trust != Trust::Muted
    }

    /// The descriptor that only this port reads from.
    pub(super) fn own_fd(&self) -> Option<RawFd> {
        match &self.wire {
            Wire::Stream(stream) => Some(stream.as_raw_fd()),
            // Peers of a server share its socket.
            Wire::Datagrams(socket, _) if self.origin.is_none() => Some(socket.as_raw_fd()),
            Wire::Datagrams(..) | Wire::Down | Wire::Program => None,
        }
    }

    /// The descriptor to wait for until the port takes more, if it is blocked.
    pub(super) fn blocked_fd(&self) -> Option<RawFd> {
        match &self.wire {
            Wire::Stream(stream) if self.blocked => Some(stream.as_raw_fd()),
            Wire::Datagrams(socket, _) if self.blocked => Some(socket.as_raw_fd()),
            _ => None,
        }
    }

    /// Sends queued frames as far as possible without waiting. `clock` tells the time in microseconds.
    ///
    /// # Errors
    /// A stream is broken, or there is no way for the datagrams of a socket that has a peer. Other errors of datagrams
    /// are counted.
    pub(super) fn flush(&mut self, clock: impl Fn() -> u32) -> io::Result<()> {
        match &mut self.wire {
            Wire::Stream(stream) => {
                self.blocked = !self.outbox.write_to(|bytes| stream.write(bytes), clock)?;
            }
            Wire::Datagrams(socket, to) => {
                let (socket, to) = (Arc::clone(socket), *to);
                self.blocked = !self.flush_datagrams(&socket, to, clock)?;
            }
            Wire::Down | Wire::Program => {}
        }
        Ok(())
    }

    /// True if everything is sent.
    fn flush_datagrams(
        &mut self,
        socket: &UdpSocket,
        to: Option<Address>,
        clock: impl Fn() -> u32,
    ) -> io::Result<bool> {
        let mut refused = false;
        while !self.outbox.is_empty() {
            let grouped = self.grouped;
            let send = |datagrams: &mut dyn Iterator<Item = &[u8]>| {
                send_batch(socket, datagrams, to, grouped)
            };
            match self.outbox.send_with(send::BATCH, send, &clock) {
                Ok(()) => refused = false,
                Err(error) if error.kind() == io::ErrorKind::WouldBlock => return Ok(false),
                Err(error) if grouped && cannot_group(&error) => self.grouped = false,
                Err(error) if to.is_none() && is_way_gone(&error) => {
                    self.traffic.send_errors += 1;
                    return Err(error);
                }
                // The error may belong to an earlier datagram that nobody wanted: this one is tried again.
                Err(_) if !refused => refused = true,
                Err(_) => {
                    self.traffic.send_errors += 1;
                    self.outbox.drop_front();
                    refused = false;
                }
            }
        }
        Ok(true)
    }

    /// Has a connection that came about.
    pub(super) fn connect(&mut self, wire: Wire) {
        let address = if let Wire::Stream(stream) = &wire { stream.peer() } else { None };
        self.peer = address.map(|peer| peer.to_string());
        self.grouped = true;
        self.wire = wire;
    }

    /// Has none any more.
    pub(super) fn disconnect(&mut self) {
        self.overrun = self.overrun();
        self.wire = Wire::Down;
        self.peer = None;
        self.blocked = false;
        self.outbox.clear();
        if let Some(stream) = &mut self.stream {
            stream.clear();
        }
    }

    /// Datagrams that the system dropped at its sockets because they were not read in time, where it says so.
    pub(super) fn overrun(&self) -> Option<u64> {
        let now = match &self.wire {
            Wire::Datagrams(socket, _) => overrun(socket),
            Wire::Stream(_) | Wire::Down | Wire::Program => None,
        };
        self.overrun.into_iter().chain(now).reduce(|before, now| before + now)
    }

    /// The datagrams so far end with bytes that may be the beginning of a frame.
    #[inline]
    pub(super) fn waits_for_datagram(&self) -> bool {
        matches!(self.wire, Wire::Datagrams(..))
            && self.stream.as_ref().is_some_and(|stream| stream.buffered() > 0)
    }

    /// It takes more, and has half of what may wait.
    #[inline]
    pub(super) fn is_crowded(&self) -> bool {
        !self.blocked && self.outbox.is_half_full()
    }

    /// Counts damaged frames and junk that arrived.
    pub(super) fn count(&mut self, damaged: u64, junk_bytes: u64) {
        self.traffic.damaged += damaged;
        self.traffic.junk_bytes += junk_bytes;
    }

    /// The counts of its frames; `routed` stays empty.
    pub(super) fn traffic(&self) -> Traffic {
        Traffic {
            sent: self.outbox.sent,
            sent_bytes: self.outbox.sent_bytes,
            dropped: self.outbox.dropped,
            ..self.traffic
        }
    }
}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use super::*;
    use std::net::Ipv4Addr;

    #[test]
    fn what_the_system_dropped_is_known_when_its_socket_is_gone() {
        let socket = || UdpSocket::bind((Ipv4Addr::LOCALHOST, 0)).unwrap();
        let (unread, sender) = (socket(), socket());
        sender.connect(unread.local_addr().unwrap()).unwrap();
        let wire = Wire::Datagrams(Arc::new(unread), None);
        let mut port = Port::new(LinkId(0), 1, wire, &PortSpec::default(), None, 0);
        while port.overrun() == Some(0) {
            sender.send(&[0; 1_000]).unwrap();
        }
        let lost = port.overrun();
        assert!(lost > Some(0));
        port.disconnect();
        assert_eq!(port.overrun(), lost);
        port.connect(Wire::Datagrams(Arc::new(socket()), None));
        assert_eq!(port.overrun(), lost);
    }
}
