//! The thread that does the work: waits for all descriptors, reads what is there, routes it, sends what is queued.
//!
//! Nothing here waits for one link. Connecting happens on threads of its own, writing stops where a socket takes no more,
//! and a round takes a bounded amount from each link so that a flood on one does not keep the others waiting.

use std::collections::{BTreeMap, HashMap};
use std::io::{self, Read as _};
use std::net::{TcpListener, UdpSocket};
use std::os::fd::{AsRawFd as _, RawFd};
use std::os::unix::net::UnixStream;
use std::rc::Rc;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, SyncSender};
use std::time::{Duration, Instant};

use mavwire_core::router::{LinkId, LinkSet};

use super::automation::Automation;
use super::endpoint::{LinkSpec, Opened, Stream};
use super::hub::Hub;
use super::latency::Latency;
use super::port::Wire;
use super::recorder::Recorder;
use super::stats::{Stats, Traffic};
use super::switch::{Moment, PROGRAM, Switch};
use super::{BridgeError, Waker};
use crate::address::Address;
use crate::bytes::READ_SIZE;
use crate::clock;
use crate::datagrams::{BATCH, Inbox};
use crate::readiness::poll;

/// What the link is called that frames of the program around the bridge come over.
pub(super) const PROGRAM_NAME: &str = "program";
/// Peers of a UDP server, and connections to a TCP server.
const MAX_PEERS: usize = 64;
/// Batches of datagrams that are read from one socket in a round, and connections that are taken.
const TURNS: usize = 8;
/// Commands that are obeyed in a round.
const COMMANDS: usize = 64;
/// How often peers are looked at that say nothing any more.
const TICK: u64 = 1_000_000;
/// The first pause before a connection is tried again; doubled up to the limit of the link.
const FIRST_RETRY: Duration = Duration::from_millis(250);

/// What the handle asks of the thread.
pub(super) enum Command {
    Add(Box<LinkSpec>, Opened, SyncSender<Result<(), BridgeError>>),
    Remove(String, SyncSender<Result<(), BridgeError>>),
    Stats(SyncSender<Stats>),
    Send(Vec<u8>),
    /// A thread that dials has an answer.
    Dialled(u32, io::Result<Stream>),
    Stop,
}

/// What a link has besides its ports.
pub(super) enum Kind {
    Datagrams(Rc<UdpSocket>, LinkId),
    DatagramServer(Rc<UdpSocket>, HashMap<Address, LinkId>),
    Listener(TcpListener),
    Dialled(LinkId, Dialling),
}

/// The state of a connection that is made again.
#[derive(Default)]
pub(super) struct Dialling {
    /// When to try again; `None` while connected, being connected, or given up.
    pub(super) at: Option<u64>,
    pause: Duration,
    pub(super) under_way: bool,
    pub(super) connections: u64,
}

pub(super) struct Link {
    pub(super) spec: LinkSpec,
    pub(super) kind: Kind,
    pub(super) refused: u64,
    pub(super) error: Option<String>,
    /// Of the peers that left.
    pub(super) departed: Traffic,
    pub(super) departed_latency: Latency,
    /// A listener that cannot accept, for want of descriptors, is left alone until the next tick.
    resting: bool,
}

impl Link {
    /// Keeps the numbers of a peer that left.
    fn part_with(&mut self, (traffic, latency): (Traffic, Latency)) {
        self.departed.add(&traffic);
        self.departed_latency.add(&latency);
    }
}

/// What a ready descriptor stands for.
#[derive(Clone, Copy)]
enum Token {
    Wake,
    Link(u32),
    Port(LinkId),
    Writable(LinkId),
}

pub(super) struct EventLoop {
    pub(super) switch: Switch,
    pub(super) links: BTreeMap<u32, Link>,
    last_number: u32,
    hub: Arc<Hub>,
    pub(super) recorder: Option<Recorder>,
    commands: Receiver<Command>,
    waker: Waker,
    wake: UnixStream,
    started: Instant,
    next_tick: u64,
    inbox: Inbox,
    buffer: Vec<u8>,
    watched: Vec<libc::pollfd>,
    tokens: Vec<Token>,
}

impl EventLoop {
    pub(super) fn new(
        switch: Switch,
        hub: Arc<Hub>,
        recorder: Option<Recorder>,
        commands: Receiver<Command>,
        waker: Waker,
        wake: UnixStream,
    ) -> Self {
        hub.name_link(PROGRAM, PROGRAM_NAME);
        Self {
            switch,
            links: BTreeMap::new(),
            last_number: PROGRAM,
            hub,
            recorder,
            commands,
            waker,
            wake,
            started: Instant::now(),
            next_tick: 0,
            inbox: Inbox::default(),
            buffer: vec![0; READ_SIZE],
            watched: Vec::new(),
            tokens: Vec::new(),
        }
    }

