use super::*;
use crate::frame::Header;
use crate::router::limit::stream_key;
use crate::router::links::LinkSet;
use crate::testing::header;
use mavwire_schema::WireVersion::V2;

mod mixes;

/// The longest frame.
const MAX_LEN: f64 = 280.0;
const MS: u64 = 1_000_000;
const HEARTBEAT: u32 = 0;

/// A message type: id, bytes, how often in ten seconds.
type Kind = (u32, usize, u64);

/// A link at which messages come at stated times.
struct Link {
    bytes: ByteRate,
    number: u64,
}

impl Link {
    fn new(rate: f64) -> Self {
        Self { bytes: ByteRate::new(rate), number: 0 }
    }

    /// Whether a message passes.
    fn passes(&mut self, msgid: u32, len: usize, is_urgent: bool, now: u64) -> bool {
        self.passes_to(1, &header(V2, msgid, 0), len, is_urgent, now)
    }

    /// Whether one passes that is for so many peers.
    fn passes_to(
        &mut self,
        peers: usize,
        header: &Header,
        len: usize,
        is_urgent: bool,
        now: u64,
    ) -> bool {
        self.number += 1;
        let stream = stream_key(header, LinkSet::EMPTY);
        let asks = || self.bytes.admit(stream, len, is_urgent, self.number, now);
        let passes = asks();
        assert!((1..peers).all(|_| asks() == passes), "to all peers or to none");
        passes
    }

    /// How far ahead of the rate it is, in seconds.
    fn lead(&self, now: u64) -> f64 {
        self.bytes.account().ordinary.lead(now) as f64 / SECOND
    }

    /// How many messages of each kind pass that come in batches, so many seconds from one to the next: those of a batch
    /// in the order in which they were sent, at one moment.
    fn in_batches(&mut self, kinds: &[Kind], interval: f64, from: u64, seconds: u64) -> Vec<u64> {
        let mut messages = Vec::new();
        for (kind, &(.., often)) in kinds.iter().enumerate() {
            let sent = (0..seconds * often / 10).map(|n| 10.0 * n as f64 / often as f64);
            messages.extend(sent.map(|sent| ((sent / interval).floor(), sent, kind)));
        }
        messages.sort_by(|one, other| one.partial_cmp(other).unwrap());
        let mut counts = vec![0; kinds.len()];
        for (batch, _, kind) in messages {
            let now = from * 1_000 * MS + (batch * interval * SECOND) as u64;
            let (msgid, len, _) = kinds[kind];
            counts[kind] += u64::from(self.passes(msgid, len, msgid == HEARTBEAT, now));
        }
        counts
    }
}

struct Passed {
    /// Messages of each kind.
    counts: Vec<u64>,
    bytes: usize,
    /// How far ahead of the rate frames left, in seconds: on average.
    lead: f64,
}

/// The messages that a byte rate lets pass. Each tenth of a second the vehicle sends those that are due in a row.
fn passed(rate: f64, kinds: &[Kind], urgent: &[u32], seconds: u64) -> Passed {
    let mut link = Link::new(rate);
    let (mut counts, mut total, mut lead) = (vec![0; kinds.len()], 0, 0.0);
    for tenth in 0..10 * seconds {
        let mut now = (1_000 + 100 * tenth) * MS;
        for (&(msgid, len, often), count) in kinds.iter().zip(&mut counts) {
            // Evenly spread, as far as tenths go.
            let is_due = |tenth: u64| tenth * often / 100;
            for _ in is_due(tenth)..is_due(tenth + 1) {
                now += MS / 10;
                let before = link.lead(now);
                if link.passes(msgid, len, urgent.contains(&msgid), now) {
                    lead += before;
                    *count += 1;
                    total += len;
                }
            }
        }
    }
    let mean = lead / counts.iter().sum::<u64>().max(1) as f64;
    Passed { counts, bytes: total, lead: mean }
}

/// The fair rate of each stream, in messages per second, by max-min fairness. A stream is given as its rate and message
/// size. It gets its own rate, or the largest rate that all others get too.
fn fair(rate: f64, streams: &[(f64, usize)]) -> Vec<f64> {
    let bytes =
        |most: f64| -> f64 { streams.iter().map(|&(hz, len)| hz.min(most) * len as f64).sum() };
    let (mut low, mut high) = (0.0, 1e6);
    for _ in 0..100 {
        let middle = f64::midpoint(low, high);
        *(if bytes(middle) > rate { &mut high } else { &mut low }) = middle;
    }
    streams.iter().map(|&(hz, _)| hz.min(low)).collect()
}

