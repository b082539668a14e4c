//! What the event loop knows about itself, for who asks.

use std::net::UdpSocket;
use std::os::fd::AsRawFd as _;

use mavwire_core::router::{ComponentStats, LinkSet};

use super::connections::{Kind, Link};
use super::event_loop::{EventLoop, PROGRAM_NAME};
use super::latency::Latency;
use super::port::{Port, Wire};
use super::recorder::Recorder;
use super::stats::{ComponentReport, LinkReport, Stats};

/// Components that are told of: those that were heard last.
const MAX_COMPONENTS: usize = 4_096;

/// Who was heard, as it stands in the router: thousands, if someone makes up addresses. Who asks turns it into reports, so
/// that frames do not wait for that.
pub(super) struct Heard {
    now: u64,
    components: Vec<(u8, u8, ComponentStats, LinkSet)>,
    /// Names of links by the numbers of their ports.
    names: Vec<Option<String>>,
}

impl Heard {
    /// A report on each component, and how many there are besides: who makes up addresses does not make every look at the
    /// numbers slow for ever after.
    pub(super) fn reports(mut self) -> (Vec<ComponentReport>, usize) {
        let hidden = self.components.len().saturating_sub(MAX_COMPONENTS);
        if hidden > 0 {
            let heard = |(.., stats, _): &(u8, u8, ComponentStats, LinkSet)| stats.heard;
            self.components.select_nth_unstable_by_key(hidden, heard);
            self.components.drain(..hidden);
            self.components.sort_unstable_by_key(|&(sysid, compid, ..)| (sysid, compid));
        }
        let report = |&(sysid, compid, stats, links): &(u8, u8, ComponentStats, LinkSet)| {
            let names = links.iter().filter_map(|id| self.names.get(id.index())?.as_deref());
            let age = self.now.saturating_sub(stats.heard) as f64 / 1e6;
            ComponentReport { sysid, compid, stats, age, links: unique(names) }
        };
        (self.components.iter().map(report).collect(), hidden)
    }
}

impl EventLoop {
    /// All but the components, and what they are made of.
    pub(super) fn stats(&self) -> (Stats, Heard) {
        let now = self.switch.moment.now;
        let program = LinkReport {
            name: PROGRAM_NAME.to_owned(),
            state: "up",
            traffic: self.switch.traffic(self.switch.program()),
            ..LinkReport::default()
        };
        let links = self.links.iter().flat_map(|(&n, link)| self.link_reports(n, link));
        let stats = Stats {
            uptime: now as f64 / 1e6,
            links: links.chain([program]).collect(),
            components: Vec::new(),
            hidden_components: 0,
            recording: self.recorder.as_ref().map(Recorder::stats),
        };
        let components = self.switch.router().components(now).collect();
        (stats, Heard { now, components, names: self.names() })
    }

    /// Number of a port -> name of its link.
    fn names(&self) -> Vec<Option<String>> {
        let mut names = Vec::new();
        for port in self.switch.ports() {
            let link = self.links.get(&port.link);
            names.resize(names.len().max(port.id.index() + 1), None);
            names[port.id.index()] =
                Some(link.map_or(PROGRAM_NAME, |link| &link.spec.name).to_owned());
        }
        names
    }

