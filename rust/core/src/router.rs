//! Which links a frame goes to: frame in, set of links out (MAVLink guide, "Routing").
//!
//! The rules, in the order they are asked:
//!
//! 1. Frames that the source link's inbound filter stops, and duplicates, count as never received.
//! 2. `SETUP_SIGNING` carries a key in clear and is not forwarded (R53).
//! 3. The sender is now known at the source link, and at all links of its group. A duplicate only renews known routes.
//! 4. A frame without a target, or of an unknown id, goes to every link that is not private. A frame with one goes to
//!    the links where the target component was heard, or its system as long as the component was not; nowhere if
//!    nobody knows it.
//! 5. Sniffers get every frame. Nothing goes back to a link where its sender lives, or to the source's group.
//! 6. Outbound filters and limits of each link take their share.
//!
//! Of a frame only the header and the target are read, and frames are never altered. A frame may add a route and never takes
//! one away: anyone can send in the name of any system. Routes end by silence or with their link. Time is an argument, in
//! microseconds of a clock that does not go back.

mod byte_rate;
mod dedup;
mod filter;
mod limit;
mod links;
mod table;

pub use byte_rate::ByteRate;
pub use filter::{Filter, Part};
pub use limit::Limits;
pub use links::{LinkId, LinkSet, MAX_LINKS};
pub use table::ComponentStats;

use std::collections::BTreeMap;

use crate::border::BorderOptions;
use crate::frame::Header;
use crate::registry::{Entry, Registry};
use dedup::Dedup;
use limit::{Limiter, stream_key};
use table::{Sender, Table};

const SETUP_SIGNING: u32 = 256;

/// How a router works.
#[derive(Debug, Clone, Copy)]
pub struct Settings {
    /// A route lasts between this long and twice as long after its owner was heard; microseconds.
    pub max_age: u64,
    /// Copies that arrive over another link within this long are dropped; microseconds, 0 for never.
    pub dedup_window: u64,
    /// Links where this system was heard get every frame; 0 for none.
    pub sniffer_sysid: u8,
    /// A number that senders cannot know, for the digests of frames.
    pub seed: u64,
}

impl Settings {
    /// Routes of a minute, duplicates of half a second.
    pub fn new(seed: u64) -> Self {
        Self { max_age: 60_000_000, dedup_window: 500_000, sniffer_sysid: 0, seed }
    }
}

/// How a link takes part.
#[derive(Debug, Clone, Default)]
pub struct LinkOptions {
    /// Links of a group lead to the same place, such as two radios to one vehicle: nothing goes from one to another.
    pub group: Option<u16>,
    /// Gets only what is addressed to a system that was heard there.
    pub private: bool,
    /// Gets everything.
    pub sniffer: bool,
    /// Frames that may come in.
    pub inbound: Filter,
    /// Frames that may go out.
    pub outbound: Filter,
    /// How much may go out.
    pub limits: Limits,
    /// Changes to frames on the way out. They may change the length of a frame.
    pub border: BorderOptions,
}

/// The router's decision about a frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Fate {
    /// It goes to these links; none where there is no other.
    Forwarded(LinkSet),
    /// The source's inbound filter stopped it.
    Filtered,
    /// It was there before, over another link.
    Duplicate,
    /// It carries a key.
    Withheld,
    /// The link to its target is not known.
    Unroutable,
}

/// Counts of a link's frames, by the decisions about them.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct LinkStats {
    /// Frames that came in.
    pub received: u64,
    /// Their bytes.
    pub received_bytes: u64,
    /// Received frames that the inbound filter stopped.
    pub filtered_in: u64,
    /// Received copies of frames from other links.
    pub duplicates: u64,
    /// Received frames that carry a key.
    pub withheld: u64,
    /// Received frames to a target that is not known.
    pub unroutable: u64,
    /// Frames that the outbound filter kept back.
    pub filtered_out: u64,
    /// Frames that the limits kept back.
    pub limited: u64,
}

#[derive(Debug, Clone)]
struct Port {
    options: LinkOptions,
    /// Its inbound filter stops something.
    has_inbound: bool,
    limiter: Option<Limiter>,
    /// The links of its group, itself among them.
    group: LinkSet,
    /// The link has sent a frame to a known system.
    has_targeted: bool,
    stats: LinkStats,
}

/// The offsets of the target in a payload; [`NONE`] for a message without one.
#[derive(Debug, Clone, Copy)]
struct TargetOffsets {
    system: u8,
    component: u8,
}

