//! From bytes that arrived to frames that wait to leave: scanner, router, queues. No system call happens here.

use std::cell::RefCell;
use std::rc::Rc;
use std::sync::Arc;

use mavwire_core::border::{Border, BorderOptions};
use mavwire_core::frame::{FrameBuffer, Header};
use mavwire_core::peer_slots::SlotHolder;
use mavwire_core::registry::{Entry, Registry};
use mavwire_core::router::{Fate, LinkId, LinkOptions, LinkSet, MAX_LINKS, Router, Settings};
use mavwire_core::scan::{Found, Resync, Scanner};
use mavwire_core::signing::{SecretKey, SigningState, timestamp_from_unix_micros};
use mavwire_core::stream::Piece;
use mavwire_core::unknown::{UnknownCounts, UnknownKind};

use super::endpoint::{PortSpec, Wire};
use super::frames::{FrameInfo, Frames};
use super::port::{Port, Trust};
use super::stats::{Departed, MOST_UNKNOWN, Traffic};

/// The link number of the program around the bridge.
pub(super) const PROGRAM: u32 = 0;

/// The moment that a round of the event loop happens at.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Moment {
    /// Microseconds since the bridge started.
    pub(super) now: u64,
    /// Microseconds since 1970.
    pub(super) unix: u64,
}

/// Damaged frames and foreign bytes in a piece of a stream, and whether a frame proved its sender.
#[derive(Debug, Default)]
struct Tally {
    damaged: u64,
    junk_bytes: u64,
    /// A frame got in that proves its sender.
    proven: bool,
}

#[derive(Debug)]
pub(super) struct Switch {
    registry: Arc<Registry>,
    router: Router,
    /// By number, up to the highest that is taken.
    ports: Vec<Option<Port>>,
    program: LinkId,
    /// One for each key that was ever used, so that what was heard before cannot be replayed to a peer that is new.
    signing: Vec<Rc<RefCell<SigningState>>>,
    /// Ports with something to send.
    pub(super) dirty: LinkSet,
    /// A port that takes more has a queue that is half full: time to send.
    pub(super) crowded: bool,
    /// The frames received in this round, for the program around the bridge and for the recording.
    pub(super) arrived: Frames,
    pub(super) moment: Moment,
}

impl Switch {
    pub(super) fn new(registry: Arc<Registry>, settings: Settings) -> Self {
        let router = Router::new(&registry, settings);
        let mut switch = Self {
            registry,
            router,
            ports: Vec::new(),
            program: LinkId(0),
            signing: Vec::new(),
            dirty: LinkSet::EMPTY,
            crowded: false,
            arrived: Frames::default(),
            moment: Moment::default(),
        };
        let options = LinkOptions { private: true, ..LinkOptions::default() };
        let spec = PortSpec { options, forward_unverified: true, ..PortSpec::default() };
        if let Some(program) = switch.add(PROGRAM, Wire::Program, &spec) {
            switch.program = program;
        }
        switch
    }

    /// Adds a port; `None` if there is no number left for it.
    pub(super) fn add(&mut self, link: u32, wire: Wire, spec: &PortSpec) -> Option<LinkId> {
        let id = self.router.add_link(spec.options.clone())?;
        let options = &spec.options.border;
        let border = (!options.is_open()).then(|| self.border(id, options));
        if self.ports.len() <= id.index() {
            self.ports.resize_with(id.index() + 1, || None);
        }
        self.ports[id.index()] = Some(Port::new(id, link, wire, spec, border, self.moment.now));
        Some(id)
    }

    /// The same for a peer of a server: it gets nothing before it sent a signature, if it needs one.
    pub(super) fn add_peer(&mut self, link: u32, wire: Wire, spec: &PortSpec) -> Option<&mut Port> {
        let id = self.add(link, wire, spec)?;
        let port = self.port(id)?;
        if spec.options.border.verify {
            port.trust = Trust::Muted;
        }
        Some(port)
    }

    /// A border with the signing state of its key. No two ports have signatures with the same link id.
    fn border(&mut self, id: LinkId, options: &BorderOptions) -> Border {
        let options = BorderOptions { link_id: id.0, ..options.clone() };
        let state = match &options.key {
            Some(key) => self.signing_state(key),
            None => Rc::default(),
        };
        Border::new(options, state)
    }

    fn signing_state(&mut self, key: &SecretKey) -> Rc<RefCell<SigningState>> {
        let is_same = |state: &SigningState| state.key().is_some_and(|other| other.equals(key));
        if let Some(known) = self.signing.iter().find(|state| is_same(&state.borrow())) {
            return Rc::clone(known);
        }
        let mut state = SigningState::default();
        state.set_key(SecretKey::new(key.expose()).ok());
        state.timestamp = timestamp_from_unix_micros(self.moment.unix);
        let state = Rc::new(RefCell::new(state));
        self.signing.push(Rc::clone(&state));
        state
    }