    fn link_reports(&self, number: u32, link: &Link) -> Vec<LinkReport> {
        let report = LinkReport {
            name: link.spec.name.clone(),
            endpoint: link.spec.endpoint.to_string(),
            refused: link.refused,
            error: link.error.clone(),
            ..LinkReport::default()
        };
        let ports = self.switch.ports().filter(|port| port.link == number);
        let mut reports: Vec<LinkReport> = ports
            .map(|port| LinkReport {
                peer: port.peer.clone(),
                state: state_of(&port.wire, &link.kind),
                traffic: self.switch.traffic(port.id),
                queued: port.outbox.queued(),
                latency: percentiles(&port.outbox.latency),
                overrun: link.socket(port).and_then(overrun),
                ..report.clone()
            })
            .collect();
        match &link.kind {
            Kind::DatagramServer(..) | Kind::Listener(_) => {
                for peer in &mut reports {
                    (peer.refused, peer.error) = (0, None);
                }
                let own = LinkReport {
                    state: "listening",
                    traffic: link.departed,
                    latency: percentiles(&link.departed_latency),
                    overrun: link.server_socket().and_then(overrun),
                    connections: link.welcomed,
                    ..report
                };
                reports.insert(0, own);
            }
            Kind::Dialled(_, dialling) => {
                for one in &mut reports {
                    one.connections = dialling.connections;
                }
            }
            Kind::Datagrams(..) => {}
        }
        reports
    }
}

impl Link {
    /// The socket that all peers of a UDP server share.
    fn server_socket(&self) -> Option<&UdpSocket> {
        if let Kind::DatagramServer(socket, _) = &self.kind { Some(socket) } else { None }
    }

    /// The socket of a port that shares it with no other.
    fn socket<'a>(&self, port: &'a Port) -> Option<&'a UdpSocket> {
        match (&self.kind, &port.wire) {
            (Kind::DatagramServer(..), _) => None,
            (_, Wire::Datagrams(socket, _)) => Some(socket.as_ref()),
            _ => None,
        }
    }
}

/// Datagrams that the system dropped because they were not read in time.
#[cfg(target_os = "linux")]
fn overrun(socket: &UdpSocket) -> Option<u64> {
    /// Numbers that tell of a socket's memory (`SK_MEMINFO_VARS`), the last of which counts what was dropped.
    const COUNT: usize = 9;
    let mut numbers = [0_u32; COUNT];
    let mut len = size_of_val(&numbers) as libc::socklen_t;
    // SAFETY: the pointers are to so many bytes, and to their number, both of which the call may write.
    let done = unsafe {
        libc::getsockopt(
            socket.as_raw_fd(),
            libc::SOL_SOCKET,
            libc::SO_MEMINFO,
            numbers.as_mut_ptr().cast(),
            &raw mut len,
        )
    };
    (done == 0 && len as usize == size_of_val(&numbers)).then(|| numbers[COUNT - 1].into())
}

#[cfg(not(target_os = "linux"))]
fn overrun(_: &UdpSocket) -> Option<u64> {
    None
}

fn percentiles(latency: &Latency) -> [Option<u32>; 3] {
    [0.5, 0.99, 0.999].map(|part| latency.percentile(part))
}

fn unique<'a>(names: impl Iterator<Item = &'a str>) -> Vec<String> {
    let mut unique: Vec<String> = Vec::new();
    for name in names {
        if !unique.iter().any(|known| known == name) {
            unique.push(name.to_owned());
        }
    }
    unique
}

fn state_of(wire: &Wire, kind: &Kind) -> &'static str {
    match (wire, kind) {
        (Wire::Down, Kind::Dialled(_, dialling)) if dialling.under_way || dialling.at.is_some() => {
            "connecting"
        }
        (Wire::Down, _) => "down",
        _ => "up",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_too_many_components_those_are_told_of_that_were_heard_last() {
        let heard = |count: u64| {
            let stats = |n| ComponentStats { heard: n, ..ComponentStats::default() };
            let one =
                |n: u64| ((n >> 8) as u8, n as u8, stats((n + 5_000) % count), LinkSet::EMPTY);
            let components = (0..count).map(one).collect();
            Heard { now: count, components, names: Vec::new() }.reports()
        };
        let (all, hidden) = heard(4_096);
        assert_eq!((all.len(), hidden), (4_096, 0));
        let (some, hidden) = heard(65_536);
        assert_eq!((some.len(), hidden), (4_096, 65_536 - 4_096));
        assert!(some.iter().all(|one| one.stats.heard >= 65_536 - 4_096));
        assert!(some.is_sorted_by_key(|one| (one.sysid, one.compid)));
    }
}
