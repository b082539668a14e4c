//! The rules as a table: what was heard where, a frame, and the links it goes to.

use super::*;
use crate::frame::IFLAG_SIGNED;
use crate::testing::{encode, header, registry};
use mavwire_schema::WireVersion::V2;

const HEARTBEAT: u32 = 0;
const SYSTEM_TIME: u32 = 2;
/// The messages of the testing dialect have no target offsets, so those of real ones are used.
const COMMAND_LONG: u32 = 76;
const MANUAL_CONTROL: u32 = 69;
const NOW: u64 = 10_000_000;

/// A router over `common`, and a way to feed it.
struct Net {
    router: Router,
    registry: Registry,
    seq: u8,
    now: u64,
}

impl Net {
    fn new(links: &[LinkOptions], settings: Settings) -> Self {
        let dialect = crate::builtin::dialect("common", V2).expect("it is built in");
        let registry = Registry::new(dialect);
        let mut router = Router::new(&registry, settings);
        for (n, options) in links.iter().enumerate() {
            assert_eq!(router.add_link(options.clone()), Some(LinkId(n as u8)));
        }
        Self { router, registry, seq: 0, now: NOW }
    }

    fn plain(links: usize) -> Self {
        Self::new(&vec![LinkOptions::default(); links], Settings::new(1))
    }

    fn frame(&mut self, (sysid, compid): (u8, u8), msgid: u32, payload: &[u8]) -> Vec<u8> {
        self.seq = self.seq.wrapping_add(1);
        let header = Header { sysid, compid, ..header(V2, msgid, self.seq) };
        let crc_extra = self.registry.lookup(msgid).map_or(77, |entry| entry.crc_extra);
        let mut out = Vec::new();
        crate::frame::encode(&mut out, header, payload, crc_extra).expect("a valid header");
        out
    }

    fn feed(&mut self, link: u8, frame: &[u8]) -> Fate {
        let header = Header::parse(frame).expect("a frame");
        let entry = self.registry.lookup(header.msgid);
        self.router.route(frame, &header, entry, LinkId(link), self.now)
    }

    fn send(&mut self, link: u8, from: (u8, u8), msgid: u32, payload: &[u8]) -> Fate {
        let frame = self.frame(from, msgid, payload);
        self.feed(link, &frame)
    }

    fn hear(&mut self, link: u8, from: (u8, u8)) {
        self.send(link, from, HEARTBEAT, &[1; 9]);
    }

    /// Where a command from `from` to `to` goes.
    fn command(&mut self, link: u8, from: (u8, u8), to: (u8, u8)) -> Fate {
        let mut payload = [1; 33];
        (payload[30], payload[31]) = to;
        self.send(link, from, COMMAND_LONG, &payload)
    }
}

fn to(links: &[u8]) -> Fate {
    Fate::Forwarded(links.iter().map(|&n| LinkId(n)).collect())
}

#[test]
fn what_has_no_target_goes_everywhere_but_back() {
    let mut net = Net::plain(4);
    assert_eq!(net.send(1, (1, 1), HEARTBEAT, &[1; 9]), to(&[0, 2, 3]));
    assert_eq!(net.command(1, (1, 1), (0, 0)), to(&[0, 2, 3]), "target 0");
    assert_eq!(net.command(1, (1, 1), (0, 7)), to(&[0, 2, 3]), "target 0, a component");
    assert_eq!(net.send(1, (1, 1), 12_345_678, &[9; 5]), to(&[0, 2, 3]), "an unknown id");
    assert_eq!(net.send(1, (0, 0), HEARTBEAT, &[1; 9]), to(&[0, 2, 3]), "no valid sender");
    assert_eq!(Net::plain(1).send(0, (1, 1), HEARTBEAT, &[1; 9]), to(&[]));
}

