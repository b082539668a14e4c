//! The thread that does the work: waits for all descriptors, reads, routes, and sends queued frames.
//!
//! Nothing here waits for one link. Connecting happens on threads of its own, writing stops where a socket takes no more,
//! and a round takes a bounded amount from each link so that a flood on one does not keep the others waiting.

use std::collections::BTreeMap;
use std::io::{self, Read as _};
use std::net::UdpSocket;
use std::os::fd::{AsRawFd as _, RawFd};
use std::os::unix::net::UnixStream;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, SyncSender};
use std::time::{Duration, Instant};

use mavwire_core::router::{LinkId, LinkSet};

use super::automation::Automation;
use super::connections::{Kind, Link};
use super::endpoint::{LinkSpec, Opened, Wire};
use super::hub::Hub;
use super::recorder::Recorder;
use super::report::Heard;
use super::stats::Stats;
use super::switch::{Moment, PROGRAM, Switch};
use super::{BridgeError, Waker};
use crate::address::Address;
use crate::bytes::READ_SIZE;
use crate::clock;
use crate::datagrams::{BATCH, Inbox};
use crate::readiness::poll;

/// The name of the link of the program around the bridge.
pub(super) const PROGRAM_NAME: &str = "program";
/// Batches of datagrams that are read from one socket in a round, and connections that are taken.
pub(super) const TURNS: usize = 8;
/// Bytes after which no further batch is read.
const ROUND_BYTES: usize = 256 * 1024;
/// Bytes that are routed before queues are looked at: a burst must not drop frames that a link would take.
const PIECE: usize = 16 * 1024;
/// Commands that are obeyed in a round.
const COMMANDS: usize = 64;
/// How long a round waits that cannot tell which descriptors are ready.
const BLIND_WAIT: Duration = Duration::from_millis(1);
/// How often peers are looked at that say nothing any more.
pub(super) const TICK: u64 = 1_000_000;

/// A request of the handle to the thread.
pub(super) enum Command {
    Add(Box<LinkSpec>, Opened, SyncSender<Result<(), BridgeError>>),
    Remove(String, SyncSender<Result<(), BridgeError>>),
    Stats(SyncSender<(Stats, Heard)>),
    /// Whole frames that the program sends.
    Send(Box<[u8]>),
    /// A thread that dials has an answer.
    Dialled(u32, io::Result<Wire>),
    Stop,
}