fn fair_of_kinds(rate: f64, kinds: &[Kind]) -> Vec<f64> {
    let streams: Vec<_> = kinds.iter().map(|&(_, len, often)| (often as f64 / 10.0, len)).collect();
    fair(rate, &streams)
}

fn check(name: &str, rate: f64, kinds: &[Kind], urgent: &[u32]) {
    let seconds = 300;
    let Passed { counts, bytes, lead } = passed(rate, kinds, urgent, seconds);
    let told = format!("{name} at {rate}: {counts:?}, {bytes} bytes, {lead:.2} s ahead");
    assert!(bytes as f64 <= rate * (seconds as f64 + 2.0) + MAX_LEN, "{told}");
    let longest = kinds.iter().map(|kind| kind.1).max().unwrap_or(0) as f64 / rate;
    assert!(lead < 1.5_f64.max(160.0 / rate) + longest, "{told}");
    let (first, others): (Vec<Kind>, Vec<Kind>) =
        kinds.iter().partition(|kind| urgent.contains(&kind.0));
    let first_share = fair_of_kinds(rate, &first);
    let taken: f64 = first.iter().zip(&first_share).map(|(kind, hz)| kind.1 as f64 * hz).sum();
    let others_share = fair_of_kinds((rate - taken).max(0.0), &others);
    let shares = first_share.into_iter().chain(others_share);
    for (kind, share) in first.iter().chain(&others).zip(shares) {
        let got = kinds.iter().zip(&counts).find(|one| one.0 == kind).unwrap().1;
        let expected = share * seconds as f64;
        let near = expected * 0.85 - 2.0..=expected * 1.1 + 10.0;
        assert!(near.contains(&(*got as f64)), "{kind:?}, not {expected:.0}: {told}");
        assert!(kind.0 != HEARTBEAT || taken > rate * 0.9 || *got == 300, "{told}");
    }
}

const RATES: [f64; 9] = [40.0, 60.0, 100.0, 200.0, 300.0, 600.0, 1_200.0, 5_760.0, 100_000.0];
const VEHICLE: [Kind; 9] = [
    (30, 40, 100),
    (27, 41, 100),
    (33, 40, 50),
    (74, 32, 40),
    (1, 43, 20),
    (111, 28, 10),
    (253, 60, 10),
    (2, 24, 10),
    (HEARTBEAT, 21, 10),
];

#[test]
fn each_stream_gets_what_it_asks_for_or_its_share() {
    let mut backwards = VEHICLE;
    backwards.reverse();
    let heartbeat = [(HEARTBEAT, 21, 10)];
    let of_all_lengths = (1..31).map(|n| (n, 14 + 7 * n as usize, 40)).chain(heartbeat);
    let slow = (1..31).map(|n| (n, 50, 10)).chain(heartbeat);
    let long = (1..16).map(|n| (n, 280, 40)).chain(heartbeat);
    let kinds: [(&str, Vec<Kind>); 6] = [
        ("vehicle", VEHICLE.into()),
        ("backwards", backwards.into()),
        ("files", VEHICLE.into_iter().chain([(110, 263, 50)]).collect()),
        ("of all lengths", of_all_lengths.collect()),
        ("slow", slow.collect()),
        ("long", long.collect()),
    ];
    for (name, kinds) in kinds {
        for rate in RATES {
            check(name, rate, &kinds, &[HEARTBEAT]);
        }
    }
}

#[test]
fn urgent_streams_share_among_themselves_too() {
    for rate in [100.0, 200.0, 300.0, 600.0] {
        check("one", rate, &VEHICLE, &[30, HEARTBEAT]);
        check("two", rate, &VEHICLE, &[30, 27, HEARTBEAT]);
        check("all", rate, &VEHICLE, &VEHICLE.map(|kind| kind.0));
    }
}

#[test]
fn turns_that_were_long_for_a_while_are_forgotten() {
    let (mut link, mut passed) = (Link::new(150.0), vec![0; 8]);
    for tenth in 0..900_u64 {
        let now = (1_000 + 100 * tenth) * MS;
        for compid in (1..21).filter(|_| (200..230).contains(&tenth)) {
            link.passes_to(1, &Header { compid, ..header(V2, 22, 0) }, 37, true, now);
        }
        for (&(msgid, len, _), count) in VEHICLE.iter().zip(&mut passed) {
            let got = link.passes(msgid, len, false, now);
            *count += u32::from(got && tenth >= 300);
        }
    }
    // A minute of 9,000 bytes for frames of 308 in all.
    assert!(passed.iter().all(|count| (24..=34).contains(count)), "{passed:?}");
}