#[test]
fn what_has_a_target_goes_where_it_was_heard() {
    let mut net = Net::plain(5);
    for (link, from) in [(0, (1, 1)), (0, (1, 154)), (1, (1, 100)), (2, (2, 1)), (3, (255, 190))] {
        net.hear(link, from);
    }
    let cases: [((u8, u8), Fate); 8] = [
        ((1, 1), to(&[0])),
        ((1, 100), to(&[1])),
        ((1, 0), to(&[0, 1])),
        ((1, 55), to(&[0, 1])), // a component nobody heard, of a system that was
        ((2, 1), to(&[2])),
        ((2, 9), to(&[2])),
        ((9, 1), Fate::Unroutable),
        ((255, 190), to(&[])), // it lives where the frame came from
    ];
    for (target, fate) in cases {
        assert_eq!(net.command(3, (255, 190), target), fate, "{target:?}");
    }
    assert_eq!(net.router.link_stats(LinkId(3)).map(|stats| stats.unroutable), Some(1));
    let stick = [1; 11];
    assert_eq!(net.send(3, (255, 190), MANUAL_CONTROL, &stick), to(&[0, 1]), "`target` is one too");
    assert_eq!(net.command(0, (1, 154), (1, 100)), to(&[1]), "inside a system");
}

#[test]
fn a_trimmed_target_is_zero() {
    let mut net = Net::plain(3);
    net.hear(0, (1, 1));
    let mut payload = [1; 33];
    payload[30..].fill(0);
    assert_eq!(net.send(2, (255, 190), COMMAND_LONG, &payload), to(&[0, 1]));
}

#[test]
fn nothing_goes_to_where_the_sender_lives() {
    let mut net = Net::plain(4);
    net.hear(0, (1, 1));
    net.hear(1, (1, 1));
    assert_eq!(net.send(0, (1, 1), HEARTBEAT, &[1; 9]), to(&[2, 3]));
    assert_eq!(net.send(0, (1, 2), HEARTBEAT, &[1; 9]), to(&[1, 2, 3]), "another component");
}

#[test]
fn links_of_a_group_are_one_place() {
    let radio = LinkOptions { group: Some(7), ..LinkOptions::default() };
    let plain = LinkOptions::default;
    let mut net = Net::new(&[radio.clone(), radio, plain(), plain()], Settings::new(1));
    assert_eq!(net.send(0, (1, 1), HEARTBEAT, &[1; 9]), to(&[2, 3]));
    assert_eq!(net.command(2, (255, 190), (1, 1)), to(&[0, 1]), "over both radios");
    net.router.remove_link(LinkId(1));
    assert_eq!(net.command(2, (255, 190), (1, 1)), to(&[0]));
}

#[test]
fn private_links_get_only_what_is_meant_for_them() {
    let private = LinkOptions { private: true, ..LinkOptions::default() };
    let mut net = Net::new(&[LinkOptions::default(), private], Settings::new(1));
    assert_eq!(net.send(1, (1, 100), HEARTBEAT, &[1; 9]), to(&[0]));
    assert_eq!(net.send(0, (255, 190), HEARTBEAT, &[1; 9]), to(&[]));
    assert_eq!(net.command(0, (255, 190), (1, 100)), to(&[1]));
    assert_eq!(net.command(0, (255, 190), (1, 0)), to(&[1]));
}

#[test]
fn sniffers_get_everything() {
    let sniffer = LinkOptions { sniffer: true, private: true, ..LinkOptions::default() };
    let links = [LinkOptions::default(), LinkOptions::default(), sniffer, LinkOptions::default()];
    let mut net = Net::new(&links, Settings { sniffer_sysid: 254, ..Settings::new(1) });
    net.hear(0, (1, 1));
    net.hear(3, (254, 1));
    assert_eq!(net.command(1, (255, 190), (1, 1)), to(&[0, 2, 3]));
    assert_eq!(net.command(1, (255, 190), (9, 1)), to(&[2, 3]), "even what nobody can get");
    assert_eq!(net.command(2, (255, 190), (9, 1)), to(&[3]), "but not back");
}

