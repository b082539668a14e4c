//! Statistics that the event loop makes on request.

use mavwire_core::router::{ComponentStats, LinkSet};

use super::connections::{Kind, Link};
use super::endpoint::Wire;
use super::event_loop::{EventLoop, PROGRAM_NAME};
use super::latency::Latency;
use super::recorder::Recorder;
use super::socket_options::overrun;
use super::stats::{ComponentReport, LinkReport, Stats};

/// Components that are told of: those that were heard last.
const MAX_COMPONENTS: usize = 4_096;

/// Components as the router has them: thousands, if someone makes up addresses. The caller's thread makes reports of them,
/// so that frames do not wait.
pub(super) struct Heard {
    now: u64,
    components: Vec<(u8, u8, ComponentStats, LinkSet)>,
    /// Names of links by the numbers of their ports.
    names: Vec<Option<String>>,
}

impl Heard {
    /// Reports on the components heard last, and how many there are besides. Made-up addresses must not make statistics slow
    /// for ever.
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
    /// The statistics without the components, and the components as the router has them.
    pub(super) fn stats(&self) -> (Stats, Heard) {
        let now = self.switch.moment.now;
        let program = LinkReport {
            name: PROGRAM_NAME.to_owned(),
            state: "up",
            traffic: self.switch.traffic(self.switch.program()),
            unknown: self.switch.unknown(self.switch.program()),
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
        // Peers of a server share its socket.
        let server =
            if let Kind::DatagramServer(socket, _) = &link.kind { Some(socket) } else { None };
        let mut reports: Vec<LinkReport> = ports
            .map(|port| LinkReport {
                peer: port.peer.clone(),
                state: state_of(&port.wire, &link.kind),
                traffic: self.switch.traffic(port.id),
                unknown: self.switch.unknown(port.id),
                queued: port.outbox.queued(),
                latency: percentiles(&port.outbox.latency),
                overrun: if server.is_some() { None } else { port.overrun() },
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
                    traffic: link.departed.traffic,
                    unknown: link.departed.unknown.clone(),
                    latency: percentiles(&link.departed.latency),
                    overrun: server.and_then(|socket| overrun(socket)),
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
        }
        reports
    }
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