    /// Works until it is told to stop.
    pub(super) fn run(mut self) {
        while self.round() {}
    }

    /// One round; false if it was the last.
    fn round(&mut self) -> bool {
        self.watch();
        // An interrupted or failed wait reports nothing ready, and the next round asks again.
        let timeout = self.until_due();
        if poll(&mut self.watched, timeout).is_err() {
            self.watched.iter_mut().for_each(|watched| watched.revents = 0);
        }
        self.switch.moment = Moment {
            now: self.started.elapsed().as_micros() as u64,
            unix: (clock::unix_seconds() * 1e6) as u64,
        };
        let mut running = true;
        for n in 0..self.watched.len() {
            if self.watched[n].revents == 0 {
                continue;
            }
            match self.tokens[n] {
                Token::Wake => running &= self.obey(),
                Token::Link(number) => self.read_link(number),
                Token::Port(id) => self.read_port(id),
                Token::Writable(id) => self.unblock(id),
            }
        }
        self.redial();
        self.switch.automate();
        if self.switch.moment.now >= self.next_tick {
            self.next_tick = self.switch.moment.now + TICK;
            self.links.values_mut().for_each(|link| link.resting = false);
            self.forget_silent_peers();
        }
        self.flush();
        self.hand_over();
        running
    }

    // -- waiting

    fn watch(&mut self) {
        self.watched.clear();
        self.tokens.clear();
        let mut add = |fd: RawFd, events, token| {
            self.watched.push(libc::pollfd { fd, events, revents: 0 });
            self.tokens.push(token);
        };
        add(self.wake.as_raw_fd(), libc::POLLIN, Token::Wake);
        for (&number, link) in &self.links {
            match &link.kind {
                Kind::Datagrams(socket, _) | Kind::DatagramServer(socket, _) => {
                    add(socket.as_raw_fd(), libc::POLLIN, Token::Link(number));
                }
                Kind::Listener(listener) if !link.resting => {
                    add(listener.as_raw_fd(), libc::POLLIN, Token::Link(number));
                }
                Kind::Listener(_) | Kind::Dialled(..) => {}
            }
        }
        for port in self.switch.ports() {
            if let Wire::Stream(stream) = &port.wire {
                add(stream.as_raw_fd(), libc::POLLIN, Token::Port(port.id));
            }
            if let Some(fd) = port.blocked_fd() {
                add(fd, libc::POLLOUT, Token::Writable(port.id));
            }
        }
    }

    /// How long there is nothing to do unless something arrives.
    fn until_due(&self) -> Duration {
        let now = self.started.elapsed().as_micros() as u64;
        let retries = self.links.values().filter_map(|link| match &link.kind {
            Kind::Dialled(_, dialling) => dialling.at,
            _ => None,
        });
        let heartbeats = self
            .switch
            .ports()
            .filter(|port| port.is_up())
            .filter_map(|port| port.automation.as_ref().and_then(Automation::due));
        let due = retries.chain(heartbeats).chain([self.next_tick]).min().unwrap_or(now);
        Duration::from_micros(due.saturating_sub(now))
    }

    // -- reading

    fn read_link(&mut self, number: u32) {
        let Some(link) = self.links.get(&number) else { return };
        match &link.kind {
            Kind::Datagrams(socket, port) => {
                let (socket, port) = (Rc::clone(socket), *port);
                self.read_datagrams(&socket, |_, _, _| Some(port));
            }
            Kind::DatagramServer(socket, _) => {
                let socket = Rc::clone(socket);
                let socket = &socket;
                self.read_datagrams(socket, |this, bytes, from| {
                    this.peer(number, socket, bytes, from)
                });
            }
            Kind::Listener(_) => self.accept(number),
            Kind::Dialled(..) => {}
        }
    }

    fn read_datagrams(
        &mut self,
        socket: &UdpSocket,
        port_of: impl Fn(&mut Self, &[u8], Address) -> Option<LinkId>,
    ) {
        let mut inbox = std::mem::take(&mut self.inbox);
        for _ in 0..TURNS {
            // What a socket says of an earlier datagram to a peer that is not there is no matter of reading.
            let Ok(count) = inbox.fill(socket.as_raw_fd(), None) else { break };
            while let Some((bytes, from)) = inbox.front() {
                let len = bytes.len();
                if let Some(port) = port_of(self, bytes, from) {
                    self.switch.feed(port, bytes);
                }
                inbox.advance(len);
            }
            if count < BATCH {
                break;
            }
        }
        self.inbox = inbox;
    }

