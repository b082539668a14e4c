//! The statistics of a bridge.

use mavwire_core::router::{ComponentStats, LinkStats};
use mavwire_core::unknown::UnknownCounts;

use super::latency::Latency;
use super::recorder::RecordingStats;

/// Unknown kinds of messages that are counted apart for a link or peer.
pub(super) const MOST_UNKNOWN: usize = 64;

/// A bridge at one moment.
#[derive(Debug, Clone, Default)]
pub struct Stats {
    /// Seconds since it started.
    pub uptime: f64,
    /// Its links, the peers of those that have several, and last the program around the bridge.
    pub links: Vec<LinkReport>,
    /// Everyone who was heard, up to some thousands that were heard last.
    pub components: Vec<ComponentReport>,
    /// Components that are not among these.
    pub hidden_components: usize,
    /// The recording.
    pub recording: Option<RecordingStats>,
}

/// Counts of a link's frames.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Traffic {
    /// Frames that came in, by what the router did with them.
    pub routed: LinkStats,
    /// Frames that left.
    pub sent: u64,
    /// Their bytes.
    pub sent_bytes: u64,
    /// Frames that did not, because the link was down or too slow.
    pub dropped: u64,
    /// Attempts to send that the system refused.
    pub send_errors: u64,
    /// Frames that came damaged.
    pub damaged: u64,
    /// Bytes of these, and of what was no frame at all.
    pub junk_bytes: u64,
    /// Frames that came without the good signature that they need here.
    pub unverified: u64,
    /// Frames that did not leave because the version of the link cannot carry them.
    pub unconverted: u64,
}

impl Traffic {
    /// The counters with their names for users.
    pub fn counters(&mut self) -> [(&'static str, &mut u64); 16] {
        let Self { routed, .. } = self;
        [
            ("received", &mut routed.received),
            ("received_bytes", &mut routed.received_bytes),
            ("duplicates", &mut routed.duplicates),
            ("filtered_in", &mut routed.filtered_in),
            ("withheld", &mut routed.withheld),
            ("unroutable", &mut routed.unroutable),
            ("sent", &mut self.sent),
            ("sent_bytes", &mut self.sent_bytes),
            ("filtered_out", &mut routed.filtered_out),
            ("limited", &mut routed.limited),
            ("dropped", &mut self.dropped),
            ("send_errors", &mut self.send_errors),
            ("damaged", &mut self.damaged),
            ("junk_bytes", &mut self.junk_bytes),
            ("unverified", &mut self.unverified),
            ("unconverted", &mut self.unconverted),
        ]
    }

    /// Adds the numbers of a peer that left to those of its link.
    pub(super) fn add(&mut self, mut other: Self) {
        for ((_, sum), (_, more)) in self.counters().into_iter().zip(other.counters()) {
            *sum += *more;
        }
    }
}

/// The numbers of peers that left.
#[derive(Debug, Default)]
pub(super) struct Departed {
    pub(super) traffic: Traffic,
    pub(super) latency: Latency,
    pub(super) unknown: UnknownCounts,
}

impl Departed {
    pub(super) fn add(&mut self, other: Self) {
        self.traffic.add(other.traffic);
        self.latency.add(&other.latency);
        for (kind, count) in other.unknown.listed {
            self.unknown.add(kind, count, MOST_UNKNOWN);
        }
        self.unknown.unlisted += other.unknown.unlisted;
    }
}

/// A link, or one peer of it.
#[derive(Debug, Clone, Default)]
pub struct LinkReport {
    /// Name of the link.
    pub name: String,
    /// Where it leads.
    pub endpoint: String,
    /// The peer, where the link has several or is connected to one. A server's own entry has none, and the traffic of
    /// the peers that left.
    pub peer: Option<String>,
    /// `up`, `connecting`, `listening`, or `down` for good.
    pub state: &'static str,
    /// Counts of its frames.
    pub traffic: Traffic,
    /// Messages that the dialect does not define.
    pub unknown: UnknownCounts,
    /// Bytes that wait to leave.
    pub queued: usize,
    /// How long frames were in the bridge from arriving to having left; microseconds that a half, 99 and 99.9 of a
    /// hundred did not exceed.
    pub latency: [Option<u32>; 3],
    /// Datagrams that the system dropped because they were not read in time, where it says so.
    pub overrun: Option<u64>,
    /// Peers that were turned away because there were too many.
    pub refused: u64,
    /// Connections that came about; peers that a server got so far.
    pub connections: u64,
    /// Why the last attempt to connect failed.
    pub error: Option<String>,
}

/// A component that was heard.
#[derive(Debug, Clone)]
pub struct ComponentReport {
    /// System id.
    pub sysid: u8,
    /// Component id.
    pub compid: u8,
    /// Counts of the frames received from it.
    pub stats: ComponentStats,
    /// Seconds since the last of it.
    pub age: f64,
    /// Names of the links that lead to it now.
    pub links: Vec<String>,
}