#[test]
fn a_stream_that_asks_for_little_may_ask_for_it_at_once() {
    let (mut link, mut passed) = (Link::new(300.0), [0; 2]);
    for tenth in 0..1_800_u64 {
        let mut now = (1_000 + 100 * tenth) * MS;
        let mut asks = |msgid, len| {
            now += MS / 10;
            u32::from(link.passes(msgid, len, false, now))
        };
        for msgid in 30..34 {
            asks(msgid, 40);
        }
        // A text in three pieces each ten seconds, eight parameters each fifteen.
        for _ in (0..3).filter(|_| tenth % 100 == 50) {
            passed[0] += asks(253, 60);
        }
        for _ in (0..8).filter(|_| tenth % 150 == 70) {
            passed[1] += asks(22, 37);
        }
    }
    assert!(passed[0] >= 50 && passed[1] >= 84, "{passed:?} of [54, 96]");
}

#[test]
fn made_up_streams_take_what_others_leave() {
    let (mut link, mut passed) = (Link::new(1_000.0), 0);
    for tenth in 0..1_200_u32 {
        let now = (1_000 + 100 * u64::from(tenth)) * MS;
        for made_up in 10 * tenth..10 * tenth + 10 {
            let (sysid, compid) = ((made_up >> 8) as u8, made_up as u8);
            link.passes_to(1, &Header { sysid, compid, ..header(V2, 30, 0) }, 40, false, now);
        }
        for msgid in (100..110).filter(|_| tenth % 10 == 0) {
            passed += u32::from(link.passes(msgid, 40, false, now));
        }
    }
    // 400 bytes a second are those of the vehicle.
    assert!(passed > 1_100, "{passed} of 1,200");
}

const FAST_VEHICLE: [Kind; 8] = [
    (30, 40, 500),
    (27, 41, 500),
    (33, 40, 100),
    (74, 32, 40),
    (1, 43, 20),
    (111, 28, 10),
    (253, 60, 10),
    (HEARTBEAT, 21, 10),
];

#[test]
fn batches_are_shared_like_single_messages() {
    for interval in [0.02, 0.1, 0.2, 0.5] {
        let counts = Link::new(2_000.0).in_batches(&FAST_VEHICLE, interval, 1, 300);
        for ((&count, kind), share) in
            counts.iter().zip(FAST_VEHICLE).zip(fair_of_kinds(2_000.0, &FAST_VEHICLE))
        {
            let share = share * 300.0;
            let near = share * 0.75 - 2.0..share * 1.25;
            assert!(
                near.contains(&(count as f64)),
                "{kind:?}, not {share:.0}: {counts:?}, {interval} s"
            );
        }
    }
}

#[test]
fn of_rare_bursts_that_are_too_long_all_get_something() {
    let kinds = |often| (100..110).map(move |msgid| (msgid, 40, often)).collect::<Vec<Kind>>();
    for (often, interval, rate) in
        [(2, 5.0, 100.0), (2, 5.0, 60.0), (5, 2.0, 180.0), (5, 2.0, 210.0)]
    {
        let counts = Link::new(rate).in_batches(&kinds(often), interval, 1, 600);
        let most = counts.iter().max().unwrap();
        assert!(counts.iter().all(|count| 4 * count > *most), "{counts:?} at {rate}");
    }
    for interval in [2.0, 3.0, 5.0, 10.0] {
        let counts = Link::new(300.0).in_batches(&VEHICLE, interval, 1, 600);
        let bursts = (600.0 / interval) as u64;
        assert!(counts.iter().all(|&count| count + 2 >= bursts), "{counts:?} each {interval} s");
    }
}

#[test]
fn after_an_absence_rare_bursts_are_waited_for_again() {
    let (mut link, kinds) = (Link::new(60.0), (100..110).map(|msgid| (msgid, 40, 2)));
    let kinds: Vec<Kind> = kinds.collect();
    link.in_batches(&kinds, 5.0, 1, 60);
    let counts = link.in_batches(&kinds, 5.0, 3_661, 300);
    let (least, most) = (counts.iter().min().unwrap(), counts.iter().max().unwrap());
    assert!(4 * least > *most, "{counts:?}");
}