#[test]
fn r53_keys_stay_where_they_are() {
    let mut net = Net::plain(2);
    net.hear(1, (1, 1));
    let setup = [1; 42];
    assert_eq!(net.send(0, (255, 190), SETUP_SIGNING, &setup), Fate::Withheld);
    assert_eq!(net.router.link_stats(LinkId(0)).map(|stats| stats.withheld), Some(1));
}

#[test]
fn spoofed_restarts_take_no_route_from_a_system_that_is_alive() {
    let time = |boot_ms: u32| [&[1; 8][..], &boot_ms.to_le_bytes()].concat();
    let mut net = Net::plain(3);
    net.hear(0, (1, 1));
    for boot_ms in [1_000_000_000, 0] {
        net.send(1, (1, 1), SYSTEM_TIME, &time(boot_ms));
        net.now += 4_000_000;
    }
    assert_eq!(net.command(2, (255, 190), (1, 1)), to(&[0, 1]));
}

#[test]
fn a_system_that_moves_to_another_link_is_known_at_both_until_the_old_route_is_silent() {
    let mut net = Net::plain(3);
    net.hear(0, (1, 1));
    net.now += 59_000_000;
    net.hear(1, (1, 1));
    assert_eq!(net.command(2, (255, 190), (1, 1)), to(&[0, 1]));
    net.now += 59_000_000;
    net.hear(1, (1, 1));
    net.now += 3_000_000;
    assert_eq!(net.command(2, (255, 190), (1, 1)), to(&[1]));
}

#[test]
fn faster_copies_of_the_frames_of_another_take_no_route_from_it() {
    let mut net = Net::plain(3);
    net.hear(0, (1, 1));
    for _ in 0..30 {
        net.now += 10_000_000;
        let frame = net.frame((1, 1), HEARTBEAT, &[1; 9]);
        assert_ne!(net.feed(1, &frame), Fate::Duplicate, "a copy that comes before its original");
        assert_eq!(net.feed(0, &frame), Fate::Duplicate);
        assert_eq!(net.command(2, (255, 190), (1, 1)), to(&[0, 1]));
        assert_eq!(net.command(2, (255, 190), (1, 0)), to(&[0, 1]));
    }
    net.now += 121_000_000;
    assert_eq!(net.command(2, (255, 190), (1, 1)), Fate::Unroutable, "silence ends it");
}

#[test]
fn a_spoofed_sender_does_not_use_up_the_rate_of_the_genuine_one() {
    let limits = Limits { message_rates: vec![(HEARTBEAT, 1.0)], ..Limits::default() };
    let thin = LinkOptions { limits, ..LinkOptions::default() };
    let plain = LinkOptions::default;
    let mut net = Net::new(&[plain(), plain(), thin], Settings::new(1));
    for _ in 0..10 {
        for _ in 0..50 {
            net.now += 20_000;
            net.hear(1, (1, 1));
        }
        assert_eq!(net.send(0, (1, 1), HEARTBEAT, &[1; 9]), to(&[2]));
    }
}

#[test]
fn routes_end_with_their_link_and_with_time() {
    let mut net = Net::plain(3);
    net.hear(0, (1, 1));
    assert_eq!(net.router.remove_link(LinkId(0)).map(|stats| stats.received), Some(1));
    assert_eq!(net.router.remove_link(LinkId(0)), None);
    assert_eq!(net.command(2, (255, 190), (1, 1)), Fate::Unroutable);
    assert_eq!(net.router.add_link(LinkOptions::default()), Some(LinkId(0)), "the number is free");
    assert_eq!(net.command(2, (255, 190), (1, 1)), Fate::Unroutable, "the routes are not back");
    net.hear(0, (1, 1));
    net.now += 59_000_000;
    assert_eq!(net.command(2, (255, 190), (1, 1)), to(&[0]));
    net.now += 61_000_000;
    assert_eq!(net.command(2, (255, 190), (1, 1)), Fate::Unroutable);
}