    /// Removes a port, and returns what became of its frames.
    pub(super) fn remove(&mut self, id: LinkId) -> Departed {
        self.dirty.remove(id);
        let traffic = self.traffic(id);
        self.router.remove_link(id);
        let Some(mut port) = self.ports.get_mut(id.index()).and_then(Option::take) else {
            return Departed { traffic, ..Departed::default() };
        };
        while self.ports.last().is_some_and(Option::is_none) {
            self.ports.pop();
        }
        port.outbox.clear();
        Departed {
            traffic: Traffic { dropped: port.outbox.dropped, ..traffic },
            latency: port.outbox.latency,
            unknown: port.unknown,
        }
    }

    pub(super) fn port(&mut self, id: LinkId) -> Option<&mut Port> {
        self.ports.get_mut(id.index())?.as_mut()
    }

    pub(super) fn ports(&self) -> impl Iterator<Item = &Port> {
        self.ports.iter().flatten()
    }

    /// The peers of all servers, with their link and port.
    pub(super) fn peers(&self) -> impl Iterator<Item = (u32, LinkId, SlotHolder)> {
        self.ports().filter_map(|port| {
            let peer = port.as_slot_holder(self.router.has_targeted(port.id), self.moment.now)?;
            Some((port.link, port.id, peer))
        })
    }

    /// The number of ports that can still be added.
    pub(super) fn free_ports(&self) -> usize {
        MAX_LINKS - self.ports().count()
    }

    /// The port of the program around the bridge.
    pub(super) fn program(&self) -> LinkId {
        self.program
    }

    pub(super) fn router(&self) -> &Router {
        &self.router
    }

    pub(super) fn traffic(&self, id: LinkId) -> Traffic {
        let port = self.ports.get(id.index()).and_then(Option::as_ref);
        let routed = self.router.link_stats(id).unwrap_or_default();
        Traffic { routed, ..port.map(Port::traffic).unwrap_or_default() }
    }

    pub(super) fn unknown(&self, id: LinkId) -> UnknownCounts {
        let port = self.ports.get(id.index()).and_then(Option::as_ref);
        port.map(|port| port.unknown.clone()).unwrap_or_default()
    }

    /// Whether a datagram begins with a good frame that the dialect knows.
    fn begins_with_frame(&self, bytes: &[u8]) -> bool {
        let found = Scanner::new(Resync::Rescan).next(bytes, &self.registry);
        matches!(found, Found::Frame { entry: Some(_), .. })
    }

    /// Looks for a good frame of a known id in a datagram, or of any id if unverified ones will do; without one, how many
    /// damaged ones it has. The scanner remembers the definitions of senders.
    pub(super) fn check_mavlink(&self, bytes: &[u8], scanner: &mut Scanner) -> Result<(), u64> {
        scanner.restart();
        let is_known = |id| self.registry.lookup(id).is_some();
        let (mut at, mut damaged) = (0, 0);
        loop {
            let (len, is_damaged) = match scanner.next(&bytes[at..], &self.registry) {
                Found::Frame { entry, header, .. }
                    if entry.is_some() || is_known(header.msgid) || scanner.accept_unverified =>
                {
                    return Ok(());
                }
                Found::Frame { len, .. } | Found::Noise { len } => (len, false),
                Found::Rejected { len, .. } => (len, true),
                Found::Incomplete { .. } => return Err(damaged),
            };
            at += len;
            damaged += u64::from(is_damaged);
        }
    }

    /// Routes the bytes that arrived at a port.
    pub(super) fn feed(&mut self, id: LinkId, bytes: &[u8]) {
        let waits = self.port(id).is_some_and(|port| port.waits_for_datagram());
        if waits && self.begins_with_frame(bytes) {
            self.end(id); // what waits for the rest of a frame is none
        }
        let Some(mut stream) = self.port(id).and_then(|port| port.stream.take()) else { return };
        let registry = Arc::clone(&self.registry);
        let mut tally = Tally::default();
        let mut feed = stream.feed(bytes);
        while let Some(piece) = feed.next(&registry) {
            self.take(id, piece, &mut tally);
        }
        drop(feed);
        let now = self.moment.now;
        if let Some(port) = self.port(id) {
            port.stream = Some(stream);
            port.count(tally.damaged, tally.junk_bytes);
            if tally.proven {
                port.heard = now;
                port.trust = Trust::Proven;
            }
        }
    }