#[test]
fn rare_types_that_come_in_one_moment_pass_as_far_as_they_fit() {
    // Bytes a second, types, and how many of 100 pass of each. The first lines are in docs/bridge.md.
    for (rate, rare, near) in [
        (100.0, 3, 30..=99),
        (100.0, 10, 10..=50),
        (200.0, 3, 95..=100),
        (1_000.0, 10, 95..=100),
        (2_000.0, 24, 95..=100),
    ] {
        let (mut link, mut passed) = (Link::new(rate), vec![0; rare]);
        for tenth in 0..20_000 {
            let now = (1_000 + 100 * tenth) * MS;
            (100..150).for_each(|msgid| _ = link.passes(msgid, 40, false, now));
            for msgid in (0..rare).filter(|_| tenth % 200 == 45) {
                passed[msgid] += u32::from(link.passes(msgid as u32 + 1, 50, false, now));
            }
        }
        assert!(passed.iter().all(|count| near.contains(count)), "{passed:?} at {rate}");
    }
}

#[test]
fn after_an_absence_all_have_their_share_at_once() {
    for absence in [0, 30, 300, 3_600] {
        let mut link = Link::new(200.0);
        link.in_batches(&VEHICLE, 0.1, 1, 60);
        let counts = link.in_batches(&VEHICLE, 0.1, 61 + absence, 10);
        assert!(
            counts.iter().all(|count| (4..=10).contains(count)),
            "{counts:?} after {absence} s"
        );
    }
}

#[test]
fn a_rare_type_passes_that_comes_behind_others() {
    let kinds: [Kind; 4] = [(HEARTBEAT, 21, 10), (148, 72, 5), (253, 30, 10), (2, 24, 1)];
    let counts = Link::new(66.0).in_batches(&kinds, 1.0, 1, 300);
    assert!(counts[3] >= 28, "{counts:?}");
}

/// Numbers that look random, from 0 to 1.
fn random(state: &mut u64) -> f64 {
    for shift in [13, 7, 17] {
        *state ^= if shift == 7 { *state >> shift } else { *state << shift };
    }
    (*state >> 11) as f64 / (1_u64 << 53) as f64
}

#[test]
fn urgent_ones_pass_as_if_there_were_no_others() {
    for rate in [25.0, 100.0, 200.0, 600.0] {
        let (mut alone, mut beside, mut state) = (Link::new(rate), Link::new(rate), 1);
        let (mut now, mut at) = (1_000 * MS, 0);
        for _ in 0..1_000 {
            now += (-(1.0 - random(&mut state)).ln() * SECOND / 3.0) as u64;
            while at < now {
                beside.passes(27, 40, false, at);
                at += 90 * MS;
            }
            let passes = alone.passes(76, 33, true, now);
            assert_eq!(beside.passes(76, 33, true, now), passes, "{rate} at {now}");
        }
    }
}

#[test]
fn whoever_is_silent_for_long_makes_up_for_eight_rounds_and_no_more() {
    let mut link = Link::new(10_000.0);
    for second in 1..5 {
        link.passes(1, 40, false, 1_000 * second * MS);
    }
    for ms in 0..30_000 {
        link.passes(30, 40, false, (5_000 + ms) * MS);
    }
    let now = 35_000 * MS;
    let burst = (0..100).filter(|_| link.passes(1, 40, false, now)).count();
    assert_eq!(burst, 9, "this round, too");
    // Then both alike.
    let mut passed = [0; 2];
    for ms in 0..1_000 {
        let now = now + ms * MS;
        passed[0] += u32::from(link.passes(30, 40, false, now));
        passed[1] += u32::from(link.passes(1, 40, false, now));
    }
    assert!(passed.iter().all(|passed| (110..=130).contains(passed)), "{passed:?}");
}

#[test]
fn a_type_that_was_never_there_passes_at_once_on_a_busy_link() {
    let (mut link, mut passed) = (Link::new(1_000.0), 0);
    for tick in 0..3_000 {
        let now = (1_000 + 10 * tick) * MS;
        let is_at_its_limit = link.passes(30, 40, false, now) && link.lead(now) > 0.1;
        if is_at_its_limit && tick % 100 < 10 {
            passed += u32::from(link.passes(100 + tick as u32, 40, false, now));
            assert!(link.lead(now) > 0.15, "it was busy");
        }
    }
    assert!(passed >= 25, "{passed}");
}