const NONE: u8 = u8::MAX;

/// Routes frames between links.
#[derive(Debug, Clone)]
pub struct Router {
    /// By message index.
    targets: Box<[TargetOffsets]>,
    table: Table,
    dedup: Dedup,
    sniffer_sysid: u8,
    ports: Vec<Option<Port>>,
    /// Links that get what has no target.
    broadcast: LinkSet,
    sniffers: LinkSet,
    /// Links that have an outbound filter or limits.
    screened: LinkSet,
    /// Frames that were asked about at these.
    asked: u64,
}

impl Router {
    /// A router without links. Frames are to come with entries of this `registry`.
    pub fn new(registry: &Registry, settings: Settings) -> Self {
        let messages = &registry.dialect().messages;
        let offsets = messages.iter().map(|message| TargetOffsets {
            system: message.target_system_offset.unwrap_or(NONE),
            component: message.target_component_offset.unwrap_or(NONE),
        });
        Self {
            targets: offsets.collect(),
            table: Table::new(settings.max_age),
            dedup: Dedup::new(settings.dedup_window, settings.seed),
            sniffer_sysid: settings.sniffer_sysid,
            ports: Vec::new(),
            broadcast: LinkSet::EMPTY,
            sniffers: LinkSet::EMPTY,
            screened: LinkSet::EMPTY,
            asked: 0,
        }
    }

    /// Adds a link; `None` if there are [`MAX_LINKS`] already.
    pub fn add_link(&mut self, options: LinkOptions) -> Option<LinkId> {
        let free = self.ports.iter().position(Option::is_none).unwrap_or(self.ports.len());
        let id = LinkId(u8::try_from(free).ok()?);
        let limiter = (!options.limits.is_open()).then(|| Limiter::new(&options.limits));
        let port = Port {
            has_inbound: !options.inbound.is_open(),
            options,
            limiter,
            group: LinkSet::EMPTY,
            has_targeted: false,
            stats: LinkStats::default(),
        };
        if free == self.ports.len() {
            self.ports.push(Some(port));
        } else {
            self.ports[free] = Some(port);
        }
        self.regroup();
        Some(id)
    }

    /// Removes a link, and all routes over it; returns what it came to.
    pub fn remove_link(&mut self, link: LinkId) -> Option<LinkStats> {
        let port = self.ports.get_mut(link.index())?.take()?;
        self.table.forget_link(link);
        self.regroup();
        Some(port.stats)
    }

    /// Works out anew which links belong to what.
    fn regroup(&mut self) {
        [self.broadcast, self.sniffers, self.screened] = [LinkSet::EMPTY; 3];
        let mut groups: BTreeMap<u16, LinkSet> = BTreeMap::new();
        let ids = || (0..=u8::MAX).map(LinkId);
        for (id, port) in ids().zip(&self.ports) {
            let Some(Port { options, .. }) = port else { continue };
            if !options.private {
                self.broadcast.insert(id);
            }
            if options.sniffer {
                self.sniffers.insert(id);
            }
            if !options.outbound.is_open() || !options.limits.is_open() {
                self.screened.insert(id);
            }
            if let Some(group) = options.group {
                groups.entry(group).or_default().insert(id);
            }
        }
        for (id, port) in ids().zip(&mut self.ports) {
            let Some(port) = port else { continue };
            let own = LinkSet::only(id);
            port.group = port.options.group.map_or(own, |group| groups[&group]);
        }
    }

    /// Decides about a frame that arrived over `source`. `frame` is whole and good, `header` its header and `entry`
    /// what the registry has for its id; `now` is of a clock that never goes back.
    ///
    /// # Panics
    /// Where there is no link `source`.
    #[inline]
    pub fn route(
        &mut self,
        frame: &[u8],
        header: &Header,
        entry: Option<Entry>,
        source: LinkId,
        now: u64,
    ) -> Fate {
        let port = self.ports[source.index()].as_mut().expect("frames come from links there are");
        port.stats.received += 1;
        port.stats.received_bytes += frame.len() as u64;
        if port.has_inbound && !port.options.inbound.accept(header) {
            port.stats.filtered_in += 1;
            return Fate::Filtered;
        }
        let &Header { sysid, compid, seq, .. } = header;
        let group = port.group;
        if self.dedup.is_duplicate(frame, source, now) {
            port.stats.duplicates += 1;
            self.table.advance(now);
            self.table.hear_duplicate(sysid, compid, group);
            return Fate::Duplicate;
        }
        if header.msgid == SETUP_SIGNING {
            port.stats.withheld += 1;
            return Fate::Withheld;
        }
        self.table.advance(now);
        let home = self.table.hear(Sender { sysid, compid, seq, len: frame.len() }, group, now);
        let reached = self.reached(frame, header, entry, source);
        if reached.is_none() {
            self.count(source, |stats| stats.unroutable += 1);
        }
        let links = (reached.unwrap_or_default() | self.sniffers()) - home - group;
        if links.is_empty() && reached.is_none() {
            return Fate::Unroutable;
        }
        Fate::Forwarded(self.screen(links, frame, header, entry, group, now))
    }

