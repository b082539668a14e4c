//! Properties of the router in every network: no frame circulates for ever, none is lost or doubled on the way, and
//! filters stop exactly the frames that they name.

use super::*;
use crate::testing::{encode, header, registry};
use mavwire_schema::WireVersion::V2;
use proptest::prelude::*;
use std::collections::VecDeque;

fn router(links: &[LinkOptions], settings: Settings) -> Router {
    let mut router = Router::new(&registry(), settings);
    for options in links {
        router.add_link(options.clone()).expect("there is room");
    }
    router
}

fn heartbeat(sysid: u8, compid: u8, seq: u8) -> (Header, Vec<u8>) {
    let frame = encode(Header { sysid, compid, ..header(V2, 0, seq) }, &[1; 9]);
    (Header::parse(&frame).expect("a frame"), frame)
}

fn route(router: &mut Router, (header, frame): &(Header, Vec<u8>), link: u8, now: u64) -> LinkSet {
    match router.route(frame, header, None, LinkId(link), now) {
        Fate::Forwarded(links) => links,
        _ => LinkSet::EMPTY,
    }
}

/// Routers joined by cables; link 0 of each leads to a station of its own.
struct Graph {
    routers: Vec<Router>,
    /// `cables[router][link - 1]`: the router and link at the other end.
    cables: Vec<Vec<(usize, u8)>>,
}

impl Graph {
    /// A connected graph: router `n + 1` hangs on one before it, and further cables close loops.
    fn new(tree: &[usize], loops: &[(usize, usize)], dedup_window: u64) -> Self {
        let count = tree.len() + 1;
        let mut cables = vec![Vec::new(); count];
        let edges = tree.iter().enumerate().map(|(n, &up)| (n + 1, up % (n + 1)));
        for (a, b) in edges.chain(loops.iter().map(|&(a, b)| (a % count, b % count))) {
            if a != b {
                let (at_a, at_b) = (cables[a].len() as u8 + 1, cables[b].len() as u8 + 1);
                cables[a].push((b, at_b));
                cables[b].push((a, at_a));
            }
        }
        let settings = Settings { dedup_window, ..Settings::new(5) };
        let routers = cables
            .iter()
            .map(|cables| router(&vec![LinkOptions::default(); cables.len() + 1], settings));
        Self { routers: routers.collect(), cables }
    }

    /// Sends a frame from a router's station; how many copies each station gets, `None` if it does not come to rest.
    fn send(&mut self, at: usize, frame: &(Header, Vec<u8>), now: u64) -> Option<Vec<usize>> {
        let mut copies = vec![0; self.routers.len()];
        let mut under_way = VecDeque::from([(at, 0)]);
        for _ in 0..100_000 {
            let Some((at, link)) = under_way.pop_front() else { return Some(copies) };
            for out in route(&mut self.routers[at], frame, link, now).iter() {
                match out.index().checked_sub(1) {
                    None => copies[at] += 1,
                    Some(cable) => under_way.push_back(self.cables[at][cable]),
                }
            }
        }
        None
    }
}

fn graphs() -> impl Strategy<Value = (Vec<usize>, Vec<(usize, usize)>)> {
    let tree = prop::collection::vec(0..100_usize, 1..8);
    (tree, prop::collection::vec((0..100_usize, 0..100_usize), 0..8))
}