#[test]
fn what_a_stream_that_ended_had_is_the_others() {
    let mut link = Link::new(200.0);
    let nine: Vec<Kind> = (1..10).map(|msgid| (msgid, 40, 50)).collect();
    link.in_batches(&nine, 0.1, 1, 60);
    let counts = link.in_batches(&nine[..2], 0.1, 61, 10);
    assert!(counts.iter().all(|count| (20..=32).contains(count)), "{counts:?}");
}

#[test]
fn types_that_come_several_times_in_a_rare_burst_all_get_something() {
    // Of each kind in a burst, milliseconds between two, and bytes a second.
    for (times, apart, rate) in
        [(2, 2, 60.0), (2, 2, 100.0), (12, 0, 60.0), (12, 0, 100.0), (12, 2, 100.0)]
    {
        let (mut link, mut counts) = (Link::new(rate), [0; 10]);
        for burst in 0..120_u64 {
            for n in 0..10 * times {
                let now = (1_000 + 5_000 * burst + apart * (n / 10)) * MS;
                let kind = n as usize % 10;
                counts[kind] += u32::from(link.passes(kind as u32 + 1, 40, false, now));
            }
        }
        let (least, most) = (counts.iter().min().unwrap(), counts.iter().max().unwrap());
        assert!(4 * least > *most, "{counts:?}, {times} each {apart} ms at {rate}");
    }
}

#[test]
fn rare_types_pass_beside_steady_ones_and_do_not_stop_them() {
    // Rare types, bytes of each, tenths of a second between, bytes a second.
    for (rare, len, each, rate) in
        [(30, 40, 100, 300.0), (20, 50, 500, 100.0), (100, 40, 300, 600.0)]
    {
        let (mut link, mut counts, mut bytes) = (Link::new(rate), vec![0; rare as usize], 0);
        let (mut passed_at, mut longest) = (0, 0);
        for tenth in 0..6_000_u64 {
            let now = (1_000 + 100 * tenth) * MS;
            for msgid in 1_000..1_004 {
                if link.passes(msgid, 40, false, now) {
                    (bytes, passed_at) = (bytes + 40, tenth);
                }
            }
            for msgid in (0..rare).filter(|_| tenth % each == 50) {
                if link.passes(msgid + 1, len, false, now) {
                    counts[msgid as usize] += 1;
                    (bytes, passed_at) = (bytes + len, tenth);
                }
            }
            longest = longest.max(tenth - passed_at);
        }
        let told =
            format!("{rare} at {rate}: {counts:?}, {bytes} bytes, {longest} tenths of silence");
        assert!(bytes as f64 > 600.0 * rate * 0.9 && longest <= 50, "{told}");
        assert!(each > 100 || counts.iter().all(|&count| count > 6), "{told}");
    }
}

#[test]
fn a_frame_for_several_peers_takes_one_turn() {
    let (mut link, mut counts) = (Link::new(1_000.0), [0; 2]);
    for hundredth in 0..12_000 {
        let now = (1_000 + 10 * hundredth) * MS;
        let (msgid, peers) = [(1, 5), (2, 1)][hundredth as usize % 2];
        let got = link.passes_to(peers, &header(V2, msgid, 0), 40, false, now);
        counts[hundredth as usize % 2] += u32::from(got);
    }
    // 120,000 bytes: as many frames of 200 as of 40.
    assert!(counts.iter().all(|count| (470..=530).contains(count)), "{counts:?}");
}

#[test]
fn streams_that_are_too_many_are_forgotten() {
    let mut rounds = Rounds::new(1e6);
    for key in 0..2 * rounds::MAX_STREAMS as u64 {
        rounds.arrive(key, key);
        assert!(rounds.known() <= rounds::MAX_STREAMS);
    }
}

#[test]
fn clocks_that_jump_do_no_harm() {
    for rate in [1.0, 5_760.0, 2_f64.powi(63)] {
        let mut link = Link::new(rate);
        for start in [0, u64::MAX / 2, 1, u64::MAX, u64::MAX - 1_000 * MS, 0, u64::MAX] {
            for n in 0..2_000_u32 {
                let now = start.saturating_add(u64::from(n) * MS);
                link.passes(n % 7, 40, n % 7 == 0, now);
            }
        }
        let ahead = Link::new(rate).passes(1, 40, false, u64::MAX);
        assert!(ahead, "at the end of all time");
    }
}