    /// Whether a frame may leave over a link that was not routed, as what the link itself has to say: filter and limits
    /// hold for that too.
    pub fn admit(
        &mut self,
        frame: &[u8],
        header: &Header,
        entry: Option<Entry>,
        link: LinkId,
        now: u64,
    ) -> bool {
        !self.screen(LinkSet::only(link), frame, header, entry, LinkSet::EMPTY, now).is_empty()
    }

    /// The links that a frame from `source` goes to; `None` if its target is unknown.
    #[inline]
    fn reached(
        &mut self,
        frame: &[u8],
        header: &Header,
        entry: Option<Entry>,
        source: LinkId,
    ) -> Option<LinkSet> {
        let none = TargetOffsets { system: NONE, component: NONE };
        let offsets = entry.map_or(none, |entry| self.targets[usize::from(entry.index)]);
        let byte = |offset| match offset {
            NONE => 0,
            offset => payload_byte(frame, header, offset.into()),
        };
        let links = match (byte(offsets.system), byte(offsets.component)) {
            (0, _) => return Some(self.broadcast),
            (system, 0) => self.table.system(system),
            (system, component) => self.table.component(system, component),
        };
        if links.is_empty() {
            return None;
        }
        if let Some(port) = &mut self.ports[source.index()] {
            port.has_targeted = true;
        }
        Some(links)
    }

    /// The links that get everything.
    #[inline]
    fn sniffers(&self) -> LinkSet {
        match self.sniffer_sysid {
            0 => self.sniffers,
            sysid => self.sniffers | self.table.system(sysid),
        }
    }

    /// Filters `links`: outbound filters and limits may hold back a frame that came from the group `source`.
    #[inline]
    fn screen(
        &mut self,
        links: LinkSet,
        frame: &[u8],
        header: &Header,
        entry: Option<Entry>,
        source: LinkSet,
        now: u64,
    ) -> LinkSet {
        let screened = links & self.screened;
        if screened.is_empty() {
            return links;
        }
        self.asked += 1;
        let stream = stream_key(header, source);
        let mut passed = links;
        for link in screened.iter() {
            let Some(port) = &mut self.ports[link.index()] else { continue };
            if !port.options.outbound.accept(header) {
                port.stats.filtered_out += 1;
                passed.remove(link);
            } else if let Some(limiter) = &mut port.limiter {
                let len = port.options.border.len_outside(frame.len(), header, entry);
                if limiter.admit(stream, len, self.asked, now.saturating_mul(1000)) {
                    continue;
                }
                port.stats.limited += 1;
                passed.remove(link);
            }
        }
        passed
    }

    fn count(&mut self, link: LinkId, with: impl FnOnce(&mut LinkStats)) {
        if let Some(port) = &mut self.ports[link.index()] {
            with(&mut port.stats);
        }
    }

    /// The counts of a link; `None` if there is no such link.
    pub fn link_stats(&self, link: LinkId) -> Option<LinkStats> {
        Some(self.ports.get(link.index())?.as_ref()?.stats)
    }

    /// Whether a link has sent a frame to a known system.
    pub fn has_targeted(&self, link: LinkId) -> bool {
        self.ports.get(link.index()).and_then(Option::as_ref).is_some_and(|port| port.has_targeted)
    }

    /// Everyone who was heard: system, component, what came, and the links that lead there now.
    pub fn components(&self, now: u64) -> impl Iterator<Item = (u8, u8, ComponentStats, LinkSet)> {
        self.table.components(now)
    }
}

/// A byte of the payload; 0 behind its end, where version 2 leaves zeros out.
#[inline]
fn payload_byte(frame: &[u8], header: &Header, offset: usize) -> u8 {
    if offset < usize::from(header.payload_len) { frame[header.len() + offset] } else { 0 }
}

#[cfg(test)]
mod properties;
#[cfg(test)]
mod tests;