    /// The port of a peer of a UDP server. A new one gets a port when it sends a good frame (R61).
    fn peer(
        &mut self,
        number: u32,
        socket: &Rc<UdpSocket>,
        bytes: &[u8],
        from: Address,
    ) -> Option<LinkId> {
        let link = self.links.get_mut(&number)?;
        let Kind::DatagramServer(_, peers) = &mut link.kind else { return None };
        if let Some(&port) = peers.get(&from) {
            return Some(port);
        }
        if !self.switch.is_mavlink(bytes) {
            return None;
        }
        let wire = Wire::Datagrams(Rc::clone(socket), Some(from));
        let room = peers.len() < MAX_PEERS;
        let added = room.then(|| self.switch.add_peer(number, wire, &link.spec.port)).flatten();
        let Some(port) = added else {
            link.refused += 1;
            return None;
        };
        peers.insert(from, port.id);
        port.peer = Some(from.socket_addr().to_string());
        Some(port.id)
    }

    fn accept(&mut self, number: u32) {
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
            let Ok(stream) = Stream::tcp(stream) else { continue };
            let count = self.switch.ports().filter(|port| port.link == number).count();
            let wire = Wire::Stream(stream);
            let room = count < MAX_PEERS;
            let added = room.then(|| self.switch.add_peer(number, wire, &link.spec.port)).flatten();
            match added {
                Some(port) => port.peer = Some(from.to_string()),
                None => link.refused += 1, // dropped, which closes it
            }
        }
    }

    /// Reads once: that is some thousand frames, and what is left comes in the next round.
    fn read_port(&mut self, id: LinkId) {
        let Some(port) = self.switch.port(id) else { return };
        let Wire::Stream(stream) = &mut port.wire else { return };
        match stream.read(&mut self.buffer) {
            Ok(0) => self.hang_up(id, None),
            Ok(len) => self.switch.feed(id, &self.buffer[..len]),
            Err(error) => match error.kind() {
                io::ErrorKind::WouldBlock | io::ErrorKind::Interrupted => {}
                _ => self.hang_up(id, Some(error)),
            },
        }
    }

    // -- writing

    fn unblock(&mut self, id: LinkId) {
        if let Some(port) = self.switch.port(id) {
            port.blocked = false;
            self.switch.dirty.insert(id);
        }
    }

    fn flush(&mut self) {
        let started = self.started;
        let dirty = std::mem::replace(&mut self.switch.dirty, LinkSet::EMPTY);
        for id in dirty.iter() {
            let Some(port) = self.switch.port(id).filter(|port| !port.blocked) else { continue };
            if let Err(error) = port.flush(|| started.elapsed().as_micros() as u32) {
                self.hang_up(id, Some(error));
            }
        }
    }

    /// Gives what arrived to the program around the bridge, and to the recording.
    fn hand_over(&mut self) {
        let arrived = &mut self.switch.arrived;
        if arrived.infos.is_empty() {
            return;
        }
        self.hub.deliver(arrived);
        if let Some(recorder) = &self.recorder {
            recorder.append(arrived);
        }
        arrived.clear();
    }

    // -- connections that come and go

    /// A stream has ended. A server's port goes with it; what is dialled is dialled again.
    fn hang_up(&mut self, id: LinkId, error: Option<io::Error>) {
        let Some(port) = self.switch.port(id) else { return };
        let Some(link) = self.links.get_mut(&port.link) else { return };
        if let Some(error) = error {
            link.error = Some(error.to_string());
        }
        if let Kind::Dialled(_, dialling) = &mut link.kind {
            port.wire = Wire::Down;
            port.peer = None;
            port.blocked = false;
            port.outbox.clear();
            if let Some(stream) = &mut port.stream {
                stream.clear();
            }
            let pause = dialling.pause.as_micros() as u64;
            dialling.at = link.spec.retry.map(|_| self.switch.moment.now + pause);
        } else {
            link.part_with(self.switch.remove(id));
        }
    }

    /// Dials what is due, each on a thread of its own.
    fn redial(&mut self) {
        let now = self.switch.moment.now;
        for (&number, link) in &mut self.links {
            let Kind::Dialled(_, dialling) = &mut link.kind else { continue };
            if dialling.under_way || dialling.at.is_none_or(|at| at > now) {
                continue;
            }
            let (endpoint, waker) = (link.spec.endpoint.clone(), self.waker.clone());
            let dial = move || {
                // The bridge may have stopped in the meantime, and then nobody wants the answer.
                let _ = waker.send(Command::Dialled(number, endpoint.dial()));
            };
            match std::thread::Builder::new().name("mavwire-dial".into()).spawn(dial) {
                Ok(_) => (dialling.under_way, dialling.at) = (true, None),
                Err(_) => dialling.at = Some(now + TICK),
            }
        }
    }

    fn dialled(&mut self, number: u32, result: io::Result<Stream>) {
        let now = self.switch.moment.now;
        let Some(link) = self.links.get_mut(&number) else { return };
        let Kind::Dialled(id, dialling) = &mut link.kind else { return };
        dialling.under_way = false;
        match result {
            Ok(stream) => {
                (dialling.pause, dialling.at) = (FIRST_RETRY, None);
                dialling.connections += 1;
                link.error = None;
                if let Some(port) = self.switch.port(*id) {
                    port.peer = stream.peer().map(|peer| peer.to_string());
                    port.wire = Wire::Stream(stream);
                }
            }
            Err(error) => {
                link.error = Some(error.to_string());
                let longest = link.spec.retry.unwrap_or(FIRST_RETRY);
                dialling.at = Some(now + dialling.pause.min(longest).as_micros() as u64);
                dialling.pause = (dialling.pause * 2).min(longest);
            }
        }
    }

    fn forget_silent_peers(&mut self) {
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
                link.part_with(self.switch.remove(id));
            }
        }
    }

    // -- commands

    /// Does what the handle asked for; false if that was to stop.
    fn obey(&mut self) -> bool {
        let mut signals = [0; 256];
        while matches!(self.wake.read(&mut signals), Ok(len) if len > 0) {}
        for _ in 0..COMMANDS {
            let Ok(command) = self.commands.try_recv() else { return true };
            match command {
                Command::Add(spec, opened, answer) => {
                    let _ = answer.send(self.add(*spec, opened));
                }
                Command::Remove(name, answer) => {
                    let _ = answer.send(self.remove(&name));
                }
                Command::Stats(answer) => {
                    let _ = answer.send(self.stats());
                }
                Command::Send(bytes) => self.switch.send(&bytes),
                Command::Dialled(number, result) => self.dialled(number, result),
                Command::Stop => return false,
            }
        }
        // There may be more, for the next round.
        self.waker.wake();
        true
    }

    fn add(&mut self, spec: LinkSpec, opened: Opened) -> Result<(), BridgeError> {
        let taken = self.links.values().any(|link| link.spec.name == spec.name);
        if taken || spec.name == PROGRAM_NAME {
            return Err(BridgeError::NameTaken(spec.name));
        }
        let number = self.last_number + 1;
        let kind = self.kind(number, &spec, opened)?;
        self.last_number = number;
        self.hub.name_link(number, &spec.name);
        let link = Link {
            spec,
            kind,
            refused: 0,
            error: None,
            departed: Traffic::default(),
            departed_latency: Latency::default(),
            resting: false,
        };
        self.links.insert(number, link);
        Ok(())
    }

    fn kind(&mut self, number: u32, spec: &LinkSpec, opened: Opened) -> Result<Kind, BridgeError> {
        let mut add =
            |wire| self.switch.add(number, wire, &spec.port).ok_or(BridgeError::TooManyLinks);
        Ok(match opened {
            Opened::Datagrams(socket) => {
                let failed = |error| BridgeError::Io { link: spec.name.clone(), error };
                let to = spec.endpoint.broadcast_address().map_err(failed)?;
                let socket = Rc::new(socket);
                let wire = Wire::Datagrams(Rc::clone(&socket), to.map(Address::from));
                Kind::Datagrams(socket, add(wire)?)
            }
            Opened::DatagramServer(socket) => Kind::DatagramServer(Rc::new(socket), HashMap::new()),
            Opened::Listener(listener) => Kind::Listener(listener),
            Opened::Dialled(stream) => {
                let mut dialling = Dialling { pause: FIRST_RETRY, ..Dialling::default() };
                match stream {
                    Some(_) => dialling.connections = 1,
                    None => dialling.at = Some(0),
                }
                let wire = stream.map_or(Wire::Down, Wire::Stream);
                Kind::Dialled(add(wire)?, dialling)
            }
        })
    }

    fn remove(&mut self, name: &str) -> Result<(), BridgeError> {
        let found = self.links.iter().find(|(_, link)| link.spec.name == name);
        let number = *found.ok_or_else(|| BridgeError::NoSuchLink(name.to_owned()))?.0;
        self.links.remove(&number);
        let ports: Vec<LinkId> =
            self.switch.ports().filter(|port| port.link == number).map(|port| port.id).collect();
        for id in ports {
            self.switch.remove(id);
        }
        Ok(())
    }
}

/// However the loop ends, nobody waits for frames any more.
impl Drop for EventLoop {
    fn drop(&mut self) {
        self.hub.stop();
    }
}