#[test]
fn there_is_room_for_so_many_links() {
    let mut net = Net::plain(MAX_LINKS);
    assert_eq!(net.router.add_link(LinkOptions::default()), None);
    let Fate::Forwarded(links) = net.send(255, (1, 1), HEARTBEAT, &[1; 9]) else { panic!() };
    assert_eq!(links.len(), MAX_LINKS - 1);
}

#[test]
fn copies_from_another_link_are_dropped_and_teach_nothing() {
    let mut net = Net::plain(3);
    let frame = net.frame((1, 1), HEARTBEAT, &[1; 9]);
    assert_eq!(net.feed(0, &frame), to(&[1, 2]));
    assert_eq!(net.feed(1, &frame), Fate::Duplicate);
    assert_eq!(net.feed(0, &frame), to(&[1, 2]), "the same link may repeat itself");
    // Otherwise the second route of a ring of bridges is unused, and nothing arrives when the first is cut.
    assert_eq!(net.send(0, (1, 1), HEARTBEAT, &[1; 9]), to(&[1, 2]));
    assert_eq!(net.command(2, (255, 190), (1, 1)), to(&[0]));
    let stats = net.router.link_stats(LinkId(1)).expect("it is there");
    assert_eq!((stats.received, stats.received_bytes, stats.duplicates), (1, 21, 1));
}

#[test]
fn filters_and_limits_take_their_share() {
    let inbound = Filter::default().block(Part::Messages, [30]);
    let outbound = Filter::default().allow(Part::Systems, [2]);
    let limits = Limits { message_rates: vec![(0, 1.0)], ..Limits::default() };
    let links = [
        LinkOptions { inbound, ..LinkOptions::default() },
        LinkOptions { outbound, ..LinkOptions::default() },
        LinkOptions { limits, ..LinkOptions::default() },
    ];
    let mut net = Net::new(&links, Settings::new(1));
    assert_eq!(net.send(0, (1, 1), 30, &[1; 28]), Fate::Filtered);
    assert_eq!(net.command(1, (255, 190), (1, 1)), Fate::Unroutable, "it was never received");
    assert_eq!(net.send(0, (1, 1), HEARTBEAT, &[1; 9]), to(&[2]));
    assert_eq!(net.send(0, (2, 1), HEARTBEAT, &[1; 9]), to(&[1, 2]));
    assert_eq!(net.send(0, (2, 1), HEARTBEAT, &[1; 9]), to(&[1]), "too soon for link 2");
    let counts = |link| net.router.link_stats(LinkId(link)).expect("it is there");
    assert_eq!((counts(0).filtered_in, counts(1).filtered_out, counts(2).limited), (1, 1, 1));
}

#[test]
fn bytes_are_counted_as_they_leave_and_those_of_the_link_itself_too() {
    let link = |sign| LinkOptions {
        limits: Limits { bytes_per_second: Some(ByteRate::new(3_400.0)), ..Limits::default() },
        outbound: Filter::default().block(Part::Messages, [30]),
        border: BorderOptions { sign, ..BorderOptions::default() },
        ..LinkOptions::default()
    };
    let mut net = Net::new(&[LinkOptions::default(), link(false), link(true)], Settings::new(1));
    let mut passed = [0; 3];
    for _ in 0..10_000 {
        net.now += 1_000;
        if let Fate::Forwarded(links) = net.send(0, (1, 1), HEARTBEAT, &[1; 9]) {
            links.iter().for_each(|link| passed[link.index()] += 1);
        }
    }
    // 34,000 bytes in 10 seconds, and less than three quarters of a second's ahead; frames of 21 bytes, and of 34 with a signature.
    assert!((1_619..=1_740).contains(&passed[1]) && (1_000..=1_075).contains(&passed[2]));
    let mut own = |msgid| {
        let frame = net.frame((125, 240), msgid, &[1; 9]);
        let header = Header::parse(&frame).expect("a frame");
        let entry = net.registry.lookup(msgid);
        (0..10_000).filter(|_| net.router.admit(&frame, &header, entry, LinkId(2), net.now)).count()
    };
    assert_eq!(own(30), 0, "stopped");
    assert!((1..=4).contains(&own(HEARTBEAT)), "too many but for the first ones");
    net.now += 10_000_000;
    let frame = net.frame((125, 240), HEARTBEAT, &[1; 9]);
    let header = Header::parse(&frame).expect("a frame");
    let admit = |_: &i32| net.router.admit(&frame, &header, None, LinkId(2), net.now);
    let count = (0..10_000).filter(admit).count();
    assert!((150..=152).contains(&count), "a second and a half ahead: {count}");
}