/// The owner of a watched descriptor.
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
    pub(super) last_number: u32,
    pub(super) hub: Arc<Hub>,
    pub(super) recorder: Option<Recorder>,
    commands: Receiver<Command>,
    pub(super) waker: Waker,
    wake: UnixStream,
    started: Instant,
    next_tick: u64,
    /// More was asked for than a round obeys.
    more_commands: bool,
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
            more_commands: false,
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
        self.wait();
        self.switch.moment = Moment { now: self.now(), unix: (clock::unix_seconds() * 1e6) as u64 };
        for n in 0..self.watched.len() {
            if self.watched[n].revents == 0 {
                continue;
            }
            match self.tokens[n] {
                Token::Wake => self.empty_wake(),
                Token::Link(number) => self.read_link(number),
                Token::Port(id) => self.read_port(id),
                Token::Writable(id) => self.unblock(id),
            }
        }
        // In every round, and so at each tick, as a signal may be lost. Last, when what was found ready is done with.
        let running = self.obey();
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

    /// Microseconds since the bridge started.
    fn now(&self) -> u64 {
        self.started.elapsed().as_micros() as u64
    }

    /// Waits until something is ready or due.
    fn wait(&mut self) {
        let timeout = self.until_due();
        let Err(error) = poll(&mut self.watched, timeout) else { return };
        // Interrupted: the next round asks again. Where the system cannot wait for so many descriptors, since it has no
        // memory for them or allows a process fewer, each of them is tried: none of them blocks.
        let is_interrupted = error.kind() == io::ErrorKind::Interrupted;
        if !is_interrupted {
            std::thread::sleep(timeout.min(BLIND_WAIT));
        }
        for watched in &mut self.watched {
            watched.revents = if is_interrupted { 0 } else { watched.events };
        }
    }

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
                Kind::DatagramServer(socket, _) => {
                    add(socket.as_raw_fd(), libc::POLLIN, Token::Link(number));
                }
                Kind::Listener(listener) if !link.resting => {
                    add(listener.as_raw_fd(), libc::POLLIN, Token::Link(number));
                }
                Kind::Listener(_) | Kind::Dialled(..) => {}
            }
        }
        for port in self.switch.ports() {
            if let Some(fd) = port.own_fd() {
                add(fd, libc::POLLIN, Token::Port(port.id));
            }
            if let Some(fd) = port.blocked_fd() {
                add(fd, libc::POLLOUT, Token::Writable(port.id));
            }
        }
    }

    /// How long there is nothing to do unless something arrives.
    fn until_due(&self) -> Duration {
        if self.more_commands {
            return Duration::ZERO;
        }
        let now = self.now();
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
            Kind::DatagramServer(socket, _) => {
                let socket = Arc::clone(socket);
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
        let mut read = 0;
        for _ in 0..TURNS {
            // A socket may report an error about an earlier datagram, to a peer that is gone. Reading ignores it.
            let Ok(count) = inbox.fill(socket.as_raw_fd(), None) else { break };
            while let Some((bytes, from)) = inbox.front() {
                let len = bytes.len();
                if let Some(port) = port_of(self, bytes, from) {
                    self.feed(port, bytes);
                }
                read += len;
                inbox.advance(len);
            }
            if count < BATCH || read >= ROUND_BYTES {
                break;
            }
        }
        self.inbox = inbox;
    }

    /// Routes what arrived at a port, and sends in between what would not find room in its queue.
    fn feed(&mut self, id: LinkId, bytes: &[u8]) {
        for piece in bytes.chunks(PIECE) {
            self.switch.feed(id, piece);
            if self.switch.crowded {
                self.flush();
            }
        }
    }

    /// The port of a peer of a UDP server. A new one gets a port when it sends a good frame (R61).
    fn peer(
        &mut self,
        number: u32,
        socket: &Arc<UdpSocket>,
        bytes: &[u8],
        from: Address,
    ) -> Option<LinkId> {
        let link = self.links.get_mut(&number)?;
        let Kind::DatagramServer(_, peers) = &link.kind else { return None };
        if let Some(&port) = peers.get(&from) {
            return Some(port);
        }
        if let Err(damaged) = self.switch.check_mavlink(bytes, &mut link.strangers) {
            let junk = &mut link.departed.traffic;
            junk.damaged += damaged;
            junk.junk_bytes += bytes.len() as u64;
            return None;
        }
        let wire = Wire::Datagrams(Arc::clone(socket), Some(from));
        let id = self.welcome(number, wire, from.socket_addr())?;
        if let Kind::DatagramServer(_, peers) = &mut self.links.get_mut(&number)?.kind {
            peers.insert(from, id);
        }
        Some(id)
    }

    /// Reads from what is a port's own. A stream is read once: that is some thousand frames, and what is left comes in
    /// the next round.
    fn read_port(&mut self, id: LinkId) {
        let Some(port) = self.switch.port(id) else { return };
        let stream = match &mut port.wire {
            Wire::Stream(stream) => stream,
            Wire::Datagrams(socket, _) => {
                let socket = Arc::clone(socket);
                return self.read_datagrams(&socket, |_, _, _| Some(id));
            }
            Wire::Down | Wire::Program => return,
        };
        let mut buffer = std::mem::take(&mut self.buffer);
        match stream.read(&mut buffer) {
            Ok(0) => self.close_port(id, None),
            Ok(len) => self.feed(id, &buffer[..len]),
            Err(error) => match error.kind() {
                io::ErrorKind::WouldBlock | io::ErrorKind::Interrupted => {}
                _ => self.close_port(id, Some(error)),
            },
        }
        self.buffer = buffer;
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
        self.switch.crowded = false;
        let dirty = std::mem::replace(&mut self.switch.dirty, LinkSet::EMPTY);
        for id in dirty.iter() {
            let Some(port) = self.switch.port(id).filter(|port| !port.blocked) else { continue };
            if let Err(error) = port.flush(|| started.elapsed().as_micros() as u32) {
                self.close_port(id, Some(error));
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

    // -- commands

    /// Takes the signals that have woken the loop.
    fn empty_wake(&mut self) {
        let mut signals = [0; 256];
        while matches!(self.wake.read(&mut signals), Ok(len) if len > 0) {}
    }

    /// Does what the handle asked for; false if that was to stop.
    fn obey(&mut self) -> bool {
        self.more_commands = false;
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
                Command::Send(frames) => {
                    self.feed(self.switch.program(), &frames);
                    self.switch.end(self.switch.program());
                }
                Command::Dialled(number, result) => self.dialled(number, result),
                Command::Stop => return false,
            }
        }
        self.more_commands = true;
        true
    }
}

/// However the loop ends, nobody waits for frames any more.
impl Drop for EventLoop {
    fn drop(&mut self) {
        self.hub.stop();
    }
}