    /// Routes the frames that are left at a port. Half a frame is junk: the next bytes do not continue it.
    pub(super) fn end(&mut self, id: LinkId) {
        let Some(mut stream) = self.port(id).and_then(|port| port.stream.take()) else { return };
        let registry = Arc::clone(&self.registry);
        let mut tally = Tally::default();
        while let Some(piece) = stream.next_at_end(&registry) {
            self.take(id, piece, &mut tally);
        }
        let left = stream.buffered() as u64;
        stream.clear();
        if let Some(port) = self.port(id) {
            port.stream = Some(stream);
            port.count(tally.damaged, tally.junk_bytes + left);
        }
    }

    #[inline]
    fn take(&mut self, id: LinkId, piece: Piece<'_>, tally: &mut Tally) {
        match piece.found {
            Found::Frame { header, entry, .. } => {
                tally.proven |= self.admit(id, piece.bytes, &header, entry);
            }
            Found::Rejected { len, .. } => {
                tally.damaged += 1;
                tally.junk_bytes += len as u64;
            }
            Found::Noise { len } => tally.junk_bytes += len as u64,
            Found::Incomplete { .. } => {}
        }
    }

    /// Sends the bridge's own frames that are due.
    pub(super) fn automate(&mut self) {
        let moment = self.moment;
        for port in self.ports.iter_mut().flatten().filter(|port| port.is_up()) {
            let due =
                port.automation.as_mut().and_then(|automation| automation.heartbeat(moment.now));
            if let Some(frame) = due {
                send_own(port, &mut self.router, &frame, &self.registry, moment);
                self.dirty.insert(port.id);
            }
        }
    }

    /// Asks a vehicle for telemetry whose heartbeat came, if that is wanted.
    fn ask(&mut self, id: LinkId, frame: &[u8], header: &Header) {
        let moment = self.moment;
        let Some(port) = self.ports.get_mut(id.index()).and_then(Option::as_mut) else { return };
        let Some(automation) = &mut port.automation else { return };
        let requests = automation.requests(frame, header, moment.now);
        for request in &requests {
            send_own(port, &mut self.router, request, &self.registry, moment);
            self.dirty.insert(id);
        }
    }

    /// A good frame at the border of its port; whether it proves its sender.
    #[inline]
    fn admit(&mut self, id: LinkId, frame: &[u8], header: &Header, entry: Option<Entry>) -> bool {
        let moment = self.moment;
        let Some(port) = self.port(id) else { return false };
        let has_automation = port.automation.is_some();
        if entry.is_none()
            && let Some(kind) = UnknownKind::of(frame)
        {
            port.unknown.add(kind, 1, MOST_UNKNOWN);
        }
        let mut proven = true;
        if let Some(border) = &port.border {
            let now = timestamp_from_unix_micros(moment.unix);
            let Some(entered) = border.incoming(frame, now) else {
                port.traffic.unverified += 1;
                return false;
            };
            proven = entered.proven;
            // Without its signature its header is another one.
            let header = Header::parse(&entered.frame).unwrap_or(*header);
            self.dispatch(id, &entered.frame, &header, entry);
        } else {
            self.dispatch(id, frame, header, entry);
        }
        if has_automation {
            self.ask(id, frame, header);
        }
        proven
    }

    #[inline]
    fn dispatch(&mut self, source: LinkId, frame: &[u8], header: &Header, entry: Option<Entry>) {
        match self.router.route(frame, header, entry, source, self.moment.now) {
            Fate::Forwarded(links) => {
                let moment = self.moment;
                for id in links.iter() {
                    if let Some(port) = &mut self.ports[id.index()] {
                        port.push(frame, header, entry, moment);
                        self.crowded |= port.is_crowded();
                    }
                }
                self.dirty = self.dirty | links;
            }
            Fate::Unroutable => {}
            Fate::Filtered | Fate::Duplicate | Fate::Withheld => return,
        }
        let port = self.ports.get(source.index()).and_then(Option::as_ref);
        let link = port.map_or(PROGRAM, |port| port.link);
        let &Header { sysid, compid, msgid, .. } = header;
        let info = FrameInfo {
            len: frame.len() as u16,
            time: self.moment.unix,
            link,
            sysid,
            compid,
            msgid,
            index: entry.map(|entry| entry.index),
        };
        self.arrived.push(frame, info);
    }
}

/// Queues a frame of the bridge itself at a port, if it may leave there.
fn send_own(
    port: &mut Port,
    router: &mut Router,
    frame: &FrameBuffer,
    registry: &Registry,
    moment: Moment,
) {
    let Some(header) = Header::parse(frame) else { return };
    let entry = registry.lookup(header.msgid);
    if router.admit(frame, &header, entry, port.id, moment.now) {
        port.push(frame, &header, entry, moment);
    }
}