#[test]
fn peers_of_a_link_have_its_bytes_together_and_each_gets_the_same() {
    let limits = Limits { bytes_per_second: Some(ByteRate::new(2_100.0)), ..Limits::default() };
    let peer = LinkOptions { limits, ..LinkOptions::default() };
    let others = vec![peer; 5];
    let mut net = Net::new(&[vec![LinkOptions::default()], others].concat(), Settings::new(1));
    let mut passed = [0; 6];
    for _ in 0..10_000 {
        net.now += 1_000;
        if let Fate::Forwarded(links) = net.send(0, (1, 1), HEARTBEAT, &[1; 9]) {
            links.iter().for_each(|link| passed[link.index()] += 1);
        }
    }
    // 21,000 bytes in 10 seconds and less than three quarters of a second's ahead, 105 for each frame.
    assert!((200..=215).contains(&passed[1]), "{passed:?}");
    assert!(passed[2..].iter().all(|&count| count == passed[1]), "{passed:?}");
}

#[test]
fn r19_signed_frames_and_version_1_are_routed_like_others() {
    let mut net = Net::plain(2);
    net.hear(0, (1, 1));
    let mut signed = net.frame((255, 190), COMMAND_LONG, &[1; 33]);
    signed[2] |= IFLAG_SIGNED;
    signed.extend([5; 13]);
    assert_eq!(net.feed(1, &signed), to(&[0]));
    let v1 = Header { sysid: 255, ..header(mavwire_schema::WireVersion::V1, COMMAND_LONG, 0) };
    let mut frame = Vec::new();
    crate::frame::encode(&mut frame, v1, &[1; 33], 152).expect("a valid header");
    assert_eq!(net.feed(1, &frame), to(&[0]));
}

#[test]
fn everyone_who_was_heard_is_listed() {
    let mut net = Net::plain(2);
    net.hear(0, (1, 1));
    net.hear(1, (255, 190));
    let frame = net.frame((255, 190), HEARTBEAT, &[1; 9]);
    net.feed(1, &frame);
    assert_eq!(net.feed(0, &frame), Fate::Duplicate);
    let listed: Vec<_> = net.router.components(net.now).collect();
    let heard = |frames, bytes, duplicates| ComponentStats {
        frames,
        bytes,
        lost: 0,
        duplicates,
        heard: NOW,
    };
    assert_eq!(
        listed,
        [
            (1, 1, heard(1, 21, 0), LinkSet::only(LinkId(0))),
            (255, 190, heard(2, 42, 1), LinkSet::only(LinkId(1))),
        ]
    );
}

#[test]
fn a_dialect_without_targets_still_routes() {
    let mut router = Router::new(&registry(), Settings::new(1));
    for _ in 0..2 {
        router.add_link(LinkOptions::default());
    }
    let frame = encode(header(V2, 110, 0), &[1; 20]);
    let parsed = Header::parse(&frame).expect("a frame");
    let entry = registry().lookup(110);
    assert_eq!(router.route(&frame, &parsed, entry, LinkId(0), 0), to(&[1]));
}