proptest! {
    // Each case makes routers with a megabyte of duplicate suppression; the networks are small.
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn every_station_gets_one_copy_however_many_loops_there_are(
        (tree, loops) in graphs(),
        senders in prop::collection::vec(0..100_usize, 1..20),
    ) {
        let mut graph = Graph::new(&tree, &loops, 500_000);
        for (n, sender) in senders.iter().enumerate() {
            let at = sender % graph.routers.len();
            let frame = heartbeat(at as u8 + 1, 1, n as u8);
            let copies = graph.send(at, &frame, n as u64 * 1_000);
            let mut expected = vec![1; graph.routers.len()];
            expected[at] = 0;
            prop_assert_eq!(copies, Some(expected));
        }
    }

    #[test]
    fn without_duplicate_suppression_frames_still_come_to_rest(
        (tree, loops) in (prop::collection::vec(0..100_usize, 1..4), prop::collection::vec((0..100_usize, 0..100_usize), 0..3)),
        sysid in prop_oneof![Just(0), any::<u8>()],
    ) {
        let mut graph = Graph::new(&tree, &loops, 0);
        let copies = graph.send(0, &heartbeat(sysid, 1, 0), 0);
        prop_assert!(copies.is_some_and(|copies| copies.iter().skip(1).all(|&count| count >= 1)));
    }

    #[test]
    fn filters_commute_with_routing(
        frames in prop::collection::vec((1..4_u8, 1..3_u8, 0..4_u8), 1..40),
        blocked in prop::collection::vec(1..4_u32, 0..3),
        allowed in prop::option::of(prop::collection::vec(1..3_u32, 0..3)),
    ) {
        let mut filter = Filter::default().block(Part::Systems, blocked);
        if let Some(allowed) = allowed {
            filter = filter.allow(Part::Components, allowed);
        }
        let open = LinkOptions::default;
        let at_exit = LinkOptions { outbound: filter.clone(), ..open() };
        let at_entry = LinkOptions { inbound: filter.clone(), ..open() };
        let settings = Settings::new(9);
        let mut plain = router(&[open(), open(), open(), open()], settings);
        let mut outbound = router(&[open(), at_exit, open(), open()], settings);
        let mut inbound = router(&[at_entry, open(), open(), open()], settings);
        let mut never = plain.clone();
        for (seq, &(sysid, compid, link)) in (0..).zip(&frames) {
            let frame = heartbeat(sysid, compid, seq);
            let mut links = route(&mut plain, &frame, link, 0);
            if !filter.accept(&frame.0) {
                links.remove(LinkId(1));
            }
            prop_assert_eq!(route(&mut outbound, &frame, link, 0), links, "routed, then filtered");
            let got = route(&mut inbound, &frame, link, 0);
            let stopped = link == 0 && !filter.accept(&frame.0);
            let wanted =
                if stopped { LinkSet::EMPTY } else { route(&mut never, &frame, link, 0) };
            prop_assert_eq!(got, wanted, "what is stopped was never there");
        }
    }

    #[test]
    fn nothing_is_lost_below_the_limits(
        gaps in prop::collection::vec(20_000..60_000_u64, 1..200),
        compids in prop::collection::vec(1..5_u8, 200),
    ) {
        // At most 50 frames of 21 bytes a second, by limits of 50 and of 1,050.
        let limits = Limits {
            bytes_per_second: Some(ByteRate::new(1_050.0)),
            message_rate: Some(50.0),
            ..Limits::default()
        };
        let limited = LinkOptions { limits, ..LinkOptions::default() };
        let mut router = router(&[LinkOptions::default(), limited], Settings::new(2));
        let mut now = 1_000_000;
        for (n, (gap, compid)) in gaps.iter().zip(compids).enumerate() {
            now += gap;
            let frame = heartbeat(1, compid, n as u8);
            prop_assert_eq!(route(&mut router, &frame, 0, now), LinkSet::only(LinkId(1)));
        }
    }

    #[test]
    fn limits_hold_whatever_comes(
        gaps in prop::collection::vec(0..20_000_u64, 1..400),
        rate in 1..100_u32,
    ) {
        let limits = Limits { message_rate: Some(rate.into()), ..Limits::default() };
        let limited = LinkOptions { limits, ..LinkOptions::default() };
        let mut router = router(&[LinkOptions::default(), limited], Settings::new(2));
        let (mut now, mut passed) = (1_000_000_u64, 0_u64);
        for (n, gap) in gaps.iter().enumerate() {
            now += gap;
            passed += route(&mut router, &heartbeat(1, 1, n as u8), 0, now).len() as u64;
        }
        let most = (now - 1_000_000) * u64::from(rate) / 1_000_000 + 2;
        prop_assert!(passed <= most, "{} of at most {}", passed, most);
    }
}
