//! From bytes that arrived to frames that wait to leave: scanner, router, queues. No system call happens here.

use std::sync::Arc;

use mavwire_core::frame::Header;
use mavwire_core::registry::{Entry, Registry};
use mavwire_core::router::{Fate, LinkId, LinkOptions, LinkSet, MAX_LINKS, Router, Settings};
use mavwire_core::scan::{Found, Resync, Scanner};

use super::hub::{FrameInfo, Frames};
use super::outbox::Outbox;
use super::port::{Port, Wire};
use super::stats::Traffic;

/// The link number that stands for the program around the bridge.
pub(super) const PROGRAM: u32 = 0;

/// The moment that a round of the event loop happens at.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Moment {
    /// Microseconds since the bridge started.
    pub(super) now: u64,
    /// Microseconds since 1970.
    pub(super) unix: u64,
}

#[derive(Debug)]
pub(super) struct Switch {
    registry: Arc<Registry>,
    router: Router,
    ports: Vec<Option<Port>>,
    program: LinkId,
    /// Ports with something to send.
    pub(super) dirty: LinkSet,
    /// What came in this round, for the program around the bridge and for the recording.
    pub(super) arrived: Frames,
    pub(super) moment: Moment,
}

impl Switch {
    pub(super) fn new(registry: Arc<Registry>, settings: Settings) -> Self {
        let router = Router::new(&registry, settings);
        let mut switch = Self {
            registry,
            router,
            ports: (0..MAX_LINKS).map(|_| None).collect(),
            program: LinkId(0),
            dirty: LinkSet::EMPTY,
            arrived: Frames::default(),
            moment: Moment::default(),
        };
        let options = LinkOptions { private: true, ..LinkOptions::default() };
        if let Some(program) = switch.add(PROGRAM, Wire::Program, options, Outbox::new(0, 0)) {
            switch.program = program;
        }
        switch
    }

    /// Adds a port; `None` if there is no number left for it.
    pub(super) fn add(
        &mut self,
        link: u32,
        wire: Wire,
        options: LinkOptions,
        outbox: Outbox,
    ) -> Option<LinkId> {
        let id = self.router.add_link(options)?;
        self.ports[id.index()] = Some(Port::new(id, link, wire, outbox, self.moment.now));
        Some(id)
    }

    /// Removes a port; what became of its frames.
    pub(super) fn remove(&mut self, id: LinkId) -> Traffic {
        self.dirty.remove(id);
        let traffic = self.traffic(id);
        self.router.remove_link(id);
        if let Some(mut port) = self.ports[id.index()].take() {
            port.outbox.clear();
            return Traffic { dropped: port.outbox.dropped, ..traffic };
        }
        traffic
    }

    pub(super) fn port(&mut self, id: LinkId) -> Option<&mut Port> {
        self.ports[id.index()].as_mut()
    }

    pub(super) fn ports(&self) -> impl Iterator<Item = &Port> {
        self.ports.iter().flatten()
    }

    /// The port of the program around the bridge.
    pub(super) fn program(&self) -> LinkId {
        self.program
    }

    pub(super) fn router(&self) -> &Router {
        &self.router
    }

    pub(super) fn traffic(&self, id: LinkId) -> Traffic {
        let port = self.ports[id.index()].as_ref();
        let routed = self.router.link_stats(id).unwrap_or_default();
        Traffic { routed, ..port.map(Port::traffic).unwrap_or_default() }
    }

    /// Whether a datagram has a good frame in it that the dialect knows.
    pub(super) fn is_mavlink(&self, bytes: &[u8]) -> bool {
        let mut scanner = Scanner::new(Resync::Rescan);
        let mut at = 0;
        loop {
            match scanner.next(&bytes[at..], &self.registry) {
                Found::Frame { entry: Some(_), .. } => return true,
                Found::Frame { len, .. } | Found::Noise { len } | Found::Rejected { len, .. } => {
                    at += len;
                }
                Found::Incomplete { .. } => return false,
            }
        }
    }

    /// Routes what arrived at a port.
    pub(super) fn feed(&mut self, id: LinkId, bytes: &[u8]) {
        let Some(mut stream) = self.ports[id.index()].as_mut().and_then(|port| port.stream.take())
        else {
            return;
        };
        let registry = Arc::clone(&self.registry);
        let (mut damaged, mut junk_bytes, mut good) = (0, 0, false);
        let mut feed = stream.feed(bytes);
        while let Some(piece) = feed.next(&registry) {
            match piece.found {
                Found::Frame { header, entry, .. } => {
                    good = true;
                    self.dispatch(id, piece.bytes, &header, entry);
                }
                Found::Rejected { len, .. } => {
                    damaged += 1;
                    junk_bytes += len as u64;
                }
                Found::Noise { len } => junk_bytes += len as u64,
                Found::Incomplete { .. } => {}
            }
        }
        drop(feed);
        let now = self.moment.now;
        if let Some(port) = self.port(id) {
            port.stream = Some(stream);
            port.traffic.damaged += damaged;
            port.traffic.junk_bytes += junk_bytes;
            if good {
                port.heard = now;
            }
        }
    }

    /// Routes frames of the program around the bridge.
    pub(super) fn send(&mut self, bytes: &[u8]) {
        self.feed(self.program, bytes);
    }

    #[inline]
    fn dispatch(&mut self, source: LinkId, frame: &[u8], header: &Header, entry: Option<Entry>) {
        match self.router.route(frame, header, entry, source, self.moment.now) {
            Fate::Forwarded(links) => {
                for id in links.iter() {
                    if let Some(port) = &mut self.ports[id.index()] {
                        port.push(frame);
                    }
                }
                self.dirty = self.dirty | links;
            }
            Fate::Unroutable => {}
            Fate::Filtered | Fate::Duplicate | Fate::Withheld => return,
        }
        let link = self.ports[source.index()].as_ref().map_or(PROGRAM, |port| port.link);
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
